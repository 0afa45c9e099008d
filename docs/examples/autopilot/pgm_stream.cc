#include "pgm_stream.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <stdexcept>

namespace {

constexpr std::size_t kMostHeaderBytes = 1000;
constexpr int kMostPixels = 32766;  // along a side

[[noreturn]] void refuse() {
  throw std::runtime_error("what comes through the pipe is no binary PGM with 8 bits");
}

/// What the comment of a header says of the exposure, if it is one that does.
std::optional<std::int64_t> exposure_of(const std::string& comment) {
  const std::string key = " exposure_us ";
  if (!comment.starts_with(key)) return std::nullopt;
  std::int64_t number = 0;
  const char* end = comment.data() + comment.size();
  const auto read = std::from_chars(comment.data() + key.size(), end, number);
  constexpr std::int64_t kLatest_us = 4'102'444'800'000'000;  // 2100
  if (read.ec != std::errc{} || read.ptr != end || number < 0 || number > kLatest_us) refuse();
  return number;
}

}  // namespace

std::optional<TimedFrame> PgmStream::next() {
  TimedFrame frame;
  std::array<std::string, 4> words;  // P5, width, height, white
  std::size_t word = 0;
  std::size_t at = 0;
  while (word < words.size()) {
    if (at > kMostHeaderBytes) refuse();
    if (at == bytes_.size()) return std::nullopt;
    const char letter = static_cast<char>(bytes_[at++]);
    if (letter == '#') {
      const auto end = std::find(bytes_.begin() + static_cast<std::ptrdiff_t>(at), bytes_.end(), '\n');
      if (end == bytes_.end()) {
        if (bytes_.size() > kMostHeaderBytes) refuse();
        return std::nullopt;
      }
      const auto exposure = exposure_of(std::string(bytes_.begin() + static_cast<std::ptrdiff_t>(at), end));
      if (exposure) frame.exposure_us = exposure;
      at = static_cast<std::size_t>(end - bytes_.begin()) + 1;
    } else if (std::isspace(static_cast<unsigned char>(letter)) == 0) {
      words[word] += letter;
    } else if (!words[word].empty()) {
      ++word;
    }
  }
  std::array<int, 3> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::string& text = words[i + 1];
    const auto read = std::from_chars(text.data(), text.data() + text.size(), numbers[i]);
    if (read.ec != std::errc{} || read.ptr != text.data() + text.size() || numbers[i] < 1) refuse();
  }
  if (words[0] != "P5" || numbers[2] != 255 || std::max(numbers[0], numbers[1]) > kMostPixels) refuse();
  const std::size_t count = static_cast<std::size_t>(numbers[0]) * static_cast<std::size_t>(numbers[1]);
  if (bytes_.size() < at + count) return std::nullopt;
  const auto begin = bytes_.begin() + static_cast<std::ptrdiff_t>(at);
  frame.pixels.create(numbers[1], numbers[0], CV_8UC1);
  std::copy(begin, begin + static_cast<std::ptrdiff_t>(count), frame.pixels.data);
  bytes_.erase(bytes_.begin(), begin + static_cast<std::ptrdiff_t>(count));
  return frame;
}
