#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <regex>

#include <nlohmann/json.hpp>

#include "pilotage/base/json_object.h"
#include "pilotage/base/markup.h"
#include "pilotage/base/text.h"
#include "pilotage/report/page_assets.h"
#include "pilotage/report/page_text.h"
#include "pilotage/report/report.h"
#include "pilotage/report/strip_chart.h"
#include "pilotage/report/tile_class.h"
#include "pilotage/report/tile_fields.h"
#include "pilotage/report/wording.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

std::string badge(std::string_view status) {
  return "<span class=\"badge " + std::string(status) + "\">" + std::string(status) + "</span>";
}

std::string cell(const std::string& text) {
  return "<td>" + html_escape(text) + "</td>";
}
// On a small screen a row becomes a card, in which each value says what it is.
std::string cell(const std::string& label, const std::string& text) {
  return "<td data-label=\"" + label + "\">" + html_escape(text) + "</td>";
}
std::string badge_cell(std::string_view status) {
  return "<td data-label=\"Status\">" + badge(status) + "</td>";
}
std::string heading(const std::string& text) {
  return "<th scope=\"row\">" + html_escape(text) + "</th>";
}

// "55°29'42.7\" N"
std::string dms(double degrees, char positive, char negative) {
  if (!std::isfinite(degrees)) return "–";
  const auto tenths = static_cast<std::int64_t>(std::llround(std::abs(degrees) * 36000));  // of a second
  const auto two = [](std::int64_t number) { return (number < 10 ? "0" : "") + std::to_string(number); };
  return std::to_string(tenths / 36000) + "°" + two(tenths / 600 % 60) + "'" + two(tenths / 10 % 60) + "." +
         std::to_string(tenths % 10) + "\" " + (degrees < 0 ? negative : positive);
}
std::string lat_lon_dms(GeodeticPoint point) {
  return dms(point.lat_deg, 'N', 'S') + " " + dms(point.lon_deg, 'E', 'W');
}

// "53.123456, 7.123456": latitude first, as planners write it.
std::string lat_lon(GeodeticPoint point) {
  return number_text(point.lat_deg, 6) + ", " + number_text(point.lon_deg, 6);
}

// Brings a stretch of the route into sight; nothing for one whose place is not known.
std::string show_button(double from_m, double to_m, const std::string& what) {
  if (!std::isfinite(from_m) || !std::isfinite(to_m)) return "";
  return " <button type=\"button\" class=\"show\" data-from=\"" + format_number(from_m) + "\" data-to=\"" +
         format_number(to_m) + "\" aria-label=\"Show " + html_escape(what) + " on the map\">Show</button>";
}

std::string copy_cell(GeodeticPoint from, GeodeticPoint to, const std::string& show) {
  // One place to a button, as the search of a map takes it.
  const auto place = [](GeodeticPoint point, const std::string& which) {
    const std::string text = html_escape(lat_lon(point));
    return "<code>" + text + "</code> <button type=\"button\" class=\"copy\" data-copy=\"" + text +
           "\" aria-label=\"Copy where it " + which + "\">Copy</button>";
  };
  return "<td class=\"coordinates\" data-label=\"From, to\"><span class=\"place\">" + place(from, "begins") +
         " →</span> <span class=\"place\">" + place(to, "ends") + "</span>" + show + "<span class=\"dms\">" +
         html_escape(lat_lon_dms(from) + " → " + lat_lon_dms(to)) + "</span></td>";
}

