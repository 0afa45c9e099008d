#pragma once

#include <array>
#include <cstddef>

namespace pilotage {

/// Numbers that are worked out together: a loop over them is of a known length.
inline constexpr std::size_t kTogether = 8;
using Together = std::array<double, kTogether>;

}  // namespace pilotage

// PILOTAGE_WIDE_CLONES before a function compiles it for AVX2, too, where its loops over a known number of doubles, no
// fewer than four, take wide instructions. These add and multiply as the others do, and none is fused: the numbers are
// the same. The choice is made while the program is loaded, when the thread sanitizer cannot be called yet.
#if defined(__x86_64__) && !defined(__SANITIZE_THREAD__)
#define PILOTAGE_WIDE_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define PILOTAGE_WIDE_CLONES
#endif
