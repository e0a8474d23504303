#include "core/result/result_writer.h"

#include <glog/logging.h>

#include "core/result/calibration_text.h"
#include "core/result/result_files.h"
#include "core/result/result_text.h"
#include "core/util/atomic_file.h"

namespace plumbline {

struct ResultWriter::Impl {
  Impl(const ResultDirectory& directory,
       const std::string& part,
       const std::vector<CloudFormat>& formats)
      : folder(directory.Folder(part)), final_name(directory.FinalName(part)) {
    for (const CloudFormat format : formats) {
      const std::string file = "/" + CloudFileName(format);
      clouds.push_back(CreatePointCloudWriter(format, folder + file, final_name + file));
    }
  }

  void Write(const std::string& name, const std::string& content) {
    CHECK(IsResultFile(name)) << name;
    WriteWholeFile(folder + "/" + name, content, final_name + "/" + name);
  }

  std::string folder;
  std::string final_name;
  std::vector<std::unique_ptr<PointCloudWriter>> clouds;
};

ResultWriter::ResultWriter(const ResultDirectory& directory,
                           const std::string& part,
                           const std::vector<CloudFormat>& formats)
    : impl_(std::make_unique<Impl>(directory, part, formats)) {}

ResultWriter::~ResultWriter() = default;

void ResultWriter::WriteTrajectory(const std::vector<StampedPose>& poses) {
  impl_->Write("trajectory.tum", FormatTrajectory(poses));
}

void ResultWriter::WritePlanes(const std::vector<PlanePatch>& planes) {
  impl_->Write("planes.json", FormatPlanes(planes));
  impl_->Write("planes.ply", FormatPlanePolygons(planes));
}

void ResultWriter::WriteTrajectoryCovariance(const std::vector<StampedCovariance>& poses) {
  impl_->Write("trajectory_covariance.csv", FormatTrajectoryCovariance(poses));
}

void ResultWriter::WritePlaneCovariance(const PlaneCovariance& covariance) {
  impl_->Write("plane_covariance.csv", FormatPlaneCovariance(covariance));
}

void ResultWriter::WriteWindow(const std::vector<StampedPose>& poses,
                               const std::vector<StampedCovariance>& covariances,
                               const PlaneCovariance& planes) {
  impl_->Write("window_trajectory.tum", FormatTrajectory(poses));
  impl_->Write("window_trajectory_covariance.csv", FormatTrajectoryCovariance(covariances));
  impl_->Write("window_planes.json", FormatPlanes(planes.planes()));
  impl_->Write("window_plane_covariance.csv", FormatPlaneCovariance(planes));
}

void ResultWriter::WriteLoopClosures(const std::vector<LoopClosure>& closures) {
  impl_->Write("loop_closures.json", FormatLoopClosures(closures));
}

void ResultWriter::AddMapPoints(const PointBuffer& points) {
  for (const auto& cloud : impl_->clouds) cloud->Add(points);
}

void ResultWriter::WriteCalibration(const Calibration& calibration) {
  impl_->Write("calibration.json", FormatCalibration(calibration));
}

void ResultWriter::WriteSummary(const Summary& summary) {
  impl_->Write("summary.json", FormatSummary(summary));
}

void ResultWriter::WriteConfig(const std::string& yaml) {
  const bool complete = !yaml.empty() && yaml.back() == '\n';
  impl_->Write("config_used.yaml", complete ? yaml : yaml + "\n");
}

void ResultWriter::Finish() {
  for (const auto& cloud : impl_->clouds) cloud->Finish();
}

}  // namespace plumbline
