// What was heard and said, with times, as ground stations record it (.tlog): before each frame its time in µs since
// 1970, 8 bytes, the greatest first.
#pragma once

#include <cstdint>
#include <fstream>
#include <optional>
#include <span>
#include <string>

#include "mavlink.h"

class RecordingReader {
 public:
  /// Throws std::runtime_error for a file that cannot be read.
  explicit RecordingReader(const std::string& path);

  struct Entry {
    std::int64_t time_us = 0;
    mavlink::Bytes frame;
  };
  /// Nothing at the end. Throws std::runtime_error where no frame stands.
  std::optional<Entry> next();

 private:
  std::string path_;
  std::ifstream file_;
};

class RecordingWriter {
 public:
  /// Throws std::runtime_error for a file that exists or cannot be written.
  explicit RecordingWriter(const std::string& path);
  /// Throws std::runtime_error where the disk does not take it.
  void write(std::int64_t time_us, std::span<const std::uint8_t> frame);

 private:
  std::string path_;
  std::ofstream file_;
  std::int64_t flushed_us_ = 0;
};
