#include "pilotage/mapdb/chip_codec.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include <opencv2/core.hpp>
#include <zstd.h>

#include "pilotage/base/error.h"
#include "pilotage/mapdb/byte_order.h"
#include "pilotage/mapdb/descriptor_row.h"

namespace pilotage {
namespace {

constexpr std::size_t kHeaderBytes = 6;
constexpr std::uint8_t kHasMask = 1;
// The strongest that does not need more than the picture's own size of memory; the picture is small, so it is quick.
constexpr int kCompressionLevel = 19;

/// How gray values become steps: step k stands for darkest + k·(brightest − darkest)/(steps − 1).
struct GraySteps {
  int darkest = 0;
  int brightest = 0;
  int steps = 1;

  int gray(int step) const {
    if (steps == 1) return darkest;
    return darkest + (2 * step * (brightest - darkest) + (steps - 1)) / (2 * (steps - 1));
  }
  int step(int gray) const {
    const int range = brightest - darkest;
    if (range == 0) return 0;
    return (2 * (gray - darkest) * (steps - 1) + range) / (2 * range);
  }
};

struct Header {
  int factor = 1;
  bool has_mask = false;
  GraySteps gray;
};

GraySteps choose_steps(const ChipPicture& picture, int gray_bits) {
  double darkest = 0;
  double brightest = 0;
  if (cv::countNonZero(picture.valid) > 0) {
    cv::minMaxLoc(picture.gray, &darkest, &brightest, nullptr, nullptr, picture.valid);
  }
  const int range = static_cast<int>(brightest - darkest);
  return {static_cast<int>(darkest), static_cast<int>(brightest), std::min(1 << gray_bits, range + 1)};
}

/// What the steps left of, above and diagonally above a pixel promise for it.
int predict_step(const std::uint8_t* above, const std::uint8_t* row, int col) {
  if (above == nullptr) return col == 0 ? 0 : row[col - 1];
  if (col == 0) return above[0];
  const int a = row[col - 1];
  const int b = above[col];
  const int c = above[col - 1];
  if (c >= std::max(a, b)) return std::min(a, b);
  if (c <= std::min(a, b)) return std::max(a, b);
  return a + b - c;
}

std::size_t mask_bytes(int pixels) {
  return (static_cast<std::size_t>(pixels) + 7) / 8;
}

void check_picture(const ChipPicture& picture, int gray_bits) {
  if (picture.gray.type() != CV_8UC1 || picture.valid.type() != CV_8UC1 || picture.gray.empty() ||
      picture.gray.size() != picture.valid.size()) {
    throw UsageError("chip: gray and valid must be CV_8UC1 of one size");
  }
  if (static_cast<std::int64_t>(picture.gray.total()) > kMaxChipPixels) {
    throw UsageError("chip: " + std::to_string(picture.gray.cols) + " × " + std::to_string(picture.gray.rows) +
                     " px are more than " + std::to_string(kMaxChipPixels));
  }
  if (picture.factor < 1 || picture.factor > kMaxChipFactor) {
    throw UsageError("chip: factor = " + std::to_string(picture.factor) + " is outside [1, " +
                     std::to_string(kMaxChipFactor) + "]");
  }
  if (gray_bits < 1 || gray_bits > 8) {
    throw UsageError("chip: gray_bits = " + std::to_string(gray_bits) + " is outside [1, 8]");
  }
}

/// The bits of the mask (when there is one), then the residuals.
std::vector<std::uint8_t> plain_bytes(const ChipPicture& picture, const GraySteps& gray_steps, bool has_mask) {
  const int width = picture.gray.cols;
  const int pixels = width * picture.gray.rows;
  std::vector<std::uint8_t> bytes(has_mask ? mask_bytes(pixels) : 0, 0);
  bytes.reserve(bytes.size() + static_cast<std::size_t>(pixels));
  cv::Mat steps(picture.gray.size(), CV_8UC1);
  for (int row = 0; row < picture.gray.rows; ++row) {
    const auto* gray = picture.gray.ptr<std::uint8_t>(row);
    const auto* valid = picture.valid.ptr<std::uint8_t>(row);
    auto* line = steps.ptr<std::uint8_t>(row);
    const std::uint8_t* above = row == 0 ? nullptr : steps.ptr<std::uint8_t>(row - 1);
    for (int col = 0; col < width; ++col) {
      const int predicted = predict_step(above, line, col);
      const int step = valid[col] != 0 ? gray_steps.step(gray[col]) : predicted;
      line[col] = static_cast<std::uint8_t>(step);
      bytes.push_back(static_cast<std::uint8_t>((step - predicted + gray_steps.steps) % gray_steps.steps));
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
  const std::uint8_t* residual = bytes.data() + (header.has_mask ? mask_bytes(size.area()) : 0);
  ChipPicture picture{cv::Mat(size, CV_8UC1), cv::Mat(size, CV_8UC1), header.factor};
  for (int row = 0; row < size.height; ++row) {
    auto* line = picture.gray.ptr<std::uint8_t>(row);  // steps first, gray values when no prediction needs them
    const std::uint8_t* above = row == 0 ? nullptr : picture.gray.ptr<std::uint8_t>(row - 1);
    for (int col = 0; col < size.width; ++col) {
      if (*residual >= header.gray.steps) {
        throw DataError(where + ": chip has residual " + std::to_string(*residual) + ", expected less than " +
                        std::to_string(header.gray.steps));
      }
      line[col] = static_cast<std::uint8_t>((predict_step(above, line, col) + *residual++) % header.gray.steps);
    }
  }
  for (int row = 0; row < size.height; ++row) {
    auto* line = picture.gray.ptr<std::uint8_t>(row);
    auto* valid = picture.valid.ptr<std::uint8_t>(row);
    for (int col = 0; col < size.width; ++col) {
      const int pixel = row * size.width + col;
      const bool ground = !header.has_mask || (bytes[static_cast<std::size_t>(pixel / 8)] >> (pixel % 8) & 1) != 0;
      valid[col] = ground ? 255 : 0;
      line[col] = ground ? static_cast<std::uint8_t>(header.gray.gray(line[col])) : 0;
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
  const Header header{read_le<std::uint16_t>(bytes), (bytes[5] & kHasMask) != 0, {bytes[2], bytes[3], bytes[4] + 1}};
  const int range = header.gray.brightest - header.gray.darkest;
  if (header.factor < 1 || header.factor > kMaxChipFactor || range < 0 || header.gray.steps > range + 1 ||
      (header.gray.steps == 1 && range > 0) || (bytes[5] & ~kHasMask) != 0) {
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

ChipPicture reduce_to_chip(const cv::Mat& gray, const cv::Mat& valid, int factor) {
  if (gray.type() != CV_8UC1 || valid.type() != CV_8UC1 || gray.empty() || gray.size() != valid.size() || factor < 1 ||
      factor > kMaxChipFactor || gray.cols % factor != 0 || gray.rows % factor != 0) {
    throw UsageError("chip: gray and valid must be CV_8UC1 of one size in multiples of factor = " +
                     std::to_string(factor) + ", 1 to " + std::to_string(kMaxChipFactor));
  }
  ChipPicture picture{cv::Mat::zeros(gray.rows / factor, gray.cols / factor, CV_8UC1),
                      cv::Mat::zeros(gray.rows / factor, gray.cols / factor, CV_8UC1), factor};
  for (int row = 0; row < picture.gray.rows; ++row) {
    for (int col = 0; col < picture.gray.cols; ++col) {
      int sum = 0;
      int count = 0;
      for (int y = row * factor; y < (row + 1) * factor; ++y) {
        const auto* gray_line = gray.ptr<std::uint8_t>(y);
        const auto* valid_line = valid.ptr<std::uint8_t>(y);
        for (int x = col * factor; x < (col + 1) * factor; ++x) {
          if (valid_line[x] == 0) continue;
          sum += gray_line[x];
          ++count;
        }
      }
      if (2 * count < factor * factor) continue;
      picture.gray.at<std::uint8_t>(row, col) = static_cast<std::uint8_t>((2 * sum + count) / (2 * count));
      picture.valid.at<std::uint8_t>(row, col) = 255;
    }
  }
  return picture;
}

MapChip encode_chip(const ChipPicture& picture, std::int64_t tile_id, int level, std::int64_t col_px,
                    std::int64_t row_px, int gray_bits) {
  check_picture(picture, gray_bits);
  const GraySteps gray_steps = choose_steps(picture, gray_bits);
  const bool has_mask = cv::countNonZero(picture.valid) != static_cast<int>(picture.valid.total());
  MapChip chip;
  chip.tile_id = tile_id;
  chip.level = level;
  chip.window = {col_px, row_px, picture.gray.cols * picture.factor, picture.gray.rows * picture.factor};
  chip.encoding = kChipEncoding;
  append_le(chip.data, static_cast<std::uint16_t>(picture.factor));
  append_le(chip.data, static_cast<std::uint8_t>(gray_steps.darkest));
  append_le(chip.data, static_cast<std::uint8_t>(gray_steps.brightest));
  append_le(chip.data, static_cast<std::uint8_t>(gray_steps.steps - 1));
  append_le(chip.data, static_cast<std::uint8_t>(has_mask ? kHasMask : 0));
  const std::vector<std::uint8_t> plain = plain_bytes(picture, gray_steps, has_mask);
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
  if (chip.encoding == kGrayEncoding) {
    check_pixels(chip.window.width, chip.window.height, where);
    ChipPicture picture{cv::Mat(chip.window.height, chip.window.width, CV_8UC1), cv::Mat(), 1};
    std::copy(chip.data.begin(), chip.data.end(), picture.gray.data);
    picture.valid = cv::Mat(picture.gray.size(), CV_8UC1, cv::Scalar(255));
    return picture;
  }
  if (chip.encoding != kChipEncoding) {
    throw DataError(where + ": chip has encoding \"" + chip.encoding + "\", expected gray8 or " +
                    std::string(kChipEncoding));
  }
  const Header header = read_header(chip, where);
  const cv::Size size(chip.window.width / header.factor, chip.window.height / header.factor);
  const std::size_t plain_size =
      static_cast<std::size_t>(size.area()) + (header.has_mask ? mask_bytes(size.area()) : 0);
  const auto plain = decompress(std::span(chip.data).subspan(kHeaderBytes), plain_size, where);
  return picture_from_plain(plain, header, size, where);
}

}  // namespace pilotage
