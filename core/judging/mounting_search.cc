#include "core/judging/mounting_search.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>

#include "core/geometry/angles.h"
#include "core/geometry/roll_pitch_yaw.h"
#include "core/judging/levels.h"
#include "core/judging/mounting_fit.h"
#include "core/judging/words.h"

namespace plumbline {
namespace {

constexpr int kLinesForAgreement = 400;  // of each pair
// Turns of any angle are tried in such steps, and the best of them fitted.
constexpr int kTurnStep = 20;    // deg
constexpr double kCaught = 0.4;  // m, between places that a fit may bring together
constexpr size_t kMaxFitted = 4;

using Sample = std::vector<std::vector<SampledLine>>;

PairAgreement AgreementOf(const Sample& sample, const MountedRig& rig, size_t a, size_t b) {
  const auto comparisons = CompareViews(sample, rig, a, b, kLinesForAgreement);
  return {a,
          b,
          static_cast<int>(comparisons.size()),
          ShareWithin(comparisons, kAgreed),
          MedianDistance(comparisons)};
}

// The mean share of the pairs that have one of the scanners; negative where none could be
// compared.
double ShareOf(const std::vector<PairAgreement>& agreements,
               const std::set<size_t>& scanners) {
  double sum = 0.0;
  int num = 0;
  for (const PairAgreement& pair : agreements) {
    if (pair.num_compared < kMinPlaces) continue;
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
              Named(i) +
                  " is mirrored against the rig file: its beams come the other way "
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
          .scale *= unit.scale;
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
    OtherMounting* other = Add({0, 1, 2},
                               "the three scanners are exchanged in a circle: " + names_[0] +
                                   " sees what " + names_[sources[0]] + " should see",
                               "exchange their topics in the rig file");
    for (size_t i = 0; i < 3; ++i) other->rig[i].source = rig_[sources[i]].source;
  }

  const MountedRig& rig_;
  const std::vector<std::string>& names_;
};

// Judges a mounting by its places, and keeps it if it is good enough and better for the whole
// rig than the best so far.
void KeepBetter(const Sample& sample,
                OtherMounting* other,
                std::optional<OtherMounting>* best) {
  const std::set<size_t> changed(other->scanners.begin(), other->scanners.end());
  const std::vector<PairAgreement> agreements = AgreementsOf(sample, other->rig);
  other->share_so = ShareOf(agreements, changed);
  const double gain = other->share_so - other->share_as_stated;
  if (other->share_so < 0.5 || gain < 1.0 - kMost) return;
  std::set<size_t> all;
  for (size_t i = 0; i < other->rig.size(); ++i) all.insert(i);
  other->share_of_all = ShareOf(agreements, all);
  if (*best && other->share_of_all <= (*best)->share_of_all) return;
  *best = *other;
}

// Tries turns of one scanner by any angle.
class TurnSearch {
 public:
  TurnSearch(const Sample& sample,
             const MountedRig& rig,
             size_t scanner,
             const std::string& name)
      : sample_(sample), rig_(rig), scanner_(scanner), name_(name) {}

  // share_as_stated: of the scanner's places.
  void Search(double share_as_stated, std::optional<OtherMounting>* best) {
    std::vector<std::pair<double, MountedRig>> starts = Starts();
    std::stable_sort(starts.begin(), starts.end(), [](const auto& a, const auto& b) {
      return a.first > b.first;
    });
    if (starts.size() > kMaxFitted) starts.resize(kMaxFitted);
    for (auto& [share, turned] : starts) {
      turned[scanner_] = FitMounting(sample_, turned, scanner_).corrected;
      OtherMounting other;
      other.scanners = {scanner_};
      other.share_as_stated = share_as_stated;
      other.rig = turned;
      Describe(&other);
      KeepBetter(sample_, &other, best);
    }
  }

 private:
  // Coarse turns, with the share of the places that come near each other.
  std::vector<std::pair<double, MountedRig>> Starts() const {
    std::vector<std::pair<double, MountedRig>> starts;
    for (const bool is_upright : {true, false}) {
      for (int angle = kTurnStep; angle < 360; angle += kTurnStep) {
        MountedRig turned = rig_;
        turned[scanner_] = TurnedInPlane(rig_[scanner_], angle * kRadiansPerDegree);
        if (is_upright) {
          turned[scanner_].body_from_scanner.rotation =
              Eigen::AngleAxisd(angle * kRadiansPerDegree, Eigen::Vector3d::UnitZ()) *
              rig_[scanner_].body_from_scanner.rotation;
        }
        starts.emplace_back(CaughtShare(turned), turned);
      }
    }
    return starts;
  }

  double CaughtShare(const MountedRig& rig) const {
    double sum = 0.0;
    int num = 0;
    for (size_t other = 0; other < rig.size(); ++other) {
      if (other == scanner_) continue;
      const auto comparisons = CompareViews(sample_, rig, scanner_, other, kLinesForAgreement);
      if (static_cast<int>(comparisons.size()) < kMinPlaces) continue;
      sum += ShareWithin(comparisons, kCaught);
      ++num;
    }
    return num == 0 ? 0.0 : sum / num;
  }

  void Describe(OtherMounting* other) const {
    const Eigen::Quaterniond stated = rig_[scanner_].body_from_scanner.rotation;
    const Eigen::Quaterniond found = other->rig[scanner_].body_from_scanner.rotation;
    const Eigen::AngleAxisd turn(found * stated.conjugate());
    const Eigen::Vector3d own_axis = stated * Eigen::Vector3d::UnitZ();
    const double by = turn.angle() * kDegreesPerRadian;
    const double upright = turn.axis().z();
    const double own = turn.axis().dot(own_axis);
    constexpr double kAlong = 0.99;
    std::string words = "scanner " + name_ + " is turned by ";
    if (std::abs(upright) > kAlong) {
      words += Decimal(upright > 0.0 ? by : -by, 0) + " deg about the vertical";
    } else if (std::abs(own) > kAlong) {
      words += Decimal(own > 0.0 ? by : -by, 0) + " deg in its own plane";
    } else {
      words += Decimal(by, 0) + " deg";
    }
    other->words = words + " against the rig file";
    const Eigen::Vector3d rpy = RollPitchYawDegrees(found);
    other->advice = "in the rig file: rotation_rpy_deg: [" + Decimal(rpy.x(), 1) + ", " +
                    Decimal(rpy.y(), 1) + ", " + Decimal(rpy.z(), 1) + "]";
  }

  const Sample& sample_;
  const MountedRig& rig_;
  size_t scanner_;
  const std::string& name_;
};

}  // namespace

bool PairAgreement::IsApart() const {
  return num_compared >= kMinPlaces && near_share < kMost;
}

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
    if (other.share_as_stated < 0.0 || other.share_as_stated > kMost) continue;
    KeepBetter(sample, &other, &best);
  }
  return best;
}

std::optional<OtherMounting> FindTurn(const Sample& sample,
                                      const MountedRig& rig,
                                      const std::vector<std::string>& names) {
  const std::vector<PairAgreement> stated = AgreementsOf(sample, rig);
  std::optional<OtherMounting> best;
  for (size_t i = 0; i < rig.size(); ++i) {
    const double share = ShareOf(stated, {i});
    if (share < 0.0 || share > kMost) continue;
    TurnSearch(sample, rig, i, names[i]).Search(share, &best);
  }
  return best;
}

}  // namespace plumbline
