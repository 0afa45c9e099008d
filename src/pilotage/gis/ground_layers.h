#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "pilotage/mapdb/map_landmarks.h"
#include "pilotage/raster/gdal_vector.h"
#include "pilotage/report/report.h"
#include "pilotage/report/tile_fields.h"

// The ground as layers of a map, of a route's report and of a survey alike (schemas/report-layers.md).

namespace pilotage {

/// "#rrggbbaa"; `opacity` is its last two digits.
std::string with_opacity(Rgb color, const char* opacity);

/// The measure in which tiles and heat maps are coloured: the first that any tile has a value of, P(correct fix) where
/// there is one; the first when none has.
const MeasureScale& shown_scale(const std::vector<MeasureScale>& measures);

/// Layer `tiles`: the cell of every tile, the stride-sized square around its centre, with a column for each field, in
/// the ground's CRS. Hidden in KML until it is asked for.
VectorLayer tile_layer(const Ground& ground, const std::vector<ReportTile>& tiles, const std::vector<TileField>& fields,
                       const MeasureScale& scale);

/// A table without shapes of a text `value` for each text `key`: `rows`, then role, name, date and digest of each input
/// ("inputs.0.role" …).
VectorLayer key_value_layer(const std::string& name, const std::string& title, const std::string& description,
                            const std::vector<std::pair<std::string, std::string>>& rows,
                            const std::vector<InputFile>& inputs);

/// Layer `decision`: outlines of the ground of one class (tile_class.h), in the ground's CRS.
VectorLayer decision_layer(const Ground& ground, const std::vector<ReportTile>& tiles);

/// Layer `landmarks`: points, WGS 84.
VectorLayer landmark_layer(const MapLandmarks& landmarks);

/// Tiles of a level for which `belongs` holds and that touch along edges, largest group first; of equals the one with
/// the smallest tile_id. They point into `tiles`.
std::vector<std::vector<const ReportTile*>> connected_tiles(const std::vector<ReportTile>& tiles,
                                                            const std::function<bool(const ReportTile&)>& belongs);

/// The outline of a group of tiles with its number of them and, where it is known, the range of their P(correct fix):
/// values after the first are its level, tiles, and both ends of that range.
VectorFeature outline_of(const Ground& ground, const std::vector<const ReportTile*>& group, VectorValue first);

}  // namespace pilotage
