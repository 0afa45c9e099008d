#include "pilotage/survey/survey.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>

#include "pilotage/base/nan.h"
#include "pilotage/base/options.h"
#include "pilotage/base/source_date.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"
#include "pilotage/base/wording.h"
#include "pilotage/ground/imagery_months.h"
#include "pilotage/ground/tile_chances.h"
#include "pilotage/matchability/level_at_age.h"
#include "pilotage/matchability/matchability_model.h"
#include "pilotage/matchability/reasons.h"
#include "pilotage/report/display.h"
#include "pilotage/report/display_plane.h"
#include "pilotage/report/landmark_prospects.h"
#include "pilotage/report/page_parts.h"
#include "pilotage/report/page_text.h"
#include "pilotage/report/sketch.h"
#include "pilotage/verdict/imagery_age.h"
#include "pilotage/verdict/map_holds.h"

namespace pilotage {
namespace {

std::string camera_phrase(const SurveyedGround& area) {
  const Camera& camera = area.camera;
  const double width_deg = 2 * std::atan(camera.width_px / 2.0 / camera.fx_px) * 180 / std::numbers::pi;
  std::string text = (area.camera_name.empty() ? "a camera" : area.camera_name) + " of " +
                     std::to_string(camera.width_px) + " × " + std::to_string(camera.height_px) + " px, " +
                     number_text(width_deg, 1) + "° wide, ";
  const CameraMount& mount = camera.mount;
  if (mount.pitch_deg == 0 && mount.roll_deg == 0) {
    text += "looking straight down";
  } else {
    text +=
        "mounted with pitch " + format_number(mount.pitch_deg) + "° and roll " + format_number(mount.roll_deg) + "°";
  }
  return text + " in level flight from " + number_text(area.agl_m, 0) + " m above ground: a frame shows " +
         number_text(area.footprint_width_m, 0) + " × " + number_text(area.footprint_height_m, 0) + " m";
}

std::string dates_of(const std::vector<ImageryDataset>& datasets) {
  std::vector<std::string> dates;
  for (const ImageryDataset& raster : datasets) {
    dates.push_back(raster.acquired.empty() ? "date not known" : raster.acquired);
  }
  std::sort(dates.begin(), dates.end());
  dates.erase(std::unique(dates.begin(), dates.end()), dates.end());
  return join(dates, ", ");
}

std::string model_phrase(const SurveyInput& input, bool known) {
  if (!known) return "P(correct fix) is not there: ground is judged by the margin of its degraded copies";
  const GridLevel& level = input.area.ground.levels.front();
  const int side_px = level.matrix.tile_size_px;
  const bool judged_here = std::any_of(input.scores.begin(), input.scores.end(),
                                       [](const TileScores& tile) { return tile.level_tiles > 0; });
  const std::string parameters =
      input.model.empty() ? "fitted on other places" : "with the parameters of " + input.model;
  return "P(correct fix) is modelled from one date, " + parameters + ", and not measured here; it was tested on " +
         tested_on_text() + ", these are " + std::to_string(side_px) + " px at " + number_text(level.gsd_m, 2) +
         " m/px" +
         (is_like_tested(level) ? ""
          : judged_here         ? ", beyond that; it rests on tiles of this ground that were judged"
                                : ": beyond what was tested");
}

/// ", on 2026-11-27 imagery 35 months old …"; "" where the planner did not say when it is flown.
std::string age_phrase(const SurveyInput& input) {
  const SurveyedGround& area = input.area;
  if (area.ground.flight_time.empty()) return "";
  const GeodeticPoint middle = area.ground.tiles[area.ground.tiles.size() / 2].center;
  const ImageryAge age = imagery_age(area.ground.imagery.datasets, middle, area.ground.flight_time);
  std::optional<bool> counted;
  if (any_p_known(input.scores)) {
    counted = counted_age_months(input.scores, std::vector<bool>(input.scores.size(), true)).has_value();
  }
  return "; on " + area.ground.flight_time + " " + imagery_age_phrase(age, counted) + "; " + imagery_age_measured();
}

std::vector<std::string> assumptions_of(const SurveyInput& input, bool known) {
  const SurveyedGround& area = input.area;
  std::vector<std::string> phrases = {camera_phrase(area)};
  phrases.push_back(input.matcher == FlyingMatcher::kFeatures ? "matched by features, on a map without chips"
                                                              : "matched by features and chips");
  phrases.push_back("a frame's place is known to within " + number_text(area.search_radius_m, 0) +
                    " m along each axis" + (area.search_radius_assumed ? " (default)" : ""));
  phrases.push_back("imagery: " + dates_of(area.ground.imagery.datasets) + age_phrase(input) +
                    (input.second_dates.empty() ? "; no second date, so what seasons and years change is not measured"
                                                : "; second date: " + dates_of(input.second_dates) +
                                                      ", which is shown beside P and is no part of it"));
  if (!input.second_date_assumption.empty()) phrases.push_back(input.second_date_assumption);
  phrases.push_back(model_phrase(input, known));
  return phrases;
}

// "; go shrinks to 48 % a year later …": go is what is found at least every second time. "" where P counts no age,
// and where later flights are nearer to the imagery.
std::string later_phrase(const Survey& survey) {
  const auto later = [&](double months) {
    return std::count_if(survey.tiles.begin(), survey.tiles.end(),
                         [&](const ReportTile& tile) { return is_half_found_later(tile.score, months); });
  };
  if (!ageing_imagery(survey.area.ground) || later(0) == 0) return "";
  const auto share = [&](double months) { return percent_text(survey.statistics.share(later(months))); };
  return "; go is " + share(12) + " of the area a year later and " + share(24) + " two years later (" + kAgeRule + ")";
}

std::string detail_of(const Survey& survey) {
  const AreaStatistics& all = survey.statistics;
  const auto part = [&](const char* name, std::int64_t tiles) {
    return std::string(name) + " " + area_text(all.area_km2 * all.share(tiles)) + " (" +
           percent_text(all.share(tiles)) + ")";
  };
  std::string text = part("marginal", all.tiles.marginal) + ", " + part("no-go", all.tiles.no_go);
  if (all.tiles.not_known > 0) text += ", " + part("not known", all.tiles.not_known);
  if (!std::isnan(all.median_p_correct_fix)) {
    text += "; median P(correct fix) " + number_text(all.median_p_correct_fix, 2);
  }
  if (survey.farthest_from_go_m > 0) {
    text +=
        "; no place is farther than " + length_text(survey.farthest_from_go_m) + " from go ground, as the crow flies";
  }
  return text + later_phrase(survey);
}

std::vector<ReportTile> tiles_of(const SurveyInput& input) {
  const Ground& ground = input.area.ground;
  const ReasonContext context = reason_context(ground.crs, ground.levels.front());
  const auto oldest = ageing_imagery(ground);
  std::vector<ReportTile> tiles;
  for (std::size_t i = 0; i < ground.tiles.size(); ++i) {
    tiles.push_back({ground.tiles[i], {}, input.scores[i], false, "", "", half_found_until(oldest, input.scores[i])});
    tiles.back().reasons = reasons_text(tile_reasons(input.scores[i], context));
  }
  return tiles;
}

// Tells the tiles what landmarks promise there, and says it of the area.
SurveyLandmarks add_landmarks(const SurveyInput& input, Survey& survey) {
  SurveyLandmarks found;
  found.landmarks = *input.landmarks;
  found.classes = landmark_classes(found.landmarks);
  const std::vector<LandmarkProspect> prospects =
      landmark_prospects(input.area.ground, found.landmarks, input.area.camera, input.area.search_radius_m);
  for (std::size_t i = 0; i < prospects.size(); ++i) {
    ReportTile& tile = survey.tiles[i];
    const double p = tile.p_landmark_fix = prospects[i].p_fix;
    if (p > (found.strongest ? survey.tiles[*found.strongest].p_landmark_fix : 0)) found.strongest = i;
    if (p < kLeastLandmarkGain) continue;
    ++found.likely_tiles;
    found.gaining_tiles += p > tile.score.p_correct_fix ? 1 : 0;
  }
  const AreaStatistics& all = survey.statistics;
  const auto area = [&](std::int64_t tiles) { return area_text(all.area_km2 * all.share(tiles)); };
  found.said = landmarks_phrase(found.classes) + ": ";
  if (found.likely_tiles == 0) {
    found.said += "nowhere may a fix by landmarks alone be expected";
  } else {
    found.said += "a fix by landmarks alone may be expected over " + percent_text(all.share(found.likely_tiles)) +
                  " of the area (" + area(found.likely_tiles) + ")";
    if (!std::isnan(all.median_p_correct_fix)) {
      found.said +=
          std::string(", ") + (found.gaining_tiles == 0 ? "nowhere" : "over " + area(found.gaining_tiles) + " of it") +
          " likelier than one " + (input.matcher == FlyingMatcher::kFeatures ? "by features" : "by features and chips");
    }
  }
  if (found.strongest) {
    const ReportTile& tile = survey.tiles[*found.strongest];
    found.said += "; P is " + landmark_p_text(tile.p_landmark_fix) + " at best, at " + lat_lon(tile.tile.center);
  }
  found.assumes = landmark_assumption("the headline or the classes of ground",
                                      "to within " + number_text(input.area.search_radius_m, 0) + " m along each axis",
                                      unresolved_classes(input.area.ground, found.landmarks, input.area.camera));
  return found;
}

std::vector<std::pair<std::string, std::string>> title_block_of(const SurveyedGround& area) {
  std::vector<std::pair<std::string, std::string>> block;
  if (const auto made = source_date()) block.emplace_back("Made", format_utc_time(*made));
  const GridLevel& level = area.ground.levels.front();
  const auto metres = [&](int px) { return number_text(px * level.gsd_m, 0) + " m"; };
  block.emplace_back("Tiles", metres(level.matrix.tile_size_px) + " wide, one every " + metres(level.matrix.stride_px));
  block.emplace_back("Imagery", dates_of(area.ground.imagery.datasets));
  block.emplace_back("CRS", area.ground.crs.name());
  return block;
}

std::string title_of(const SurveyInput& input) {
  if (!input.title.empty()) return input.title;
  return std::filesystem::path(input.area.ground.imagery.datasets.front().dataset).filename().string();
}

std::vector<std::array<Eigen::Vector2d, 4>> corners_of(const SurveyInput& input,
                                                       const std::vector<SquareKilometre>& squares) {
  const std::vector<GroundTile>& tiles = input.area.ground.tiles;
  const double reference_deg = tiles.empty() ? 0 : tiles[tiles.size() / 2].center.lon_deg;  // as make_display
  const auto plane = mercator_from_map(input.geodetic_from_map, reference_deg);
  std::vector<std::array<Eigen::Vector2d, 4>> corners;
  for (const SquareKilometre& square : squares) {
    const auto corner = [&](std::int64_t east, std::int64_t north) {
      return plane(
          {1000.0 * static_cast<double>(square.east_km + east), 1000.0 * static_cast<double>(square.north_km + north)});
    };
    corners.push_back({corner(0, 1), corner(1, 1), corner(1, 0), corner(0, 0)});
  }
  return corners;
}

}  // namespace

std::string area_text(double area_km2) {
  return number_text(area_km2, area_km2 < 9.995 ? 2 : area_km2 < 99.95 ? 1 : 0) + " km²";
}

std::vector<std::string> reason_names(const ReasonCounts& reasons) {
  std::vector<std::string> names;
  for (const auto& [code, count] : reasons) {
    if (names.size() < 3) names.push_back(options_detail::enum_to_name(code));
  }
  return names;
}

std::string weak_because(const AreaStatistics& statistics) {
  const std::int64_t weak = statistics.tiles.all() - statistics.tiles.go;
  std::vector<std::string> parts;
  for (const auto& [code, count] : statistics.reasons) {
    if (parts.size() == 3) break;
    parts.push_back(std::string(reason_words(code).what) + " (" +
                    percent_text(static_cast<double>(count) / static_cast<double>(weak)) +
                    (parts.empty() ? " of the weak ground)" : ")"));
  }
  return join(parts, ", ");
}

Survey make_survey(const SurveyInput& input) {
  const Ground& ground = input.area.ground;
  const ScoreTable table(ground, input.scores);
  Survey survey;
  survey.title = name_as_utf8(title_of(input));
  survey.software_version = input.software_version;
  survey.area = input.area;
  survey.area.ground.tiles.clear();
  std::vector<const TileScores*> all;
  for (const TileScores& tile : input.scores) all.push_back(&tile);
  survey.statistics = area_statistics(all, cell_km2(ground.levels.front()));
  survey.squares = square_kilometres(table);
  survey.farthest_from_go_m = farthest_from_go_m(table);
  survey.tiles = tiles_of(input);

  const bool known = !std::isnan(survey.statistics.median_p_correct_fix);
  const double share = survey.statistics.share(survey.statistics.tiles.go);
  survey.go_share = percent_text(share);
  survey.headline = std::string(known ? "a fix may be expected over " : "the ground stands out from all around over ") +
                    survey.go_share + " of the area: " + area_text(share * survey.statistics.area_km2) + " of " +
                    area_text(survey.statistics.area_km2) + (known ? "" : "; how often fixes come there is not known");
  survey.detail = detail_of(survey);
  survey.assumptions = assumptions_of(input, known);
  survey.not_looked_at =
      "a route and the errors that grow between fixes, wind, errors of attitude and height, light and weather on the "
      "day, obstacles; no go and no no-go for a flight";
  survey.title_block = title_block_of(input.area);
  for (auto& phrase : survey.assumptions) phrase = valid_utf8(phrase);
  for (auto& [label, value] : survey.title_block) value = valid_utf8(value);

  for (const Measure* measure : heat_maps()) survey.measures.push_back(measure_scale(*measure, input.scores));
  if (input.landmarks) survey.landmarks = add_landmarks(input, survey);
  const Measure& judged_by = survey.measures.front().measure;
  for (std::size_t i = 0; i < survey.tiles.size(); ++i) {
    const auto value = [&](std::size_t tile) { return judged_by.get(survey.tiles[tile].score); };
    if (std::isnan(value(i))) continue;
    if (!survey.strongest || value(i) > value(*survey.strongest)) survey.strongest = i;
    if (!survey.weakest || value(i) < value(*survey.weakest)) survey.weakest = i;
  }
  survey.matcher = input.matcher;
  survey.model = name_as_utf8(input.model);
  survey.second_dates = input.second_dates;
  for (auto* datasets : {&survey.area.ground.imagery.datasets, &survey.second_dates}) {
    for (ImageryDataset& dataset : *datasets) {
      dataset.dataset = name_as_utf8(dataset.dataset);
      dataset.crs = valid_utf8(dataset.crs);
      dataset.acquired = valid_utf8(dataset.acquired);
    }
  }
  for (const InputFile& file : input.inputs) {
    survey.inputs.push_back({valid_utf8(file.role),
                             valid_utf8(file.name),
                             valid_utf8(file.date),
                             valid_utf8(file.digest),
                             {valid_utf8(file.licence.terms), valid_utf8(file.licence.attribution)}});
  }
  survey.parameters = valid_utf8_json(input.parameters);
  survey.sketch = valid_utf8_json(
      sketch_data(input.sketched.mission, input.scores, input.sketched.selection, input.sketched.mission_file));
  for (const std::string& text : input.area.warnings) survey.warnings.push_back(valid_utf8(text));
  for (const std::string& text : input.area.notes) survey.notes.push_back(valid_utf8(text));
  survey.display = make_display({ground, input.imagery, input.pictures, input.geodetic_from_map}, survey.tiles);
  survey.square_corners_m = corners_of(input, survey.squares);
  return survey;
}

}  // namespace pilotage
