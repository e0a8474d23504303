#include "core/result/result_types.h"

#include <glog/logging.h>

namespace plumbline {

std::string PlaneTypeName(PlaneType type) {
  switch (type) {
    case PlaneType::kHorizontal:
      return "horizontal";
    case PlaneType::kVertical:
      return "vertical";
    case PlaneType::kGeneral:
      return "general";
  }
  LOG(FATAL) << "plane type " << static_cast<int>(type);
}

std::string VerdictName(Verdict verdict) {
  switch (verdict) {
    case Verdict::kConsistent:
      return "consistent";
    case Verdict::kDoubtful:
      return "doubtful";
    case Verdict::kContradictory:
      return "contradictory";
  }
  LOG(FATAL) << "verdict " << static_cast<int>(verdict);
}

}  // namespace plumbline
