#include "core/estimation/arrowhead_inverse.h"

#include <glog/logging.h>

#include <algorithm>

namespace plumbline {

Eigen::MatrixXd ArrowheadInverse::BandBlock(int first, int size) const {
  const int split = std::min(size, tile_size_ - first % tile_size_);
  const int rest = size - split;
  CHECK_LE(rest, tile_size_) << "outside the band";
  const auto index = static_cast<size_t>(first / tile_size_);
  const int at = first % tile_size_;
  Eigen::MatrixXd block(size, size);
  block.topLeftCorner(split, split) = tiles_[index].diagonal.block(at, at, split, split);
  if (rest > 0) {
    block.bottomLeftCorner(rest, split) = tiles_[index].next.block(0, at, rest, split);
    block.topRightCorner(split, rest) = block.bottomLeftCorner(rest, split).transpose();
    block.bottomRightCorner(rest, rest) = tiles_[index + 1].diagonal.topLeftCorner(rest, rest);
  }
  return block;
}

void ArrowheadInverse::Clear(int variable) {
  const int num_band = tiles_.empty() ? 0 : tiles_.back().first + tiles_.back().size();
  if (variable < num_band) {
    ArrowheadTile& tile = tiles_[static_cast<size_t>(variable / tile_size_)];
    tile.diagonal(variable - tile.first, variable - tile.first) = 0.0;
  } else {
    border_.row(variable - num_band).setZero();
    border_.col(variable - num_band).setZero();
  }
}

}  // namespace plumbline
