// Half of what libFuzzer tries on the target map are forgeries, the other half its own mutations.

#include <algorithm>
#include <string>

#include "fuzz/fuzz_targets.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  pilotage::Random random(seed);
  if (random.below(2) == 0) return LLVMFuzzerMutate(data, size, max_size);
  const std::string forged = pilotage::forge_map(std::string(data, data + size), random);
  if (forged.size() > max_size) return LLVMFuzzerMutate(data, size, max_size);
  std::copy(forged.begin(), forged.end(), data);
  return forged.size();
}
