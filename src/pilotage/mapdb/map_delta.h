#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/mapdb/map_purpose.h"
#include "pilotage/mapdb/map_signature.h"

#pragma GCC visibility push(default)

namespace pilotage {

// The difference between two maps as a file that turns the first into the second, byte for byte, on the aircraft
// (schemas/map-delta.md; docs/decisions/map-updates.md). The ground makes it: mapdb/map_delta_writer.h.

/// How update_map trusts what it is given.
struct MapUpdateOptions {
  /// Minisign public keys, or their files: one of them must have signed the delta (DELTA.minisig beside it), and the
  /// new map. Without a key neither is asked for, and only digests are checked, which a stranger can make, too; the
  /// signature that the delta holds is then put beside the map unread.
  std::vector<std::string> trusted_keys;
  /// What the new map must be for, and of which version. Where nothing is said, the old map's mission, if it has one;
  /// in any case of a later version than the old map's, if that has one.
  MapRequirements required;
  bool overwrite = false;  ///< Replace what stands at the place of the new map.
};

/// What update_map wrote.
struct MapUpdate {
  std::uint64_t bytes = 0;  ///< Of the new map.
  std::string digest;       ///< BLAKE2b-256 of its bytes, 64 hex digits.
  MapPurpose purpose;       ///< What it is for.
  std::optional<SignatureInfo> signature;
};

/// Makes `new_map` out of `old_map` and `delta`, with its signature and its list of chunks beside it where the delta
/// holds them. All appear together, when they are whole and checked, or nothing does. The old map is not touched and
/// has another name, so a power cut at any moment leaves it as it was. Memory is the size of the delta and some 100
/// MiB, and where a key is given that of a new map that was signed without a list of chunks (kChunkListAboveBytes).
///
/// Throws IntegrityError when a key did not sign the delta or the new map, when the result is not what the delta says,
/// or not what is required; DataError when `old_map` is not the map that the delta begins with, a file cannot be read,
/// the delta is damaged, the disk has no room for the map, `new_map` exists and may not be replaced, or cannot be
/// written; UsageError for keys that are none, or `new_map` = `old_map`; Interrupted.
MapUpdate update_map(const std::filesystem::path& old_map, const std::filesystem::path& delta,
                     const std::filesystem::path& new_map, const MapUpdateOptions& options,
                     const Progress& progress = {});

/// Where the delta of a new map stands: ".delta" appended.
std::filesystem::path map_delta_path_of(const std::filesystem::path& map);

}  // namespace pilotage

#pragma GCC visibility pop
