#pragma once

#include <cstddef>
#include <cstdint>

namespace pilotage {

/// The one of `count` descriptors that is nearest to a query.
struct NearestDescriptor {
  std::size_t index = 0;         ///< In `candidates`; the first of equal ones.
  std::uint32_t distance = ~0U;  ///< Number of differing bits.
};

/// The nearest of the descriptors candidates[0 … count − 1] to `query`, all of `bytes` bytes (a multiple of 8). For a
/// handful of known candidates; HammingIndex is for searching many. Uses the population count instruction where the
/// machine has it; the result is the same without.
NearestDescriptor nearest_descriptor(const std::uint8_t* query, const std::uint8_t* const* candidates,
                                     std::size_t count, std::size_t bytes);

}  // namespace pilotage
