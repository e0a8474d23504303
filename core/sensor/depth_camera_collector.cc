#include "core/sensor/depth_camera_collector.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/util/error.h"

namespace plumbline {
namespace {

std::string SizeText(uint32_t width, uint32_t height) {
  return std::to_string(width) + " x " + std::to_string(height) + " pixels";
}

// Why the rows of an image can not be taken; empty where they can. first: image of the camera.
std::string FaultOf(const ImageMessage& image, const ImageMessage& first) {
  if (!HoldsDepths(image)) {
    return "has images of encoding " + Quoted(image.encoding) +
           ", not of depths in 16UC1 (mm) or 32FC1 (m)";
  }
  if (image.width != first.width || image.height != first.height) {
    return "has images of " + SizeText(first.width, first.height) + " and of " +
           SizeText(image.width, image.height);
  }
  if (image.row_bytes < BytesOfRow(image)) {
    return "has images whose rows of " + std::to_string(image.row_bytes) +
           " bytes are too short for " + std::to_string(image.width) + " pixels";
  }
  return "";
}

bool IsSame(const MessageRef& a, const MessageRef& b) {
  return a.topic_index == b.topic_index && a.part == b.part && a.begin == b.begin;
}

std::string Whose(const DepthCamera& camera) { return "depth camera " + Quoted(camera.name); }

}  // namespace

DepthCameraCollector::DepthCameraCollector(const Rig& rig)
    : rig_(rig),
      sent_(rig.depth_cameras.size()),
      angles_(rig.scanners.size()),
      ranges_(rig.scanners.size()) {}

bool DepthCameraCollector::Wants(const RecordingTopic& topic) const {
  return std::any_of(
      rig_.depth_cameras.begin(), rig_.depth_cameras.end(), [&](const DepthCamera& camera) {
        return (topic.HasImages() && camera.topic == topic.name) ||
               (topic.HasCameraInfos() && camera.info_topic == topic.name);
      });
}

std::vector<int> DepthCameraCollector::RowsOf(size_t camera) const {
  std::vector<int> scanners;
  for (size_t i = 0; i < rig_.scanners.size(); ++i) {
    const auto& row = rig_.scanners[i].camera_row;
    if (row && row->camera == camera) scanners.push_back(static_cast<int>(i));
  }
  return scanners;
}

void DepthCameraCollector::Add(const RecordingTopic& topic, const CameraInfoMessage& message) {
  for (size_t i = 0; i < sent_.size(); ++i) {
    if (rig_.depth_cameras[i].info_topic != topic.name || sent_[i].info) continue;
    sent_[i].info = message;
  }
}

std::vector<int> DepthCameraCollector::Add(const RecordingTopic& topic,
                                           const ImageMessage& image) {
  for (size_t i = 0; i < sent_.size(); ++i) {
    if (rig_.depth_cameras[i].topic != topic.name) continue;
    Sent& sent = sent_[i];
    if (sent.image.encoding.empty()) {
      sent.image = image;
      sent.image.data = {};
    }
    if (sent.fault.empty()) sent.fault = FaultOf(image, sent.image);
    return RowsOf(i);
  }
  return {};
}

void DepthCameraCollector::AddLost(const RecordingTopic& topic, const MessageRef& message) {
  for (size_t i = 0; i < sent_.size(); ++i) {
    const DepthCamera& camera = rig_.depth_cameras[i];
    if (camera.topic == topic.name || camera.info_topic == topic.name) {
      sent_[i].lost.Add(message);
    }
  }
}

void DepthCameraCollector::CheckTopics(const DepthCamera& camera,
                                       const std::vector<RecordingTopic>& topics,
                                       const std::string& damage) const {
  std::set<std::string> images;
  std::set<std::string> infos;
  for (const RecordingTopic& topic : topics) {
    if (topic.HasImages()) images.insert(topic.name);
    if (topic.HasCameraInfos()) infos.insert(topic.name);
  }
  const auto check = [&](const std::string& name,
                         const std::string& type,
                         const std::set<std::string>& present) {
    if (present.count(name) > 0) return;
    throw Error("has no " + type + " in topic " + Shown(name) + " (" + Whose(camera) +
                " of the rig); topics with such messages in this recording:" +
                TopicsText(present) + damage);
  };
  check(camera.topic, "sensor_msgs/Image", images);
  check(camera.info_topic, "sensor_msgs/CameraInfo", infos);
}

// A rectified image has the model P. Of cameras without rectification some drivers state K
// only.
PinholeModel DepthCameraCollector::ModelOf(size_t index) const {
  const DepthCamera& camera = rig_.depth_cameras[index];
  const Sent& sent = sent_[index];
  const std::string where =
      "topic " + Shown(camera.topic) + " (" + Whose(camera) + " of the rig) ";
  const std::string of_info =
      "topic " + Shown(camera.info_topic) + " (" + Whose(camera) + " of the rig) ";
  if (!sent.fault.empty()) throw Error(where + sent.fault);
  if (!sent.info) throw Error(of_info + "has no message that can be decoded");
  const CameraInfoMessage& info = *sent.info;
  const bool has_images = !sent.image.encoding.empty();
  if (has_images && (sent.image.width != info.width || sent.image.height != info.height)) {
    throw Error(where + "has images of " + SizeText(sent.image.width, sent.image.height) +
                ", and topic " + Shown(camera.info_topic) + " states " +
                SizeText(info.width, info.height));
  }
  PinholeModel model;
  model.width = static_cast<int>(info.width);
  model.height = static_cast<int>(info.height);
  const bool is_rectified = info.projection[0] > 0.0;
  model.focal_x = is_rectified ? info.projection[0] : info.camera[0];
  model.centre_x = is_rectified ? info.projection[2] : info.camera[2];
  model.focal_y = is_rectified ? info.projection[5] : info.camera[4];
  model.centre_y = is_rectified ? info.projection[6] : info.camera[5];
  const auto is_length = [](double f) { return std::isfinite(f) && f > 0.0; };
  if (!is_length(model.focal_x) || !is_length(model.focal_y) ||
      !std::isfinite(model.centre_x) || !std::isfinite(model.centre_y) || model.width < 2) {
    throw Error(of_info + "states no focal lengths, neither in P nor in K, or no rows");
  }
  return model;
}

void DepthCameraCollector::Finish(const std::string& path,
                                  const std::vector<RecordingTopic>& topics,
                                  const std::string& damage) {
  for (size_t i = 0; i < sent_.size(); ++i) {
    try {
      CheckTopics(rig_.depth_cameras[i], topics, damage);
      PlaceRows(i, ModelOf(i), &rig_);
    } catch (const Error& error) {
      throw Error(path + ": " + error.what());
    }
    for (const int scanner : RowsOf(i)) {
      angles_[Index(scanner)] = RowAngles(rig_.depth_cameras[i].model,
                                          rig_.scanners[Index(scanner)].camera_row->row);
    }
  }
}

void DepthCameraCollector::AddWarnings(std::vector<std::string>* warnings) const {
  for (size_t i = 0; i < sent_.size(); ++i) {
    const std::string whose = Whose(rig_.depth_cameras[i]);
    sent_[i].lost.WarnOf(whose, "that can not be decoded", warnings);
    const std::vector<double>& distortion = sent_[i].info->distortion;
    if (std::all_of(distortion.begin(), distortion.end(), [](double d) { return d == 0.0; })) {
      continue;
    }
    warnings->push_back(whose +
                        ": its CameraInfo states a distortion of the lens; the images "
                        "are taken as rectified");
  }
}

void DepthCameraCollector::Place(Rig* rig) const {
  for (size_t i = 0; i < sent_.size(); ++i) PlaceRows(i, rig_.depth_cameras[i].model, rig);
}

void DepthCameraCollector::ReadRow(int scanner,
                                   const MessageRef& where,
                                   RecordingSource* source,
                                   ScanLineMessage* scan_line) {
  if (ranges_[Index(scanner)].empty() || !IsSame(where, open_)) {
    ImageMessage image;
    source->ReadImage(where, &image);
    const size_t camera = RowOf(scanner)->camera;
    if (!FaultOf(image, sent_[camera].image).empty()) {
      throw Error(source->path() + ": has changed while it was read");
    }
    for (const int row : RowsOf(camera)) {
      ranges_[Index(row)] =
          RowRanges(image, rig_.depth_cameras[camera].model, RowOf(row)->row);
    }
    open_ = where;
    stamp_ns_ = image.stamp_ns;
  }
  *scan_line = {};
  scan_line->stamp_ns = stamp_ns_;
  scan_line->ranges = ranges_[Index(scanner)];
  scan_line->angles = angles_[Index(scanner)];
  scan_line->num_beams = static_cast<uint32_t>(scan_line->ranges.size());
  scan_line->angle_min = scan_line->angles.front();
  scan_line->angle_increment = (scan_line->angles.back() - scan_line->angles.front()) /
                               static_cast<float>(scan_line->angles.size() - 1);
}

}  // namespace plumbline
