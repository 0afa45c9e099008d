#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "pilotage/base/progress.h"
#include "pilotage/mapdb/map_purpose.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// Which tiles of a map are those of another one, by place and by what is stored of them.
struct MapDifference {
  std::int64_t same = 0;     ///< In both, with the same features and chip.
  std::int64_t changed = 0;  ///< In both, with others.
  std::int64_t added = 0;
  std::int64_t removed = 0;
};

/// Compares the tiles of two maps by place, pixels and what is stored of them. Nothing when their CRS is not the same.
/// Throws DataError when one cannot be read.
std::optional<MapDifference> difference_of_maps(const std::filesystem::path& old_map,
                                                const std::filesystem::path& new_map);

/// Before the work: throws DataError when the old map cannot be read, UsageError when a new one of this purpose would
/// not be later by its own word (docs/decisions/map-updates.md).
void check_map_to_update(const std::filesystem::path& old_map, const MapPurpose& purpose);

/// Writes the delta that makes `new_map` out of `old_map` (update_map in mapdb/map_delta.h), with the new map's
/// signature and list of chunks where they are given. The same maps give the same bytes. Throws DataError when one
/// cannot be read or the delta cannot be written, Interrupted.
///
/// Each 16 MiB of the new map are compressed (zstd) with 64 MiB of the old one as their dictionary: those that have the
/// most pages in common with them. So what moved within the file is found, on the aircraft no more of the old
/// map is in memory than that, and here some 100 MiB, and 50 bytes for each page of 4096 of the old map.
void write_map_delta(const std::filesystem::path& path, const std::filesystem::path& old_map,
                     const std::filesystem::path& new_map, const std::optional<std::filesystem::path>& signature,
                     const std::optional<std::filesystem::path>& chunk_list, const Progress& progress = {});

}  // namespace pilotage

#pragma GCC visibility pop
