#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <deque>
#include <fstream>
#include <string>
#include <type_traits>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/map/map_state.h"
#include "core/util/checksum.h"
#include "factors/util/compact_array.h"

namespace plumbline {

// A file that values are written to, or read from in the same order. A value visited is
// written or replaced, bit by bit: the file is for the same program on the same kind of
// machine. It ends with a checksum, so that what is read is what was written, or nothing.
class BinaryArchive {
 public:
  enum class Mode { kWrite, kRead };

  // Throws Error when the file can not be opened, or is damaged.
  BinaryArchive(const std::string& path, Mode mode);
  // Ends the file: its bytes are on their way to the disk, or have all been read. Throws
  // Error.
  void Finish();

  bool is_reading() const { return mode_ == Mode::kRead; }

  template <typename T>
  std::enable_if_t<std::is_arithmetic_v<T> || std::is_enum_v<T>> operator()(T& value) {
    Bytes(&value, sizeof(value));
  }
  template <typename T, size_t kSize>
  void operator()(std::array<T, kSize>& values) {
    for (T& value : values) (*this)(value);
  }
  template <typename T, int kRows, int kColumns, int kOptions>
  void operator()(Eigen::Matrix<T, kRows, kColumns, kOptions>& matrix) {
    int64_t rows = matrix.rows();
    int64_t columns = matrix.cols();
    (*this)(rows);
    (*this)(columns);
    if (is_reading()) {
      CheckSize(rows, static_cast<int64_t>(sizeof(T)));
      CheckSize(columns, rows * static_cast<int64_t>(sizeof(T)));
      matrix.resize(rows, columns);
    }
    Bytes(matrix.data(), static_cast<size_t>(matrix.size()) * sizeof(T));
  }
  void operator()(Eigen::Quaterniond& rotation) { (*this)(rotation.coeffs()); }
  void operator()(std::string& text) { NumberSequence(&text); }
  template <typename T>
  void operator()(std::vector<T>& values) {
    if constexpr (std::is_arithmetic_v<T>) {
      NumberSequence(&values);
    } else {
      Sequence(&values);
    }
  }
  template <typename T>
  void operator()(std::deque<T>& values) {
    Sequence(&values);
  }
  template <typename T>
  void operator()(CompactArray<T>& values) {
    std::vector<T> copy(values.begin(), values.end());
    (*this)(copy);
    if (is_reading()) values = CompactArray<T>(copy);
  }
  void operator()(Rigid3d& pose);
  void operator()(ControlPoint& point);
  void operator()(ObservedPoint& point);
  void operator()(Observation& observation);
  void operator()(Landmark& landmark);
  void operator()(MovingBeams& beams);
  void operator()(PoseConstraint& constraint);
  void operator()(MapGap& gap);
  void operator()(ScannerEstimate& scanner);
  void operator()(ImuBiases& biases);
  void operator()(ImuEstimate& imu);
  void operator()(MapState& state);

 private:
  template <typename Container>
  void Sequence(Container* values) {
    auto size = static_cast<int64_t>(values->size());
    (*this)(size);
    if (is_reading()) {
      CheckSize(size, 1);
      values->resize(static_cast<size_t>(size));
    }
    for (auto& value : *values) (*this)(value);
  }
  template <typename Container>
  void NumberSequence(Container* values) {
    auto size = static_cast<int64_t>(values->size());
    constexpr auto kBytesEach = static_cast<int64_t>(sizeof(typename Container::value_type));
    (*this)(size);
    if (is_reading()) {
      CheckSize(size, kBytesEach);
      values->resize(static_cast<size_t>(size));
    }
    Bytes(values->data(), static_cast<size_t>(size * kBytesEach));
  }

  // Throws Error where a file to be read does not end with the checksum of what it holds.
  void CheckWhole();
  void Bytes(void* data, size_t size);
  // Throws Error where the file is too short for num_elements of bytes_each.
  void CheckSize(int64_t num_elements, int64_t bytes_each) const;
  [[noreturn]] void FailAsDamaged() const;

  std::string path_;
  Mode mode_;
  std::fstream stream_;
  int64_t num_left_ = 0;  // bytes of a file that have not been read, without the checksum
  Checksum checksum_;     // of what has been written
};

}  // namespace plumbline
