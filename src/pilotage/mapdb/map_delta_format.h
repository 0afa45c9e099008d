#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "pilotage/base/progress.h"

namespace pilotage {

// The bytes of a delta (schemas/map-delta.md), as map_delta.cc reads and map_delta_writer.cc writes them.

inline constexpr std::string_view kMapDeltaMagic = "PilotageDelta01\n";
/// Of the new map that one frame gives, but for the last, which may give less.
inline constexpr std::uint32_t kDeltaFrameBytes = std::uint32_t{16} << 20;
/// Of the old map that one frame refers to, at most.
inline constexpr std::uint32_t kDeltaWindowBytes = std::uint32_t{64} << 20;
/// Of zstd: what holds a window and a frame.
inline constexpr int kDeltaWindowLog = 27;
inline constexpr std::uint32_t kMaxDeltaSignatureBytes = 64 * 1024;

/// What stands before the frames.
struct MapDeltaHeader {
  std::uint64_t old_bytes = 0;
  std::array<std::uint8_t, 32> old_digest{};  ///< BLAKE2b-256 of the file.
  std::uint64_t new_bytes = 0;
  std::array<std::uint8_t, 32> new_digest{};
  std::string_view signature;   ///< The new map's .minisig, in the delta; "" when it is not signed.
  std::string_view chunk_list;  ///< Its .chunks, in the delta; "" when it has none.
};

/// What stands before the compressed bytes of a frame.
struct MapDeltaFrame {
  std::uint64_t old_offset = 0;
  std::uint32_t old_bytes = 0;
  std::uint32_t new_bytes = 0;
  std::uint32_t compressed_bytes = 0;
};

/// Makes `new_map` of a delta's bytes and the map before it, whose digest and size must be the header's; what it makes
/// is held against the header, too. Signatures, versions and the list of chunks are the caller's (update_map). `name`:
/// the delta, for messages. Throws DataError, IntegrityError, Interrupted.
MapDeltaHeader unpack_map_delta(std::string_view delta, const std::string& name, const std::filesystem::path& old_map,
                                const std::filesystem::path& new_map, const Progress& progress = {});

}  // namespace pilotage
