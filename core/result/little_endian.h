#pragma once

#include <string>
#include <type_traits>

namespace plumbline {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "values are written as they lie");

// Appends the bytes of a number, the least significant first, as LAS and E57 files hold it.
template <typename Value>
void AppendLittleEndian(Value value, std::string* bytes) {
  static_assert(std::is_arithmetic_v<Value>);
  bytes->append(reinterpret_cast<const char*>(&value), sizeof(value));
}

}  // namespace plumbline
