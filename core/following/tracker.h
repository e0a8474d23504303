#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/association/association.h"
#include "core/estimation/estimation_problem.h"
#include "core/estimation/solver.h"
#include "core/following/thin_evidence.h"
#include "core/geometry/matrix_types.h"
#include "core/map/map_state.h"
#include "core/options/mapper_options.h"
#include "core/registration/scan_matching.h"
#include "core/sensor/rig.h"
#include "core/surface/landmark_view.h"
#include "core/trajectory/motion_prior.h"
#include "core/trajectory/pose_gaussian.h"
#include "core/trajectory/pose_uncertainty.h"
#include "core/trajectory/trajectory.h"

namespace plumbline {

// Tracker takes the light step of every scan: it estimates the newest control points alone,
// some 24 unknowns, with the window's problem and solver but all planes held constant. Its
// prior comes from the window (Reset) and takes in scan after scan until the window is solved
// again.
class Tracker {
 public:
  Tracker(const Rig& rig,
          bool planar,
          const MapperOptions& options,
          MotionPrior* motion_prior,
          MapState* state);
  // Goes on from where another one stands, with copies of what it works on.
  Tracker(const Tracker& other, const Rig& rig, MotionPrior* motion_prior, MapState* state);

  // Moves the newest control points, if there are any that no scan has held yet, to where
  // wheels or IMU say that the rig went.
  void FollowOwnMotion();

  // Associates the observations first .. last of the newest scan with the landmarks and
  // estimates its poses, in turn until the associations stand.
  // scan_matcher: with the scan's points, if they are to hold the pose as well; nullptr if
  // not.
  void Track(int first_observation,
             int last_observation,
             const LandmarksWithinGap& landmarks,
             const ScanMatcher* scan_matcher = nullptr);

  // Adds an observation that was given a landmark after its scan had been tracked.
  void Add(int observation_index) { recent_.push_back(observation_index); }

  // Starts anew from what the window knows of the newest control points.
  void Reset(int64_t now_ns, PoseGaussian gaussian);

  // Whether it may go on without the window for a while: the rig moves steadily, and most of
  // what the scans show are known planes.
  bool FollowsWell(int64_t now_ns) const;
  // Whether the rig moves as its spline can follow.
  bool IsSteady(int64_t now_ns) const { return now_ns >= loose_until_ns_; }
  // Whether the walls in the newest scan leave its position open in some horizontal direction,
  // or, in space, its heading, and have not for long: what is left to hold it may be somebody
  // who walks along.
  bool IsUndecided(int64_t now_ns) const;

  // Leaves the position to the predicted motion where long walls leave it open: points and
  // smaller planes do not hold it.
  void set_bridges_by_motion(bool bridges) { bridges_by_motion_ = bridges; }
  // Whether the walls in the newest scan leave its position open in some horizontal direction,
  // or, in space, its heading.
  bool is_open() const { return is_open_; }

  // The uncertainty of the newest poses, the planes given.
  const PoseUncertainty& pose_uncertainty() const { return pose_uncertainty_; }

 private:
  // Association holds a scan's segments and their planes, chosen together. How the rig's poses
  // differ from their prediction is an error of the control points and, where the motion is
  // `unsteady`, what no spline of these knots can follow.
  struct Association {
    std::vector<std::pair<int, int>> chosen;  // observation index, landmark id
    bool unsteady = false;
    double cost = 0.0;      // -2 ln of its likelihood
    double length_m = 0.0;  // of the segments that have a plane
  };

  // ScanEstimate is what a scan says of the newest control points, and by what.
  struct ScanEstimate {
    PoseGaussian gaussian;
    std::vector<PoseConstraint> constraints;  // of its points
    double share_on_no_plane = 0.0;
    bool unsteady = false;
  };

  // Estimates the newest control points by the scan's planes, by its points where these hold
  // the pose (by_points: what they alone say), and by its points alone where they or the
  // wheels speak against the planes. wheels: where wheels and the motion before predict the
  // scan's end, with covariance.
  ScanEstimate EstimateScan(int first_observation,
                            int last_observation,
                            const LandmarksWithinGap& landmarks,
                            const ScanMatcher* scan_matcher,
                            const std::optional<ScanMatch>& by_points,
                            const std::pair<Rigid3d, Matrix6d>& wheels);
  // Takes the planes from the scan: its points alone hold the pose.
  void LeaveToPoints(int first_observation,
                     int last_observation,
                     const ScanMatch& match,
                     ScanEstimate* estimate);
  // Estimates the newest control points from the points of the scan alone, on top of the
  // prediction, and returns how they then agree with the local map; nothing where it knows too
  // little of them or they lie elsewhere.
  std::optional<ScanMatch> EstimateByPoints(const ScanMatcher& scan_matcher);
  // Whether the wheels deny that the rig is where it is now estimated: it is not where the
  // motion before and they predict it, by far more than both may be off. Of a rig in the plane
  // that has wheels.
  bool WheelsDeny(const Rigid3d& predicted,
                  const Matrix6d& covariance,
                  int64_t scan_end_ns) const;
  // Looks for the scan in the local map from where it is predicted on. Where its points lie
  // better there than by the present estimate, returns what they say; the poses stay.
  std::optional<ScanMatch> SearchElsewhere(const ScanMatcher& scan_matcher,
                                           const Rigid3d& predicted,
                                           int64_t scan_end_ns) const;
  // Whether the points lie where the local map has them as nearly as by_points says.
  bool AgreesWithPoints(const ScanMatcher& scan_matcher, const ScanMatch& by_points) const;

