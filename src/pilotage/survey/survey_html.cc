#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "pilotage/base/markup.h"
#include "pilotage/base/text.h"
#include "pilotage/base/wording.h"
#include "pilotage/report/ground_json.h"
#include "pilotage/report/page_assets.h"
#include "pilotage/report/page_parts.h"
#include "pilotage/report/page_text.h"
#include "pilotage/survey/survey.h"
#include "pilotage/survey/survey_assets.h"
#include "pilotage/verdict/tile_class.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostRows = 400;  // of the table of squares; all stand in survey_squares.csv
constexpr std::size_t kMostCauses = 3;

// What makes the ground weak, over the whole area.
std::string causes_html(const Survey& survey) {
  const AreaStatistics& all = survey.statistics;
  const auto weak = static_cast<double>(all.tiles.all() - all.tiles.go);
  std::string html;
  for (std::size_t i = 0; i < std::min(kMostCauses, all.reasons.size()); ++i) {
    const auto& [code, count] = all.reasons[i];
    const ReasonWords& words = reason_words(code);
    const double share = all.share(count);
    html += "<li class=\"marginal\"><p><span class=\"where\">" + capitalized(std::string(words.what)) +
            "</span></p><p>" + area_text(share * all.area_km2) + ", " +
            percent_text(static_cast<double>(count) / weak) + " of the ground that is not go.</p><p class=\"todo\">" +
            std::string(words.todo) + "</p></li>\n";
  }
  if (!html.empty()) return html;
  return weak == 0 ? "<li class=\"good\"><p>All of the area is go ground.</p></li>\n"
                   : "<li class=\"marginal\"><p>No single reason; click tiles on the map.</p></li>\n";
}

// The shares as one bar, in the colours of the map.
std::string bar_html(const AreaStatistics& statistics) {
  const ClassCounts& tiles = statistics.tiles;
  std::string svg =
      "<svg class=\"share-bar\" viewBox=\"0 0 100 10\" preserveAspectRatio=\"none\" aria-hidden=\"true\">";
  double from = 0;
  std::size_t known = 0;
  for (const std::int64_t count : {tiles.go, tiles.marginal, tiles.no_go}) {
    const RasterClass& look = tile_classes()[known++];
    const double width = 100 * statistics.share(count);
    svg += "<rect x=\"" + format_fixed(from, 2) + "\" y=\"0\" width=\"" + format_fixed(width, 2) +
           "\" height=\"10\" fill=\"" + hex_color({look.rgb[0], look.rgb[1], look.rgb[2]}) + "\"/>";
    from += width;
  }
  return svg + "</svg>";
}

std::string place_cell(const SquareKilometre& square, std::size_t index) {
  const std::string place = html_escape(lat_lon(square.center));
  return "<td class=\"coordinates\" data-label=\"Middle\"><code>" + place +
         "</code> <button type=\"button\" class=\"copy\" data-copy=\"" + place + "\" aria-label=\"Copy the middle of " +
         square.name() + "\">Copy</button> <button type=\"button\" class=\"show-square\" data-square=\"" +
         std::to_string(index) + "\" aria-label=\"Show " + square.name() + " on the map\">Show</button></td>";
}

std::string squares_html(const Survey& survey) {
  std::string html;
  for (std::size_t i = 0; i < std::min(kMostRows, survey.squares.size()); ++i) {
    const SquareKilometre& square = survey.squares[i];
    const AreaStatistics& statistics = square.statistics;
    const auto share = [&](std::int64_t tiles) { return percent_text(statistics.share(tiles)); };
    html += "<tr>" + heading_html(square.name()) + "<td data-label=\"Shares\">" + bar_html(statistics) + "</td>" +
            cell_html("Go", share(statistics.tiles.go)) + cell_html("Marginal", share(statistics.tiles.marginal)) +
            cell_html("No-go", share(statistics.tiles.no_go)) +
            cell_html("Median P", number_text(statistics.median_p_correct_fix, 2)) +
            cell_html("Surveyed", area_text(statistics.area_km2)) +
            cell_html("Weak because", capitalized(weak_because(statistics))) + place_cell(square, i) + "</tr>\n";
  }
  return html;
}

// Where P is highest and lowest, with their places.
std::string extremes_html(const Survey& survey) {
  if (!survey.strongest) return "";
  const auto place = [&](const char* which, std::size_t index) {
    const ReportTile& tile = survey.tiles[index];
    const std::string center = html_escape(lat_lon(tile.tile.center));
    return std::string(which) + ": P " + number_text(survey.measures.front().measure.get(tile.score), 2) +
           " at <code>" + center + "</code> (tile " + std::to_string(tile.tile.tile_id) +
           ") <button type=\"button\" class=\"show-tile\" data-tile=\"" + std::to_string(index) +
           "\" aria-label=\"Show tile " + std::to_string(tile.tile.tile_id) + " on the map\">Show</button>";
  };
  return "<p class=\"extremes\">" + place("Strongest ground", *survey.strongest) + " · " +
         place("weakest", *survey.weakest) + "</p>";
}

std::string landmarks_html(const Survey& survey) {
  if (!survey.landmarks) return "";
  const SurveyLandmarks& found = *survey.landmarks;
  std::string html =
      "<section aria-labelledby=\"landmarks-heading\">\n  <h2 id=\"landmarks-heading\">Fixes by landmarks</h2>\n  <p>" +
      html_escape(found.said) + ".";
  if (found.strongest) {
    const std::string id = std::to_string(survey.tiles[*found.strongest].tile.tile_id);
    html += " <button type=\"button\" class=\"show-tile\" data-tile=\"" + std::to_string(*found.strongest) +
            "\" aria-label=\"Show tile " + id + " on the map\">Show</button>";
  }
  return html + "</p>\n  <p>" + html_escape(found.assumes) + "</p>\n" + landmark_classes_html(found.classes) +
         "</section>\n";
}

