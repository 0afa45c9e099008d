#pragma once

#include "pilotage/base/options.h"
#include "pilotage/vision/descriptor.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// How features are found and described. Map and frame must agree in pattern and descriptor_bits.
struct FeatureOptions {
  double features_per_mpx = 20000;
  DescriptorPattern pattern = kDefaultDescriptorPattern;
  int descriptor_bits = kDefaultDescriptorBits;
  int fast_threshold = 20;
  int min_fast_threshold = 5;
  int octaves = 1;
  double scale_factor = 1.5;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("features_per_mpx", self.features_per_mpx,
                 "Most features for each million pixels, over all octaves; spread evenly.", Range{1, 200000});
    fields.field("pattern", self.pattern,
                 "Tests of the descriptor: ground, learned on ground at two dates; orb, cv::ORB's; brief, drawn at "
                 "random. P of a correct fix is fitted for ground of 128 bits.");
    fields.field("descriptor_bits", self.descriptor_bits, kDescriptorBitsHelp,
                 Range{kLeastDescriptorBits, kMostDescriptorBits});
    fields.field("fast_threshold", self.fast_threshold, "Contrast of a corner, gray levels.", Range{1, 254});
    fields.field("min_fast_threshold", self.min_fast_threshold,
                 "Contrast to fall back to where the ground is too faint for fast_threshold.", Range{1, 254});
    fields.field("octaves", self.octaves, "Number of scales.", Range{1, 12});
    fields.field("scale_factor", self.scale_factor, "Ratio of one octave's pixel size to the one before.",
                 Range{1.05, 2});
  }
};

/// Throws UsageError when an option is outside its range, when the pattern has no such descriptor_bits, when
/// min_fast_threshold > fast_threshold, or when the coarsest octave would shrink more than 64 times.
void check_feature_options(const FeatureOptions& options);

/// Side of an octave's pixel in pixels of the image.
double octave_scale(const FeatureOptions& options, int octave);

/// What features are described with. Throws UsageError when the pattern has no such descriptor_bits.
const BinaryDescriptor& descriptor_of(const FeatureOptions& options);

}  // namespace pilotage

#pragma GCC visibility pop