// The question the page answers, in one sentence.
std::string answer_text(const Report& report) {
  std::string text = report.headline + ".";
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

std::string title_block_html(const Report& report) {
  std::string html;
  for (const auto& [label, value] : report.title_block) {
    html += "<div><dt>" + html_escape(label) + "</dt><dd>" + html_escape(value) + "</dd></div>";
  }
  return html;
}

std::string places_heading(const Report& report) {
  const bool weak = std::any_of(report.weak_places.begin(), report.weak_places.end(),
                                [](const WeakPlace& place) { return place.status != QualityStatus::kGood; });
  return weak ? "Where it cannot, why, and what to do" : "Weakest places";
}

std::string places_html(const Report& report) {
  std::string html;
  for (const WeakPlace& place : report.weak_places) {
    const std::string status(status_name(place.status));
    html += "<li class=\"" + status + "\"><p><span class=\"where\">" + html_escape(place.where) + "</span> " +
            badge(status) + show_button(place.from_distance_m, place.to_distance_m, place.where) + "</p><p>" +
            html_escape(place.what) + "</p>";
    if (!place.why.empty()) html += "<p><b>Why:</b> " + html_escape(place.why) + "</p>";
    if (!place.todo.empty()) {
      const bool good = place.status == QualityStatus::kGood;
      html += "<p class=\"todo\">" + std::string(good ? "To do better: " : "What to do: ") + html_escape(place.todo) +
              "</p>";
    }
    html += "</li>\n";
  }
  return html.empty() ? "<li class=\"good\"><p>No gap, and no leg beyond 80 % of the limit.</p></li>\n" : html;
}

std::string evaluation_html(const Report& report) {
  if (!report.evaluation) return "";
  const EvaluationNote& note = *report.evaluation;
  std::string html =
      "<section aria-labelledby=\"evaluation-heading\">\n  <h2 id=\"evaluation-heading\">What the scores are "
      "worth</h2>\n";
  html +=
      "  <p>" + html_escape(note.source) + ": " + html_escape(note.outcomes) + ".</p>\n  <div class=\"evaluation\">\n";
  if (!note.diagram_svg.empty()) {
    // As a picture, so that nothing in the file can run.
    html += "    <img src=\"data:image/svg+xml;base64," + base64(note.diagram_svg) +
            "\" alt=\"Reliability diagram: promised probability against the share that came true\">\n";
  }
  html +=
      "    <table><thead><tr><th scope=\"col\">Predictor</th><th scope=\"col\">AUC</th><th scope=\"col\">Brier "
      "skill</th>"
      "<th scope=\"col\">Calibration error</th></tr></thead><tbody>\n";
  for (const EvaluationNote::Row& row : note.rows) {
    html +=
        "<tr>" + heading(row.title) + cell(row.auc) + cell(row.brier_skill) + cell(row.calibration_error) + "</tr>\n";
  }
  return html + "</tbody></table></div>\n</section>\n";
}

std::string quality_html(const Report& report) {
  std::string html;
  for (const QualityRow& row : report.quality) {
    html += "<tr>" + heading(row.label + (row.decides ? " *" : "")) + cell("Value", row.value) +
            badge_cell(status_name(row.status)) + cell("Threshold", row.threshold) + cell("Advice", row.advice) +
            "</tr>\n";
  }
  return html;
}

// "–" where nothing is known, words where the number does not exist.
std::string leg_probability_text(const Report& report, double p) {
  return std::isnan(p) && report.probability ? "not reached within the limit" : probability_text(p);
}

// The plan's own numbers: "2 → 3"; "–" where the file has none, as for home.
std::string items_text(const ReportLeg& leg) {
  const auto number = [](int item) { return item < 0 ? std::string("–") : std::to_string(item); };
  return leg.from_item < 0 && leg.to_item < 0 ? "–" : number(leg.from_item) + " → " + number(leg.to_item);
}

std::string legs_html(const Report& report) {
  std::string html;
  for (const int index : report.worst_legs) {
    const ReportLeg& leg = report.legs[static_cast<std::size_t>(index)];
    html += "<tr>" + heading("Leg " + std::to_string(leg.status.leg + 1)) + cell("Items of the plan", items_text(leg)) +
            badge_cell(status_name(leg.quality)) +
            cell("Largest error", comparison_text(leg.status.max_error_m, report.max_error_m)) +
            cell("P within limit", leg_probability_text(report, leg.status.p_within_limit)) +
            cell("P of a fix", leg_probability_text(report, leg.status.p_fix)) +
            cell("Matchable", percent_text(leg.status.matchable_fraction)) +
            cell("Length", length_text(leg.status.length_m)) +
            copy_cell(leg.from, leg.to,
                      show_button(leg.from_distance_m, leg.from_distance_m + leg.status.length_m,
                                  "leg " + std::to_string(leg.status.leg + 1))) +
            "</tr>\n";
  }
  return html.empty() ? "<tr><td colspan=\"9\">The route has no leg.</td></tr>" : html;
}

std::string gaps_html(const Report& report) {
  std::string html;
  for (const ReportGap& gap : report.gaps) {
    html += "<tr>" + heading(length_text(gap.gap.from_distance_m) + " – " + length_text(gap.gap.to_distance_m)) +
            badge_cell(status_name(gap.quality)) + cell("Length", length_text(gap.length_m)) +
            cell("Time", duration_text(gap.gap.duration_s)) +
            cell("Error at its end", comparison_text(gap.gap.error_m, report.max_error_m)) +
            copy_cell(gap.from, gap.to,
                      show_button(gap.gap.from_distance_m, gap.gap.to_distance_m,
                                  "the gap at " + length_text(gap.gap.from_distance_m))) +
            "</tr>\n";
  }
  return html.empty() ? "<tr><td colspan=\"6\">No gap.</td></tr>" : html;
}

// What is drawn behind the route where GNSS is denied; nothing where it is lost at the first point.
std::string denied_key_html(const Report& report) {
  if (report.denied.empty()) return "";
  return "<li><svg class=\"key\" viewBox=\"0 0 34 12\" aria-hidden=\"true\"><line class=\"denied-key\" x1=\"1\" "
         "y1=\"6\" "
         "x2=\"33\" y2=\"6\"/></svg> " +
         std::string(report.loss_anywhere ? "GNSS lost for good" : "GNSS denied") + "</li>\n  ";
}

std::string denied_box_html(const Report& report) {
  if (report.denied.empty()) return "";
  return "\n        <label><input type=\"checkbox\" id=\"show-denied\" checked> " +
         std::string(report.loss_anywhere ? "GNSS lost" : "GNSS denied") + "</label>";
}

std::string imagery_html(const Report& report) {
  std::string html;
  for (const ImageryDataset& imagery : report.imagery) {
    html += "<tr>" + heading(imagery.dataset) + cell(imagery.acquired.empty() ? "unknown" : imagery.acquired) +
            cell(number_text(imagery.gsd_m, 3) + " m/px") + cell(imagery.crs) +
            cell(std::to_string(imagery.width_px) + " × " + std::to_string(imagery.height_px) + " px") + "</tr>\n";
  }
  return html;
}

std::string inputs_html(const Report& report) {
  std::string html;
  for (const InputFile& file : report.inputs) {
    html += "<tr>" + heading(file.role) + cell(file.name) + cell(file.date) + "<td class=\"digest\">" +
            html_escape(file.digest) + "</td></tr>\n";
  }
  return html;
}

std::string grid_html(const Report& report) {
  std::string html = "<tr>" + heading("Mission grid") + cell(report.crs_name) + "</tr>\n";
  html += "<tr>" + heading("Corridor half width") + cell(length_text(report.corridor_half_width_m)) + "</tr>\n";
  html += "<tr>" + heading("Camera footprint") +
          cell(number_text(report.footprint_width_m, 1) + " × " + number_text(report.footprint_height_m, 1) + " m") +
          "</tr>\n";
  for (const GridLevel& level : report.levels) {
    html +=
        "<tr>" + heading("Level " + std::to_string(level.matrix.level)) +
        cell(number_text(level.gsd_m, 3) + " m/px; tile " + std::to_string(level.matrix.tile_size_px) + " px every " +
             std::to_string(level.matrix.stride_px) + " px; search ±" + std::to_string(level.search_radius_px) +
             " px; " + number_text(level.min_agl_m, 0) + " to " + number_text(level.max_agl_m, 0) + " m above ground") +
        "</tr>\n";
  }
  if (!report.elevation.empty()) html += "<tr>" + heading("Elevation") + cell(report.elevation) + "</tr>\n";
  return html;
}

// Nested objects become dotted names, as the options are called in a configuration file.
void append_parameters(const std::string& prefix, const Json& json, std::string& html) {
  if (json.is_object()) {
    for (const auto& item : json.items()) {
      append_parameters(prefix.empty() ? item.key() : prefix + "." + item.key(), item.value(), html);
    }
    return;
  }
  html += "<tr>" + heading(prefix) + cell(json.is_string() ? json.get<std::string>() : json.dump()) + "</tr>\n";
}

std::string list_html(const std::vector<std::string>& texts) {
  std::string html;
  for (const std::string& text : texts) html += "<li>" + html_escape(text) + "</li>\n";
  return html.empty() ? "<li>None.</li>" : html;
}

Json plane_line_json(const std::vector<Eigen::Vector2d>& line) {
  Json json = Json::array();
  for (const Eigen::Vector2d& point : line) {
    json.push_back(std::round(point.x() * 10) / 10);
    json.push_back(std::round(point.y() * 10) / 10);
  }
  return json;
}

Json display_json(const Report& report) {
  const ReportDisplay& display = report.display;
  Json json;
  json["drawn"] = display.drawn;
  json["missing"] = display.missing;
  json["edges_m"] = {display.min_x_m, display.min_y_m, display.max_x_m, display.max_y_m};
  json["imagery"] = display.imagery_jpeg.empty() ? "" : "data:image/jpeg;base64," + base64(display.imagery_jpeg);
  json["pictures"] = display.pictures_jpeg.empty() ? "" : "data:image/jpeg;base64," + base64(display.pictures_jpeg);
  json["picture_side_px"] = display.picture_side_px;
  json["picture_columns"] = display.picture_columns;
  json["cells_m"] = Json::array();
  for (const auto& corners : display.cells_m)
    json["cells_m"].push_back(plane_line_json({corners.begin(), corners.end()}));
  json["leg_lines_m"] = Json::array();
  for (const auto& line : display.leg_lines_m) json["leg_lines_m"].push_back(plane_line_json(line));
  json["gap_lines_m"] = Json::array();
  for (const auto& line : display.gap_lines_m) json["gap_lines_m"].push_back(plane_line_json(line));
  json["denied_lines_m"] = Json::array();
  for (const auto& line : display.denied_lines_m) json["denied_lines_m"].push_back(plane_line_json(line));
  json["places_m"] = Json::array();
  for (const auto& [distance_m, point] : display.places_m) {
    json["places_m"].push_back(
        {std::round(distance_m * 10) / 10, std::round(point.x() * 10) / 10, std::round(point.y() * 10) / 10});
  }
  json["profile_p"] = Json::array();  // one for each row of the error profile
  for (const ErrorSample& sample : report.error_profile) {
    json["profile_p"].push_back(
        Json::array({json_number(rounded(sample.p_correct_fix, 4)), json_number(rounded(sample.p_within_limit, 6))}));
  }
  json["heights"] = Json::array();  // distance, ground, flown
  for (const HeightSample& sample : report.heights.samples) {
    json["heights"].push_back({json_number(rounded(sample.distance_m, 7)), json_number(rounded(sample.ground_m, 5)),
                               json_number(rounded(sample.flown_m, 5))});
  }
  json["classes"] = Json::array();  // of each tile, null where nothing decides
  for (const ReportTile& tile : report.tiles) {
    const std::optional<TileClass> known = tile_class(tile.score);
    json["classes"].push_back(known ? Json(static_cast<int>(*known)) : Json());
  }
  json["class_names"] = Json::array();
  json["class_colors"] = Json::array();
  for (const RasterClass& next : tile_classes()) {
    json["class_names"].push_back(next.name);
    json["class_colors"].push_back(hex_color({next.rgb[0], next.rgb[1], next.rgb[2]}));
  }
  json["class_meaning"] = tile_classes_meaning();
  json["shades"] = Json::array();
  json["color_maps"] = Json::array();
  json["decimals"] = Json::array();
  for (const MeasureScale& scale : report.measures) {
    Json shades = Json::array();
    for (const ReportTile& tile : report.tiles) shades.push_back(shade(scale, scale.measure.get(tile.score)));
    json["shades"].push_back(shades);
    json["color_maps"].push_back(scale.measure.heat.colors == ColorMap::kBlues ? "blues" : "cividis");
    json["decimals"].push_back(scale.measure.heat.decimals);
  }
  for (const auto& [name, map] : {std::pair{"blues", ColorMap::kBlues}, std::pair{"cividis", ColorMap::kCividis}}) {
    for (const Rgb color : color_table(map)) json["colors"][name].push_back(hex_color(color));
  }
  return json;
}

// The last line of Leaflet's files points debuggers to a map file that the page does not have.
std::string without_source_map(const std::string& text) {
  return std::regex_replace(text, std::regex(R"((//|/\*)# sourceMappingURL=[^\n]*)"), "");
}

// Leaflet's own pictures (layer button, default marker) are not used; a reference to a file that is not there must not
// stay.
std::string without_files(const std::string& css) {
  return std::regex_replace(css, std::regex(R"(url\([^)]*\))"), "none");
}

// The page's scripts in one scope of their own.
std::string page_script() {
  std::string script = "(function () {\n'use strict';\n";
  for (const std::string_view part :
       {page_assets::page_state_js(), page_assets::page_ground_js(), page_assets::page_canvas_js(),
        page_assets::page_grid_js(), page_assets::page_map_js(), page_assets::page_tile_js(),
        page_assets::page_panel_js(), page_assets::page_chart_js(), page_assets::page_start_js()}) {
    script += part;
  }
  return script + "}());\n";
}

}  // namespace

