#pragma once

#include <cmath>

namespace pilotage::testing {

/// The weight of a pixel so far away by cubic convolution with a = −1/2 (R. Keys, IEEE Trans. ASSP 29, 1981).
inline double keys_weight(double distance_px) {
  const double d = std::abs(distance_px);
  if (d < 1) return (1.5 * d - 2.5) * d * d + 1;
  return d < 2 ? ((-0.5 * d + 2.5) * d - 4) * d + 2 : 0;
}

}  // namespace pilotage::testing
