#include "core/sensor/rig.h"

#include <algorithm>
#include <cmath>

#include "core/util/error.h"

namespace plumbline {
namespace {

double TiltOf(const Eigen::Vector3d& normal_body) {
  return std::atan2(normal_body.head<2>().norm(), std::abs(normal_body.z()));
}

// The angle between a scan plane and the horizontal one of the body; the largest that a mount
// gives it.
double Tilt(const Scanner& scanner) {
  const Eigen::Vector3d normal_body =
      scanner.body_from_scanner.rotation * Eigen::Vector3d::UnitZ();
  double tilt = TiltOf(normal_body);
  if (!scanner.mount) return tilt;
  const Mount& mount = *scanner.mount;
  const double reach = mount.swing ? mount.swing->amplitude_rad : 0.5 * M_PI;
  for (const double angle : {mount.zero_rad - reach, mount.zero_rad, mount.zero_rad + reach}) {
    tilt = std::max(tilt, TiltOf(mount.TurnBy(angle).rotation * normal_body));
  }
  return tilt;
}

bool IsExact(const ScannerUncertainty& uncertainty) {
  return uncertainty.rotation_rad == 0.0 && uncertainty.translation_m == 0.0 &&
         uncertainty.time_s == 0.0;
}

bool IsExact(const MountUncertainty& uncertainty) {
  return uncertainty.zero_rad == 0.0 && uncertainty.time_s == 0.0 && uncertainty.rate == 0.0 &&
         uncertainty.axis_rad == 0.0 && uncertainty.point_m == 0.0;
}

}  // namespace

bool IsPlanar(const Rig& rig) {
  // Scan planes tilted by less against the body see no heights: 2 degrees move a wall 5 m away
  // by 17 cm up or down, and a wall looks the same there.
  constexpr double kTolerance = 2.0 * M_PI / 180.0;
  return rig.motion == MotionModel::kPlanar ||
         (rig.motion == MotionModel::kAutomatic && AllScannersHorizontal(rig, kTolerance));
}

bool AllScannersHorizontal(const Rig& rig, double tolerance_rad) {
  return std::all_of(rig.scanners.begin(), rig.scanners.end(), [&](const Scanner& scanner) {
    return Tilt(scanner) <= tolerance_rad;
  });
}

std::optional<size_t> ExactlyPlacedScanner(const Rig& rig) {
  const auto exact =
      std::find_if(rig.scanners.begin(), rig.scanners.end(), [](const Scanner& scanner) {
        return !scanner.mount && IsExact(scanner.uncertainty);
      });
  if (exact == rig.scanners.end()) return std::nullopt;
  return static_cast<size_t>(exact - rig.scanners.begin());
}

size_t BodyScanner(const Rig& rig) {
  if (const auto exact = ExactlyPlacedScanner(rig)) return *exact;
  const auto moves = [](const Scanner& scanner) { return scanner.mount.has_value(); };
  const bool all_move = std::all_of(rig.scanners.begin(), rig.scanners.end(), moves);
  const auto can_be_body = [&](const Scanner& scanner) { return all_move || !moves(scanner); };
  if (IsPlanar(rig)) {
    return static_cast<size_t>(
        std::find_if(rig.scanners.begin(), rig.scanners.end(), can_be_body) -
        rig.scanners.begin());
  }
  // A level scanner sees neither floor nor ceiling, by which the body's attitude is known. Of
  // scanners that are about as steep it is the first, however a rig file is off.
  double steepest = 0.0;
  for (const Scanner& scanner : rig.scanners) {
    if (can_be_body(scanner)) steepest = std::max(steepest, Tilt(scanner));
  }
  const auto body =
      std::find_if(rig.scanners.begin(), rig.scanners.end(), [&](const Scanner& scanner) {
        return can_be_body(scanner) && 2.0 * Tilt(scanner) >= steepest;
      });
  return static_cast<size_t>(body - rig.scanners.begin());
}

bool EstimatesScanners(const Rig& rig) {
  return rig.scanners.size() > 1 &&
         std::any_of(rig.scanners.begin(), rig.scanners.end(), [](const Scanner& scanner) {
           return !IsExact(scanner.uncertainty) || scanner.uncertainty.range_m > 0.0 ||
                  scanner.uncertainty.range_scale > 0.0 ||
                  (scanner.mount && !IsExact(scanner.mount->uncertainty));
         });
}

void PlaceRows(size_t camera, const PinholeModel& model, Rig* rig) {
  DepthCamera& with = rig->depth_cameras[camera];
  if (model.height < with.num_rows) {
    throw Error("images of depth camera " + with.name + " have " +
                std::to_string(model.height) + " rows, of which the rig file uses " +
                std::to_string(with.num_rows));
  }
  with.model = model;
  int used_row = 0;
  for (Scanner& scanner : rig->scanners) {
    if (!scanner.camera_row || scanner.camera_row->camera != camera) continue;
    const int row = ImageRow(model, used_row++, with.num_rows);
    scanner.camera_row->row = row;
    scanner.body_from_scanner = with.body_from_camera * CameraFromRow(model, row);
    scanner.beams = model.width;
  }
}

Rig WithoutCameraRows(Rig rig) {
  const auto is_row = [](const Scanner& scanner) { return scanner.camera_row.has_value(); };
  rig.scanners.erase(std::remove_if(rig.scanners.begin(), rig.scanners.end(), is_row),
                     rig.scanners.end());
  rig.depth_cameras.clear();
  return rig;
}

double MaxRangeNoise(const Rig& rig) {
  double range_noise_m = 0.0;
  for (const Scanner& scanner : rig.scanners) {
    range_noise_m = std::max(range_noise_m, scanner.RangeStddev(scanner.max_range_m));
  }
  return range_noise_m;
}

}  // namespace plumbline
