#pragma once

#include "pilotage/match/match.h"

namespace pilotage::testing {

/// An accepted match with a fix whose covariance has axes of 2 m and 4 m, turned by 30°: 4 cos² 30° + 16 sin² 30° = 7
/// m² east, 13 m² north, (16 − 4) · sin 30° · cos 30° between them.
inline MatchResult some_match() {
  Fix fix;
  fix.position = {114.8741234567, -1.0745678912};
  fix.covariance_en_m2 << 7, 5.196152422706632, 5.196152422706632, 13;
  fix.center = {1, 2};  // must not be mistaken for the aircraft
  fix.height_agl_m = 120;
  fix.height_sigma_m = 3;
  MatchResult result;
  result.status = MatchStatus::kFix;
  result.fix = fix;
  return result;
}

/// A refused match: with a best place, for people only.
inline MatchResult refused_match() {
  MatchResult result = some_match();
  result.status = MatchStatus::kAmbiguous;
  result.candidate = result.fix;
  result.fix.reset();
  return result;
}

}  // namespace pilotage::testing
