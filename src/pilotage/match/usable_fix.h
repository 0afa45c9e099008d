#pragma once

#include "pilotage/match/match.h"

namespace pilotage {

/// Whether a match may go into a navigation filter: its status is kFix, it holds a fix, position and covariance are
/// finite, the latitude is one, and the covariance is that of an error (positive on its diagonal, no correlation above
/// one).
bool has_usable_fix(const MatchResult& result);

}  // namespace pilotage
