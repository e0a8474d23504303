#include "core/result/cloud_export.h"

#include <filesystem>
#include <memory>
#include <system_error>

#include "core/result/ply_reader.h"
#include "core/util/atomic_file.h"
#include "core/util/error.h"

namespace plumbline {

int64_t RunCloudExport(const CloudExport& job, const ProgressCallback& progress) {
  PlyReader reader(job.result + "/" + CloudFileName(CloudFormat::kPly));
  std::error_code error;
  std::filesystem::create_directories(job.output, error);
  if (error) throw Error(job.output + ": can not be created: " + error.message());
  std::vector<AtomicFile> files;
  std::vector<std::unique_ptr<PointCloudWriter>> writers;
  for (const CloudFormat format : job.formats) {
    files.emplace_back(job.output + "/" + CloudFileName(format));
    const AtomicFile& file = files.back();
    writers.push_back(CreatePointCloudWriter(format, file.temporary_path(), file.path()));
  }
  int64_t num_done = 0;
  PointBuffer points;
  while (reader.Next(&points)) {
    for (const auto& writer : writers) writer->Add(points);
    num_done += points.num_points();
    progress(static_cast<double>(num_done) / static_cast<double>(reader.num_points()));
  }
  for (const auto& writer : writers) writer->Finish();
  for (AtomicFile& file : files) file.Commit();
  return num_done;
}

}  // namespace plumbline
