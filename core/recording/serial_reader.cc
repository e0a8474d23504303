#include "core/recording/serial_reader.h"

namespace plumbline {

bool SerialReader::ForCdr(ByteView message, SerialReader* reader) {
  constexpr size_t kEncapsulationBytes = 4;  // representation (2 bytes), options (2)
  if (message.size < kEncapsulationBytes || message.data[0] != 0 || message.data[1] > 1) {
    return false;
  }
  *reader =
      SerialReader({message.data + kEncapsulationBytes, message.size - kEncapsulationBytes});
  reader->is_cdr_ = true;
  reader->is_big_endian_ = message.data[1] == 0;
  return true;
}

bool SerialReader::Align(size_t size) {
  if (!is_cdr_) return true;
  const size_t gap = (size - position_ % size) % size;
  if (gap > num_left()) return false;
  position_ += gap;
  return true;
}

bool SerialReader::TakeBytes(size_t size, ByteView* bytes) {
  if (size > num_left()) return false;
  *bytes = {bytes_.data + position_, size};
  position_ += size;
  return true;
}

bool SerialReader::TakeText(std::string* text) {
  uint32_t length = 0;
  ByteView bytes;
  if (!Take(&length) || !TakeBytes(length, &bytes)) return false;
  if (is_cdr_ && bytes.size > 0 && bytes.data[bytes.size - 1] == 0) --bytes.size;
  text->assign(reinterpret_cast<const char*>(bytes.data), bytes.size);
  return true;
}

bool SerialReader::TakeFloats(uint32_t* count, std::vector<float>* floats) {
  ByteView bytes;
  if (!Take(count) || !TakeBytes(size_t{*count} * sizeof(float), &bytes)) return false;
  if (floats == nullptr) return true;
  floats->resize(*count);
  if (!is_big_endian_) {
    if (bytes.size > 0) std::memcpy(floats->data(), bytes.data, bytes.size);
    return true;
  }
  for (size_t i = 0; i < *count; ++i) {
    (*floats)[i] = NumberAt<float>(bytes.data + i * sizeof(float));
  }
  return true;
}

bool SerialReader::TakeHeader(int64_t* stamp_ns, std::string* frame_id) {
  uint32_t sequence = 0;
  if (!is_cdr_ && !Take(&sequence)) return false;
  uint32_t seconds = 0;  // ROS 2 has a sign: what comes after 2038 is before 1970 there
  uint32_t nanoseconds = 0;
  if (!Take(&seconds) || !Take(&nanoseconds)) return false;
  *stamp_ns = int64_t{seconds} * 1'000'000'000 + nanoseconds;
  return TakeText(frame_id);
}

}  // namespace plumbline
