#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pilotage/mapdb/map_info.h"
#include "pilotage/mapdb/map_types.h"
#include "pilotage/mapdb/sqlite.h"

namespace pilotage {

// A row of the table pilotage_descriptors between memory and bytes, as schemas/pilotage_descriptors.md lays it out.

inline constexpr int kKeypointBytes = 8;
inline constexpr int kDigestBytes = 32;

/// The row as it is stored; the spans live as long as what they were made from.
struct DescriptorRow {
  std::int64_t tile_id = 0;
  int level = 0;
  PixelWindow window;
  std::int64_t count = 0;
  int descriptor_bytes = 0;
  std::optional<double> ground_base_m;
  std::span<const std::uint8_t> keypoints;
  std::span<const std::uint8_t> descriptors;
  std::span<const std::uint8_t> digest;  ///< Empty until it is computed.
};

/// Key points as bytes, and the height they count from.
struct EncodedKeypoints {
  std::vector<std::uint8_t> bytes;
  std::optional<double> ground_base_m;
};

/// Throws UsageError, beginning with `where`, when a feature lies outside the window, a number is not finite or the
/// parts do not have the same number of elements.
EncodedKeypoints encode_keypoints(const TileDescriptors& descriptors, const std::string& where);

/// The columns that read_descriptor_row expects first in a SELECT from pilotage_descriptors.
inline constexpr std::string_view kDescriptorColumns =
    "tile_id, level, window_col_px, window_row_px, window_width_px, window_height_px, count, descriptor_bytes, "
    "ground_base_m, keypoints, descriptors, digest";

/// The current row of a statement, lengths checked against count; the spans live until its next step(). Throws
/// DataError beginning with `file`.
DescriptorRow read_descriptor_row(const Statement& statement, const std::string& file);

/// Throws DataError, beginning with `file`, when the descriptors have another length than the map says its features
/// have.
void check_descriptor_length(const DescriptorRow& row, const MapInfo& info, const std::string& file);

/// The features are described by `pattern`. Throws DataError, beginning with `file`, when a key point is not one that
/// encode_keypoints makes.
TileDescriptors decode_descriptors(const DescriptorRow& row, DescriptorPattern pattern, const std::string& file);

/// The columns that read_chip_row expects first in a SELECT from pilotage_chips.
inline constexpr std::string_view kChipColumns =
    "tile_id, level, window_col_px, window_row_px, window_width_px, window_height_px, encoding, data, digest";

/// The current row as a chip; throws DataError beginning with `file`.
MapChip read_chip_row(const Statement& statement, const std::string& file);

/// What is wrong with a window, or "".
std::string window_problem(const PixelWindow& window);
/// What is wrong with a chip's encoding or length, or "".
std::string chip_problem(const MapChip& chip);

}  // namespace pilotage
