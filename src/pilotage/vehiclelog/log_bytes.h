#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>

namespace pilotage {

// Numbers at a place of a text of bytes, little endian, whatever the machine. The caller has checked that they lie
// inside.

inline std::uint64_t unsigned_at(std::string_view bytes, std::size_t offset, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i) {
    value |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[offset + i])) << (8 * i);
  }
  return value;
}

inline std::int64_t signed_at(std::string_view bytes, std::size_t offset, std::size_t size) {
  const auto unused_bits = static_cast<int>(8 * (8 - size));
  return static_cast<std::int64_t>(unsigned_at(bytes, offset, size) << unused_bits) >> unused_bits;
}

inline double float_at(std::string_view bytes, std::size_t offset) {
  return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(unsigned_at(bytes, offset, 4))));
}

inline double double_at(std::string_view bytes, std::size_t offset) {
  return std::bit_cast<double>(unsigned_at(bytes, offset, 8));
}

/// Up to the first zero byte.
inline std::string text_until_zero(std::string_view bytes) {
  return std::string(bytes.substr(0, bytes.find('\0')));
}

}  // namespace pilotage
