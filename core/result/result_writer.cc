#include "core/result/result_writer.h"

#include <glog/logging.h>

#include <filesystem>
#include <map>
#include <system_error>

#include "core/result/point_cloud_writer.h"
#include "core/result/result_text.h"
#include "core/util/atomic_file.h"
#include "core/util/error.h"

namespace plumbline {

namespace fs = std::filesystem;

namespace {

// Returns whether the directory had to be created.
bool CreateDirectory(const std::string& directory) {
  std::error_code error;
  const bool created = fs::create_directories(directory, error);
  if (error) {
    throw Error(directory + ": can not be used as output directory: " + error.message());
  }
  if (!fs::is_directory(directory, error)) {
    throw Error(directory + ": can not be used as output directory: it is a file");
  }
  return created;
}

}  // namespace

struct ResultWriter::Impl {
  explicit Impl(const std::string& directory) : directory(directory) {}
  ~Impl() {
    // Only an empty directory goes away.
    std::error_code ignored;
    files.clear();
    points.reset();
    if (created && !committed) fs::remove(directory, ignored);
  }

  std::string PathOf(const std::string& name) const {
    return (fs::path(directory) / name).string();
  }

  // Writes a whole file under its temporary name; a second time replaces the first.
  void Write(const std::string& name, const std::string& content) {
    CHECK(!committed) << name << " after Commit()";
    std::unique_ptr<AtomicFile>& file = files[name];
    if (file == nullptr) file = std::make_unique<AtomicFile>(PathOf(name));
    WriteWholeFile(file->temporary_path(), content, file->path());
  }

  std::string directory;
  bool created = false;
  bool committed = false;
  std::map<std::string, std::unique_ptr<AtomicFile>> files;  // by name
  std::unique_ptr<PointCloudWriter> points;
};

ResultWriter::ResultWriter(const std::string& directory)
    : impl_(std::make_unique<Impl>(directory)) {
  impl_->created = CreateDirectory(directory);
  // Opened now, so that a directory that can not be written to shows before the work is done.
  impl_->points =
      std::make_unique<PointCloudWriter>(impl_->PathOf("map.ply"), impl_->PathOf("map.pcd"));
}

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

void ResultWriter::AddMapPoints(const PointBuffer& points) { impl_->points->Add(points); }

void ResultWriter::WriteSummary(const Summary& summary) {
  impl_->Write("summary.json", FormatSummary(summary));
}

void ResultWriter::WriteConfig(const std::string& yaml) {
  const bool complete = !yaml.empty() && yaml.back() == '\n';
  impl_->Write("config_used.yaml", complete ? yaml : yaml + "\n");
}

void ResultWriter::Commit() {
  CHECK(!impl_->committed) << "Commit() twice";
  impl_->points->Finish();
  // What a renaming could stumble over is looked for first: all or nothing.
  std::vector<std::string> names = {"map.ply", "map.pcd"};
  for (const auto& [name, file] : impl_->files) names.push_back(name);
  for (const std::string& name : names) {
    const std::string path = impl_->PathOf(name);
    if (fs::is_directory(path)) throw Error(path + ": can not be written: is a directory");
  }
  impl_->points->Commit();
  for (const auto& [name, file] : impl_->files) file->Commit();
  impl_->committed = true;
}

}  // namespace plumbline
