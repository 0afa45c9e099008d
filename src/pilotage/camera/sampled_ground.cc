#include "pilotage/camera/sampled_ground.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include <opencv2/core.hpp>

#include "pilotage/base/nan.h"
#include "pilotage/base/wide_clones.h"

namespace pilotage {
namespace {

constexpr int kCubicTaps = 4;
constexpr int kLinearTaps = 2;
constexpr double kMostSamples = 256;  // along each side of a pixel of the frame

/// Corners of eight pixels: each pointer leads to nine numbers.
struct Corners {
  const double* above_x_px;
  const double* above_y_px;
  const double* below_x_px;
  const double* below_y_px;
};

/// The squares of the longest sides of eight pixels.
PILOTAGE_WIDE_CLONES
void measure_sides(const Corners& corners, Together& longest2_px) {
  const Corners at = corners;
  Together longest;
  for (std::size_t i = 0; i < kTogether; ++i) {
    const double top_x = at.above_x_px[i + 1] - at.above_x_px[i];
    const double top_y = at.above_y_px[i + 1] - at.above_y_px[i];
    const double bottom_x = at.below_x_px[i + 1] - at.below_x_px[i];
    const double bottom_y = at.below_y_px[i + 1] - at.below_y_px[i];
    const double left_x = at.below_x_px[i] - at.above_x_px[i];
    const double left_y = at.below_y_px[i] - at.above_y_px[i];
    const double right_x = at.below_x_px[i + 1] - at.above_x_px[i + 1];
    const double right_y = at.below_y_px[i + 1] - at.above_y_px[i + 1];
    const double flat = std::max(top_x * top_x + top_y * top_y, bottom_x * bottom_x + bottom_y * bottom_y);
    const double steep = std::max(left_x * left_x + left_y * left_y, right_x * right_x + right_y * right_y);
    longest[i] = std::max(flat, steep);
  }
  longest2_px = longest;
}

/// Positions of a sample in eight pixels, as rows and columns count: pixel centres at 0.
struct Places {
  Together x;
  Together y;
};

/// `right` and `down`: where in each pixel, 0 … 1. Within one the projection is bilinear to far less than a sample's
/// distance.
PILOTAGE_WIDE_CLONES
void place_samples(const Corners& corners, double right, double down, Places& places) {
  const Corners at = corners;
  Places found;
  for (std::size_t i = 0; i < kTogether; ++i) {
    const double above_x = (1 - right) * at.above_x_px[i] + right * at.above_x_px[i + 1];
    const double above_y = (1 - right) * at.above_y_px[i] + right * at.above_y_px[i + 1];
    const double below_x = (1 - right) * at.below_x_px[i] + right * at.below_x_px[i + 1];
    const double below_y = (1 - right) * at.below_y_px[i] + right * at.below_y_px[i + 1];
    found.x[i] = (1 - down) * above_x + down * below_x - 0.5;
    found.y[i] = (1 - down) * above_y + down * below_y - 0.5;
  }
  places = found;
}

/// The top left one of the pixels that eight samples are interpolated from, which lie `stride` numbers apart from row
/// to row, and how far right of and below the pixel before it each sample lies.
struct Taps {
  std::array<const float*, kTogether> first;
  std::size_t stride = 0;
  Together right;
  Together down;
};

PILOTAGE_WIDE_CLONES
void add_linear(const Taps& taps, Together& sums) {
  Together upper_left;
  Together upper_right;
  Together lower_left;
  Together lower_right;
  for (std::size_t i = 0; i < kTogether; ++i) {
    const float* upper = taps.first[i];
    const float* lower = upper + taps.stride;
    upper_left[i] = upper[0];
    upper_right[i] = upper[1];
    lower_left[i] = lower[0];
    lower_right[i] = lower[1];
  }
  Together sum = sums;
  for (std::size_t i = 0; i < kTogether; ++i) {
    const double right = taps.right[i];
    const double down = taps.down[i];
    const double upper = (1 - right) * upper_left[i] + right * upper_right[i];
    const double lower = (1 - right) * lower_left[i] + right * lower_right[i];
    sum[i] += (1 - down) * upper + down * lower;
  }
  sums = sum;
}

/// The weights of cubic convolution of eight samples; weights[tap].
using CubicWeights = std::array<Together, kCubicTaps>;

PILOTAGE_WIDE_CLONES
void weigh_cubic(const Together& rest, CubicWeights& weights) {
  CubicWeights found;
  for (std::size_t i = 0; i < kTogether; ++i) {
    const double t = rest[i];
    const double t2 = t * t;
    const double t3 = t2 * t;
    found[0][i] = -0.5 * t + t2 - 0.5 * t3;
    found[1][i] = 1 - 2.5 * t2 + 1.5 * t3;
    found[2][i] = 0.5 * t + 2 * t2 - 1.5 * t3;
    found[3][i] = -0.5 * t2 + 0.5 * t3;
  }
  weights = found;
}

using Float4 [[gnu::vector_size(16)]] = float;
using Double4 [[gnu::vector_size(32)]] = double;

/// Four pixels side by side times `weight`, added to `sum`.
[[gnu::always_inline]] inline void add_row(const float* row, double weight, Double4& sum) {
  Float4 grays;
  std::memcpy(&grays, row, sizeof grays);
  sum += weight * __builtin_convertvector(grays, Double4);
}

PILOTAGE_WIDE_CLONES
void add_cubic(const Taps& taps, const CubicWeights& across, const CubicWeights& down, Together& sums) {
  for (std::size_t i = 0; i < kTogether; ++i) {
    Double4 columns = {};
    const float* row = taps.first[i];
    for (std::size_t tap = 0; tap < kCubicTaps; ++tap, row += taps.stride) add_row(row, down[tap][i], columns);
    sums[i] +=
        across[0][i] * columns[0] + across[1][i] * columns[1] + across[2][i] * columns[2] + across[3][i] * columns[3];
  }
}

/// The last places at which a sample can be taken, as Places; the first is 1 in both directions.
struct Limits {
  double last_x;
  double last_y;
};

/// Places brought within the limits, and whether they were: their pixels, counted from the first, the rest of them, and
/// NaN added to the sums of those that were not.
PILOTAGE_WIDE_CLONES
void find_taps(const Places& places, const Limits& limits, Places& before, Taps& taps, Together& sums) {
  const Limits most = limits;
  Places found;
  Together right;
  Together down;
  Together sum = sums;
  for (std::size_t i = 0; i < kTogether; ++i) {
    const double x = std::min(std::max(1.0, places.x[i]), most.last_x);
    const double y = std::min(std::max(1.0, places.y[i]), most.last_y);
    sum[i] += places.x[i] == x && places.y[i] == y ? 0 : kNaN;
    found.x[i] = static_cast<double>(static_cast<std::int32_t>(x));
    found.y[i] = static_cast<double>(static_cast<std::int32_t>(y));
    right[i] = x - found.x[i];
    down[i] = y - found.y[i];
  }
  before = found;
  taps.right = right;
  taps.down = down;
  sums = sum;
}

/// Adds the gray values at eight places to `sums`; a place that needs a pixel that is not there, or not valid, turns
/// its sum into NaN. There are at least four rows and columns of `pixels` (CV_32F); `valid` is empty where all are.
template <int kTaps>
void add_samples(const cv::Mat& pixels, const cv::Mat& valid, const Places& places, Together& sums) {
  constexpr int kBefore = kTaps / 2 - 1;  // taps left of and above the sample's pixel
  const Limits limits{std::nextafter(pixels.cols - 2.0, 0), std::nextafter(pixels.rows - 2.0, 0)};
  Taps taps;
  taps.stride = pixels.step1();
  Places before;
  find_taps(places, limits, before, taps, sums);
  const auto* const first = pixels.ptr<float>();
  for (std::size_t i = 0; i < kTogether; ++i) {
    const int left = static_cast<int>(before.x[i]) - kBefore;
    const int top = static_cast<int>(before.y[i]) - kBefore;
    taps.first[i] = first + static_cast<std::ptrdiff_t>(top) * static_cast<std::ptrdiff_t>(taps.stride) + left;
    if (valid.empty()) continue;
    for (int row = 0; row < kTaps; ++row) {
      const auto* are_valid = valid.ptr<std::uint8_t>(top + row) + left;
      if (std::find(are_valid, are_valid + kTaps, 0) != are_valid + kTaps) sums[i] = kNaN;
    }
  }
  if constexpr (kTaps == kLinearTaps) {
    add_linear(taps, sums);
  } else {
    CubicWeights across;
    CubicWeights down;
    weigh_cubic(taps.right, across);
    weigh_cubic(taps.down, down);
    add_cubic(taps, across, down, sums);
  }
}

/// The means over eight pixels, whose longest sides ask for as many samples.
template <int kTaps>
Together means_of(const cv::Mat& pixels, const cv::Mat& valid, const Corners& corners, int count) {
  Together sums = {};
  if (pixels.cols < kCubicTaps || pixels.rows < kCubicTaps) {
    sums.fill(kNaN);
    return sums;
  }
  Places places;
  for (int row = 0; row < count; ++row) {
    for (int col = 0; col < count; ++col) {
      place_samples(corners, (col + 0.5) / count, (row + 0.5) / count, places);
      add_samples<kTaps>(pixels, valid, places, sums);
    }
    if (std::all_of(sums.begin(), sums.end(), [](double sum) { return std::isnan(sum); })) return sums;
  }
  for (double& sum : sums) sum /= count * count;
  return sums;
}

/// How a pixel is sampled: whether by cubic convolution, and how often along each side; 0: not at all.
struct Sampling {
  bool cubic = false;
  int count = 0;
  bool operator==(const Sampling&) const = default;
};

Sampling sampling_of(double longest_px) {
  if (!std::isfinite(longest_px)) return {};  // a corner sees no ground
  return {longest_px <= 1, static_cast<int>(std::clamp(std::ceil(2 * longest_px), 2.0, kMostSamples))};
}

}  // namespace

SampledGround::SampledGround(const Raster& ground) {
  ground.pixels.convertTo(pixels_, CV_32F);
  const bool all_valid = static_cast<std::size_t>(cv::countNonZero(ground.valid)) == ground.valid.total();
  if (!all_valid) valid_ = ground.valid;
}

void SampledGround::means_between(const CornerLine& above, const CornerLine& below, std::vector<double>& means) const {
  const std::size_t count = means.size();
  // The corners of the last pixels, which are fewer than eight; what stands behind them is not looked at.
  std::array<std::array<double, kTogether + 1>, 4> last = {};
  for (std::size_t first = 0; first < count; first += kTogether) {
    Corners corners{&above.x_px[first], &above.y_px[first], &below.x_px[first], &below.y_px[first]};
    const std::size_t here = std::min(kTogether, count - first);
    if (here < kTogether) {
      std::copy_n(corners.above_x_px, here + 1, last[0].begin());
      std::copy_n(corners.above_y_px, here + 1, last[1].begin());
      std::copy_n(corners.below_x_px, here + 1, last[2].begin());
      std::copy_n(corners.below_y_px, here + 1, last[3].begin());
      corners = {last[0].data(), last[1].data(), last[2].data(), last[3].data()};
    }
    Together longest2_px;
    measure_sides(corners, longest2_px);
    std::array<Sampling, kTogether> samplings;
    for (std::size_t i = 0; i < here; ++i) samplings[i] = sampling_of(std::sqrt(longest2_px[i]));
    // Neighbours nearly always take equally many samples; where they do not, each kind is worked out for all eight.
    std::array<bool, kTogether> done = {};
    for (std::size_t i = 0; i < here; ++i) {
      if (done[i]) continue;
      Together found;
      found.fill(kNaN);
      const Sampling sampling = samplings[i];
      if (sampling.count > 0) {
        found = sampling.cubic ? means_of<kCubicTaps>(pixels_, valid_, corners, sampling.count)
                               : means_of<kLinearTaps>(pixels_, valid_, corners, sampling.count);
      }
      for (std::size_t other = i; other < here; ++other) {
        if (samplings[other] != sampling) continue;
        means[first + other] = found[other];
        done[other] = true;
      }
    }
  }
}

}  // namespace pilotage
