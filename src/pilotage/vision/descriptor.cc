#include "pilotage/vision/descriptor.h"

#include "pilotage/base/error.h"

namespace pilotage {

const BinaryDescriptor& descriptor_of_bits(int bits) {
  if (const BinaryDescriptor* const found = find_descriptor(bits)) return *found;
  throw UsageError("descriptor_bits = " + std::to_string(bits) + " is not one of: " + descriptor_lengths(1));
}

std::string descriptor_lengths(int bits_per_unit) {
  std::string text;
  for (const BinaryDescriptor& descriptor : kBinaryDescriptors) {
    text += (text.empty() ? "" : ", ") + std::to_string(descriptor.bits / bits_per_unit);
  }
  return text;
}

}  // namespace pilotage
