#include "simulation/evaluation/plane_matching.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/geometry/angles.h"
#include "core/geometry/plane_axes.h"

namespace plumbline {
namespace {

using Polygon = std::vector<Eigen::Vector2d>;

// Accurate for small angles, where acos of the dot product is not.
double AngleBetweenDeg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * kDegreesPerRadian;
}

// Moves a polygon along an arc by whole circles so that its middle is the nearest to the origin.
void CentreOnArc(double circle_m, Polygon* polygon) {
  double mean = 0.0;
  for (const Eigen::Vector2d& p : *polygon) {
    mean += p.x() / static_cast<double>(polygon->size());
  }
  const double shift = std::remainder(mean, circle_m) - mean;
  for (Eigen::Vector2d& p : *polygon) p.x() += shift;
}

// The outline in coordinates of a plane like the face, on walls (along, up), along the arc of
// a cylinder. Planar: a strip of height one, so that only the extent along the wall matters.
Polygon ProjectOutline(const PlanePatch& patch, const PlanePatch& face, bool planar) {
  const Eigen::Vector3d& normal = face.normal;
  const Eigen::Vector3d helper = std::abs(normal.z()) < 0.9 ? Eigen::Vector3d::UnitZ().eval()
                                                            : Eigen::Vector3d::UnitY().eval();
  const Eigen::Vector3d u = helper.cross(normal).normalized();
  const Eigen::Vector3d v = normal.cross(u);
  Polygon polygon;
  const PlaneAxes axes{face.centre, u, v, face.curvature};
  for (const Eigen::Vector3d& corner : patch.outline) {
    polygon.push_back(axes.Project(corner));
    if (!face.IsCurved() || polygon.size() < 2) continue;
    // An outline goes on where it may pass the arc's far side.
    const double last = polygon[polygon.size() - 2].x();
    polygon.back().x() =
        last + std::remainder(polygon.back().x() - last, 2.0 * M_PI * face.Radius());
  }
  if (face.IsCurved()) CentreOnArc(2.0 * M_PI * face.Radius(), &polygon);
  if (!planar || polygon.empty()) return polygon;
  const auto [low, high] =
      std::minmax_element(polygon.begin(), polygon.end(), [](const auto& a, const auto& b) {
        return a.x() < b.x();
      });
  const double min = low->x();
  const double max = high->x();
  return {{min, 0.0}, {max, 0.0}, {max, 1.0}, {min, 1.0}};
}

// Even-odd rule: an outline that reaches its holes by a bridge is handled too.
bool Contains(const Polygon& polygon, const Eigen::Vector2d& p) {
  bool inside = false;
  for (size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = polygon[j];
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    if (p.x() < a.x() + (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y())) inside = !inside;
  }
  return inside;
}

// Centres of the cells of a raster that lie in the polygon; its corners' mean where it is too
// thin for any.
Polygon SampleInside(const Polygon& polygon) {
  constexpr int kCells = 64;  // overlaps to a few per cent, well below the least that counts
  Eigen::Vector2d min = polygon.front();
  Eigen::Vector2d max = polygon.front();
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& corner : polygon) {
    min = min.cwiseMin(corner);
    max = max.cwiseMax(corner);
    mean += corner / static_cast<double>(polygon.size());
  }
  const Eigen::Vector2d cell = (max - min) / kCells;
  Polygon samples;
  for (int i = 0; i < kCells; ++i) {
    for (int j = 0; j < kCells; ++j) {
      const Eigen::Vector2d p = min + cell.cwiseProduct(Eigen::Vector2d(i + 0.5, j + 0.5));
      if (Contains(polygon, p)) samples.push_back(p);
    }
  }
  if (samples.empty()) samples.push_back(mean);
  return samples;
}

double ShareInside(const Polygon& a, const Polygon& b) {
  const Polygon samples = SampleInside(a);
  const auto inside = std::count_if(samples.begin(), samples.end(), [&b](const auto& sample) {
    return Contains(b, sample);
  });
  return static_cast<double>(inside) / static_cast<double>(samples.size());
}

