#include "core/check/mounting_search.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>

#include "core/geometry/angles.h"

namespace plumbline {
namespace {

using Vector8d = Eigen::Matrix<double, 8, 1>;  // rotation, translation, time, range
using Matrix8d = Eigen::Matrix<double, 8, 8>;

constexpr int kLinesForAgreement = 400;  // of each pair
constexpr int kLinesForFit = 1500;
constexpr int kMinCompared = 20;         // places that say anything about a pair
constexpr double kAgreed = 0.1;          // m
constexpr double kNear = 0.03;           // m
// Another mounting has to bring so many more of the places together, and most of them.
constexpr double kMinGain = 0.25;
constexpr double kMinShareSo = 0.55;
// Scales of Cauchy's loss, one for each step: what is far off is to be caught first.
constexpr double kLossScales[] = {0.4, 0.4, 0.2, 0.2, 0.1, 0.05, 0.05, 0.05};  // m
// Standard deviations of the prior about what the rig file says.
constexpr double kPriorTurn = 0.2;    // rad
constexpr double kPriorShift = 0.2;   // m
constexpr double kPriorTime = 0.1;    // s
constexpr double kPriorRange = 0.05;  // m
// What is known less well than this is left open by the scans, and held at zero; so are turns
// and shifts that are known so many times worse than those about or along the best axis, since
// what little is seen of them comes from the noise of the surfaces' directions.
constexpr double kOpenTurn = 1.0 * kRadiansPerDegree;
constexpr double kOpenShift = 0.05;  // m
constexpr double kOpenTime = 0.01;   // s
constexpr double kOpenRange = 0.01;  // m
constexpr double kOpenRatio = 5.0;

Vector8d Stacked(double turn, double shift, double time, double range) {
  Vector8d stacked;
  stacked << turn, turn, turn, shift, shift, shift, time, range;
  return stacked;
}

using Sample = std::vector<std::vector<SampledLine>>;

double MedianSize(const std::vector<ViewComparison>& comparisons) {
  std::vector<double> sizes;
  for (const ViewComparison& one : comparisons) sizes.push_back(std::abs(one.distance_m));
  if (sizes.empty()) return 0.0;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return *middle;
}

double ShareWithin(const std::vector<ViewComparison>& comparisons, double distance_m) {
  if (comparisons.empty()) return 0.0;
  const auto num = std::count_if(
      comparisons.begin(), comparisons.end(), [distance_m](const ViewComparison& one) {
        return std::abs(one.distance_m) < distance_m;
      });
  return static_cast<double>(num) / static_cast<double>(comparisons.size());
}

PairAgreement AgreementOf(const Sample& sample, const MountedRig& rig, size_t a, size_t b) {
  const auto comparisons = CompareViews(sample, rig, a, b, kLinesForAgreement);
  return {a,
          b,
          static_cast<int>(comparisons.size()),
          ShareWithin(comparisons, kAgreed),
          MedianSize(comparisons)};
}

// The mean share of the pairs that have one of the scanners; negative where none could be
// compared.
double ShareOf(const std::vector<PairAgreement>& agreements, const std::set<size_t>& scanners) {
  double sum = 0.0;
  int num = 0;
  for (const PairAgreement& pair : agreements) {
    if (pair.num_compared < kMinCompared) continue;
    if (scanners.count(pair.a) == 0 && scanners.count(pair.b) == 0) continue;
    sum += pair.near_share;
    ++num;
  }
  return num == 0 ? -1.0 : sum / num;
}

MountedScanner TurnedInPlane(const MountedScanner& scanner, double angle_rad) {
  MountedScanner turned = scanner;
  turned.body_from_scanner.rotation =
      scanner.body_from_scanner.rotation *
      Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()));
  return turned;
}

// Lists the ways in which a rig may be built otherwise.
class Alternatives {
 public:
  Alternatives(const MountedRig& rig, const std::vector<std::string>& names)
      : rig_(rig), names_(names) {
    for (size_t i = 0; i < rig.size(); ++i) {
      AddTurned(i);
      AddScaled(i);
      for (size_t j = i + 1; j < rig.size(); ++j) AddExchanged(i, j);
    }
    if (rig.size() == 3) {
      AddCycle({1, 2, 0});
      AddCycle({2, 0, 1});
    }
  }

  std::vector<OtherMounting> list;

 private:
  std::string Named(size_t i) const { return "scanner " + names_[i]; }

  OtherMounting* Add(const std::vector<size_t>& scanners,
                     const std::string& words,
                     const std::string& advice) {
    OtherMounting other;
    other.scanners = scanners;
    other.words = words;
    other.advice = advice;
    other.rig = rig_;
    list.push_back(other);
    return &list.back();
  }

