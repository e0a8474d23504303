#pragma once

#include <string>
#include <vector>

#include "core/outputs/data_section.h"
#include "core/outputs/quantised_points.h"
#include "core/outputs/report.h"

namespace plumbline {

// The content of a report: a JSON text, numbers as sections, and the points.
//
// The text is one object: title; start_s, when the recording begins, on its clock; summary,
// planes, loop_closures, calibration and evaluation as docs/outputs.md describes these files
// (the last two null where there are none); floor_plans and num_poses, how many there are;
// part_reports, whether those of parts stand where this one can name them;
// covariance_plane_ids, the planes whose parameters the section holds, in its order;
// statistics of all points.
//
// Sections, little-endian:
//   poses             float32 per pose: t since start_s, x, y, z, qx, qy, qz, qw, and the
//   largest
//                     standard deviations over all directions of position (m) and rotation
//                     (rad)
//   covariance        the lower triangle, row by row, of the joint covariance, float64, as
//   eight
//                     arrays: the first bytes of all numbers, the second ones, ...
//   floor-plan-<i>    SVG, from 1
struct ReportContent {
  std::string json;
  std::vector<DataSection> sections;
  QuantisedPoints points;
};

// Reads the result. Throws Error naming the file and what is wrong with it.
ReportContent ReadReportContent(const ReportJob& job);

}  // namespace plumbline
