#include "pilotage/reroute/reroute_files.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/angle.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/markup.h"
#include "pilotage/base/svg.h"
#include "pilotage/base/text.h"
#include "pilotage/report/display_plane.h"
#include "pilotage/report/page_text.h"
#include "pilotage/report/tile_class.h"
#include "pilotage/report/wording.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

double to_decimals(double value, int decimals) {
  const double steps = std::pow(10, decimals);
  return std::round(value * steps) / steps;
}

Json line_json(const RerouteLine& line) {
  Json json = {{"verdict", std::string(verdict_name(line.verdict))},
               {"verdict_text", line.verdict_text},
               {"p_within_limit", line.p_within_limit ? json_number(*line.p_within_limit) : Json(nullptr)},
               {"largest_error_m", json_number(to_decimals(line.largest_error_m, 2))},
               {"matchable_fraction", to_decimals(line.matchable_fraction, 4)},
               {"length_m", to_decimals(line.length_m, 2)},
               {"duration_s", to_decimals(line.duration_s, 2)},
               {"turns", line.turns},
               {"turned_deg", to_decimals(line.turned_deg, 1)},
               {"no_fly_m", to_decimals(line.no_fly_m, 2)},
               {"points", Json::array()}};
  for (const GeodeticPoint& point : line.points) {
    json["points"].push_back({to_decimals(point.lon_deg, 7), to_decimals(point.lat_deg, 7)});
  }
  return json;
}

Json line_feature(const char* role, const RerouteLine& line) {
  Json coordinates = line_json(line)["points"];
  return {{"type", "Feature"},
          {"properties",
           {{"line", role},
            {"verdict", std::string(verdict_name(line.verdict))},
            {"p_within_limit", line.p_within_limit ? json_number(*line.p_within_limit) : Json(nullptr)},
            {"length_m", to_decimals(line.length_m, 2)},
            {"stroke", std::string(role) == "planned" ? "#777777" : "#000000"}}},
          {"geometry", {{"type", "LineString"}, {"coordinates", std::move(coordinates)}}}};
}

Json ring_feature(const char* role, const std::vector<GeodeticPoint>& ring) {
  Json corners = Json::array();
  for (const GeodeticPoint& corner : ring) {
    corners.push_back({to_decimals(corner.lon_deg, 7), to_decimals(corner.lat_deg, 7)});
  }
  corners.push_back(corners.front());
  return {{"type", "Feature"},
          {"properties", {{"zone", role}}},
          {"geometry", {{"type", "LineString"}, {"coordinates", std::move(corners)}}}};
}

std::string signed_text(double number, int decimals) {
  const std::string text = format_fixed(std::abs(number), decimals);
  return (number < 0 ? "−" : "+") + text;
}

std::string minutes_text(double duration_s) {
  return format_fixed(duration_s / 60, 1) + " min";
}

std::string p_text(const RerouteLine& line) {
  return line.p_within_limit ? probability_text(*line.p_within_limit) : "unknown";
}

// A plane of the picture: metres east and south of a corner, in pixels.
struct Picture {
  double lon_deg = 0;
  double lat_deg = 0;
  double x_per_deg = 1;
  double y_per_deg = 1;
  double width = 0;
  double height = 0;

  double x(GeodeticPoint point) const { return (unwrap_lon_deg(point.lon_deg, lon_deg) - lon_deg) * x_per_deg; }
  double y(GeodeticPoint point) const { return (lat_deg - point.lat_deg) * y_per_deg; }
};

