#include "pilotage/mapdb/descriptor_row.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/mapdb/byte_order.h"

namespace pilotage {
namespace {

constexpr double kUnitsPerPx = 16;
constexpr double kUnitsPerMetre = 10;
constexpr std::int16_t kNoHeight = std::numeric_limits<std::int16_t>::min();
constexpr std::int64_t kMaxWindowStart = std::int64_t{1} << 40;

// A key point is a number of 64 bits, lowest first: x, y, octave, two zeros, height.
constexpr int kPositionBits = 21;  // 16 · kMaxMapWindowPx is 2²⁰
constexpr int kOctaveBits = 4;
constexpr int kHeightShift = 48;
constexpr std::uint64_t kPositionMask = (std::uint64_t{1} << kPositionBits) - 1;
constexpr int kMaxOctave = (1 << kOctaveBits) - 1;

void check_sizes(const TileDescriptors& d, const std::string& where) {
  const FeatureSet& set = d.features;
  if (!is_descriptor_length(8 * set.descriptor_bytes)) {
    throw UsageError(where + ": descriptor_bytes = " + std::to_string(set.descriptor_bytes) +
                     " is not one of: " + descriptor_byte_lengths());
  }
  if (set.size() > static_cast<std::size_t>(kMaxMapDescriptors)) {
    throw UsageError(where + ": has " + std::to_string(set.size()) + " features, at most " +
                     std::to_string(kMaxMapDescriptors) + " are allowed");
  }
  if (set.descriptors.size() != set.size() * static_cast<std::size_t>(set.descriptor_bytes)) {
    throw UsageError(where + ": has " + std::to_string(set.descriptors.size()) + " bytes of descriptors, expected " +
                     std::to_string(set.size()) + " × " + std::to_string(set.descriptor_bytes));
  }
  if (!d.ground_height_m.empty() && d.ground_height_m.size() != set.size()) {
    throw UsageError(where + ": has " + std::to_string(d.ground_height_m.size()) + " heights for " +
                     std::to_string(set.size()) + " features");
  }
}

std::string feature_name(const std::string& where, std::size_t index) {
  return where + ": feature " + std::to_string(index);
}

void check_feature(const Feature& feature, const PixelWindow& window, const std::string& where, std::size_t index) {
  const bool inside = feature.x_px >= 0 && feature.x_px <= static_cast<float>(window.width) && feature.y_px >= 0 &&
                      feature.y_px <= static_cast<float>(window.height);
  if (!inside) {
    throw UsageError(feature_name(where, index) + ": lies at (" + format_number(feature.x_px) + ", " +
                     format_number(feature.y_px) + "), outside its window of " + std::to_string(window.width) + " × " +
                     std::to_string(window.height) + " px");
  }
  if (feature.octave < 0 || feature.octave > kMaxOctave) {
    throw UsageError(feature_name(where, index) + ": octave = " + std::to_string(feature.octave) + " is outside [0, " +
                     std::to_string(kMaxOctave) + "]");
  }
}

/// The middle of the known heights in whole metres, or nothing when none is known.
std::optional<double> ground_base(const std::vector<float>& heights_m) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const float height : heights_m) {
    if (std::isnan(height)) continue;
    low = std::min(low, static_cast<double>(height));
    high = std::max(high, static_cast<double>(height));
  }
  if (low > high) return std::nullopt;
  return std::floor((low + high) / 2 + 0.5);
}

std::int16_t encode_height(double height_m, double base_m, const std::string& where, std::size_t index) {
  if (std::isnan(height_m)) return kNoHeight;
  const double units = std::floor((height_m - base_m) * kUnitsPerMetre + 0.5);
  if (!(std::abs(units) <= 32767)) {
    throw UsageError(feature_name(where, index) + ": ground height " + format_number(height_m) +
                     " m is more than 3276.7 m from " + format_number(base_m) + " m, the middle of its tile");
  }
  return static_cast<std::int16_t>(units);
}

std::string row_name(const std::string& file, std::int64_t tile_id, int level) {
  return file + ": tile " + std::to_string(tile_id) + ", level " + std::to_string(level);
}