// Shares of outline a in b and of b in a, seen along the normal.
struct Overlap {
  double of_a = 0.0;
  double of_b = 0.0;
  // Share of the smaller outline, which is the larger share.
  double OfSmaller() const { return std::max(of_a, of_b); }
};

Overlap ComputeOverlap(const PlanePatch& a,
                       const PlanePatch& b,
                       const PlanePatch& face,
                       bool planar) {
  if (a.outline.empty() || b.outline.empty()) return {};
  const Polygon polygon_a = ProjectOutline(a, face, planar);
  const Polygon polygon_b = ProjectOutline(b, face, planar);
  return {ShareInside(polygon_a, polygon_b), ShareInside(polygon_b, polygon_a)};
}

// Whether both are planes, or cylinders of about the same radius, seen from the same side.
bool AreBentAlike(const PlanePatch& a,
                  const PlanePatch& b,
                  const PlaneMatchingOptions& options) {
  if (!a.IsCurved() && !b.IsCurved()) return true;
  const double ratio = b.curvature != 0.0 ? a.curvature / b.curvature : 0.0;
  return ratio < options.max_radius_ratio && ratio * options.max_radius_ratio > 1.0;
}

// Overlap of an estimate with a face; none where orientation or position exclude the match.
Overlap MatchOverlap(const PlanePatch& estimate,
                     const PlanePatch& face,
                     bool planar,
                     const PlaneMatchingOptions& options) {
  if (!AreBentAlike(estimate, face, options)) return {};
  const Eigen::Vector3d normal = face.NormalAt(estimate.centre);
  if (AngleBetweenDeg(estimate.normal, normal) > options.max_angle_deg) return {};
  if (std::abs(face.SignedDistance(estimate.centre)) > options.max_distance_m) return {};
  const Overlap overlap = ComputeOverlap(estimate, face, face, planar);
  return overlap.OfSmaller() >= options.min_overlap ? overlap : Overlap{};
}

bool Coplanar(const PlanePatch& a, const PlanePatch& b, const PlaneMatchingOptions& options) {
  return AreBentAlike(a, b, options) &&
         AngleBetweenDeg(a.NormalAt(b.centre), b.normal) <= options.coplanar_angle_deg &&
         std::abs(a.SignedDistance(b.centre)) <= options.coplanar_distance_m;
}

// The true faces that an estimate shows.
struct ShownFaces {
  const PlanePatch* estimate = nullptr;
  std::vector<size_t> faces;  // positions, the best fitting one first
  size_t list_index = 0;      // of the estimate in the evaluation's list
};

ShownFaces FindFaces(const PlanePatch& estimate,
                     const std::vector<PlanePatch>& faces,
                     bool planar,
                     const PlaneMatchingOptions& options) {
  ShownFaces shown;
  shown.estimate = &estimate;
  const int best = FindBestFace(estimate, faces, planar, options);
  if (best < 0) return shown;
  const size_t best_index = static_cast<size_t>(best);
  const auto add = [&](size_t i) {
    const Overlap overlap = MatchOverlap(estimate, faces[i], planar, options);
    if (overlap.OfSmaller() > 0.0) shown.faces.push_back(i);
  };
  add(best_index);
  for (size_t i = 0; i < faces.size(); ++i) {
    if (i != best_index && Coplanar(faces[best_index], faces[i], options)) add(i);
  }
  return shown;
}

// True when a and b show the same face and overlap there, and b is the one to keep: it has
// more points, or as many and comes first.
bool IsDoubleOf(const ShownFaces& a,
                const ShownFaces& b,
                const std::vector<PlanePatch>& faces,
                bool planar,
                const PlaneMatchingOptions& options) {
  const int64_t points_a = a.estimate->num_points;
  const int64_t points_b = b.estimate->num_points;
  const bool b_wins =
      points_b > points_a || (points_b == points_a && b.list_index < a.list_index);
  if (!b_wins) return false;
  const auto shared =
      std::find_first_of(a.faces.begin(), a.faces.end(), b.faces.begin(), b.faces.end());
  if (shared == a.faces.end()) return false;
  const Overlap overlap = ComputeOverlap(*a.estimate, *b.estimate, faces[*shared], planar);
  return overlap.OfSmaller() >= options.min_overlap;
}