std::string report_html(const Report& report) {
  Json data;
  data["report"] = report_json(report);
  data["display"] = display_json(report);
  std::string parameters;
  append_parameters("", report.parameters, parameters);
  const std::string verdict(verdict_name(report.verdict));
  return fill_template(page_assets::page_html(),
                       {{"title", html_escape(report.title)},
                        {"leaflet_css", without_source_map(without_files(std::string(page_assets::leaflet_css())))},
                        {"leaflet_js", without_source_map(std::string(page_assets::leaflet_js()))},
                        {"page_css", std::string(page_assets::page_css())},
                        {"page_js", page_script()},
                        {"data", script_json(data)},
                        {"verdict_status", std::string(status_name(report.verdict))},
                        {"verdict_word", verdict},
                        {"verdict_rest", html_escape(report.verdict_detail)},
                        {"answer", html_escape(answer_text(report))},
                        {"title_block", title_block_html(report)},
                        {"assumptions", html_escape(report.assumptions)},
                        {"places_heading", places_heading(report)},
                        {"places", places_html(report)},
                        {"evaluation", evaluation_html(report)},
                        {"imagery_age", imagery_age_html(report.imagery_age)},
                        {"denied_key", denied_key_html(report)},
                        {"denied_box", denied_box_html(report)},
                        {"chart", strip_chart_svg(report)},
                        {"heights", height_profile_svg(report.heights, chart_distance_m(report))},
                        {"waypoints", waypoints_html(report.waypoints)},
                        {"quality", quality_html(report)},
                        {"legs", legs_html(report)},
                        {"gaps", gaps_html(report)},
                        {"imagery", imagery_html(report)},
                        {"inputs", inputs_html(report)},
                        {"grid", grid_html(report)},
                        {"parameters", parameters},
                        {"warnings", list_html(report.warnings)},
                        {"notes", list_html(report.notes)},
                        {"route", html_escape(report.route_name + " (" + report.route_format + "), " +
                                              length_text(report.route_length_m))},
                        {"version", html_escape(report.software_version)}});
}

}  // namespace pilotage