Picture picture_of(const RerouteResult& result) {
  const double reference_deg = result.before.points.front().lon_deg;
  double west = INFINITY;
  double east = -INFINITY;
  double south = INFINITY;
  double north = -INFINITY;
  const auto extend = [&](GeodeticPoint point) {
    const double lon_deg = unwrap_lon_deg(point.lon_deg, reference_deg);
    west = std::min(west, lon_deg);
    east = std::max(east, lon_deg);
    south = std::min(south, point.lat_deg);
    north = std::max(north, point.lat_deg);
  };
  for (const RerouteLine* line : {&result.before, &result.after}) {
    for (const GeodeticPoint point : line->points) extend(point);
  }
  for (const SearchedTile& tile : result.searched) {
    for (const GeodeticPoint corner : tile.corners) extend(corner);
  }
  constexpr double kWidth = 1000;
  Picture picture;
  picture.lon_deg = west;
  picture.lat_deg = north;
  const double shrink = std::max(0.01, std::cos((south + north) / 2 * kRadPerDeg));
  const double wide_deg = std::max({(east - west) * shrink, (north - south) / 1.2, 1e-6});
  picture.y_per_deg = kWidth / wide_deg;
  picture.x_per_deg = picture.y_per_deg * shrink;
  picture.width = std::max(1.0, (east - west) * picture.x_per_deg);
  picture.height = std::max(1.0, (north - south) * picture.y_per_deg);
  return picture;
}

std::string points_text(const Picture& picture, const SvgWriter& svg, const std::vector<GeodeticPoint>& points) {
  std::string text;
  for (const GeodeticPoint point : points) {
    text += (text.empty() ? "" : " ") + svg.number(picture.x(point)) + "," + svg.number(picture.y(point));
  }
  return text;
}

// The class and the colour that every other map gives such a tile.
std::string cell_color(double p_fix) {
  TileScores score;
  score.p_correct_fix = p_fix;
  const RasterClass& shown = tile_classes()[static_cast<std::size_t>(tile_class(score).value_or(TileClass::kNoGo))];
  return hex_color({shown.rgb[0], shown.rgb[1], shown.rgb[2]});
}

std::string classes_key() {
  std::string html;
  for (const RasterClass& shown : tile_classes()) {
    html += "<span class=\"key\" style=\"background:" + hex_color({shown.rgb[0], shown.rgb[1], shown.rgb[2]}) +
            "\"></span> " + html_escape(shown.name) + " ";
  }
  return html;
}

// Below the cells; nothing where there is none.
std::string imagery_svg(const Picture& picture, const SvgWriter& svg, const DegreePicture& imagery) {
  constexpr std::size_t kMaxBytes = 300'000;
  if (imagery.rgba.empty()) return "";
  cv::Mat rgb;
  cv::cvtColor(imagery.rgba, rgb, cv::COLOR_RGBA2RGB);
  cv::Mat opacity;
  cv::extractChannel(imagery.rgba, opacity, 3);
  rgb.setTo(cv::Scalar::all(238), opacity == 0);  // the background's gray
  const double left = picture.x({imagery.west_deg, imagery.north_deg});
  const double top = picture.y({imagery.west_deg, imagery.north_deg});
  const double width = (imagery.east_deg - imagery.west_deg) * picture.x_per_deg;
  const double height = (imagery.north_deg - imagery.south_deg) * picture.y_per_deg;
  return "<image preserveAspectRatio=\"none\" x=\"" + svg.number(left) + "\" y=\"" + svg.number(top) + "\" width=\"" +
         svg.number(width) + "\" height=\"" + svg.number(height) + "\" href=\"data:image/jpeg;base64," +
         base64(encode_jpeg(rgb, kMaxBytes)) + "\"/>\n";
}

