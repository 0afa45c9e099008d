#include <algorithm>
#include <cmath>
#include <map>

#include <nlohmann/json.hpp>

#include "pilotage/base/json_object.h"
#include "pilotage/base/markup.h"
#include "pilotage/base/text.h"
#include "pilotage/base/wording.h"
#include "pilotage/report/explain.h"
#include "pilotage/report/ground_json.h"
#include "pilotage/report/imagery_age_section.h"
#include "pilotage/report/key_figures.h"
#include "pilotage/report/page_assets.h"
#include "pilotage/report/page_parts.h"
#include "pilotage/report/page_text.h"
#include "pilotage/report/report.h"
#include "pilotage/report/simulated_flights.h"
#include "pilotage/report/strip_chart.h"
#include "pilotage/report/tile_fields.h"
#include "pilotage/verdict/evidence.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

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
  return capitalized(report.headline) + ".";
}

// What the verdict rests on, strongest first: what is stronger than the model, which the headline tells, and what of
// that is not there.
std::string evidence_html(const Report& report) {
  std::string html;
  for (const QualityRow* row : evidence_rows(report.quality)) {
    if (row->kind == NumberKind::kModelled) continue;
    html += "      <li>" + badge_html(status_name(row->status)) + " " + kind_mark(row->kind) + " " +
            html_escape(row->label + ": " + row->value) + "</li>\n";
  }
  const std::string missing = missing_evidence(report.quality);
  return html + "      <li>" + kind_mark(NumberKind::kModelled) + " by the inertial error model" +
         (report.probability ? " and the tiles' P" : "") + (missing.empty() ? "" : "; " + html_escape(missing)) +
         "</li>\n";
}

std::string figures_html(const Report& report) {
  std::string html;
  for (const KeyFigure& figure : key_figures(report)) {
    html += figure_html(figure.label, figure.value, figure.detail, kind_mark(figure.kind));
  }
  return html;
}

std::string places_heading(const Report& report) {
  const bool weak = std::any_of(report.weak_places.begin(), report.weak_places.end(),
                                [](const WeakPlace& place) { return place.status != QualityStatus::kGood; });
  return weak ? "Where it cannot, why, and what to do" : "Weakest places";
}

// What the program knows against too many lost flights, each with what finds out how much it helps.
constexpr const char* kCures =
    "<ul class=\"cures\">\n"
    "<li><b>Another line:</b> <button type=\"button\" id=\"cure-line\" hidden>Draw one</button> <code>pilotage reroute "
    "MISSION -o new.plan</code> looks for the cheapest that is GO.</li>\n"
    "<li><b>A better inertial system:</b> <span id=\"cure-ins\"></span> <code>pilotage prepare MISSION --ins-grade "
    "GRADE</code></li>\n"
    "<li><b>A second date of this ground:</b> <code>pilotage prepare MISSION --second-epoch LATER.tif</code> "
    "measures how often its tiles are found on another day.</li>\n</ul>";

std::string places_html(const Report& report) {
  std::string html;
  for (const WeakPlace& place : report.weak_places) {
    const std::string status(status_name(place.status));
    html += "<li class=\"" + status + "\"><p><span class=\"where\">" + html_escape(place.where) + "</span> " +
            badge_html(status) + show_button(place.from_distance_m, place.to_distance_m, place.where) + "</p><p>" +
            html_escape(place.what) + "</p>";
    if (!place.why.empty()) html += "<p><b>Why:</b> " + html_escape(place.why) + "</p>";
    if (!place.todo.empty()) {
      const bool good = place.status == QualityStatus::kGood;
      html += "<p class=\"todo\">" + std::string(good ? "To do better: " : "What to do: ") + html_escape(place.todo) +
              "</p>";
    }
    if (place.most_lost) html += kCures;
    html += "</li>\n";
  }
  return html.empty() ? "<li class=\"good\"><p>No gap, and no leg beyond 80 % of the limit.</p></li>\n" : html;
}