  void AddTurned(size_t i) {
    for (int quarters = 0; quarters < 4; ++quarters) {
      const MountedScanner turned = TurnedInPlane(rig_[i], quarters * M_PI / 2.0);
      const std::string by = std::to_string(quarters < 3 ? 90 * quarters : -90) + " deg";
      if (quarters > 0) {
        Add({i},
            Named(i) + " is turned in its own plane by " + by + " against the rig file",
            "add a turn of " + by + " about the scanner's own z axis to its rotation_rpy_deg")
            ->rig[i] = turned;
      }
      OtherMounting* mirrored =
          Add({i},
              Named(i) + " is mirrored against the rig file: its beams come the other way "
                         "round, as of a scanner that hangs upside down" +
                  (quarters > 0 ? ", and turned by " + by : ""),
              "mount it the right way up, or add 180 deg to the roll of its rotation_rpy_deg" +
                  std::string(quarters > 0 ? " and turn its zero beam" : ""));
      mirrored->rig[i] = turned;
      mirrored->rig[i].mirrored = !turned.mirrored;
    }
  }

  void AddScaled(size_t i) {
    const struct {
      const char* words;
      double scale;
    } units[] = {{"in feet", 0.3048},
                 {"in inches", 0.0254},
                 {"in centimetres", 0.01},
                 {"in millimetres", 0.001},
                 {"about a tenth too long", 1.0 / 1.1},
                 {"about a tenth too short", 1.0 / 0.9}};
    for (const auto& unit : units) {
      Add({i},
          Named(i) + " gives its ranges " + unit.words,
          "let its driver give metres: sensor_msgs/LaserScan holds nothing else")
          ->rig[i]
          .scale = unit.scale;
    }
  }

  void AddExchanged(size_t i, size_t j) {
    OtherMounting* other = Add({i, j},
                               "scanners " + names_[i] + " and " + names_[j] +
                                   " are exchanged: each sees what the other should see",
                               "exchange their topics in the rig file");
    std::swap(other->rig[i].source, other->rig[j].source);
  }

  void AddCycle(const std::vector<size_t>& sources) {
    OtherMounting* other =
        Add({0, 1, 2},
            "the three scanners are exchanged in a circle: " + names_[0] + " sees what " +
                names_[sources[0]] + " should see",
            "exchange their topics in the rig file");
    for (size_t i = 0; i < 3; ++i) other->rig[i].source = rig_[sources[i]].source;
  }

  const MountedRig& rig_;
  const std::vector<std::string>& names_;
};

// Fits the correction of one scanner, the others held.
class MountingFit {
 public:
  MountingFit(const Sample& sample, const MountedRig& rig, size_t scanner)
      : sample_(sample),
        rig_(rig),
        scanner_(scanner),
        stated_(rig[scanner]),
        prior_(Stacked(kPriorTurn, kPriorShift, kPriorTime, kPriorRange)
                   .cwiseAbs2()
                   .cwiseInverse()
                   .asDiagonal()) {}

  MountingCorrection Run() {
    MountingCorrection correction;
    correction.corrected = stated_;
    Compare();
    correction.num_compared = static_cast<int>(comparisons_.size());
    if (correction.num_compared < kMinCompared) return correction;
    correction.near_share = ShareWithin(comparisons_, kNear);
    Iterate();
    HoldOpen();
    Iterate();
    correction.moved_share = ShareWithin(comparisons_, kNear);
    correction.rotation_rad = total_.head<3>();
    correction.translation_m = total_.segment<3>(3);
    correction.time_offset_s = total_(6);
    correction.range_offset_m = total_(7);
    correction.stddev = covariance_.diagonal().cwiseSqrt();
    correction.corrected = rig_[scanner_];
    return correction;
  }

 private:
  void Compare() {
    comparisons_.clear();
    for (size_t other = 0; other < rig_.size(); ++other) {
      if (other == scanner_) continue;
      const auto some = CompareViews(sample_, rig_, scanner_, other, kLinesForFit);
      comparisons_.insert(comparisons_.end(), some.begin(), some.end());
    }
  }

  void Iterate() {
    for (const double loss_scale : kLossScales) {
      Step(loss_scale);
      Apply();
      Compare();
    }
  }

  // Holds what the scans do not show.
  void HoldOpen() {
    constexpr double kHeld = 1e12;
    HoldAxes(0, kOpenTurn);
    HoldAxes(3, kOpenShift);
    if (covariance_(6, 6) > kOpenTime * kOpenTime) prior_(6, 6) = kHeld;
    if (covariance_(7, 7) > kOpenRange * kOpenRange) prior_(7, 7) = kHeld;
    total_.setZero();
    Apply();
    Compare();
  }

