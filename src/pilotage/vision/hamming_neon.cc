#include "pilotage/vision/hamming_kernel.h"

#if defined(__aarch64__)
#include <arm_neon.h>
#endif

namespace pilotage::hamming_detail {

#if defined(__aarch64__)
namespace {

/// Distances of two slots each, of a block's eight.
using BlockDistances = std::array<uint64x2_t, kSlotsPerBlock / 2>;

/// The bits that differ are counted byte by byte (CNT) and collected over the words before they are added up, since
/// that takes three instructions more for each two slots.
template <int kWords>
inline BlockDistances distances_of(const std::uint64_t* block, const uint64x2_t (&query)[kWords]) {
  static_assert(8 * kWords < 256, "a byte collects at most 8 bits of each word");
  BlockDistances distances;
  for (std::size_t pair = 0; pair < distances.size(); ++pair) {
    uint8x16_t bytes = vdupq_n_u8(0);
    for (int word = 0; word < kWords; ++word) {
      const uint64x2_t slots = vld1q_u64(block + static_cast<std::size_t>(word) * kSlotsPerBlock + 2 * pair);
      bytes = vaddq_u8(bytes, vcntq_u8(vreinterpretq_u8_u64(veorq_u64(slots, query[word]))));
    }
    distances[pair] = vpaddlq_u32(vpaddlq_u16(vpaddlq_u8(bytes)));
  }
  return distances;
}

/// Whether any is at most `bound`.
inline bool any_at_most(const BlockDistances& distances, uint64x2_t bound) {
  const uint64x2_t near = vorrq_u64(vorrq_u64(vcleq_u64(distances[0], bound), vcleq_u64(distances[1], bound)),
                                    vorrq_u64(vcleq_u64(distances[2], bound), vcleq_u64(distances[3], bound)));
  return vmaxvq_u32(vreinterpretq_u32_u64(near)) != 0;
}

template <int kWords>
void scan(const std::uint64_t* blocks, const std::uint64_t* query, std::size_t begin, std::size_t end,
          Nearest& nearest) {
  uint64x2_t query_words[kWords];
  for (int word = 0; word < kWords; ++word) query_words[word] = vdupq_n_u64(query[word]);
  uint64x2_t bound = vdupq_n_u64(nearest.bound());
  for (std::size_t slot = begin / kSlotsPerBlock * kSlotsPerBlock; slot < end; slot += kSlotsPerBlock) {
    const BlockDistances found = distances_of<kWords>(blocks + slot * kWords, query_words);
    if (!any_at_most(found, bound)) [[likely]]
      continue;
    std::uint64_t distances[kSlotsPerBlock];
    for (std::size_t pair = 0; pair < found.size(); ++pair) vst1q_u64(distances + 2 * pair, found[pair]);
    unsigned mask = 0;
    for (unsigned lane = 0; lane < kSlotsPerBlock; ++lane) {
      if (distances[lane] <= nearest.bound()) mask |= 1U << lane;
    }
    nearest.offer_block(slot, distances, mask & lanes_inside(slot, begin, end));
    bound = vdupq_n_u64(nearest.bound());
  }
}

}  // namespace

void scan_neon(const std::uint64_t* blocks, int words, const std::uint64_t* query, std::size_t begin, std::size_t end,
               Nearest& nearest) {
  with_words(words, [&]<int kWords>() { scan<kWords>(blocks, query, begin, end, nearest); });
}
#else
void scan_neon(const std::uint64_t* blocks, int words, const std::uint64_t* query, std::size_t begin, std::size_t end,
               Nearest& nearest) {
  scan_portable(blocks, words, query, begin, end, nearest);
}
#endif

}  // namespace pilotage::hamming_detail