PlaneMatch MakeMatch(const ShownFaces& shown, const std::vector<PlanePatch>& faces) {
  const PlanePatch& estimate = *shown.estimate;
  PlaneMatch match;
  match.plane_id = estimate.id;
  match.sigma_angle_deg = estimate.sigma_angle_rad * kDegreesPerRadian;
  match.sigma_distance_m = estimate.sigma_distance_m;
  if (shown.faces.empty()) return match;
  match.status = MatchStatus::kMatched;
  for (const size_t face : shown.faces) match.face_ids.push_back(faces[face].id);
  const PlanePatch& best = faces[shown.faces.front()];
  match.angle_deg = AngleBetweenDeg(estimate.normal, best.NormalAt(estimate.centre));
  match.sigma_radius_m = estimate.sigma_radius_m;
  if (best.IsCurved()) match.radius_error_m = estimate.Radius() - best.Radius();
  match.distance_m = best.SignedDistance(estimate.centre);
  return match;
}

double RootMeanSquare(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
}

void SummariseErrors(const std::vector<ShownFaces>& all_shown, PlaneEvaluation* evaluation) {
  std::vector<double> angles;
  std::vector<double> distances;
  std::vector<double> whitened_angles;
  std::vector<double> whitened_distances;
  for (size_t i = 0; i < all_shown.size(); ++i) {
    const PlaneMatch& match = evaluation->list[i];
    evaluation->num_matched += match.status == MatchStatus::kMatched;
    evaluation->num_wrong += match.status == MatchStatus::kWrong;
    evaluation->num_doubled += match.status == MatchStatus::kDoubled;
    if (match.status == MatchStatus::kWrong) continue;
    angles.push_back(match.angle_deg);
    distances.push_back(std::abs(match.distance_m));
    if (match.radius_error_m) {
      const double error_m = std::abs(*match.radius_error_m);
      const double true_m = all_shown[i].estimate->Radius() - *match.radius_error_m;
      evaluation->radius_max_m = std::max(evaluation->radius_max_m, error_m);
      evaluation->radius_max_percent =
          std::max(evaluation->radius_max_percent, 100.0 * error_m / true_m);
    }
    if (match.sigma_distance_m > 0.0) {
      whitened_distances.push_back(match.distance_m / match.sigma_distance_m);
    }
    if (match.sigma_angle_deg > 0.0 && all_shown[i].estimate->type == PlaneType::kVertical) {
      whitened_angles.push_back(match.angle_deg / match.sigma_angle_deg);
    }
  }
  evaluation->angle_rmse_deg = RootMeanSquare(angles);
  evaluation->distance_rmse_m = RootMeanSquare(distances);
  evaluation->angle_over_sigma_rms = RootMeanSquare(whitened_angles);
  evaluation->distance_over_sigma_rms = RootMeanSquare(whitened_distances);
  for (const double angle : angles) {
    evaluation->angle_max_deg = std::max(evaluation->angle_max_deg, angle);
  }
  for (const double distance : distances) {
    evaluation->distance_max_m = std::max(evaluation->distance_max_m, distance);
  }
}

// Finds the faces that no estimate shows, and the completeness.
void SummariseFaces(const std::vector<PlanePatch>& faces,
                    const std::vector<ShownFaces>& all_shown,
                    const PlaneMatchingOptions& options,
                    PlaneEvaluation* evaluation) {
  std::vector<bool> found(faces.size(), false);
  for (const ShownFaces& shown : all_shown) {
    for (const size_t face : shown.faces) found[face] = true;
  }
  double all_points = 0.0;
  double found_points = 0.0;
  for (size_t i = 0; i < faces.size(); ++i) {
    const double points = static_cast<double>(faces[i].num_points);
    all_points += points;
    if (found[i]) found_points += points;
  }
  evaluation->completeness = all_points > 0.0 ? found_points / all_points : 0.0;
  for (size_t i = 0; i < faces.size(); ++i) {
    const double points = static_cast<double>(faces[i].num_points);
    if (!found[i] && points >= options.min_points &&
        points >= options.min_point_share * all_points) {
      evaluation->missed_face_ids.push_back(faces[i].id);
    }
  }
  evaluation->num_missed = static_cast<int>(evaluation->missed_face_ids.size());
}

