#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "testing/cubic_convolution.h"
#include <Eigen/Core>

#include "pilotage/base/nan.h"
#include "pilotage/raster/raster.h"

namespace pilotage::testing {

/// The gray value at a position of `ground` (pixel centres at +0.5), from the pixels within two of it, or one; NaN
/// where one of them is missing, or what lies around is less than two pixels from the edge.
inline double plain_sample(const Raster& ground, double x_px, double y_px, bool cubic) {
  const double x = x_px - 0.5;
  const double y = y_px - 0.5;
  if (!(x >= 1 && y >= 1 && x < ground.pixels.cols - 2 && y < ground.pixels.rows - 2)) return kNaN;
  const int reach = cubic ? 2 : 1;
  double sum = 0;
  for (int row = static_cast<int>(y) - reach + 1; row <= static_cast<int>(y) + reach; ++row) {
    for (int col = static_cast<int>(x) - reach + 1; col <= static_cast<int>(x) + reach; ++col) {
      if (ground.valid.at<std::uint8_t>(row, col) == 0) return kNaN;
      const double weight =
          cubic ? keys_weight(x - col) * keys_weight(y - row) : (1 - std::abs(x - col)) * (1 - std::abs(y - row));
      sum += weight * ground.pixels.at<std::uint8_t>(row, col);
    }
  }
  return sum;
}

/// What SampledGround says of one pixel, sample by sample.
inline double plain_mean(const Raster& ground, const Eigen::Vector2d& top_left, const Eigen::Vector2d& top_right,
                         const Eigen::Vector2d& bottom_left, const Eigen::Vector2d& bottom_right) {
  const double side = std::max({(top_right - top_left).norm(), (bottom_right - bottom_left).norm(),
                                (bottom_left - top_left).norm(), (bottom_right - top_right).norm()});
  if (!std::isfinite(side)) return kNaN;
  const int count = static_cast<int>(std::clamp(std::ceil(2 * side), 2.0, 256.0));
  double sum = 0;
  for (int j = 0; j < count; ++j) {
    for (int i = 0; i < count; ++i) {
      const double right = (i + 0.5) / count;
      const double down = (j + 0.5) / count;
      const Eigen::Vector2d at = (1 - down) * ((1 - right) * top_left + right * top_right) +
                                 down * ((1 - right) * bottom_left + right * bottom_right);
      sum += plain_sample(ground, at.x(), at.y(), side <= 1);
    }
  }
  return sum / (count * count);
}

}  // namespace pilotage::testing
