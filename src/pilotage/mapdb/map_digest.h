#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "pilotage/mapdb/descriptor_row.h"
#include "pilotage/mapdb/map_types.h"
#include "pilotage/mapdb/sqlite.h"

namespace pilotage {

// BLAKE2b-256 (RFC 7693) over the byte strings of schemas/map-database.md, "Digests".

using Digest = std::array<std::uint8_t, kDigestBytes>;

/// Of one row of pilotage_descriptors; its own digest column is left out.
Digest descriptor_digest(const DescriptorRow& row);

/// Of one row of pilotage_chips.
Digest chip_digest(const MapChip& chip);

/// Of every row of every table of the database and of its schema, but for the line "content_digest" of map_info.
/// Throws DataError when the database cannot be read through.
Digest content_digest(const Database& database);

std::string to_hex(std::span<const std::uint8_t> bytes);

}  // namespace pilotage
