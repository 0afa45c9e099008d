#pragma once

#include <cstdint>

namespace pilotage::testing {

/// What this thread has done since it began, in a build with PILOTAGE_COUNT_STEPS: how often a block of the library's
/// own code was entered, and how often anything, libraries included, took memory. The same input gives the same counts.
struct CountedSteps {
  std::uint64_t blocks = 0;
  std::uint64_t allocations = 0;
};
CountedSteps counted_steps();

}  // namespace pilotage::testing
