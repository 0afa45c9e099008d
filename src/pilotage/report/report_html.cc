#include <cmath>
#include <regex>

#include "pilotage/base/safe_text.h"
#include "pilotage/base/text.h"
#include "pilotage/report/page_assets.h"
#include "pilotage/report/report.h"
#include "pilotage/report/strip_chart.h"
#include "pilotage/report/wording.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

std::string cell(const std::string& text) {
  return "<td>" + html_escape(text) + "</td>";
}
std::string heading(const std::string& text) {
  return "<th scope=\"row\">" + html_escape(text) + "</th>";
}

std::string badge(std::string_view status) {
  return "<span class=\"badge " + std::string(status) + "\">" + std::string(status) + "</span>";
}

// "53.123456, 7.123456": latitude first, as planners write it.
std::string lat_lon(GeodeticPoint point) {
  return number_text(point.lat_deg, 6) + ", " + number_text(point.lon_deg, 6);
}

std::string copy_cell(GeodeticPoint from, GeodeticPoint to) {
  const std::string text = html_escape(lat_lon(from) + " → " + lat_lon(to));
  return "<td class=\"coordinates\"><code>" + text + "</code> <button type=\"button\" class=\"copy\" data-copy=\"" +
         text + "\">Copy</button></td>";
}

std::string quality_html(const Report& report) {
  std::string html;
  for (const QualityRow& row : report.quality) {
    html += "<tr>" + heading(row.label + (row.decides ? " *" : "")) + cell(row.value) + "<td>" +
            badge(status_name(row.status)) + "</td>" + cell(row.threshold) + cell(row.advice) + "</tr>\n";
  }
  return html;
}

std::string legs_html(const Report& report) {
  std::string html;
  for (const int index : report.worst_legs) {
    const ReportLeg& leg = report.legs[static_cast<std::size_t>(index)];
    html += "<tr>" + heading("Leg " + std::to_string(leg.status.leg + 1)) + "<td>" + badge(status_name(leg.quality)) +
            "</td>" + cell(comparison_text(leg.status.max_error_m, report.max_error_m)) +
            cell(probability_text(leg.status.p_within_limit)) + cell(probability_text(leg.status.p_fix)) +
            cell(percent_text(leg.status.matchable_fraction)) + cell(length_text(leg.status.length_m)) +
            copy_cell(leg.from, leg.to) + "</tr>\n";
  }
  return html.empty() ? "<tr><td colspan=\"8\">The route has no leg.</td></tr>" : html;
}

std::string gaps_html(const Report& report) {
  std::string html;
  for (const ReportGap& gap : report.gaps) {
    html += "<tr>" + heading(length_text(gap.gap.from_distance_m) + " – " + length_text(gap.gap.to_distance_m)) +
            "<td>" +
            badge(status_name(gap.gap.within_limit ? judge_error(gap.gap.error_m, report.max_error_m)
                                                   : QualityStatus::kBad)) +
            "</td>" + cell(length_text(gap.length_m)) + cell(duration_text(gap.gap.duration_s)) +
            cell(comparison_text(gap.gap.error_m, report.max_error_m)) + copy_cell(gap.from, gap.to) + "</tr>\n";
  }
  return html.empty() ? "<tr><td colspan=\"6\">No gap.</td></tr>" : html;
}

std::string imagery_html(const Report& report) {
  std::string html;
  for (const PlanImagery& imagery : report.imagery) {
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
  for (const PlanLevel& level : report.levels) {
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
  json["cells_m"] = Json::array();
  for (const auto& corners : display.cells_m)
    json["cells_m"].push_back(plane_line_json({corners.begin(), corners.end()}));
  json["leg_lines_m"] = Json::array();
  for (const auto& line : display.leg_lines_m) json["leg_lines_m"].push_back(plane_line_json(line));
  json["gap_lines_m"] = Json::array();
  for (const auto& line : display.gap_lines_m) json["gap_lines_m"].push_back(plane_line_json(line));
  json["places_m"] = Json::array();
  for (const auto& [distance_m, point] : display.places_m) {
    json["places_m"].push_back(
        {std::round(distance_m * 10) / 10, std::round(point.x() * 10) / 10, std::round(point.y() * 10) / 10});
  }
  json["shades"] = Json::array();
  json["color_maps"] = Json::array();
  json["decimals"] = Json::array();
  for (const MeasureScale& scale : report.measures) {
    Json shades = Json::array();
    for (const ReportTile& tile : report.tiles) shades.push_back(shade(scale, scale.measure.value(tile.score)));
    json["shades"].push_back(shades);
    json["color_maps"].push_back(scale.measure.color_map == ColorMap::kViridis ? "viridis" : "cividis");
    json["decimals"].push_back(scale.measure.decimals);
  }
  for (const auto& [name, map] : {std::pair{"viridis", ColorMap::kViridis}, std::pair{"cividis", ColorMap::kCividis}}) {
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
                        {"page_js", std::string(page_assets::page_js())},
                        {"data", script_json(data)},
                        {"verdict_status", std::string(status_name(report.verdict))},
                        {"verdict_word", verdict},
                        {"verdict_rest", html_escape(report.verdict_text.substr(verdict.size() + 2))},
                        {"chart", strip_chart_svg(report)},
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
