#include "country/noise.h"

namespace pilotage::scene_detail {
namespace {

float corner(std::uint64_t seed, std::int64_t column, std::int64_t row, float dx, float dy) {
  const std::uint64_t hash = lattice_hash(seed, column, row);
  return hash_signed(hash, 0) * dx + hash_signed(hash, 2) * dy;
}

float quintic(float t) {
  return t * t * t * (t * (t * 6 - 15) + 10);
}

}  // namespace

float gradient_noise(std::uint64_t seed, double x, double y) {
  const std::int64_t column = floor_to_int(x);
  const std::int64_t row = floor_to_int(y);
  const auto fx = static_cast<float>(x - static_cast<double>(column));
  const auto fy = static_cast<float>(y - static_cast<double>(row));
  const float u = quintic(fx);
  const float v = quintic(fy);
  const float low = mix(corner(seed, column, row, fx, fy), corner(seed, column + 1, row, fx - 1, fy), u);
  const float high =
      mix(corner(seed, column, row + 1, fx, fy - 1), corner(seed, column + 1, row + 1, fx - 1, fy - 1), u);
  return 2.0F * mix(low, high, v);
}

}  // namespace pilotage::scene_detail
