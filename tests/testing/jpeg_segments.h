#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace pilotage::testing {

/// A JPEG with another application segment (APP1) right behind its first two bytes.
inline std::string with_app1(const std::string& jpeg, std::string_view content) {
  const auto length = static_cast<std::uint32_t>(content.size() + 2);
  std::string segment = "\xFF\xE1";
  segment += static_cast<char>(length >> 8);
  segment += static_cast<char>(length & 255);
  segment += content;
  return jpeg.substr(0, 2) + segment + jpeg.substr(2);
}

/// With an XMP packet (Adobe, XMP Specification Part 3, 1.1.3).
inline std::string with_xmp(const std::string& jpeg, const std::string& packet) {
  return with_app1(jpeg, std::string("http://ns.adobe.com/xap/1.0/") + '\0' + packet);
}

/// With the EXIF tag Orientation (0x0112): one entry in one little-endian directory (CIPA DC-008, 4.5, 4.6).
inline std::string with_orientation(const std::string& jpeg, std::uint8_t orientation) {
  std::string exif("Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0", 24);
  exif += static_cast<char>(orientation);
  exif += std::string(7, '\0');
  return with_app1(jpeg, exif);
}

}  // namespace pilotage::testing
