#include "pilotage/vision/hamming_distance.h"

#include <bit>
#include <cstring>

namespace pilotage {

#if defined(__x86_64__)
__attribute__((target_clones("popcnt", "default")))
#endif
NearestDescriptor
nearest_descriptor(const std::uint8_t* query, const std::uint8_t* const* candidates, std::size_t count,
                   std::size_t bytes) {
  NearestDescriptor nearest;
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t distance = 0;
    for (std::size_t at = 0; at < bytes; at += 8) {
      std::uint64_t a = 0;
      std::uint64_t b = 0;
      std::memcpy(&a, query + at, 8);
      std::memcpy(&b, candidates[i] + at, 8);
      distance += static_cast<std::uint32_t>(__builtin_popcountll(a ^ b));
    }
    if (distance < nearest.distance) nearest = {i, distance};
  }
  return nearest;
}

}  // namespace pilotage
