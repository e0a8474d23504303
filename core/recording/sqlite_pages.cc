#include "core/recording/sqlite_pages.h"

#include <algorithm>
#include <array>

#include "core/recording/message_limits.h"

namespace plumbline {
namespace {

constexpr uint64_t kHeaderBytes = 100;  // of the file
constexpr uint64_t kLeafHeaderBytes = 8;
constexpr uint8_t kTableLeaf = 13;
constexpr uint64_t kMaxVarintBytes = 9;

uint64_t BigEndian(const uint8_t* bytes, size_t size) {
  uint64_t number = 0;
  for (size_t i = 0; i < size; ++i) number = (number << 8) | bytes[i];
  return number;
}

// Numbers of SQLite's formats from the front of bytes.
class Cursor {
 public:
  Cursor(const uint8_t* bytes, size_t size) : bytes_(bytes), size_(size) {}

  size_t position() const { return position_; }
  bool TakeVarint(uint64_t* value) {
    *value = 0;
    for (size_t i = 0; i < kMaxVarintBytes; ++i) {
      if (position_ >= size_) return false;
      const uint8_t byte = bytes_[position_++];
      if (i + 1 == kMaxVarintBytes) {
        *value = (*value << 8) | byte;
        return true;
      }
      *value = (*value << 7) | (byte & 0x7fu);
      if (byte < 0x80) return true;
    }
    return true;
  }
  // An integer column, of the type that the row's header states.
  bool TakeInteger(uint64_t type, int64_t* value) {
    constexpr std::array<size_t, 7> kSizes = {0, 1, 2, 3, 4, 6, 8};
    if (type == 8 || type == 9) {
      *value = static_cast<int64_t>(type) - 8;
      return true;
    }
    if (type == 0 || type >= kSizes.size()) return false;
    const size_t size = kSizes[type];
    if (size > size_ - position_) return false;
    const auto number = BigEndian(bytes_ + position_, size) << (64 - 8 * size);
    *value = static_cast<int64_t>(number) >> (64 - 8 * size);  // with its sign
    position_ += size;
    return true;
  }

 private:
  const uint8_t* bytes_;
  size_t size_;
  size_t position_ = 0;
};

}  // namespace

SqlitePages::SqlitePages(const std::string& path, const std::string& name)
    : file_(path, name) {
  if (file_.size() < kHeaderBytes) return;
  std::array<uint8_t, kHeaderBytes> header;
  file_.Read(0, header.size(), header.data());
  page_bytes_ = BigEndian(&header[16], 2);
  if (page_bytes_ == 1) page_bytes_ = 65'536;
  if (page_bytes_ < 512 || page_bytes_ - header[20] < 480) return;
  usable_bytes_ = page_bytes_ - header[20];
  FindRows();
}

void SqlitePages::FindRows() {
  std::vector<uint8_t> page(page_bytes_);
  for (uint64_t begin = 0; begin + page_bytes_ <= file_.size(); begin += page_bytes_) {
    file_.Read(begin, page.size(), page.data());
    const uint64_t start = begin == 0 ? kHeaderBytes : 0;
    if (page[start] != kTableLeaf) continue;
    const uint64_t num_cells = BigEndian(&page[start + 3], 2);
    const uint64_t pointers = start + kLeafHeaderBytes;
    for (uint64_t i = 0; i < num_cells && pointers + 2 * i + 2 <= page_bytes_; ++i) {
      const uint64_t cell = BigEndian(&page[pointers + 2 * i], 2);
      Row row;
      if (cell < page_bytes_ && ReadRow(begin + cell, &row))
        rows_.emplace(row.id, begin + cell);
    }
  }
}

// Reads a row's payload: what of it stands in the page, and the pages to which it flows over.
bool SqlitePages::ReadPayload(uint64_t begin, uint64_t size) {
  const uint64_t most = usable_bytes_ - 35;
  uint64_t here = size;
  if (size > most) {
    const uint64_t least = (usable_bytes_ - 12) * 32 / 255 - 23;
    const uint64_t wanted = least + (size - least) % (usable_bytes_ - 4);
    here = wanted <= most ? wanted : least;
  }
  const uint64_t end_of_page = (begin / page_bytes_) * page_bytes_ + usable_bytes_;
  if (begin + here + (here < size ? 4 : 0) > std::min(end_of_page, file_.size())) return false;
  payload_.resize(size);
  file_.Read(begin, here, payload_.data());
  std::array<uint8_t, 4> next;
  uint64_t next_place = begin + here;
  while (here < size) {
    file_.Read(next_place, next.size(), next.data());
    const uint64_t page = BigEndian(next.data(), 4);
    if (page == 0 || page * page_bytes_ > file_.size()) return false;
    next_place = (page - 1) * page_bytes_;
    const uint64_t some = std::min(size - here, usable_bytes_ - 4);
    file_.Read(next_place + 4, some, &payload_[here]);
    here += some;
  }
  return true;
}

bool SqlitePages::ReadRow(uint64_t place, Row* row) {
  std::array<uint8_t, 2 * kMaxVarintBytes> head = {};
  if (place >= file_.size()) return false;
  const auto num_bytes = std::min<uint64_t>(head.size(), file_.size() - place);
  file_.Read(place, num_bytes, head.data());
  Cursor cell(head.data(), num_bytes);
  uint64_t size = 0;
  uint64_t id = 0;
  if (!cell.TakeVarint(&size) || !cell.TakeVarint(&id) || size == 0 ||
      size > kMaxMessageBytes || size > file_.size() ||
      !ReadPayload(place + cell.position(), size)) {
    return false;
  }
  // The header: its size, and the type of each column. That of an id is NULL.
  Cursor columns(payload_.data(), payload_.size());
  uint64_t header_size = 0;
  std::array<uint64_t, 4> types;
  if (!columns.TakeVarint(&header_size)) return false;
  for (uint64_t& type : types) {
    if (!columns.TakeVarint(&type)) return false;
  }
  if (columns.position() != header_size || types[0] != 0 || types[3] < 12 ||
      types[3] % 2 != 0) {
    return false;
  }
  row->id = static_cast<int64_t>(id);
  if (!columns.TakeInteger(types[1], &row->topic_id) ||
      !columns.TakeInteger(types[2], &row->timestamp_ns)) {
    return false;
  }
  const uint64_t data_size = (types[3] - 12) / 2;
  if (columns.position() + data_size != payload_.size()) return false;
  row->data = {payload_.data() + columns.position(), static_cast<size_t>(data_size)};
  return true;
}

}  // namespace plumbline