PixelWindow read_window(const Statement& statement, int first_column, const std::string& where) {
  PixelWindow window;
  window.col = statement.integer(first_column);
  window.row = statement.integer(first_column + 1);
  window.width = statement.integer(first_column + 2, 1, kMaxMapWindowPx);
  window.height = statement.integer(first_column + 3, 1, kMaxMapWindowPx);
  const std::string problem = window_problem(window);
  if (!problem.empty()) throw DataError(where + ": " + problem);
  return window;
}

void check_blob(const std::string& where, const char* what, std::size_t bytes, std::int64_t count, int each) {
  if (bytes == static_cast<std::size_t>(count) * static_cast<std::size_t>(each)) return;
  throw DataError(where + ": " + what + " blob has " + std::to_string(bytes) + " bytes, expected " +
                  std::to_string(count) + " × " + std::to_string(each));
}

}  // namespace

std::string window_problem(const PixelWindow& window) {
  if (window.width < 1 || window.width > kMaxMapWindowPx || window.height < 1 || window.height > kMaxMapWindowPx) {
    return "window of " + std::to_string(window.width) + " × " + std::to_string(window.height) + " px is outside [1, " +
           std::to_string(kMaxMapWindowPx) + "]";
  }
  if (window.col < 0 || window.col > kMaxWindowStart || window.row < 0 || window.row > kMaxWindowStart) {
    return "window starts at column " + std::to_string(window.col) + ", row " + std::to_string(window.row) +
           ", outside [0, 2^40]";
  }
  return {};
}

std::string chip_problem(const MapChip& chip) {
  if (chip.encoding.empty() || chip.encoding.size() > 60) return "chip encoding is empty or longer than 60 characters";
  if (chip.data.empty()) return "chip has no data";
  const auto pixels = static_cast<std::size_t>(chip.window.width) * static_cast<std::size_t>(chip.window.height);
  if (chip.encoding == "gray8" && chip.data.size() != pixels) {
    return "chip blob has " + std::to_string(chip.data.size()) + " bytes, expected " +
           std::to_string(chip.window.width) + " × " + std::to_string(chip.window.height);
  }
  return {};
}

EncodedKeypoints encode_keypoints(const TileDescriptors& descriptors, const std::string& where) {
  check_sizes(descriptors, where);
  EncodedKeypoints result;
  result.ground_base_m = ground_base(descriptors.ground_height_m);
  result.bytes.reserve(descriptors.features.size() * kKeypointBytes);
  for (std::size_t i = 0; i < descriptors.features.size(); ++i) {
    const Feature& feature = descriptors.features.features[i];
    check_feature(feature, descriptors.window, where, i);
    const auto x = static_cast<std::uint64_t>(std::floor(static_cast<double>(feature.x_px) * kUnitsPerPx + 0.5));
    const auto y = static_cast<std::uint64_t>(std::floor(static_cast<double>(feature.y_px) * kUnitsPerPx + 0.5));
    const std::int16_t height =
        result.ground_base_m
            ? encode_height(static_cast<double>(descriptors.ground_height_m[i]), *result.ground_base_m, where, i)
            : kNoHeight;
    append_le(result.bytes, x | y << kPositionBits | static_cast<std::uint64_t>(feature.octave) << 2 * kPositionBits |
                                static_cast<std::uint64_t>(static_cast<std::uint16_t>(height)) << kHeightShift);
  }
  return result;
}

DescriptorRow read_descriptor_row(const Statement& statement, const std::string& file) {
  DescriptorRow row;
  row.tile_id = statement.integer(0);
  row.level = statement.integer(1, std::numeric_limits<int>::min(), std::numeric_limits<int>::max());
  const std::string where = row_name(file, row.tile_id, row.level);
  row.window = read_window(statement, 2, where);
  row.count = statement.integer(6, 0, kMaxMapDescriptors);
  row.descriptor_bytes = statement.integer(7, 1, kMostDescriptorBits / 8);
  if (!is_descriptor_length(8 * row.descriptor_bytes)) {
    throw DataError(where + ": descriptor_bytes is " + std::to_string(row.descriptor_bytes) +
                    ", expected one of: " + descriptor_byte_lengths());
  }
  if (!statement.is_null(8)) {
    row.ground_base_m = statement.real(8);
    if (!(std::abs(*row.ground_base_m) <= 100000)) {
      throw DataError(where + ": ground_base_m is " + format_number(*row.ground_base_m) +
                      ", outside [-100000, 100000]");
    }
  }
  row.keypoints = statement.blob(9);
  row.descriptors = statement.blob(10);
  row.digest = statement.blob(11);
  check_blob(where, "keypoint", row.keypoints.size(), row.count, kKeypointBytes);
  check_blob(where, "descriptor", row.descriptors.size(), row.count, row.descriptor_bytes);
  check_blob(where, "digest", row.digest.size(), 1, kDigestBytes);
  return row;
}

