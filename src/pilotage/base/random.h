#pragma once

#include <cstdint>
#include <string_view>

namespace pilotage {

/// Seeded random numbers that are the same on every machine and standard library (std:: distributions are not).
/// SplitMix64: G. Steele, D. Lea, C. Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  /// Uniform over all 64-bit integers.
  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15U);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31);
  }

  /// Uniform in [0, 1), multiples of 2^-53.
  double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }

  /// Uniform in [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Uniform over 0 … count − 1; `count` > 0. The bias is below count / 2^64.
  std::uint64_t below(std::uint64_t count);

  /// Standard normal (Marsaglia's polar method; both values of a pair are used).
  double normal();

 private:
  std::uint64_t state_;
  double spare_ = 0;
  bool has_spare_ = false;
};

/// A seed for one piece of work, so that results do not depend on the order or the thread in which pieces are done.
std::uint64_t derive_seed(std::uint64_t seed, std::uint64_t index);

/// FNV-1a hash of a name, for tests and streams that seed from their own name.
std::uint64_t seed_from_name(std::string_view name);

}  // namespace pilotage
