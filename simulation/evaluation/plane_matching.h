#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/result/result_types.h"

namespace plumbline {

// An estimated plane counts as the image of a true face within these bounds. They are
// generous: they decide what is the same wall, not whether it was measured well.
struct PlaneMatchingOptions {
  double max_angle_deg = 2.0;     // between the normals, which have to face the same way
  double max_distance_m = 0.1;    // of the estimate's centre from the true face's plane
  double min_overlap = 0.1;       // share of the smaller outline that lies in the other
  double max_radius_ratio = 1.1;  // of a cylinder's radius to the true one, or the other way
  // True faces within these two bounds are one plane, which a single estimate may cover.
  double coplanar_angle_deg = 0.2;
  double coplanar_distance_m = 0.01;
  // A true face with fewer points, or with a smaller share of all points, can not be missed.
  int min_points = 200;
  double min_point_share = 0.002;
};

enum class MatchStatus {
  kMatched,
  kWrong,    // shows no true face
  kDoubled,  // overlaps, on the same true face, with an estimate that has more points
};

std::string MatchStatusName(MatchStatus status);  // "matched", "wrong", "doubled"

// PlaneMatch says what became of one estimated plane.
struct PlaneMatch {
  int plane_id = 0;
  MatchStatus status = MatchStatus::kWrong;
  std::vector<int> face_ids;     // the true faces it shows, the best fitting one first
  double angle_deg = 0.0;        // between its normal and the best fitting face's
  double distance_m = 0.0;       // signed, of its centre from the best fitting face
  double sigma_angle_deg = 0.0;  // as the estimate states them
  double sigma_distance_m = 0.0;
  // Error of a cylinder's radius, estimate minus truth, and its stated deviation.
  std::optional<double> radius_error_m;
  double sigma_radius_m = 0.0;
};

// Errors of all planes of a map.
struct PlaneEvaluation {
  int num_matched = 0;
  int num_wrong = 0;
  int num_doubled = 0;
  int num_missed = 0;
  double completeness = 0.0;  // share of the true points that lie on faces found
  // Errors of the matched and the doubled planes.
  double angle_rmse_deg = 0.0;
  double angle_max_deg = 0.0;
  double distance_rmse_m = 0.0;
  double distance_max_m = 0.0;
  double radius_max_m = 0.0;        // the largest error of a cylinder's radius, by size
  double radius_max_percent = 0.0;  // and of its share of the true one
  // Root mean square of the errors over their stated standard deviations, where one is stated:
  // near 1 for a trustworthy covariance. Angles are those of vertical planes, which have one
  // degree of freedom.
  double angle_over_sigma_rms = 0.0;
  double distance_over_sigma_rms = 0.0;
  std::vector<PlaneMatch> list;      // in the order of the estimates
  std::vector<int> missed_face_ids;  // in the order of the faces
};

// Returns the index of the face that the estimate shows, -1 for none; both are given in the
// same frame. Faces count by the share of the estimate that they hold, by how near they lie,
// and by how many of the estimate's points can be theirs: a rail just before a wall got few
// beams. Coplanar faces count together, and the best of them is returned. planar: outlines
// are compared from above, along the wall only.
int FindBestFace(const PlanePatch& estimate,
                 const std::vector<PlanePatch>& faces,
                 bool planar,
                 const PlaneMatchingOptions& options);

// Compares estimates with true faces in the same frame. planar: vertical planes only.
PlaneEvaluation MatchPlanes(const std::vector<PlanePatch>& estimates,
                            const std::vector<PlanePatch>& faces,
                            bool planar,
                            const PlaneMatchingOptions& options);

// Moves a patch into another frame.
PlanePatch TransformPatch(const Rigid3d& b_from_a, const PlanePatch& patch_a);

}  // namespace plumbline