std::string evaluation_html(const Report& report) {
  if (!report.evaluation) return "";
  const EvaluationNote& note = *report.evaluation;
  std::string html =
      "<section aria-labelledby=\"evaluation-heading\">\n  <h2 id=\"evaluation-heading\">What the scores are "
      "worth " +
      kind_mark(NumberKind::kMeasured) + "</h2>\n";
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
    html += "<tr>" + heading_html(row.title) + cell_html(row.auc) + cell_html(row.brier_skill) +
            cell_html(row.calibration_error) + "</tr>\n";
  }
  return html + "</tbody></table></div>\n</section>\n";
}

// "–" where nothing is known, words where the number does not exist.
std::string leg_probability_text(const Report& report, double p) {
  return std::isnan(p) && report.probability ? "not reached within the limit" : probability_text(p);
}

std::string legs_html(const Report& report) {
  std::string html;
  for (const int index : report.worst_legs) {
    const ReportLeg& leg = report.legs[static_cast<std::size_t>(index)];
    html += "<tr>" + heading_html("Leg " + std::to_string(leg.status.leg + 1)) +
            cell_html("Items of the plan", leg_items_text(leg)) + badge_cell_html(status_name(leg.quality)) +
            cell_html("Largest error", comparison_text(leg.status.max_error_m, report.max_error_m)) +
            cell_html("P within limit", leg_probability_text(report, leg.status.p_within_limit)) +
            cell_html("P of a fix", leg_probability_text(report, leg.status.p_fix)) +
            cell_html("Matchable", percent_text(leg.status.matchable_fraction)) +
            cell_html("Length", length_text(leg.status.length_m)) +
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
    html += "<tr>" + heading_html(length_text(gap.gap.from_distance_m) + " – " + length_text(gap.gap.to_distance_m)) +
            badge_cell_html(status_name(gap.quality)) + cell_html("Length", length_text(gap.length_m)) +
            cell_html("Time", duration_text(gap.gap.duration_s)) +
            cell_html("Error at its end", comparison_text(gap.gap.error_m, report.max_error_m)) +
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

std::string lost_key_html(const Report& report) {
  if (most_lost(report) == nullptr) return "";
  return "<li><svg class=\"key\" viewBox=\"0 0 34 12\" aria-hidden=\"true\"><line class=\"lost-key\" x1=\"1\" y1=\"6\" "
         "x2=\"33\" y2=\"6\"/></svg> " +
         std::string(kMostLost) + "</li>\n  ";
}

std::vector<MapLayer> map_layers(const Report& report) {
  std::vector<MapLayer> layers{{"imagery", "Imagery"},
                               {"heat", "Heat map"},
                               {"classes", "Outlines: go (solid), marginal (dashed), no-go (dotted)", false},
                               {"selected", "Chosen areas"},
                               {"refused", "Refused areas"},
                               {"route", "Route, legs"},
                               {"gaps", "Gaps"}};
  if (!report.denied.empty()) layers.push_back({"denied", report.loss_anywhere ? "GNSS lost" : "GNSS denied"});
  if (!report.display.true_place_lines_m.empty()) layers.push_back({"true-places", "Simulated places"});
  layers.push_back({"grid", "Coordinate grid", false});
  return layers;
}

std::string simulated_key_html(const Report& report) {
  if (report.simulations.empty()) return "";
  return "<span class=\"swatch simulated-cep50\"></span> CEP50 <span class=\"swatch simulated-r95\"></span> R95 of the "
         "simulated flights " +
         kind_mark(NumberKind::kSimulated);
}

std::string grid_html(const Report& report) {
  std::string html = "<tr>" + heading_html("Mission grid") + cell_html(report.crs_name) + "</tr>\n";
  html +=
      "<tr>" + heading_html("Corridor half width") + cell_html(length_text(report.corridor_half_width_m)) + "</tr>\n";
  html +=
      "<tr>" + heading_html("Camera footprint") +
      cell_html(number_text(report.footprint_width_m, 1) + " × " + number_text(report.footprint_height_m, 1) + " m") +
      "</tr>\n";
  for (const GridLevel& level : report.levels) {
    html += "<tr>" + heading_html("Level " + std::to_string(level.matrix.level)) +
            cell_html(number_text(level.gsd_m, 3) + " m/px; tile " + std::to_string(level.matrix.tile_size_px) +
                      " px every " + std::to_string(level.matrix.stride_px) + " px; search ±" +
                      std::to_string(level.search_radius_px) + " px; " + number_text(level.min_agl_m, 0) + " to " +
                      number_text(level.max_agl_m, 0) + " m above ground") +
            "</tr>\n";
  }
  if (!report.elevation.empty()) html += "<tr>" + heading_html("Elevation") + cell_html(report.elevation) + "</tr>\n";
  return html;
}

// The frames along the route; null without any.
Json seen_json(const Report& report) {
  const SeenFrames& seen = report.seen;
  if (report.display.seen_jpeg.empty()) return nullptr;
  Json json{{"jpeg", "data:image/jpeg;base64," + base64(report.display.seen_jpeg)},
            {"width_px", seen.width_px},
            {"height_px", seen.height_px},
            {"step_px", {seen.step_x_px, seen.step_y_px}},
            {"columns", seen.columns},
            {"second_date", seen.second_date},
            {"frames", Json::array()}};  // distance, azimuth, above ground, width on the ground, index of the tile
  for (const SeenFrame& frame : seen.frames) {
    json["frames"].push_back({rounded(frame.distance_m, 7), rounded(frame.azimuth_deg, 6), rounded(frame.agl_m, 5),
                              rounded(frame.width_m, 5), frame.tile ? Json(*frame.tile) : Json()});
  }
  return json;
}

// What an evaluation found at the tiles: index of the tile, outcome, error.
Json found_json(const Report& report) {
  Json json = Json::array();
  if (!report.evaluation) return json;
  std::map<std::int64_t, std::size_t> index;
  for (std::size_t i = 0; i < report.tiles.size(); ++i) index[report.tiles[i].tile.tile_id] = i;
  for (const EvaluationNote::Found& found : report.evaluation->found) {
    const auto at = index.find(found.tile_id);
    if (at == index.end()) continue;
    const GeodeticPoint center = report.tiles[at->second].tile.center;
    constexpr double kSamePlace_deg = 1e-6;  // a decimetre
    if (std::abs(center.lon_deg - found.center.lon_deg) > kSamePlace_deg ||
        std::abs(center.lat_deg - found.center.lat_deg) > kSamePlace_deg) {
      continue;
    }
    json.push_back({at->second, found.outcome, json_number(rounded(found.error_m, 4))});
  }
  return json;
}

Json display_json(const Report& report) {
  const ReportDisplay& display = report.display;
  Json json = ground_display_json(display, report.levels, report.tiles, report.measures);
  json["leg_lines_m"] = Json::array();
  for (const auto& line : display.leg_lines_m) json["leg_lines_m"].push_back(plane_line_json(line));
  json["gap_lines_m"] = Json::array();
  for (const auto& line : display.gap_lines_m) json["gap_lines_m"].push_back(plane_line_json(line));
  json["denied_lines_m"] = Json::array();
  for (const auto& line : display.denied_lines_m) json["denied_lines_m"].push_back(plane_line_json(line));
  json["true_place_lines_m"] = Json::array();
  for (const auto& line : display.true_place_lines_m) json["true_place_lines_m"].push_back(plane_line_json(line));
  json["simulated"] = simulated_marks_json(report);
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
  json["seen"] = seen_json(report);
  json["found"] = found_json(report);
  json["heights"] = Json::array();  // distance, ground, flown
  for (const HeightSample& sample : report.heights.samples) {
    json["heights"].push_back({json_number(rounded(sample.distance_m, 7)), json_number(rounded(sample.ground_m, 5)),
                               json_number(rounded(sample.flown_m, 5))});
  }
  return json;
}

}  // namespace

std::string report_html(const Report& report) {
  Json data;
  data["report"] = report_json(report);
  data["display"] = display_json(report);
  data["what_if"] = report.what_if;
  data["sketch"] = report.sketch;
  const std::string verdict(verdict_name(report.verdict));
  return fill_template(
      page_assets::page_html(),
      {{"title", html_escape(report.title)},
       {"head", page_head_html(verdict + " – " + report.title, true)},
       {"appearance", std::string(page_assets::page_appearance_html())},
       {"leaflet_js", page_leaflet_js()},
       {"page_js", page_script({page_assets::page_base_js(),         page_assets::page_state_js(),
                                page_assets::page_ground_js(),       page_assets::page_canvas_js(),
                                page_assets::page_grid_js(),         page_assets::page_map_js(),
                                page_assets::page_tile_js(),         page_assets::page_panel_js(),
                                page_assets::page_curve_js(),        page_assets::page_chart_js(),
                                page_assets::page_seen_js(),         page_assets::page_ins_js(),
                                page_assets::page_flight_js(),       page_assets::page_verdict_js(),
                                page_assets::page_about_js(),        page_assets::page_what_if_js(),
                                page_assets::page_geodesic_js(),     page_assets::page_sketch_flight_js(),
                                page_assets::page_sketch_files_js(), page_assets::page_sketch_read_js(),
                                page_assets::page_sketch_js(),       page_assets::page_fold_js(),
                                page_assets::page_start_js()})},
       {"map_row", map_row_html("Map of the corridor", map_layers(report))},
       {"sketch",
        sketch_section_html(
            "A budget, sparse areas and stretches with GNSS of the plan do not count here. prepare cuts its tiles "
            "along the new line and takes what ground usually shows from there, so its P differs by some "
            "hundredths; it knows tiles beside this corridor, too.")},
       {"data", script_json(data)},
       {"verdict_status", std::string(status_name(report.verdict))},
       {"verdict_word", verdict},
       {"verdict_rest", html_escape(report.verdict_detail)},
       {"answer", html_escape(answer_text(report))},
       {"title_block", title_block_html(report.title_block)},
       {"figures", figures_html(report)},
       {"assumptions", html_escape(report.assumptions)},
       {"places_heading", places_heading(report)},
       {"places", places_html(report)},
       {"evidence", evidence_html(report)},
       {"simulation", simulation_html(report)},
       {"envelope", report.envelope ? envelope_html(*report.envelope) : ""},
       {"replay", report.replay ? replay_html(*report.replay) : ""},
       {"what_if_simulated",
        !report.simulations.empty() ? " Simulated flights are not flown again, and do not enter." : ""},
       {"simulated_key", simulated_key_html(report)},
       {"measured", kind_mark(NumberKind::kMeasured)},
       {"simulated", kind_mark(NumberKind::kSimulated)},
       {"modelled", kind_mark(NumberKind::kModelled)},
       {"evaluation", evaluation_html(report)},
       {"ageing", ageing_html(report.ageing)},
       {"imagery_age", imagery_age_html(report.imagery_age)},
       {"landmarks", report.landmarks ? landmark_html(*report.landmarks) : ""},
       {"denied_key", denied_key_html(report) + lost_key_html(report)},
       {"chart", strip_chart_svg(report)},
       {"heights", height_profile_svg(report.heights, chart_distance_m(report))},
       {"waypoints", waypoints_html(report.waypoints)},
       {"quality", quality_rows_html(report.quality)},
       {"legs", legs_html(report)},
       {"gaps", gaps_html(report)},
       {"imagery", imagery_html(report.imagery)},
       {"inputs", inputs_html(report.inputs)},
       {"grid", grid_html(report)},
       {"parameters", parameters_section_html(report.parameters)},
       {"warnings", list_html(report.warnings)},
       {"notes", list_html(report.notes)},
       {"route",
        html_escape(report.route_name + " (" + report.route_format + "), " + length_text(report.route_length_m))},
       {"version", html_escape(report.software_version)}});
}

}  // namespace pilotage
