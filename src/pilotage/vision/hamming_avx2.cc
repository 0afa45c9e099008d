#include "pilotage/vision/hamming_kernel.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

// Instruction sets by attribute, not by flag: see hamming_avx512.cc.

namespace pilotage::hamming_detail {

#if defined(__x86_64__)
namespace {

/// Set bits of each byte, by two look-ups of four bits (W. Muła, N. Kurz, D. Lemire, "Faster population counts using
/// AVX2 instructions", The Computer Journal 2018).
[[gnu::target("avx2"), gnu::always_inline]] inline __m256i byte_counts(__m256i bits, __m256i table, __m256i low_four) {
  const __m256i low = _mm256_and_si256(bits, low_four);
  const __m256i high = _mm256_and_si256(_mm256_srli_epi16(bits, 4), low_four);
  return _mm256_add_epi8(_mm256_shuffle_epi8(table, low), _mm256_shuffle_epi8(table, high));
}

/// Bytes of the query's word, four times.
[[gnu::target("avx2"), gnu::always_inline]] inline __m256i repeated(std::uint64_t word) {
  return _mm256_set1_epi64x(static_cast<long long>(word));
}

/// Bits of four 64-bit lanes that are at most `bound` (both below 2⁶³).
[[gnu::target("avx2"), gnu::always_inline]] inline unsigned lanes_at_most(__m256i distances, __m256i bound) {
  const __m256i farther = _mm256_cmpgt_epi64(distances, bound);
  return 0xFU & ~static_cast<unsigned>(_mm256_movemask_pd(_mm256_castsi256_pd(farther)));
}

template <int kWords>
[[gnu::target("avx2")]] void scan(const std::uint64_t* blocks, const std::uint64_t* query, std::size_t begin,
                                  std::size_t end, Nearest& nearest) {
  const __m256i table = _mm256_setr_epi8(0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4,  //
                                         0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4);
  const __m256i low_four = _mm256_set1_epi8(0x0F);
  const __m256i zero = _mm256_setzero_si256();
  __m256i query_words[kWords];
  for (int word = 0; word < kWords; ++word) query_words[word] = repeated(query[word]);
  __m256i bound = repeated(nearest.bound());
  for (std::size_t slot = begin / kSlotsPerBlock * kSlotsPerBlock; slot < end; slot += kSlotsPerBlock) {
    const auto* const block = reinterpret_cast<const __m256i*>(blocks + slot * kWords);
    static_assert(8 * kWords < 256, "a byte collects at most 8 bits of each word");
    __m256i low_bytes = zero;
    __m256i high_bytes = zero;
    for (int word = 0; word < kWords; ++word) {
      const __m256i low = _mm256_xor_si256(_mm256_load_si256(block + 2 * word), query_words[word]);
      const __m256i high = _mm256_xor_si256(_mm256_load_si256(block + 2 * word + 1), query_words[word]);
      low_bytes = _mm256_add_epi8(low_bytes, byte_counts(low, table, low_four));
      high_bytes = _mm256_add_epi8(high_bytes, byte_counts(high, table, low_four));
    }
    const __m256i low_distances = _mm256_sad_epu8(low_bytes, zero);
    const __m256i high_distances = _mm256_sad_epu8(high_bytes, zero);
    const unsigned mask = (lanes_at_most(low_distances, bound) | lanes_at_most(high_distances, bound) << 4) &
                          lanes_inside(slot, begin, end);
    if (mask != 0) [[unlikely]] {
      alignas(32) std::uint64_t distances[kSlotsPerBlock];
      _mm256_store_si256(reinterpret_cast<__m256i*>(distances), low_distances);
      _mm256_store_si256(reinterpret_cast<__m256i*>(distances + 4), high_distances);
      nearest.offer_block(slot, distances, mask);
      bound = repeated(nearest.bound());
    }
  }
}

}  // namespace

void scan_avx2(const std::uint64_t* blocks, int words, const std::uint64_t* query, std::size_t begin, std::size_t end,
               Nearest& nearest) {
  with_words(words, [&]<int kWords>() { scan<kWords>(blocks, query, begin, end, nearest); });
}
#else
void scan_avx2(const std::uint64_t* blocks, int words, const std::uint64_t* query, std::size_t begin, std::size_t end,
               Nearest& nearest) {
  scan_portable(blocks, words, query, begin, end, nearest);
}
#endif

}  // namespace pilotage::hamming_detail
