#include <array>

#include "pilotage/vision/hamming_kernel.h"

namespace pilotage::hamming_detail {
namespace {

/// Number of set bits by adding neighbouring fields: no instruction beyond any machine's, and a compiler can run
/// several lanes side by side.
constexpr std::uint64_t count_bits(std::uint64_t x) {
  x -= (x >> 1) & 0x5555555555555555U;
  x = (x & 0x3333333333333333U) + ((x >> 2) & 0x3333333333333333U);
  x = (x + (x >> 4)) & 0x0F0F0F0F0F0F0F0FU;
  x += x >> 8;
  x += x >> 16;
  x += x >> 32;
  return x & 0x7F;
}

template <int kWords>
void scan(const std::uint64_t* blocks, const std::uint64_t* query, std::size_t begin, std::size_t end,
          Nearest& nearest) {
  std::uint64_t bound = nearest.bound();
  for (std::size_t slot = begin / kSlotsPerBlock * kSlotsPerBlock; slot < end; slot += kSlotsPerBlock) {
    const std::uint64_t* const block = blocks + slot * static_cast<std::size_t>(kWords);
    std::array<std::uint64_t, kSlotsPerBlock> distances{};
    for (std::size_t word = 0; word < static_cast<std::size_t>(kWords); ++word) {
      for (std::size_t lane = 0; lane < kSlotsPerBlock; ++lane) {
        distances[lane] += count_bits(block[word * kSlotsPerBlock + lane] ^ query[word]);
      }
    }
    unsigned mask = 0;
    for (std::size_t lane = 0; lane < kSlotsPerBlock; ++lane) {
      mask |= static_cast<unsigned>(distances[lane] <= bound) << lane;
    }
    mask &= lanes_inside(slot, begin, end);
    if (mask != 0) {
      nearest.offer_block(slot, distances.data(), mask);
      bound = nearest.bound();
    }
  }
}

}  // namespace

void scan_portable(const std::uint64_t* blocks, int words, const std::uint64_t* query, std::size_t begin,
                   std::size_t end, Nearest& nearest) {
  with_words(words, [&]<int kWords>() { scan<kWords>(blocks, query, begin, end, nearest); });
}

}  // namespace pilotage::hamming_detail
