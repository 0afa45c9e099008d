#include "pilotage/vision/descriptor.h"

#include "pilotage/base/error.h"

namespace pilotage {

const BinaryDescriptor& descriptor_of(DescriptorPattern pattern, int bits) {
  if (const BinaryDescriptor* const found = find_descriptor(pattern, bits)) return *found;
  std::string lengths;
  for (const BinaryDescriptor& descriptor : kBinaryDescriptors) {
    if (descriptor.pattern == pattern) lengths += (lengths.empty() ? "" : ", ") + std::to_string(descriptor.bits);
  }
  throw UsageError("descriptor_bits = " + std::to_string(bits) + " of the pattern " +
                   options_detail::enum_to_name(pattern) + " is not one of: " + lengths);
}

std::string descriptor_name(const BinaryDescriptor& descriptor) {
  return options_detail::enum_to_name(descriptor.pattern) + "_" + std::to_string(descriptor.bits);
}

std::string descriptor_byte_lengths() {
  std::string text;
  for (const int words : kDescriptorWords) text += (text.empty() ? "" : ", ") + std::to_string(8 * words);
  return text;
}

}  // namespace pilotage