std::string map_svg(const RerouteResult& result) {
  const Picture picture = picture_of(result);
  const SvgWriter svg;
  std::string text = "<svg viewBox=\"0 0 " + svg.number(picture.width) + " " + svg.number(picture.height) +
                     "\" role=\"img\" aria-label=\"Map of the planned and the new line\">\n";
  text += imagery_svg(picture, svg, result.imagery);
  for (const SearchedTile& tile : result.searched) {
    text += "<polygon class=\"cell\" fill=\"" + cell_color(tile.p_fix) + "\" points=\"" +
            points_text(picture, svg, tile.corners) + "\"/>\n";
  }
  for (const auto& ring : result.no_fly_rings) {
    text += "<polygon class=\"zone\" points=\"" + points_text(picture, svg, ring) + "\"/>\n";
  }
  for (const auto& ring : result.fence_rings) {
    text += "<polygon class=\"fence\" points=\"" + points_text(picture, svg, ring) + "\"/>\n";
  }
  for (const auto& [type, line] : {std::pair("planned", &result.before), std::pair("new", &result.after)}) {
    const std::string points = points_text(picture, svg, line->points);
    text += "<polyline class=\"halo\" points=\"" + points + "\"/>\n";
    text += "<polyline class=\"" + std::string(type) + "\" points=\"" + points + "\"/>\n";
  }
  for (const GeodeticPoint point : result.after.points) {
    text += "<circle class=\"stop\" cx=\"" + svg.number(picture.x(point)) + "\" cy=\"" + svg.number(picture.y(point)) +
            "\" r=\"4\"/>\n";
  }
  const GeodeticPoint start = result.after.points.front();
  const GeodeticPoint end = result.after.points.back();
  constexpr double kWordWidth = 60;
  const bool together = std::hypot(picture.x(start) - picture.x(end), picture.y(start) - picture.y(end)) < kWordWidth;
  text += svg.text("name", picture.x(start) + 7, picture.y(start) - 7, together ? "start, end" : "start");
  if (!together) text += svg.text("name", picture.x(end) + 7, picture.y(end) - 7, "end");
  return text + "</svg>\n";
}

constexpr const char* kStyle =
    "body{font:15px/1.45 system-ui,sans-serif;margin:1.5rem auto;max-width:64rem;padding:0 1rem;color:#1a1a1a;"
    "background:#fff}"
    "h1{font-size:1.4rem}h2{font-size:1.1rem}table{border-collapse:collapse}"
    "th,td{padding:.25rem .8rem;border-bottom:1px solid #ccc;text-align:right}th:first-child{text-align:left}"
    "svg{width:100%;height:auto;background:#eee;border:1px solid #999}"
    ".cell{stroke:none;fill-opacity:.4}.key{display:inline-block;width:1.6em;height:.9em;vertical-align:-.1em}"
    ".zone{fill:#b0002055;stroke:#7a0016;stroke-width:1.5}"
    ".fence{fill:none;stroke:#7a0016;stroke-width:2;stroke-dasharray:10 4}"
    ".halo{fill:none;stroke:#fff;stroke-width:7}.planned{fill:none;stroke:#000;stroke-width:2.5;stroke-dasharray:9 7}"
    ".new{fill:none;stroke:#000;stroke-width:4}.stop{fill:#fff;stroke:#000;stroke-width:2}"
    ".name{font:bold 15px system-ui,sans-serif;paint-order:stroke;stroke:#fff;stroke-width:4px}";

std::string table_row(const std::string& name, const std::string& before, const std::string& after,
                      const std::string& change) {
  return "<tr><th scope=\"row\">" + html_escape(name) + "</th><td>" + html_escape(before) + "</td><td>" +
         html_escape(after) + "</td><td>" + html_escape(change) + "</td></tr>\n";
}

std::string list_html(const std::string& title, const std::vector<std::string>& texts) {
  if (texts.empty()) return "";
  std::string html = "<h2>" + html_escape(title) + "</h2>\n<ul>\n";
  for (const std::string& text : texts) html += "<li>" + html_escape(text) + "</li>\n";
  return html + "</ul>\n";
}

}  // namespace

std::string cost_text(const RerouteResult& result) {
  const RerouteLine& before = result.before;
  const RerouteLine& after = result.after;
  return signed_text((after.length_m - before.length_m) / 1000, 2) + " km, " +
         signed_text((after.duration_s - before.duration_s) / 60, 1) + " min, " +
         signed_text(after.turns - before.turns, 0) + " turns (" +
         signed_text(after.turned_deg - before.turned_deg, 0) + "°)";
}

