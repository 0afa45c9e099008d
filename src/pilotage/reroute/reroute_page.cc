#include "pilotage/reroute/reroute_page.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "pilotage/base/angle.h"
#include "pilotage/base/markup.h"
#include "pilotage/base/svg.h"
#include "pilotage/base/text.h"
#include "pilotage/base/wording.h"
#include "pilotage/report/display_plane.h"
#include "pilotage/report/page_assets.h"
#include "pilotage/report/page_parts.h"
#include "pilotage/report/page_text.h"
#include "pilotage/reroute/reroute_assets.h"
#include "pilotage/verdict/tile_class.h"

namespace pilotage {
namespace {

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
    html += "<span class=\"swatch\" style=\"background:" + hex_color({shown.rgb[0], shown.rgb[1], shown.rgb[2]}) +
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
  std::string text = "<svg class=\"lines\" viewBox=\"0 0 " + svg.number(picture.width) + " " +
                     svg.number(picture.height) +
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

/// A figure of both lines.
struct LineFigure {
  std::string name;
  std::string before;
  std::string after;
  std::string change;
  NumberKind kind = NumberKind::kModelled;
};

std::vector<LineFigure> line_figures(const RerouteLine& before, const RerouteLine& after) {
  const auto km = [](const RerouteLine& line) { return format_fixed(line.length_m / 1000, 2) + " km"; };
  const auto minutes = [](const RerouteLine& line) { return format_fixed(line.duration_s / 60, 1) + " min"; };
  const auto turns = [](const RerouteLine& line) {
    return std::to_string(line.turns) + ", " + format_fixed(line.turned_deg, 0) + "°";
  };
  return {{"P of the route", p_text(before), p_text(after), ""},
          {"Largest error", error_text(before.largest_error_m), error_text(after.largest_error_m), ""},
          {"Matchable", percent_text(before.matchable_fraction), percent_text(after.matchable_fraction), ""},
          {"Length", km(before), km(after), signed_text((after.length_m - before.length_m) / 1000, 2) + " km",
           NumberKind::kStated},
          {"Flight time", minutes(before), minutes(after),
           signed_text((after.duration_s - before.duration_s) / 60, 1) + " min"},
          {"Turns", turns(before), turns(after), signed_text(after.turns - before.turns, 0), NumberKind::kStated}};
}

std::string figures_html(const std::vector<LineFigure>& figures) {
  std::string html;
  for (const LineFigure& figure : figures) {
    const std::string change = figure.change.empty() ? "" : " (" + figure.change + ")";
    html += figure_html(figure.name, figure.after, "planned: " + figure.before + change, kind_mark(figure.kind));
  }
  return html;
}

std::string line_row(const std::string& name, const std::string& before, const std::string& after,
                     const std::string& change) {
  return "<tr>" + heading_html(name) + cell_html(before) + cell_html(after) + cell_html(change) + "</tr>\n";
}

std::string lines_html(const std::vector<LineFigure>& figures, const RerouteLine& before, const RerouteLine& after) {
  std::string html =
      line_row("Verdict", std::string(verdict_name(before.verdict)), std::string(verdict_name(after.verdict)), "");
  for (const LineFigure& figure : figures) html += line_row(figure.name, figure.before, figure.after, figure.change);
  if (before.no_fly_m > 0) {
    html += line_row("In no-fly zones", length_text(before.no_fly_m), length_text(after.no_fly_m), "");
  }
  return html;
}

std::string list_section(const std::string& id, const std::string& title, const std::vector<std::string>& texts) {
  if (texts.empty()) return "";
  return "<section aria-labelledby=\"" + id + "\">\n  <h2 id=\"" + id + "\">" + html_escape(title) + "</h2>\n  <ul>\n" +
         list_html(texts) + "  </ul>\n</section>\n";
}

}  // namespace

std::string reroute_to_html(const RerouteResult& result, const std::string& title, const std::string& json_name) {
  const RerouteLine& before = result.before;
  const RerouteLine& after = result.after;
  const std::vector<LineFigure> figures = line_figures(before, after);
  const std::string word(verdict_name(after.verdict));
  const std::string heading = title + ": another line";
  return fill_template(
      page_assets::reroute_html(),
      {{"title", html_escape(heading)},
       {"head", page_head_html(word + " – " + heading, false)},
       {"appearance", std::string(page_assets::page_appearance_html())},
       {"page_js", page_script({page_assets::page_base_js()})},
       {"status", std::string(status_name(after.verdict))},
       {"word", word},
       {"answer", html_escape(capitalized(after.headline)) + "."},
       {"rest", html_escape(after.verdict_detail)},
       {"planned", (result.found_go ? "" : "<b>No line was found that is GO; this is the best one.</b> ") +
                       html_escape("Planned line: " + before.verdict_text)},
       {"figures", figures_html(figures)},
       {"assumptions", html_escape(result.assumptions)},
       {"map", map_svg(result)},
       {"classes", classes_key()},
       {"classes_meaning", html_escape(tile_classes_meaning())},
       {"modelled", kind_mark(NumberKind::kModelled)},
       {"lines", lines_html(figures, before, after)},
       {"lists", list_section("lost-heading", "Items that had to go", result.lost_items) +
                     list_section("shifted-heading", "Items that now happen elsewhere", result.shifted_items) +
                     list_section("removed-heading", "Waypoints that are gone", result.removed_items) +
                     list_section("notes-heading", "Notes", result.notes) +
                     list_section("warnings-heading", "Warnings", result.warnings)},
       {"json", html_escape(json_name)}});
}

}  // namespace pilotage
