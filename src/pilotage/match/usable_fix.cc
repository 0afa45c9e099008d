#include "pilotage/match/usable_fix.h"

#include <cmath>

#include <Eigen/LU>

namespace pilotage {

bool has_usable_fix(const MatchResult& result) {
  if (result.status != MatchStatus::kFix || !result.fix) return false;
  const Fix& fix = *result.fix;
  const Eigen::Matrix2d& covariance = fix.covariance_en_m2;
  if (!std::isfinite(fix.position.lon_deg) || !(std::abs(fix.position.lat_deg) <= 90)) return false;
  return covariance.allFinite() && covariance(0, 0) > 0 && covariance(1, 1) > 0 && covariance.determinant() >= 0;
}

}  // namespace pilotage
