#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"

namespace plumbline {

struct ImageMessage;

// PinholeModel says through which point of a rectified image a direction goes: p = (x, y, z)
// in the camera's optical frame (x right, y down, z ahead) through column focal_x x / z +
// centre_x and row focal_y y / z + centre_y, counted from the middle of the first pixel.
struct PinholeModel {
  int width = 0;  // pixels, as are the others
  int height = 0;
  double focal_x = 0.0;
  double focal_y = 0.0;
  double centre_x = 0.0;
  double centre_y = 0.0;
};

// DepthCamera describes a camera whose pixels hold depths. Every row of its image lies in a
// plane through the camera's centre: it is a scan line, and a scanner of the rig takes it.
// What these scanners have in common (noise, reach, clock) stands with them.
struct DepthCamera {
  std::string name;
  std::string topic;         // of its sensor_msgs/Image messages
  std::string info_topic;    // of its sensor_msgs/CameraInfo messages
  Rigid3d body_from_camera;  // of the optical frame
  int num_rows = 20;         // that are used, spread evenly over the image
  PinholeModel model;        // as the rig file states it, then as a recording does
};

// CameraRow says which row of which camera's images a scanner takes.
struct CameraRow {
  size_t camera = 0;  // position in Rig::depth_cameras
  int row = 0;        // of the image, from above
};

// The model of an image of this size whose axis goes through its middle, given the angles from
// edge to edge, rad.
PinholeModel ModelOf(int width, int height, double across_rad, double upright_rad);

// The row of the image that is the one of so many used rows, from above.
int ImageRow(const PinholeModel& model, int used_row, int num_rows);

// Pose of the scanner that takes a row: its x axis goes through the row's point above or below
// the optical centre, its y axis to the left.
Rigid3d CameraFromRow(const PinholeModel& model, int row);

// Angles of a row's beams in that scanner's frame, rad: one for each pixel, from the right to
// the left, so that they increase.
std::vector<float> RowAngles(const PinholeModel& model, int row);

// Whether depths in an image's encoding are known: "16UC1" (mm) and "32FC1" (m).
bool HoldsDepths(const ImageMessage& image);

// Bytes that the pixels of a row of such an image take.
size_t BytesOfRow(const ImageMessage& image);

// The ranges of a row's beams, m, in the order of their angles; NaN without a depth. The image
// has to be of the model's size and to hold depths.
std::vector<float> RowRanges(const ImageMessage& image, const PinholeModel& model, int row);

// The depth along the optical axis of a point at a range, m, in a column of a row.
double DepthOf(const PinholeModel& model, int row, int column, double range_m);

}  // namespace plumbline
