// Pictures as they come through a pipe: binary PGM with 8 bits, one behind the other, as `ffmpeg … -c:v pgm -f
// image2pipe` writes them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

struct TimedFrame {
  cv::Mat pixels;
  /// µs since 1970: of the comment "# exposure_us N" in the picture's header, which what knows it may write.
  std::optional<std::int64_t> exposure_us;
};

class PgmStream {
 public:
  void push(std::span<const std::uint8_t> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  /// The next whole picture. Throws std::runtime_error for what is none.
  std::optional<TimedFrame> next();
  /// Whether a picture has begun and not ended.
  bool within() const { return !bytes_.empty(); }

 private:
  std::vector<std::uint8_t> bytes_;
};
