#include "pilotage/mapdb/chip_codec.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include <opencv2/core.hpp>
#include <zstd.h>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/mapdb/byte_order.h"
#include "pilotage/mapdb/descriptor_row.h"
#include "pilotage/vision/direction_field.h"

namespace pilotage {
namespace {

constexpr std::size_t kHeaderBytes = 3;
constexpr std::uint8_t kHasMask = 1;
// The strongest that does not need more than the picture's own size of memory; the picture is small, so it is quick.
constexpr int kCompressionLevel = 19;

struct Header {
  int factor = 1;
  bool has_mask = false;
};

/// The neighbour whose direction a pixel's is told from: the left one, or that above where the left has none; 0 when
/// neither has.
int neighbour_step(const std::uint8_t* above, const std::uint8_t* row, int col) {
  const int left = col == 0 ? 0 : row[col - 1];
  return left != 0 || above == nullptr ? left : above[col];
}

/// A step as its turn from a neighbour's, 1 … kDirectionSectors for 0 … one sector less than a whole turn; the step
/// itself when neither has a direction. And back.
int turn_of(int step, int neighbour) {
  return step == 0 || neighbour == 0 ? step : 1 + (step - neighbour + kDirectionSectors) % kDirectionSectors;
}

int step_of(int turn, int neighbour) {
  return turn == 0 || neighbour == 0 ? turn : 1 + (turn - 1 + neighbour - 1) % kDirectionSectors;
}

std::size_t mask_bytes(int pixels) {
  return (static_cast<std::size_t>(pixels) + 7) / 8;
}

void check_picture(const ChipPicture& picture) {
  if (picture.steps.type() != CV_8UC1 || picture.valid.type() != CV_8UC1 || picture.steps.empty() ||
      picture.steps.size() != picture.valid.size()) {
    throw UsageError("chip: steps and valid must be CV_8UC1 of one size");
  }
  if (static_cast<std::int64_t>(picture.steps.total()) > kMaxChipPixels) {
    throw UsageError("chip: " + std::to_string(picture.steps.cols) + " × " + std::to_string(picture.steps.rows) +
                     " px are more than " + std::to_string(kMaxChipPixels));
  }
  if (picture.factor < 1 || picture.factor > kMaxChipFactor) {
    throw UsageError("chip: factor = " + std::to_string(picture.factor) + " is outside [1, " +
                     std::to_string(kMaxChipFactor) + "]");
  }
  double highest = 0;
  cv::minMaxLoc(picture.steps, nullptr, &highest);
  if (highest > kDirectionSectors) {
    throw UsageError("chip: step " + format_number(highest) + " is outside [0, " + std::to_string(kDirectionSectors) +
                     "]");
  }
}

/// The bits of the mask (when there is one), then the turns.
std::vector<std::uint8_t> plain_bytes(const ChipPicture& picture, bool has_mask) {
  const int width = picture.steps.cols;
  const int pixels = width * picture.steps.rows;
  std::vector<std::uint8_t> bytes(has_mask ? mask_bytes(pixels) : 0, 0);
  bytes.reserve(bytes.size() + static_cast<std::size_t>(pixels));
  cv::Mat steps = picture.steps.clone();
  steps.setTo(0, picture.valid == 0);
  for (int row = 0; row < steps.rows; ++row) {
    const auto* valid = picture.valid.ptr<std::uint8_t>(row);
    const auto* line = steps.ptr<std::uint8_t>(row);
    const std::uint8_t* above = row == 0 ? nullptr : steps.ptr<std::uint8_t>(row - 1);
    for (int col = 0; col < width; ++col) {
      bytes.push_back(static_cast<std::uint8_t>(turn_of(line[col], neighbour_step(above, line, col))));
      const int pixel = row * width + col;
      if (has_mask && valid[col] != 0) {
        std::uint8_t& eight = bytes[static_cast<std::size_t>(pixel / 8)];
        eight = static_cast<std::uint8_t>(eight | (1U << (pixel % 8)));
      }
    }
  }
  return bytes;
}

ChipPicture picture_from_plain(const std::vector<std::uint8_t>& bytes, const Header& header, const cv::Size& size,
                               const std::string& where) {
  const std::uint8_t* turn = bytes.data() + (header.has_mask ? mask_bytes(size.area()) : 0);
  ChipPicture picture{cv::Mat(size, CV_8UC1), cv::Mat(size, CV_8UC1, cv::Scalar(255)), header.factor};
  for (int row = 0; row < size.height; ++row) {
    auto* line = picture.steps.ptr<std::uint8_t>(row);
    auto* valid = picture.valid.ptr<std::uint8_t>(row);
    const std::uint8_t* above = row == 0 ? nullptr : picture.steps.ptr<std::uint8_t>(row - 1);
    for (int col = 0; col < size.width; ++col) {
      if (*turn > kDirectionSectors) {
        throw DataError(where + ": chip has turn " + std::to_string(*turn) + ", expected at most " +
                        std::to_string(kDirectionSectors));
      }
      line[col] = static_cast<std::uint8_t>(step_of(*turn++, neighbour_step(above, line, col)));
      const int pixel = row * size.width + col;
      if (!header.has_mask || (bytes[static_cast<std::size_t>(pixel / 8)] >> (pixel % 8) & 1) != 0) continue;
      valid[col] = 0;
      if (line[col] != 0) throw DataError(where + ": chip has a direction where it has no ground");
    }
  }
  return picture;
}

void check_pixels(int width, int height, const std::string& where) {
  if (std::int64_t{width} * height <= kMaxChipPixels) return;
  throw DataError(where + ": chip has " + std::to_string(width) + " × " + std::to_string(height) + " px, more than " +
                  std::to_string(kMaxChipPixels));
}

Header read_header(const MapChip& chip, const std::string& where) {
  if (chip.data.size() < kHeaderBytes) {
    throw DataError(where + ": chip blob has " + std::to_string(chip.data.size()) + " bytes, expected more than " +
                    std::to_string(kHeaderBytes));
  }
  const std::uint8_t* bytes = chip.data.data();
  const Header header{read_le<std::uint16_t>(bytes), (bytes[2] & kHasMask) != 0};
  if (header.factor < 1 || header.factor > kMaxChipFactor || (bytes[2] & ~kHasMask) != 0) {
    throw DataError(where + ": chip header is damaged");
  }
  const PixelWindow& window = chip.window;
  if (window.width % header.factor != 0 || window.height % header.factor != 0 || window.col % header.factor != 0 ||
      window.row % header.factor != 0) {
    throw DataError(where + ": chip window of " + std::to_string(window.width) + " × " + std::to_string(window.height) +
                    " px from column " + std::to_string(window.col) + ", row " + std::to_string(window.row) +
                    " is not in multiples of its factor " + std::to_string(header.factor));
  }
  check_pixels(chip.window.width / header.factor, chip.window.height / header.factor, where);
  return header;
}

std::vector<std::uint8_t> decompress(std::span<const std::uint8_t> data, std::size_t expected,
                                     const std::string& where) {
  const unsigned long long stated = ZSTD_getFrameContentSize(data.data(), data.size());
  if (stated != expected) {
    throw DataError(where + ": chip is not a zstd frame of " + std::to_string(expected) + " bytes");
  }
  std::vector<std::uint8_t> bytes(expected);
  const std::size_t size = ZSTD_decompress(bytes.data(), bytes.size(), data.data(), data.size());
  if (ZSTD_isError(size) != 0) {
    throw DataError(where + ": chip cannot be decompressed: " + ZSTD_getErrorName(size));
  }
  if (size != expected) {
    throw DataError(where + ": chip has " + std::to_string(size) + " bytes, expected " + std::to_string(expected));
  }
  return bytes;
}

}  // namespace

MapChip encode_chip(const ChipPicture& picture, std::int64_t tile_id, int level, std::int64_t col_px,
                    std::int64_t row_px) {
  check_picture(picture);
  const bool has_mask = cv::countNonZero(picture.valid) != static_cast<int>(picture.valid.total());
  MapChip chip;
  chip.tile_id = tile_id;
  chip.level = level;
  chip.window = {col_px, row_px, picture.steps.cols * picture.factor, picture.steps.rows * picture.factor};
  chip.encoding = kChipEncoding;
  append_le(chip.data, static_cast<std::uint16_t>(picture.factor));
  append_le(chip.data, static_cast<std::uint8_t>(has_mask ? kHasMask : 0));
  const std::vector<std::uint8_t> plain = plain_bytes(picture, has_mask);
  chip.data.resize(kHeaderBytes + ZSTD_compressBound(plain.size()));
  const std::size_t size = ZSTD_compress(chip.data.data() + kHeaderBytes, chip.data.size() - kHeaderBytes, plain.data(),
                                         plain.size(), kCompressionLevel);
  if (ZSTD_isError(size) != 0) throw DataError(std::string("zstd: ") + ZSTD_getErrorName(size));
  chip.data.resize(kHeaderBytes + size);
  return chip;
}

ChipPicture decode_chip(const MapChip& chip, const std::string& file) {
  const std::string where = file + ": tile " + std::to_string(chip.tile_id) + ", level " + std::to_string(chip.level);
  for (const std::string& problem : {window_problem(chip.window), chip_problem(chip)}) {
    if (!problem.empty()) throw DataError(where + ": " + problem);
  }
  if (chip.encoding != kChipEncoding) {
    throw DataError(where + ": chip has encoding \"" + chip.encoding + "\", expected " + std::string(kChipEncoding));
  }
  const Header header = read_header(chip, where);
  const cv::Size size(chip.window.width / header.factor, chip.window.height / header.factor);
  const std::size_t plain_size =
      static_cast<std::size_t>(size.area()) + (header.has_mask ? mask_bytes(size.area()) : 0);
  const auto plain = decompress(std::span(chip.data).subspan(kHeaderBytes), plain_size, where);
  return picture_from_plain(plain, header, size, where);
}

}  // namespace pilotage
