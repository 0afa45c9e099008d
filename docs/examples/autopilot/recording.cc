#include "recording.h"

#include <array>
#include <filesystem>
#include <stdexcept>

RecordingReader::RecordingReader(const std::string& path) : path_(path), file_(path, std::ios::binary) {
  if (!file_) throw std::runtime_error(path + ": cannot be read");
}

std::optional<RecordingReader::Entry> RecordingReader::next() {
  std::array<char, 10> head{};  // the time, the frame's first byte and its payload's length
  file_.read(head.data(), head.size());
  if (file_.gcount() == 0) return std::nullopt;
  Entry entry;
  for (std::size_t i = 0; i < 8; ++i) entry.time_us = entry.time_us << 8 | static_cast<std::uint8_t>(head[i]);
  constexpr std::int64_t kLatest_us = 4'102'444'800'000'000;  // 2100: no sum of two overflows
  entry.frame = {static_cast<std::uint8_t>(head[8]), static_cast<std::uint8_t>(head[9])};
  const bool is_time = entry.time_us >= 0 && entry.time_us <= kLatest_us;
  if (file_ && is_time && mavlink::is_frame_start(entry.frame[0])) {
    char flags = 0;
    file_.get(flags);
    entry.frame.push_back(static_cast<std::uint8_t>(flags));
    entry.frame.resize(mavlink::frame_bytes(entry.frame));
    file_.read(reinterpret_cast<char*>(entry.frame.data() + 3), static_cast<std::streamsize>(entry.frame.size() - 3));
    if (file_) return entry;
  }
  throw std::runtime_error(path_ + ": no recording of MAVLink, or it ends within a frame");
}

RecordingWriter::RecordingWriter(const std::string& path) : path_(path) {
  if (std::filesystem::exists(path)) throw std::runtime_error(path + ": exists");
  file_.open(path, std::ios::binary);
  if (!file_) throw std::runtime_error(path + ": cannot be written");
}

void RecordingWriter::write(std::int64_t time_us, std::span<const std::uint8_t> frame) {
  std::array<char, 8> time{};
  for (std::size_t i = 0; i < time.size(); ++i) time[i] = static_cast<char>(time_us >> (56 - 8 * i));
  file_.write(time.data(), time.size());
  file_.write(reinterpret_cast<const char*>(frame.data()), static_cast<std::streamsize>(frame.size()));
  constexpr std::int64_t kEach_us = 1'000'000;  // power may go with the aircraft
  if (time_us - flushed_us_ >= kEach_us) {
    file_.flush();
    flushed_us_ = time_us;
  }
  if (!file_) throw std::runtime_error(path_ + ": cannot be written");
}