void check_descriptor_length(const DescriptorRow& row, const MapInfo& info, const std::string& file) {
  const std::optional<std::string> bits = info.find("features.descriptor_bits");
  if (!bits || *bits == std::to_string(row.descriptor_bytes * 8)) return;
  throw DataError(file + ": pilotage_descriptors: tile " + std::to_string(row.tile_id) + ": its descriptors have " +
                  std::to_string(row.descriptor_bytes * 8) +
                  " bits, map_info says features.descriptor_bits = " + *bits);
}

TileDescriptors decode_descriptors(const DescriptorRow& row, DescriptorPattern pattern, const std::string& file) {
  TileDescriptors result;
  result.tile_id = row.tile_id;
  result.level = row.level;
  result.window = row.window;
  result.features.pattern = pattern;
  result.features.descriptor_bytes = row.descriptor_bytes;
  result.features.descriptors.assign(row.descriptors.begin(), row.descriptors.end());
  const auto count = static_cast<std::size_t>(row.count);
  result.features.features.resize(count);
  if (row.ground_base_m) result.ground_height_m.resize(count);
  const std::uint64_t max_x = static_cast<std::uint64_t>(row.window.width) * 16;
  const std::uint64_t max_y = static_cast<std::uint64_t>(row.window.height) * 16;
  for (std::size_t i = 0; i < count; ++i) {
    const auto packed = read_le<std::uint64_t>(row.keypoints.data() + i * kKeypointBytes);
    const std::uint64_t x = packed & kPositionMask;
    const std::uint64_t y = packed >> kPositionBits & kPositionMask;
    const std::uint64_t octave =
        packed >> 2 * kPositionBits & ((std::uint64_t{1} << (kHeightShift - 2 * kPositionBits)) - 1);
    const auto height = static_cast<std::int16_t>(packed >> kHeightShift);
    const bool height_fits = row.ground_base_m.has_value() || height == kNoHeight;
    if (x > max_x || y > max_y || octave > kMaxOctave || !height_fits) {
      throw DataError(row_name(file, row.tile_id, row.level) + ": key point " + std::to_string(i) +
                      " is damaged (outside its window, or a value that is never written)");
    }
    Feature& feature = result.features.features[i];
    feature.x_px = static_cast<float>(static_cast<double>(x) / kUnitsPerPx);
    feature.y_px = static_cast<float>(static_cast<double>(y) / kUnitsPerPx);
    feature.octave = static_cast<int>(octave);
    if (row.ground_base_m) {
      result.ground_height_m[i] = height == kNoHeight
                                      ? std::numeric_limits<float>::quiet_NaN()
                                      : static_cast<float>(*row.ground_base_m + height / kUnitsPerMetre);
    }
  }
  return result;
}

MapChip read_chip_row(const Statement& statement, const std::string& file) {
  MapChip chip;
  chip.tile_id = statement.integer(0);
  chip.level = statement.integer(1, std::numeric_limits<int>::min(), std::numeric_limits<int>::max());
  const std::string where = row_name(file, chip.tile_id, chip.level);
  chip.window = read_window(statement, 2, where);
  chip.encoding = statement.text(6);
  const auto data = statement.blob(7);
  chip.data.assign(data.begin(), data.end());
  check_blob(where, "digest", statement.blob(8).size(), 1, kDigestBytes);
  const std::string problem = chip_problem(chip);
  if (!problem.empty()) throw DataError(where + ": " + problem);
  return chip;
}

}  // namespace pilotage