bool IsVertical(const PlanePatch& patch) { return std::abs(patch.normal.z()) < 0.1; }

}  // namespace

std::string MatchStatusName(MatchStatus status) {
  switch (status) {
    case MatchStatus::kMatched:
      return "matched";
    case MatchStatus::kWrong:
      return "wrong";
    case MatchStatus::kDoubled:
      return "doubled";
  }
  std::abort();
}

int FindBestFace(const PlanePatch& estimate,
                 const std::vector<PlanePatch>& faces,
                 bool planar,
                 const PlaneMatchingOptions& options) {
  struct Candidate {
    size_t face = 0;
    double score = 0.0;
  };
  std::vector<Candidate> candidates;
  const auto estimated_points = static_cast<double>(std::max<int64_t>(1, estimate.num_points));
  for (size_t i = 0; i < faces.size(); ++i) {
    const Overlap overlap = MatchOverlap(estimate, faces[i], planar, options);
    if (overlap.of_a == 0.0) continue;
    const double distance = std::abs(faces[i].SignedDistance(estimate.centre));
    const double nearness = 1.0 - distance / (1.01 * options.max_distance_m);
    const double holds = static_cast<double>(faces[i].num_points) / estimated_points;
    candidates.push_back({i, overlap.of_a * nearness * std::min(1.0, holds)});
  }
  const auto are_coplanar = [&](const Candidate& a, const Candidate& b) {
    return a.face == b.face || Coplanar(faces[a.face], faces[b.face], options);
  };
  const Candidate* middle = nullptr;  // of the coplanar faces with the highest score together
  double best_score = 0.0;
  for (const Candidate& candidate : candidates) {
    double score = 0.0;
    for (const Candidate& other : candidates) {
      if (are_coplanar(candidate, other)) score += other.score;
    }
    if (score <= best_score) continue;
    best_score = score;
    middle = &candidate;
  }
  if (middle == nullptr) return -1;
  const Candidate* best = middle;
  for (const Candidate& candidate : candidates) {
    if (are_coplanar(*middle, candidate) && candidate.score > best->score) best = &candidate;
  }
  return static_cast<int>(best->face);
}

PlaneEvaluation MatchPlanes(const std::vector<PlanePatch>& estimates,
                            const std::vector<PlanePatch>& faces,
                            bool planar,
                            const PlaneMatchingOptions& options) {
  std::vector<PlanePatch> comparable_faces;
  for (const PlanePatch& face : faces) {
    if (!planar || IsVertical(face)) comparable_faces.push_back(face);
  }
  PlaneEvaluation evaluation;
  std::vector<ShownFaces> all_shown;
  for (const PlanePatch& estimate : estimates) {
    if (planar && !IsVertical(estimate)) continue;
    all_shown.push_back(FindFaces(estimate, comparable_faces, planar, options));
    all_shown.back().list_index = all_shown.size() - 1;
    evaluation.list.push_back(MakeMatch(all_shown.back(), comparable_faces));
  }
  for (size_t i = 0; i < all_shown.size(); ++i) {
    for (size_t j = 0; j < all_shown.size(); ++j) {
      if (IsDoubleOf(all_shown[i], all_shown[j], comparable_faces, planar, options)) {
        evaluation.list[i].status = MatchStatus::kDoubled;
      }
    }
  }
  SummariseErrors(all_shown, &evaluation);
  SummariseFaces(comparable_faces, all_shown, options, &evaluation);
  return evaluation;
}

PlanePatch TransformPatch(const Rigid3d& b_from_a, const PlanePatch& patch_a) {
  PlanePatch patch_b = patch_a;
  patch_b.normal = b_from_a.rotation * patch_a.normal;
  patch_b.distance = patch_a.distance + patch_b.normal.dot(b_from_a.translation);
  patch_b.centre = b_from_a * patch_a.centre;
  for (Eigen::Vector3d& corner : patch_b.outline) corner = b_from_a * corner;
  return patch_b;
}

}  // namespace plumbline
