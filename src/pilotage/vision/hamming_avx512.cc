#include "pilotage/vision/hamming_kernel.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

// The functions carry their instruction set as an attribute, and not the whole file as a flag: code of inline functions
// that the linker shares between files must stay runnable everywhere.

namespace pilotage::hamming_detail {

#if defined(__x86_64__)
namespace {

template <int kWords>
[[gnu::target("avx512f,avx512vpopcntdq"), gnu::always_inline]] inline __m512i block_distances(
    const std::uint64_t* block, const __m512i* query) {
  __m512i sum = _mm512_popcnt_epi64(_mm512_xor_si512(_mm512_load_si512(block), query[0]));
  for (int word = 1; word < kWords; ++word) {
    const __m512i bits = _mm512_xor_si512(_mm512_load_si512(block + 8 * word), query[word]);
    sum = _mm512_add_epi64(sum, _mm512_popcnt_epi64(bits));
  }
  return sum;
}

/// Offers the lanes of `mask`, and keeps the bound up to date.
[[gnu::target("avx512f,avx512vpopcntdq"), gnu::noinline]] __m512i offer_lanes(Nearest& nearest, std::size_t slot,
                                                                              __m512i distances, unsigned mask) {
  alignas(64) std::uint64_t stored[8];
  _mm512_store_si512(stored, distances);
  nearest.offer_block(slot, stored, mask);
  return _mm512_set1_epi64(static_cast<long long>(nearest.bound()));
}

template <int kWords>
[[gnu::target("avx512f,avx512vpopcntdq")]] void scan(const std::uint64_t* blocks, const std::uint64_t* query,
                                                     std::size_t begin, std::size_t end, Nearest& nearest) {
  if (begin >= end) return;
  __m512i query_words[kWords];
  for (int word = 0; word < kWords; ++word) {
    query_words[word] = _mm512_set1_epi64(static_cast<long long>(query[word]));
  }
  __m512i bound = _mm512_set1_epi64(static_cast<long long>(nearest.bound()));
  std::size_t slot = begin / kSlotsPerBlock * kSlotsPerBlock;
  while (slot < end) {
    // Four whole blocks at a time: one branch for 32 slots, which is hardly ever taken.
    if (slot >= begin && slot + 4 * kSlotsPerBlock <= end) {
      const std::uint64_t* const block = blocks + slot * kWords;
      const __m512i d0 = block_distances<kWords>(block, query_words);
      const __m512i d1 = block_distances<kWords>(block + 8 * kWords, query_words);
      const __m512i d2 = block_distances<kWords>(block + 16 * kWords, query_words);
      const __m512i d3 = block_distances<kWords>(block + 24 * kWords, query_words);
      const unsigned m0 = _mm512_cmple_epu64_mask(d0, bound);
      const unsigned m1 = _mm512_cmple_epu64_mask(d1, bound);
      const unsigned m2 = _mm512_cmple_epu64_mask(d2, bound);
      const unsigned m3 = _mm512_cmple_epu64_mask(d3, bound);
      if ((m0 | m1 | m2 | m3) != 0) [[unlikely]] {
        if (m0 != 0) bound = offer_lanes(nearest, slot, d0, m0);
        if (m1 != 0) bound = offer_lanes(nearest, slot + 8, d1, m1);
        if (m2 != 0) bound = offer_lanes(nearest, slot + 16, d2, m2);
        if (m3 != 0) bound = offer_lanes(nearest, slot + 24, d3, m3);
      }
      slot += 4 * kSlotsPerBlock;
      continue;
    }
    const __m512i distances = block_distances<kWords>(blocks + slot * kWords, query_words);
    const unsigned mask = _mm512_cmple_epu64_mask(distances, bound) & lanes_inside(slot, begin, end);
    if (mask != 0) bound = offer_lanes(nearest, slot, distances, mask);
    slot += kSlotsPerBlock;
  }
}

}  // namespace

void scan_avx512(const std::uint64_t* blocks, int words, const std::uint64_t* query, std::size_t begin, std::size_t end,
                 Nearest& nearest) {
  with_words(words, [&]<int kWords>() { scan<kWords>(blocks, query, begin, end, nearest); });
}
#else
void scan_avx512(const std::uint64_t* blocks, int words, const std::uint64_t* query, std::size_t begin, std::size_t end,
                 Nearest& nearest) {
  scan_portable(blocks, words, query, begin, end, nearest);
}
#endif

}  // namespace pilotage::hamming_detail
