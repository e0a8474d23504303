#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "factors/segment/segment_measurement.h"

namespace plumbline {

// Compresses the points (scanner frame, m; measured positions, motion not removed) with their
// instants in ascending order and their whitening in 1/m. The whitening does not know the
// plane and is chosen by the caller: 1 / (sigma_range |n . beam|), n the plane's normal in the
// scanner frame, makes e_i the range residual in standard deviations.
//
// offsets: of the points, whitened: e_i = w_i (x_i, y_i, 1) . g(t_i) + offsets_i; empty: none.
//
// Rows of U that can not matter are left out: with g_1 bounded by (1, 1, 100 m), rotation
// rates by 10 rad/s, speeds by 10 m/s and accelerations by 100 rad/s^2 and 100 m/s^2, what is
// left out changes the root of |U g|^2 by less than 1e-3 standard deviations of one range.
//
// nodes: the segment's own first, middle and last instant (to 1 ns), or those of a longer span
// around it, such that segments taken together share the poses at their nodes.
SegmentMeasurement CompressSegment(const Eigen::Matrix2Xd& points_scanner,
                                   const std::vector<int64_t>& times_ns,
                                   const Eigen::VectorXd& whitening,
                                   const Eigen::VectorXd& offsets,
                                   const std::array<int64_t, 3>& nodes_ns);
SegmentMeasurement CompressSegment(const Eigen::Matrix2Xd& points_scanner,
                                   const std::vector<int64_t>& times_ns,
                                   const Eigen::VectorXd& whitening,
                                   const Eigen::VectorXd& offsets = {});

}  // namespace plumbline