std::string squares_note(const Survey& survey) {
  std::string note =
      "E and N are the kilometres of its lower left corner in the grid's CRS. A tile counts where its centre lies, "
      "with all the ground it stands for; the median is over tiles with a P.";
  if (survey.squares.size() > kMostRows) {
    note += " The first " + std::to_string(kMostRows) + " of " + std::to_string(survey.squares.size()) +
            "; all stand in survey_squares.csv.";
  }
  return note;
}

std::string survey_grid_html(const Survey& survey) {
  const SurveyedGround& area = survey.area;
  const GridLevel& level = area.ground.levels.front();
  const auto row = [](const std::string& label, const std::string& text) {
    return "<tr>" + heading_html(label) + cell_html(text) + "</tr>\n";
  };
  std::string html =
      row("Grid", area.ground.crs.name()) +
      row("Camera footprint", number_text(area.footprint_width_m, 1) + " × " + number_text(area.footprint_height_m, 1) +
                                  " m from " + number_text(area.agl_m, 0) + " m above ground") +
      row("Tiles", number_text(level.gsd_m, 3) + " m/px; " + std::to_string(level.matrix.tile_size_px) + " px every " +
                       std::to_string(level.matrix.stride_px) + " px; search ±" +
                       std::to_string(level.search_radius_px) + " px");
  if (!area.ground.elevation.empty()) html += row("Elevation", area.ground.elevation);
  return html;
}

Json survey_display_json(const Survey& survey) {
  Json json = ground_display_json(survey.display, survey.area.ground.levels, survey.tiles, survey.measures);
  json["squares"] = Json::array();
  for (std::size_t i = 0; i < survey.squares.size(); ++i) {
    const auto& corners = survey.square_corners_m[i];
    const bool shown =
        std::all_of(corners.begin(), corners.end(), [](const auto& corner) { return corner.allFinite(); });
    const AreaStatistics& statistics = survey.squares[i].statistics;
    json["squares"].push_back(
        {{"name", survey.squares[i].name()},
         {"go", percent_text(statistics.share(statistics.tiles.go))},
         {"corners_m", shown ? plane_line_json({corners.begin(), corners.end()}) : Json::array()}});
  }
  return json;
}

}  // namespace

std::string survey_html(const Survey& survey) {
  Json data;
  data["report"] = survey_json(survey);
  data["display"] = survey_display_json(survey);
  data["sketch"] = survey.sketch;
  std::vector<std::string> assumptions = survey.assumptions;
  for (std::string& phrase : assumptions) phrase = capitalized(phrase) + ".";
  assumptions.push_back("Not looked at: " + survey.not_looked_at + ".");
  return fill_template(
      page_assets::survey_html(),
      {{"title", html_escape(survey.title)},
       {"head", page_head_html(survey.go_share + " go – " + survey.title, true)},
       {"appearance", std::string(page_assets::page_appearance_html())},
       {"leaflet_js", page_leaflet_js()},
       {"page_js", page_script({page_assets::page_base_js(),         page_assets::page_state_js(),
                                page_assets::page_ground_js(),       page_assets::page_canvas_js(),
                                page_assets::page_grid_js(),         page_assets::page_map_js(),
                                page_assets::page_tile_js(),         page_assets::page_panel_js(),
                                page_assets::survey_squares_js(),    page_assets::page_curve_js(),
                                page_assets::page_ins_js(),          page_assets::page_flight_js(),
                                page_assets::page_verdict_js(),      page_assets::page_about_js(),
                                page_assets::page_geodesic_js(),     page_assets::page_sketch_flight_js(),
                                page_assets::page_sketch_files_js(), page_assets::page_sketch_read_js(),
                                page_assets::page_sketch_js(),       page_assets::page_fold_js(),
                                page_assets::page_start_js()})},
       {"map_row",
        map_row_html("Map of the area", {{"imagery", "Imagery"},
                                         {"heat", "Heat map"},
                                         {"classes", "Outlines: go (solid), marginal (dashed), no-go (dotted)"},
                                         {"squares", "Square kilometres"},
                                         {"grid", "Coordinate grid", false}})},
       {"sketch",
        sketch_section_html(
            "With mission.json prepare cuts the very tiles of this page, and its P differs by less than 0.01 as a "
            "rule (48 of 51 lines over three places); near the edge of the imagery, where it has tiles that are "
            "half beyond it, P may be some hundredths higher.")},
       {"data", script_json(data)},
       {"go_share", html_escape(survey.go_share)},
       {"answer", html_escape(capitalized(survey.headline)) + "."},
       {"detail", html_escape(capitalized(survey.detail)) + "."},
       {"assumptions", list_html(assumptions)},
       {"title_block", title_block_html(survey.title_block)},
       {"causes", causes_html(survey)},
       {"extremes", extremes_html(survey)},
       {"squares", squares_html(survey)},
       {"squares_note", html_escape(squares_note(survey))},
       {"landmarks", landmarks_html(survey)},
       {"imagery", imagery_html(survey.area.ground.imagery.datasets) + imagery_html(survey.second_dates)},
       {"inputs", inputs_html(survey.inputs)},
       {"grid", survey_grid_html(survey)},
       {"parameters", parameters_section_html(survey.parameters)},
       {"warnings", list_html(survey.warnings)},
       {"notes", list_html(survey.notes)},
       {"version", html_escape(survey.software_version)}});
}

}  // namespace pilotage
