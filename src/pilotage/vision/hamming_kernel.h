#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "pilotage/vision/descriptor.h"
#include "pilotage/vision/hamming.h"

// Inside of hamming.cc and its kernels; not for users.

namespace pilotage::hamming_detail {

inline constexpr std::size_t kSlotsPerBlock = 8;
inline constexpr int kMostWords = kDescriptorWords.back();

/// Calls `scan.operator()<kWords>()` with one of kDescriptorWords as a number known when compiling.
template <class Scan>
void with_words(int words, const Scan& scan) {
  const auto try_length = [&]<std::size_t kIndex>() {
    constexpr int kWords = kDescriptorWords[kIndex];
    if (words == kWords) scan.template operator()<kWords>();
  };
  [&]<std::size_t... kIndices>(std::index_sequence<kIndices...>) {
    (try_length.template operator()<kIndices>(), ...);
  }
  (std::make_index_sequence<kDescriptorWords.size()>{});
}

/// The k nearest so far of one query, ordered by (distance, index of the feature).
struct Nearest {
  std::array<std::uint64_t, kMaxHammingNeighbours> keys;  ///< distance · 2³² + index, ascending.
  int k = 1;
  const std::uint32_t* order = nullptr;  ///< Slot → index of the feature.
  const float* x_px = nullptr;           ///< By slot; looked at only when there is a window.
  const float* y_px = nullptr;
  const HammingWindow* window = nullptr;
  std::vector<std::uint64_t>* all = nullptr;  ///< When given, every key within the bound, in no order, instead of k.

  /// Nothing found yet; nothing farther than `max_distance` will be.
  void clear(std::uint32_t max_distance = std::numeric_limits<std::uint32_t>::max()) {
    keys.fill((std::uint64_t{max_distance} << 32) | std::numeric_limits<std::uint32_t>::max());
  }

  /// Slots farther than this cannot come in; equal ones may, by a lower index.
  std::uint64_t bound() const { return keys[static_cast<std::size_t>(k - 1)] >> 32; }

  void offer(std::size_t slot, std::uint64_t distance) {
    const std::uint64_t key = (distance << 32) | order[slot];
    auto last = static_cast<std::size_t>(k - 1);
    if (key >= keys[last]) return;
    if (window != nullptr) {
      const double x = static_cast<double>(x_px[slot]);
      const double y = static_cast<double>(y_px[slot]);
      const bool inside =
          x >= window->min_x_px && x <= window->max_x_px && y >= window->min_y_px && y <= window->max_y_px;
      if (!inside) return;
    }
    if (all != nullptr) {
      all->push_back(key);
      return;
    }
    for (; last > 0 && keys[last - 1] > key; --last) keys[last] = keys[last - 1];
    keys[last] = key;
  }

  /// Offers the slots of a block whose bit is set in `mask`.
  void offer_block(std::size_t first_slot, const std::uint64_t* distances, unsigned mask) {
    for (; mask != 0; mask &= mask - 1) {
      const auto lane = static_cast<std::size_t>(__builtin_ctz(mask));
      offer(first_slot + lane, distances[lane]);
    }
  }
};

/// Bits of the lanes of the block at `first_slot` that lie in [begin, end).
inline unsigned lanes_inside(std::size_t first_slot, std::size_t begin, std::size_t end) {
  unsigned mask = 0xFF;
  if (first_slot < begin) mask &= 0xFFU << (begin - first_slot);
  if (first_slot + kSlotsPerBlock > end) mask &= 0xFFU >> (first_slot + kSlotsPerBlock - end);
  return mask;
}

void scan_portable(const std::uint64_t* blocks, int words, const std::uint64_t* query, std::size_t begin,
                   std::size_t end, Nearest& nearest);
/// Only where hamming_paths() has kAvx2; on other processors it is scan_portable.
void scan_avx2(const std::uint64_t* blocks, int words, const std::uint64_t* query, std::size_t begin, std::size_t end,
               Nearest& nearest);
/// Only where hamming_paths() has kAvx512; on other processors it is scan_portable.
void scan_avx512(const std::uint64_t* blocks, int words, const std::uint64_t* query, std::size_t begin, std::size_t end,
                 Nearest& nearest);

/// Only where hamming_paths() has kNeon; on other processors it is scan_portable.
void scan_neon(const std::uint64_t* blocks, int words, const std::uint64_t* query, std::size_t begin, std::size_t end,
               Nearest& nearest);

}  // namespace pilotage::hamming_detail
