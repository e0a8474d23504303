#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/result/plane_covariance.h"
#include "core/result/point_buffer.h"
#include "core/result/result_types.h"

namespace plumbline {

// ResultWriter writes the output directory of one run. Everything is written under temporary
// names inside it and moved to the names of docs/outputs.md by Commit(), all or nothing: files
// of an earlier result with these names are replaced only then. Without Commit() the temporary
// files are removed. Throws Error naming the file that could not be written.
class ResultWriter {
 public:
  explicit ResultWriter(const std::string& directory);  // created where it is missing
  ~ResultWriter();

  void WriteTrajectory(const std::vector<StampedPose>& poses);  // trajectory.tum
  void WritePlanes(const std::vector<PlanePatch>& planes);      // planes.json, planes.ply
  void WriteTrajectoryCovariance(const std::vector<StampedCovariance>& poses);
  void WritePlaneCovariance(const PlaneCovariance& covariance);  // plane_covariance.csv
  // window_trajectory.tum and window_trajectory_covariance.csv; window_planes.json and
  // window_plane_covariance.csv.
  void WriteWindow(const std::vector<StampedPose>& poses,
                   const std::vector<StampedCovariance>& covariances,
                   const PlaneCovariance& planes);
  void AddMapPoints(const PointBuffer& points);  // map.ply, map.pcd
  void WriteSummary(const Summary& summary);     // summary.json
  void WriteConfig(const std::string& yaml);     // config_used.yaml
  void Commit();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plumbline
