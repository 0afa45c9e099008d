#include "pilotage/report/tile_fields.h"

#include <array>
#include <charconv>
#include <cmath>

#include "pilotage/base/text.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

Json six(double value) {
  return rounded(value, 6);
}

std::string_view tile_status(const ReportTile& tile) {
  if (!tile.scored) return "not_scored";
  if (tile.score.status == TileStatus::kTooLittleGround) return "too_little_ground";
  return tile.score.status == TileStatus::kFlat ? "flat" : "scored";
}

}  // namespace

Json rounded(double value, int digits) {
  if (!std::isfinite(value)) return nullptr;
  std::array<char, 64> buffer{};
  const auto [end, error] =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::scientific, digits - 1);
  const double result = parse_number({buffer.data(), end}).value_or(value);
  return result == 0 ? 0.0 : result;  // no −0
}

Json coordinate(double degrees) {
  if (!std::isfinite(degrees)) return nullptr;
  const double result = std::round(degrees * 1e7) / 1e7;
  return result == 0 ? 0.0 : result;
}

const std::vector<TileField>& tile_fields() {
  using Tile = const ReportTile&;
  static const std::vector<TileField> fields = {
      {"tile_id", "Tile", "", [](Tile t) { return Json(t.tile.tile_id); }},
      {"level", "Level", "", [](Tile t) { return Json(t.tile.level); }},
      {"column", "Column", "", [](Tile t) { return Json(t.tile.column); }},
      {"row", "Row", "", [](Tile t) { return Json(t.tile.row); }},
      {"selected", "Selected", "", [](Tile t) { return Json(t.selected); }},
      {"status", "Status", "", [](Tile t) { return Json(tile_status(t)); }},
      {"reason", "Why not selected", "", [](Tile t) { return Json(t.reason); }},
      {"p_correct_fix", "P(correct fix)", "", [](Tile t) { return six(t.score.p_correct_fix); }},
      {"reasons", "What speaks against it", "", [](Tile t) { return Json(t.reasons); }},
      {"center_lon_deg", "Centre, longitude", "°", [](Tile t) { return coordinate(t.tile.center.lon_deg); }},
      {"center_lat_deg", "Centre, latitude", "°", [](Tile t) { return coordinate(t.tile.center.lat_deg); }},
      {"route_distance_m", "Along the route", "m", [](Tile t) { return six(t.place.distance_m); }},
      {"route_offset_m", "Beside the route", "m", [](Tile t) { return six(t.place.offset_m); }},
      {"valid_fraction", "Imagery coverage", "", [](Tile t) { return six(t.score.valid_fraction); }},
      {"gray_variance", "Gray variance (with the root)", "gray levels",
       [](Tile t) { return six(t.score.gray_variance); }},
      {"frieden_entropy", "Frieden entropy", "", [](Tile t) { return rounded(t.score.frieden_entropy, 12); }},
      {"frieden_deficit", "Frieden deficit", "", [](Tile t) { return six(t.score.frieden_deficit); }},
      {"map_features", "Features of the map", "", [](Tile t) { return six(t.score.map_features); }},
      {"vote_noise", "Noise of wrong votes", "", [](Tile t) { return six(t.score.vote_noise); }},
      {"vegetation_share", "Green ground", "", [](Tile t) { return six(t.score.vegetation_share); }},
      {"water_share", "Open water", "", [](Tile t) { return six(t.score.water_share); }},
      {"aperture", "Edges: weakest over strongest direction", "", [](Tile t) { return six(t.score.aperture); }},
      {"relief_m", "Highest minus lowest ground", "m", [](Tile t) { return six(t.score.relief_m); }},
      {"degraded_peak", "Degraded: peak R₁", "NCC", [](Tile t) { return six(t.score.degraded.peak); }},
      {"degraded_rival", "Degraded: rival R₂", "NCC", [](Tile t) { return six(t.score.degraded.rival); }},
      {"degraded_peak_margin", "Degraded: R₁ − R₂", "NCC", [](Tile t) { return six(t.score.degraded.margin); }},
      {"degraded_rival_ratio", "Degraded: R₂ / R₁", "", [](Tile t) { return six(t.score.degraded.rival_ratio); }},
      {"degraded_psr", "Degraded: peak to sidelobes", "σ", [](Tile t) { return six(t.score.degraded.psr); }},
      {"degraded_rivals", "Degraded: rivals above 0.8 R₁", "", [](Tile t) { return six(t.score.degraded.rivals); }},
      {"degraded_half_width_px", "Degraded: half width", "px",
       [](Tile t) { return six(t.score.degraded.half_width_px); }},
      {"degraded_expected_error_px", "Degraded: expected error", "px",
       [](Tile t) { return six(t.score.degraded.expected_error_px); }},
      {"degraded_rival_dx_px", "Degraded: rival to the right", "px",
       [](Tile t) { return six(t.score.degraded.rival_dx_px); }},
      {"degraded_rival_dy_px", "Degraded: rival downwards", "px",
       [](Tile t) { return six(t.score.degraded.rival_dy_px); }},
      {"clean_peak", "Clean: peak R₁", "NCC", [](Tile t) { return six(t.score.clean.peak); }},
      {"clean_rival", "Clean: rival R₂", "NCC", [](Tile t) { return six(t.score.clean.rival); }},
      {"clean_peak_margin", "Clean: R₁ − R₂", "NCC", [](Tile t) { return six(t.score.clean.margin); }},
      {"clean_rival_ratio", "Clean: R₂ / R₁", "", [](Tile t) { return six(t.score.clean.rival_ratio); }},
      {"clean_psr", "Clean: peak to sidelobes", "σ", [](Tile t) { return six(t.score.clean.psr); }},
      {"clean_rivals", "Clean: rivals above 0.8 R₁", "", [](Tile t) { return six(t.score.clean.rivals); }},
      {"clean_half_width_px", "Clean: half width", "px", [](Tile t) { return six(t.score.clean.half_width_px); }},
      {"clean_expected_error_px", "Clean: expected error", "px",
       [](Tile t) { return six(t.score.clean.expected_error_px); }},
      {"clean_rival_dx_px", "Clean: rival to the right", "px", [](Tile t) { return six(t.score.clean.rival_dx_px); }},
      {"clean_rival_dy_px", "Clean: rival downwards", "px", [](Tile t) { return six(t.score.clean.rival_dy_px); }},
      {"epoch_ncc", "Second date: correlation", "NCC", [](Tile t) { return six(t.score.epoch.ncc); }},
      {"epoch_margin", "Second date: above the best wrong place", "NCC",
       [](Tile t) { return six(t.score.epoch.margin); }},
      {"epoch_survival", "Second date: features that stayed", "", [](Tile t) { return six(t.score.epoch.survival); }},
      {"epoch_disagreement_m", "Second date: georeferences apart", "m",
       [](Tile t) { return six(t.score.epoch.disagreement_m); }},
  };
  return fields;
}

}  // namespace pilotage
