#include "pilotage/vision/hamming_distance.h"

#include <bit>
#include <cstring>

namespace pilotage {

namespace {

/// The loops of nearest_descriptor() for descriptors of `words` × 8 bytes; inlined, so that a number known when
/// compiling unrolls them and the caller's instruction set counts.
[[gnu::always_inline]] inline NearestDescriptor nearest_of(const std::uint8_t* query,
                                                           const std::uint8_t* const* candidates, std::size_t count,
                                                           std::size_t words) {
  NearestDescriptor nearest;
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t distance = 0;
    for (std::size_t word = 0; word < words; ++word) {
      std::uint64_t a = 0;
      std::uint64_t b = 0;
      std::memcpy(&a, query + 8 * word, 8);
      std::memcpy(&b, candidates[i] + 8 * word, 8);
      distance += static_cast<std::uint32_t>(__builtin_popcountll(a ^ b));
    }
    if (distance < nearest.distance) nearest = {i, distance};
  }
  return nearest;
}

}  // namespace

// The choice between clones is made while the program is loaded, when the thread sanitizer cannot be called yet.
#if defined(__x86_64__) && !defined(__SANITIZE_THREAD__)
__attribute__((target_clones("popcnt", "default")))
#endif
NearestDescriptor
nearest_descriptor(const std::uint8_t* query, const std::uint8_t* const* candidates, std::size_t count,
                   std::size_t bytes) {
  switch (bytes) {
    case 16:
      return nearest_of(query, candidates, count, 2);
    case 32:
      return nearest_of(query, candidates, count, 4);
    case 64:
      return nearest_of(query, candidates, count, 8);
    default:
      return nearest_of(query, candidates, count, bytes / 8);
  }
}

}  // namespace pilotage
