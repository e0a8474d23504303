// Maps a recording and lists the surfaces found, with the standard deviation along their normals.

#include <glog/logging.h>

#include <cstdio>
#include <exception>

#include "core/mapping/map_job.h"
#include "core/result/result_reader.h"

namespace {

void List(const plumbline::MapJob& job) {
  const plumbline::Summary summary = plumbline::RunMapJob(
      job, [](const plumbline::ProgressState&) { /* state.share_done goes from 0 to 1 */ });
  for (const plumbline::PlanePatch& plane :
       plumbline::ReadPlanes(job.output + "/planes.json")) {
    std::printf("%3d %-10s  normal (%6.3f, %6.3f, %6.3f)  distance %8.4f m +- %.1f mm\n",
                plane.id,
                plumbline::FieldsOf(plane.type).name.c_str(),
                plane.normal.x(),
                plane.normal.y(),
                plane.normal.z(),
                plane.distance,
                1e3 * plane.sigma_distance_m);
  }
  std::printf("the map is %s\n", plumbline::VerdictName(summary.consistency.verdict).c_str());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "Usage: list_surfaces RECORDING RIG OUTPUT_DIRECTORY\n");
    return 2;
  }
  FLAGS_logtostderr = true;  // else glog writes files
  FLAGS_minloglevel = google::GLOG_WARNING;
  google::InitGoogleLogging(argv[0]);
  plumbline::MapJob job;
  job.recording = argv[1];
  job.rig = argv[2];
  job.output = argv[3];
  try {
    List(job);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "list_surfaces: %s\n", error.what());
    return 1;
  }
  return 0;
}
