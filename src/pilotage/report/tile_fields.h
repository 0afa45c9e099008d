#pragma once

#include <functional>
#include <string>
#include <vector>

#include "pilotage/raster/gdal_vector.h"
#include "pilotage/report/report.h"

namespace pilotage {

/// `value` with `digits` significant decimal digits; NaN when it is not finite.
double rounded(double value, int digits);

/// What report.json and the layers for a GIS say of a number: six significant digits; NULL when it is not finite.
VectorValue number_value(double value, int digits = 6);

/// Degrees with seven decimals (about a centimetre); NULL when not finite.
VectorValue degrees_value(double degrees);

/// A column of the report's table of tiles, as report.json, the page and the layers for a GIS show it.
struct TileField {
  std::string name;   ///< As in tiles.csv.
  std::string label;  ///< For people.
  std::string unit;   ///< "" for none.
  VectorType type = VectorType::kReal;
  std::function<VectorValue(const ReportTile&)> value;
};

/// Which tile it is, what the report says of it, where it lies, and every measure, P(correct fix) before the others;
/// with landmarks behind it P of a fix by these alone.
const std::vector<TileField>& tile_fields(bool landmarks = false);

/// The same of ground that nobody flies over: its class (tile_class.h) instead of what a selection and a route say.
const std::vector<TileField>& ground_tile_fields(bool landmarks = false);

}  // namespace pilotage
