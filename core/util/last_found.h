#pragma once

namespace plumbline {

// LastFound remembers which entry of a map its owner asked for last. A copy of the owner has a
// map of its own: it remembers nothing.
template <typename Key, typename Value>
class LastFound {
 public:
  LastFound() = default;
  LastFound(const LastFound& /*other*/) {}
  LastFound& operator=(const LastFound& /*other*/) {
    Forget();
    return *this;
  }

  // The entry if it is that of the key, or nullptr.
  Value* Get(const Key& key) const { return key_ == key ? value_ : nullptr; }
  void Set(const Key& key, Value* value) {
    key_ = key;
    value_ = value;
  }
  void Forget() { value_ = nullptr; }

 private:
  Key key_ = {};
  Value* value_ = nullptr;
};

}  // namespace plumbline
