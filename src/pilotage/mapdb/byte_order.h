#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>
#include <vector>

namespace pilotage {

// Little-endian bytes on any machine.

template <std::integral T>
void append_le(std::vector<std::uint8_t>& bytes, T value) {
  const auto bits = static_cast<std::make_unsigned_t<T>>(value);
  for (std::size_t i = 0; i < sizeof(T); ++i) bytes.push_back(static_cast<std::uint8_t>(bits >> (8 * i)));
}

inline void append_le(std::vector<std::uint8_t>& bytes, double value) {
  append_le(bytes, std::bit_cast<std::uint64_t>(value));
}

inline void append_le(std::vector<std::uint8_t>& bytes, float value) {
  append_le(bytes, std::bit_cast<std::uint32_t>(value));
}

inline void append_text(std::vector<std::uint8_t>& bytes, std::string_view text) {
  bytes.insert(bytes.end(), text.begin(), text.end());
}

/// The value of the sizeof(T) bytes at `bytes`.
template <std::unsigned_integral T>
T read_le(const std::uint8_t* bytes) {
  T value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) value = static_cast<T>(value | (static_cast<T>(bytes[i]) << (8 * i)));
  return value;
}

inline double read_le_double(const std::uint8_t* bytes) {
  return std::bit_cast<double>(read_le<std::uint64_t>(bytes));
}

}  // namespace pilotage
