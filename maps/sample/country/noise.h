#pragma once

#include <cmath>
#include <cstdint>

#include "pilotage/base/random.h"

namespace pilotage::scene_detail {

/// Random bits that belong to a lattice point: the first output of SplitMix64 seeded with the seed and the point. All
/// noise of a scene comes from here, so a pixel's value depends on where it lies and on nothing else.
inline std::uint64_t lattice_hash(std::uint64_t seed, std::int64_t column, std::int64_t row) {
  const std::uint64_t index =
      (static_cast<std::uint64_t>(column) << 32) ^ (static_cast<std::uint64_t>(row) & 0xFFFFFFFFU);
  return Random(seed ^ (index * 0xD1342543DE82EF95U + 1)).next();
}

/// One of the four 16-bit parts of a hash, as a number in [0, 1).
inline float hash_part(std::uint64_t hash, int part) {
  return static_cast<float>((hash >> (16 * part)) & 0xFFFFU) * (1.0F / 65536.0F);
}

/// The same in [-1, 1).
inline float hash_signed(std::uint64_t hash, int part) {
  return 2.0F * hash_part(hash, part) - 1.0F;
}

/// Largest integer not above `x`; |x| < 2^62.
inline std::int64_t floor_to_int(double x) {
  const auto truncated = static_cast<std::int64_t>(x);
  return truncated - (static_cast<double>(truncated) > x ? 1 : 0);
}

inline float clamp01(float x) {
  return x < 0 ? 0.0F : (x > 1 ? 1.0F : x);
}
inline float mix(float a, float b, float t) {
  return a + (b - a) * t;
}

/// 0 below `from`, 1 above `to`, 3t² − 2t³ between.
inline float smooth_step(float from, float to, float x) {
  const float t = clamp01((x - from) / (to - from));
  return t * t * (3 - 2 * t);
}

/// Gradient noise of unit wavelength (K. Perlin, "An image synthesizer", SIGGRAPH 1985, with the quintic blend of his
/// "Improving noise", SIGGRAPH 2002, and gradients uniform over a square). Mean 0, standard deviation near 0.4, in [-2,
/// 2].
float gradient_noise(std::uint64_t seed, double x, double y);

/// How much of a pattern of wavelength `wavelength_m` survives in pixels of `footprint_m`: 1 from three pixels a wave,
/// 0 below one and a half. Keeps coarse renderings free of aliasing.
inline float surviving_detail(double wavelength_m, double footprint_m) {
  return smooth_step(1.5F, 3.0F, static_cast<float>(wavelength_m / footprint_m));
}

/// Gradient noise of a wavelength in metres, faded out where pixels cannot show it.
inline float detail_noise(std::uint64_t seed, double x_m, double y_m, double wavelength_m, double footprint_m) {
  const float weight = surviving_detail(wavelength_m, footprint_m);
  return weight > 0 ? weight * gradient_noise(seed, x_m / wavelength_m, y_m / wavelength_m) : 0.0F;
}

/// Share of a pixel's width covered by a line of half width `half_width_m` whose axis is `distance_m` away.
inline float line_coverage(double distance_m, double half_width_m, double footprint_m) {
  const double low = std::fmax(-half_width_m, distance_m - footprint_m / 2);
  const double high = std::fmin(half_width_m, distance_m + footprint_m / 2);
  return high > low ? static_cast<float>((high - low) / footprint_m) : 0.0F;
}

}  // namespace pilotage::scene_detail
