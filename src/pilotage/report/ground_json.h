#pragma once

#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/report/report.h"
#include "pilotage/report/tile_fields.h"

// What the files and pages of a route and of an area alike say of the ground.

namespace pilotage {

/// The measures with their scales: `measures` of report.json and survey.json.
nlohmann::ordered_json measures_json(const std::vector<MeasureScale>& measures);

/// A table with a column for each field and a row for each tile: `tiles` of both files.
nlohmann::ordered_json tiles_json(const std::vector<TileField>& fields, const std::vector<ReportTile>& tiles);

/// What the page's map draws of the ground and is no number of its own: edges, imagery, pictures, cells, classes, which
/// tiles are beyond what P was tested on, and colours (page_state.js).
nlohmann::ordered_json ground_display_json(const ReportDisplay& display, const std::vector<GridLevel>& levels,
                                           const std::vector<ReportTile>& tiles,
                                           const std::vector<MeasureScale>& measures);

/// A line in the page's plane, x and y one after the other, to decimetres.
nlohmann::ordered_json plane_line_json(const std::vector<Eigen::Vector2d>& line);

}  // namespace pilotage
