#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/result/plane_covariance.h"
#include "core/result/point_cloud_writer.h"
#include "core/result/result_directory.h"
#include "core/result/result_types.h"

namespace plumbline {

// ResultWriter writes the files of docs/outputs.md into a directory that becomes the output of
// a run when it is whole: that of a map, or of one part of it. A file that is written a second
// time replaces the first. Throws Error naming the file that could not be written.
class ResultWriter {
 public:
  // part: "" or a folder named as result_files.h says. formats: of the map's points.
  explicit ResultWriter(
      const ResultDirectory& directory,
      const std::string& part = "",
      const std::vector<CloudFormat>& formats = ParseCloudFormats(kDefaultCloudFormats));
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
  void WriteLoopClosures(const std::vector<LoopClosure>& closures);  // loop_closures.json
  void AddMapPoints(const PointBuffer& points);                      // map.ply, map.pcd, ...
  void WriteCalibration(const Calibration& calibration);             // calibration.json
  void WriteSummary(const Summary& summary);                         // summary.json
  void WriteConfig(const std::string& yaml);                         // config_used.yaml
  void Finish();  // completes all files; call once, at the end

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plumbline
