#include "pilotage/report/tile_fields.h"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include <nlohmann/json.hpp>

#include "pilotage/base/text.h"
#include "pilotage/ground/measures.h"
#include "pilotage/ground/tile_table.h"
#include "pilotage/verdict/tile_class.h"

namespace pilotage {
namespace {

VectorValue value_or_null(double value) {
  return std::isfinite(value) ? VectorValue(value) : VectorValue();
}

TileField field_of(const Measure& measure) {
  return {measure.name, measure.label, shown_unit(measure), VectorType::kReal,
          [&measure](const ReportTile& tile) { return number_value(measure.get(tile.score), measure.digits); }};
}

using Tile = const ReportTile&;
using Type = VectorType;

std::vector<TileField> identity_fields() {
  return {{"tile_id", "Tile", "", Type::kInteger, [](Tile t) { return t.tile.tile_id; }},
          {"level", "Level", "", Type::kInteger, [](Tile t) { return std::int64_t{t.tile.level}; }},
          {"column", "Column", "", Type::kInteger, [](Tile t) { return t.tile.column; }},
          {"row", "Row", "", Type::kInteger, [](Tile t) { return t.tile.row; }},
          {"selected", "Selected", "", Type::kBoolean, [](Tile t) { return t.selected; }},
          {"status", "Status", "", Type::kText, [](Tile t) { return std::string(tile_status_name(t.score.status)); }},
          {"reason", "Why not selected", "", Type::kText, [](Tile t) { return t.reason; }}};
}

std::vector<TileField> place_fields() {
  return {
      {"reasons", "What speaks against it", "", Type::kText, [](Tile t) { return t.reasons; }},
      {"half_found_until", "Found at least every second time until", "", Type::kText,
       [](Tile t) { return t.half_found_until.empty() ? VectorValue() : VectorValue(t.half_found_until); }},
      {"center_lon_deg", "Centre, longitude", "°", Type::kReal,
       [](Tile t) { return degrees_value(t.tile.center.lon_deg); }},
      {"center_lat_deg", "Centre, latitude", "°", Type::kReal,
       [](Tile t) { return degrees_value(t.tile.center.lat_deg); }},
      {"route_distance_m", "Along the route", "m", Type::kReal,
       [](Tile t) { return number_value(t.place.distance_m); }},
      {"route_offset_m", "Beside the route", "m", Type::kReal, [](Tile t) { return number_value(t.place.offset_m); }}};
}

VectorValue class_name(Tile tile) {
  const std::optional<TileClass> known = tile_class(tile.score);
  return known ? VectorValue(tile_classes()[static_cast<std::size_t>(*known)].name) : VectorValue();
}

std::vector<TileField> make_tile_fields() {
  std::vector<TileField> fields = identity_fields();
  std::vector<TileField> rest = place_fields();
  for (const Measure* measure : measures_by_group()) {
    (measure->group == MeasureGroup::kCorrectFix ? fields : rest).push_back(field_of(*measure));
  }
  fields.insert(fields.end(), rest.begin(), rest.end());
  return fields;
}

/// What of these is said of ground that nobody flies over.
std::vector<TileField> of_ground(const std::vector<TileField>& fields) {
  std::vector<TileField> kept;
  for (const TileField& field : fields) {
    if (field.name == "selected") {
      kept.push_back({"class", "Class", "", Type::kText, class_name});
    } else if (field.name != "reason" && field.name != "route_distance_m" && field.name != "route_offset_m") {
      kept.push_back(field);
    }
  }
  return kept;
}

}  // namespace

double rounded(double value, int digits) {
  if (!std::isfinite(value)) return std::numeric_limits<double>::quiet_NaN();
  std::array<char, 64> buffer{};
  const auto [end, error] =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::scientific, digits - 1);
  const double result = parse_number({buffer.data(), end}).value_or(value);
  return result == 0 ? 0.0 : result;  // no −0
}

VectorValue number_value(double value, int digits) {
  return value_or_null(rounded(value, digits));
}

VectorValue degrees_value(double degrees) {
  const double result = std::round(degrees * 1e7) / 1e7;
  return value_or_null(result == 0 ? 0.0 : result);
}

const std::vector<TileField>& tile_fields(bool landmarks) {
  static const std::vector<TileField> fields = make_tile_fields();
  static const std::vector<TileField> with_landmarks = [] {
    std::vector<TileField> more = fields;
    more.push_back({"p_landmark_fix", "P(fix by landmarks alone)", "", Type::kReal,
                    [](Tile t) { return number_value(t.p_landmark_fix); }});
    return more;
  }();
  return landmarks ? with_landmarks : fields;
}

const std::vector<TileField>& ground_tile_fields(bool landmarks) {
  static const std::vector<TileField> fields = of_ground(tile_fields());
  static const std::vector<TileField> with_landmarks = of_ground(tile_fields(true));
  return landmarks ? with_landmarks : fields;
}

}  // namespace pilotage
