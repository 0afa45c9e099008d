#include "pilotage/vision/feature_options.h"

#include <cmath>
#include <string>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

constexpr int kSmoothRadiusPx = 3;  // a kernel of 7 × 7
constexpr double kMaxShrink = 64;

}  // namespace

double octave_scale(const FeatureOptions& options, int octave) {
  return std::pow(options.scale_factor, octave);
}

void check_feature_options(const FeatureOptions& options) {
  check_options(options);
  descriptor_of_bits(options.descriptor_bits);
  if (options.min_fast_threshold > options.fast_threshold) {
    throw UsageError("min_fast_threshold = " + std::to_string(options.min_fast_threshold) +
                     " is above fast_threshold = " + std::to_string(options.fast_threshold));
  }
  if (octave_scale(options, options.octaves - 1) > kMaxShrink) {
    throw UsageError("octaves = " + std::to_string(options.octaves) +
                     " shrink the image more than 64 times; give fewer or a smaller scale_factor");
  }
}

int patch_radius_px(const FeatureOptions& options) {
  const int pattern = descriptor_of_bits(options.descriptor_bits).pattern_radius_px;
  if (!options.oriented) return pattern + kSmoothRadiusPx;
  // A corner of the pattern's square may point anywhere. The centroid's disc is smaller.
  return static_cast<int>(std::ceil(pattern * std::sqrt(2.0))) + kSmoothRadiusPx;
}

}  // namespace pilotage