Json reroute_to_json(const RerouteResult& result) {
  Json json = {
      {"pilotage_reroute", 1},
      {"found_go", result.found_go},
      {"assumptions", result.assumptions},
      {"planned", line_json(result.before)},
      {"new", line_json(result.after)},
      {"extra",
       {{"length_m", to_decimals(result.after.length_m - result.before.length_m, 2)},
        {"duration_s", to_decimals(result.after.duration_s - result.before.duration_s, 2)},
        {"turns", result.after.turns - result.before.turns},
        {"turned_deg", to_decimals(result.after.turned_deg - result.before.turned_deg, 1)}}},
      {"moved_legs", Json::array()},
      {"search",
       {{"within_m", to_decimals(result.search_within_m, 1)},
        {"tiles", result.tiles},
        {"lines_tried", result.lines_tried},
        {"lines_verified", result.lines_verified}}},
      {"items", {{"removed", result.removed_items}, {"lost", result.lost_items}, {"shifted", result.shifted_items}}},
      {"notes", result.notes}};
  for (const int leg : result.moved_legs) json["moved_legs"].push_back(leg + 1);
  return json;
}

Json reroute_to_geojson(const RerouteResult& result) {
  Json features = Json::array({line_feature("planned", result.before), line_feature("new", result.after)});
  for (const auto& ring : result.no_fly_rings) features.push_back(ring_feature("no-fly", ring));
  for (const auto& ring : result.fence_rings) features.push_back(ring_feature("fence", ring));
  return {{"type", "FeatureCollection"}, {"features", std::move(features)}};
}

std::string reroute_to_html(const RerouteResult& result, const std::string& title) {
  const RerouteLine& before = result.before;
  const RerouteLine& after = result.after;
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
      html_escape(title) + ": another line</title>\n<style>" + kStyle + "</style>\n</head>\n<body>\n";
  html += "<h1>" + html_escape(title) + ": another line</h1>\n";
  html += "<p><b>New line:</b> " + html_escape(after.verdict_text) + "</p>\n";
  html += "<p><b>Planned line:</b> " + html_escape(before.verdict_text) + "</p>\n";
  html += "<p>" + html_escape(result.assumptions) + "</p>\n";
  if (!result.found_go) html += "<p><b>No line was found that is GO; this is the best one.</b></p>\n";
  html += map_svg(result);
  html +=
      "<p>Dashed: the planned line. Solid: the new line and its waypoints. Shaded: no-fly zones; dashed outline: "
      "fence.</p>\n<p>Ground: " +
      classes_key() + "(" + html_escape(tile_classes_meaning()) + ")</p>\n";
  html += "<table>\n<tr><th></th><th>planned</th><th>new</th><th>change</th></tr>\n";
  html += table_row("Verdict", std::string(verdict_name(before.verdict)), std::string(verdict_name(after.verdict)), "");
  html += table_row("P of the route", p_text(before), p_text(after), "");
  html += table_row("Length", format_fixed(before.length_m / 1000, 2) + " km",
                    format_fixed(after.length_m / 1000, 2) + " km",
                    signed_text((after.length_m - before.length_m) / 1000, 2) + " km");
  html += table_row("Flight time", minutes_text(before.duration_s), minutes_text(after.duration_s),
                    signed_text((after.duration_s - before.duration_s) / 60, 1) + " min");
  html += table_row("Turns", std::to_string(before.turns) + ", " + format_fixed(before.turned_deg, 0) + "°",
                    std::to_string(after.turns) + ", " + format_fixed(after.turned_deg, 0) + "°",
                    signed_text(after.turns - before.turns, 0));
  html += table_row("Largest error", error_text(before.largest_error_m), error_text(after.largest_error_m), "");
  html += table_row("Matchable", percent_text(before.matchable_fraction), percent_text(after.matchable_fraction), "");
  if (before.no_fly_m > 0) {
    html += table_row("In no-fly zones", length_text(before.no_fly_m), length_text(after.no_fly_m), "");
  }
  html += "</table>\n";
  html += list_html("Items that had to go", result.lost_items);
  html += list_html("Items that now happen elsewhere", result.shifted_items);
  html += list_html("Waypoints that are gone", result.removed_items);
  html += list_html("Notes", result.notes);
  html += list_html("Warnings", result.warnings);
  return html + "</body>\n</html>\n";
}

}  // namespace pilotage
