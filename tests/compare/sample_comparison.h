#pragma once

#include "pilotage/compare/compare.h"

namespace pilotage::testing {

/// Four frames: one found, one found at the wrong place, one of other ground, one that shows the sky; by ORB and SIFT.
Comparison sample_comparison();

}  // namespace pilotage::testing
