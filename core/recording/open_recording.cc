#include <memory>
#include <string>

#include "core/recording/recording_source.h"
#include "core/recording/ros1_file.h"

namespace plumbline {

std::unique_ptr<RecordingSource> OpenRecording(const std::string& path) {
  return std::make_unique<RecordingSource>(std::make_unique<Ros1File>(path));
}

}  // namespace plumbline
