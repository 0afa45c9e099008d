#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/build_map/build_map.h"
#include "pilotage/ground/score_table.h"
#include "pilotage/mapdb/map_writer.h"

namespace pilotage {

/// What a map of a ground begins with: its CRS, its levels, and the columns of its tiles.
MapHeader map_header(const Ground& ground, const std::string& description, const BuildOptions& options);

/// Writes the tiles named (ascending tile_id) with every score and, where `places` has one for each tile of the ground,
/// their place along the route; then their descriptors and chips, level by level.
///
/// Scored tiles overlap, stored ground does not: each feature belongs to the stored tile, among those it lies in, whose
/// centre is nearest (the larger of both axis distances; the lower tile_id on a tie), so that every descriptor is
/// stored once and the descriptors of a tile's footprint are found in the tiles that overlap it. Imagery streams in
/// strips; features of a piece of ground do not depend on which tiles are stored. Chips, where asked for, are stored
/// once likewise (build_chips.h).
///
/// With keep_features = stable, a feature is dropped when `second_date` shows the ground around it and no counterpart
/// (feature_fates.h); a tile in whose window fewer than kLeastFeatures are left keeps the strongest others that it
/// owns, up to so many. The levels' grids are then north-up with square pixels. Chips stay as they are.
///
/// `imagery` is the ground's where it is open already, for this stage and others.
///
/// Throws UsageError for options out of range or keep_features without its second date, DataError when the ground has
/// no such tile, or when reading or writing fails; Interrupted.
BuildStats write_ground(MapWriter& writer, const ScoreTable& table, std::span<const std::int64_t> tile_ids,
                        std::span<const RoutePlace> places, const BuildOptions& options, int threads = 0,
                        const Progress& progress = {}, const std::optional<SecondDate>& second_date = {},
                        const GroundImagery* imagery = nullptr);

}  // namespace pilotage
