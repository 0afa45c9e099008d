#include "pilotage/vision/feature_options.h"

#include <cmath>
#include <string>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

constexpr double kMaxShrink = 64;

}  // namespace

double octave_scale(const FeatureOptions& options, int octave) {
  return std::pow(options.scale_factor, octave);
}

void check_feature_options(const FeatureOptions& options) {
  check_options(options);
  descriptor_of(options);
  if (options.min_fast_threshold > options.fast_threshold) {
    throw UsageError("min_fast_threshold = " + std::to_string(options.min_fast_threshold) +
                     " is above fast_threshold = " + std::to_string(options.fast_threshold));
  }
  if (octave_scale(options, options.octaves - 1) > kMaxShrink) {
    throw UsageError("octaves = " + std::to_string(options.octaves) +
                     " shrink the image more than 64 times; give fewer or a smaller scale_factor");
  }
}

const BinaryDescriptor& descriptor_of(const FeatureOptions& options) {
  return descriptor_of(options.pattern, options.descriptor_bits);
}

}  // namespace pilotage