  // Holds the axes, of any direction, of a turn or a shift that are known badly.
  void HoldAxes(Eigen::Index first, double open) {
    constexpr double kHeld = 1e12;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(
        covariance_.block<3, 3>(first, first));
    const Eigen::Vector3d stddev = axes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
    for (Eigen::Index i = 0; i < 3; ++i) {
      if (stddev(i) < std::min(open, kOpenRatio * stddev(0))) continue;
      prior_.block<3, 3>(first, first) +=
          kHeld * axes.eigenvectors().col(i) * axes.eigenvectors().col(i).transpose();
    }
  }

  void Step(double loss_scale) {
    Matrix8d normal_matrix = prior_;
    Vector8d right = -prior_ * total_;
    const Eigen::Vector3d origin = rig_[scanner_].body_from_scanner.translation;
    for (const ViewComparison& one : comparisons_) {
      const Eigen::Vector3d beam = one.p_a - origin;
      Vector8d jacobian;
      jacobian.head<3>() = beam.cross(one.normal);
      jacobian.segment<3>(3) = one.normal;
      jacobian(6) = -one.rate_m_s;
      jacobian(7) = one.normal.dot(beam.normalized());
      const double scaled = one.distance_m / loss_scale;
      const double weight = 1.0 / ((1.0 + scaled * scaled) * loss_scale * loss_scale);
      normal_matrix += weight * jacobian * jacobian.transpose();
      right -= weight * one.distance_m * jacobian;
    }
    const Eigen::LDLT<Matrix8d> factor(normal_matrix);
    const double scatter = ScatterRatio(loss_scale);
    covariance_ = scatter * scatter * factor.solve(Matrix8d::Identity());
    total_ += factor.solve(right);
  }

  // The standard deviation of a place's distance over the one that the loss stands for.
  // Neighbouring lines share their errors: twice what the distances show is right.
  double ScatterRatio(double loss_scale) const {
    constexpr double kMinScatter = 0.01;  // m
    constexpr double kShared = 2.0;
    const double scatter = std::max(kMinScatter, 1.4826 * MedianSize(comparisons_));
    return std::min(1.0, kShared * scatter / loss_scale);
  }

  void Apply() {
    MountedScanner& moved = rig_[scanner_];
    moved = stated_;
    const double angle = total_.head<3>().norm();
    if (angle > 0.0) {
      moved.body_from_scanner.rotation =
          Eigen::Quaterniond(Eigen::AngleAxisd(angle, total_.head<3>() / angle)) *
          stated_.body_from_scanner.rotation;
    }
    moved.body_from_scanner.translation += total_.segment<3>(3);
    moved.time_offset_s += total_(6);
    moved.range_offset_m += total_(7);
  }

  const Sample& sample_;
  MountedRig rig_;
  size_t scanner_;
  MountedScanner stated_;
  Matrix8d prior_;  // information about the total
  Vector8d total_ = Vector8d::Zero();
  Matrix8d covariance_ = Matrix8d::Zero();
  std::vector<ViewComparison> comparisons_;
};

}  // namespace

std::vector<PairAgreement> AgreementsOf(const Sample& sample, const MountedRig& rig) {
  std::vector<PairAgreement> agreements;
  for (size_t a = 0; a < rig.size(); ++a) {
    for (size_t b = a + 1; b < rig.size(); ++b) {
      agreements.push_back(AgreementOf(sample, rig, a, b));
    }
  }
  return agreements;
}

std::optional<OtherMounting> FindOtherMounting(const Sample& sample,
                                               const MountedRig& rig,
                                               const std::vector<std::string>& names) {
  const std::vector<PairAgreement> stated = AgreementsOf(sample, rig);
  std::optional<OtherMounting> best;
  for (OtherMounting& other : Alternatives(rig, names).list) {
    const std::set<size_t> changed(other.scanners.begin(), other.scanners.end());
    other.share_as_stated = ShareOf(stated, changed);
    if (other.share_as_stated < 0.0 || other.share_as_stated > 1.0 - kMinGain) continue;
    std::vector<PairAgreement> agreements;
    for (const PairAgreement& pair : stated) {
      if (changed.count(pair.a) == 0 && changed.count(pair.b) == 0) continue;
      agreements.push_back(AgreementOf(sample, other.rig, pair.a, pair.b));
    }
    other.share_so = ShareOf(agreements, changed);
    const double gain = other.share_so - other.share_as_stated;
    if (other.share_so < kMinShareSo || gain < kMinGain) continue;
    if (best && gain <= best->share_so - best->share_as_stated) continue;
    best = other;
  }
  return best;
}

std::vector<MountingCorrection> FitMountings(const Sample& sample, const MountedRig& rig) {
  std::vector<MountingCorrection> corrections(rig.size());
  for (size_t i = 0; i < rig.size() && rig.size() > 1; ++i) {
    corrections[i] = MountingFit(sample, rig, i).Run();
  }
  return corrections;
}

}  // namespace plumbline
