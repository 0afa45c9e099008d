#pragma once

#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/report/report.h"

namespace pilotage {

/// `value` with `digits` significant decimal digits; null when it is not finite.
nlohmann::ordered_json rounded(double value, int digits);

/// Degrees with seven decimals (about a centimetre); null when not finite.
nlohmann::ordered_json coordinate(double degrees);

/// One number of a tile as report.json and the page show it.
struct TileField {
  std::string_view name;   ///< As in tiles.csv.
  std::string_view label;  ///< For people.
  std::string_view unit;   ///< "" for none.
  nlohmann::ordered_json (*value)(const ReportTile&) = nullptr;
};

const std::vector<TileField>& tile_fields();

}  // namespace pilotage