  int first() const { return gaussian_.mean.empty() ? 0 : gaussian_.first; }
  std::vector<int> FreeRows(Eigen::Index size) const;
  Eigen::MatrixXd Covariance(const Eigen::MatrixXd& information) const;
  // Makes the problem of the newest control points, with all that is known of them before the
  // scan: the Gaussian from the window and the scans since then, the priors on the motion, and
  // the gauge at the start of the map. Planes and older control points are held.
  EstimationProblem MakeProblem() const;
  // Places the newest control points by the wheels, one after the other, where the scans have
  // left a gap longer than a control point reaches: extended evenly, the trajectory is too far
  // from there for a linearised fit.
  void PlaceByWheels();
  // Returns the Gaussian of the newest control points by the prior and the motion, without
  // segments.
  PoseGaussian Predict() const;
  // Estimates the newest control points from the scan's observations that have a landmark.
  PoseGaussian Estimate(int first_observation,
                        int last_observation,
                        const std::vector<PoseConstraint>& constraints);
  // Associates the scan's observations and estimates its poses in turn, until the associations
  // stand. scan_matcher: nullptr where the points do not hold the pose. Gives what they say of
  // the pose, and whether the motion is unsteady.
  PoseGaussian EstimateInRounds(int first_observation,
                                int last_observation,
                                const LandmarksWithinGap& landmarks,
                                const ScanMatcher* scan_matcher,
                                std::vector<PoseConstraint>* constraints,
                                bool* unsteady);
  // Whether all points of every scan hold the pose, those on planes as well. A level rig
  // without wheels has nothing but a slice of the room: where planes alone held it, one scan
  // that met furniture took the next ones along; and where only the points beside the planes
  // spoke against wrong ones, the pose crept away with these.
  bool PointsAlwaysHold() const;
  // Whether walls leave the position open in the scan, by which this tracker goes.
  bool IsOpen(int first_observation, int last_observation) const;
  // Whether the scan's floors, ceilings and slopes leave its height open.
  bool IsHeightOpen(int first_observation, int last_observation) const;
  // Estimates the scan's poses by long walls, floors and the motion alone.
  PoseGaussian BridgeByMotion(int first_observation, int last_observation);
  // Takes the planes from these observations of the scan and estimates anew.
  PoseGaussian EstimateWithout(const std::vector<int>& left_out,
                               int first_observation,
                               int last_observation,
                               const std::vector<PoseConstraint>& constraints);
  // Returns the covariance of the body's rotation and position after a time of accelerations
  // `scale` times as strong as usual.
  Matrix6d UnsteadyCovariance(double scale, double duration_s) const;
  // Returns the factor by which an unsteady rig accelerates more strongly than usual.
  double UnsteadyScale() const;
  // Returns the covariance of a pose by how far the local map may be off as a whole.
  Matrix6d PointsCovariance() const;
  // Gives the control points the freedom of an unsteady motion.
  void Loosen();
  // Returns the views of the landmarks within reach of the newest scan.
  std::vector<LandmarkView> OfScan(int first_observation,
                                   const Matrix6d& pose_covariance,
                                   const LandmarksWithinGap& landmarks) const;
  // Chooses the landmarks of observations, weightiest first, with poses that differ from the
  // prediction by the control points' errors and by this covariance on top.
  Association ChooseUnder(const Matrix6d& unsteady,
                          const std::vector<int>& observations,
                          const LandmarksWithinGap& landmarks) const;
  Association AssociateJointly(int first_observation,
                               int last_observation,
                               const LandmarksWithinGap& landmarks,
                               bool by_points) const;
  // Gives the scan's observations the landmarks of AssociateJointly; false when there are
  // none. Says whether the motion is unsteady, by how many they are.
  bool AssociatePredicted(int first_observation,
                          int last_observation,
                          const LandmarksWithinGap& landmarks,
                          bool by_points,
                          bool* unsteady);
  // Finds the observations' landmarks one by one; true when any is another one than before.
  bool Associate(int first_observation,
                 int last_observation,
                 const LandmarksWithinGap& landmarks);

  const Rig& rig_;
  bool planar_;
  const MapperOptions& options_;
  MotionPrior* motion_prior_;
  MapState* state_;
  std::unique_ptr<WindowSolver> solver_;
  PoseGaussian gaussian_;    // from all scans so far, planes given; empty before the first
  Prior prior_;              // gaussian_ as a prior on its blocks
  std::vector<int> recent_;  // observations that gaussian_ does not know of
  PoseUncertainty pose_uncertainty_;
  int64_t loose_until_ns_ = 0;  // till when the motion counts as unsteady
  double scan_s_ = 0.0;         // from the last scan to the end of the newest one
  int64_t last_scan_ns_ = 0;    // the end of the last scan; 0: none
  bool bridges_by_motion_ = false;
  bool is_open_ = false;      // walls leave the newest scan's pose open
  bool is_height_open_ = false;  // floors and ceilings leave its height open
  int64_t last_held_ns_ = 0;  // when they last did not
  ThinEvidence thin_evidence_;
  bool needs_points_ = false;  // whether points, too, hold the next scan
  double usual_share_on_no_plane_ = 0.0;
  double usual_share_;  // of a scan's segments, by length, that find their planes
};

}  // namespace plumbline
