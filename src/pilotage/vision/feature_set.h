#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pilotage/vision/descriptor.h"
#pragma GCC visibility push(default)

namespace pilotage {

/// A key point: where a descriptor was taken. Pixel centres lie at +0.5.
struct Feature {
  float x_px = 0;  ///< Columns to the right, in pixels of the level (octave 0), whatever the octave.
  float y_px = 0;
  int octave = 0;      ///< Pyramid step it was found on; 0 = full resolution.
  float response = 0;  ///< Corner strength; comparable within one octave. Not stored in maps.
};

/// Features and their descriptors, one row of `descriptor_bytes` after the other.
struct FeatureSet {
  std::vector<Feature> features;
  DescriptorPattern pattern = kDefaultDescriptorPattern;
  int descriptor_bytes = kDefaultDescriptorBits / 8;
  std::vector<std::uint8_t> descriptors;

  std::size_t size() const { return features.size(); }
  const std::uint8_t* descriptor(std::size_t index) const {
    return descriptors.data() + index * static_cast<std::size_t>(descriptor_bytes);
  }
};

/// What the set is described with. Throws UsageError when its pattern has no descriptor of its length.
inline const BinaryDescriptor& descriptor_of(const FeatureSet& set) {
  return descriptor_of(set.pattern, 8 * set.descriptor_bytes);
}

}  // namespace pilotage

#pragma GCC visibility pop
