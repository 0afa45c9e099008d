#include "pilotage/report/flight_notes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/markup.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"
#include "pilotage/base/wording.h"
#include "pilotage/mission/integrity.h"
#include "pilotage/mission/selection.h"
#include "pilotage/report/page_parts.h"

namespace pilotage {
namespace {

constexpr double kSameP = 1e-9;

using Json = nlohmann::ordered_json;

/// The object of a file that has `key`, which names its format.
Json read_note(const std::filesystem::path& path, const char* key, const char* command) {
  const std::string name = path.string();
  Json json = parse_json(name, read_file(path));
  if (json.is_object() && json.contains(key)) return json;
  throw DataError(name + ": is not what `pilotage " + command + "` writes");
}

std::string share_of_text(JsonObject rate) {
  const std::int64_t of = rate.integer("of", 0);
  if (of == 0) return "none";
  return std::to_string(rate.integer("count", 0)) + " of " + std::to_string(of) + ", " +
         probability_text(rate.number("rate")) + " [" + probability_text(rate.number("low")) + ", " +
         probability_text(rate.number("high")) + "]";
}

std::string metres_text(double length_m) {
  return std::isnan(length_m) ? "–" : format_fixed(length_m, 1) + " m";
}

std::string tries_text(JsonObject fixes) {
  const auto count = [&](const char* key) { return std::to_string(fixes.integer(key, 0)); };
  return "Of " + count("tries") + " tries " + count("right") + " gave a right fix, " + count("unjudged") +
         " one whose truth is not known, " + count("false_taken") + " a false one, " + count("missed") +
         " none over a stored tile; " + count("not_stored") + " were over ground that is not stored, " +
         count("off_line") + " beside the line's tile.";
}

FlownAgainstPlan read_flown(JsonObject& prediction, JsonObject fixes) {
  FlownAgainstPlan flown;
  JsonObject observed = prediction.object("observed");
  flown.fixes = observed.integer("count", 0);
  flown.tries = observed.integer("of", flown.fixes);
  flown.predicted = prediction.number_or_nan("predicted");
  flown.z = prediction.number_or_nan("large_z");
  flown.z_with_level = prediction.number_or_nan("large_z_with_level");
  flown.false_taken = fixes.integer("false_taken", 0);
  flown.without_right =
      std::max(flown.false_taken, fixes.integer("tries", 0) - fixes.integer("right", 0) - fixes.integer("unjudged", 0));
  return flown;
}

void read_prediction(JsonObject& replay, ReplayNote& note) {
  if (!replay.has_value("prediction")) return;
  JsonObject prediction = replay.object("prediction");
  note.flown = read_flown(prediction, replay.object("fixes"));
  note.sentences.push_back(
      "Over stored tiles, with priors that P is of: " + share_of_text(prediction.object("observed")) +
      " came as a fix, " + probability_text(prediction.number("predicted")) + " were predicted; " +
      signed_text(prediction.number_or_nan("large_z_with_level"), 2) +
      " standard deviations apart, with the level of the place that all tiles share (" +
      signed_text(prediction.number_or_nan("large_z"), 2) + " without).");
  NoteTable table{"P of the tiles below against what came of it", {"P", "Mean P", "Fixes, share"}, {}};
  for (JsonObject& bin : prediction.objects("reliability")) {
    table.rows.push_back({probability_text(bin.number("low_p")) + " to " + probability_text(bin.number("high_p")),
                          probability_text(bin.number("mean_p")), share_of_text(bin)});
  }
  note.tables.push_back(std::move(table));
}

void read_legs(JsonObject& replay, ReplayNote& note) {
  NoteTable table{
      "Legs",
      {"Leg", "P within the limit, planned", "Mean P of its tries", "Fixes, share", "Median error", "Largest error"},
      {}};
  for (JsonObject& leg : replay.objects("legs")) {
    table.rows.push_back(
        {"Leg " + std::to_string(leg.integer("leg", 1)), probability_text(leg.number_or_nan("planned_p")),
         probability_text(leg.number_or_nan("predicted")), share_of_text(leg.object("observed")),
         metres_text(leg.number_or_nan("median_error_m")), metres_text(leg.number_or_nan("largest_error_m"))});
  }
  if (!table.rows.empty()) note.tables.push_back(std::move(table));
}

void read_suspects(JsonObject contradictions, ReplayNote& note) {
  NoteTable table{"Tiles that were lost more often than their P lets expect",
                  {"Tile", "Latitude, longitude", "P", "Passes won", "Chance", "Refresh"},
                  {}};
  for (JsonObject& tile : contradictions.objects("suspects")) {
    table.rows.push_back({std::to_string(tile.integer("tile_id", 0)),
                          lat_lon({tile.number("center_lon_deg"), tile.number("center_lat_deg")}),
                          probability_text(tile.number("p")),
                          std::to_string(tile.integer("won", 0)) + " of " + std::to_string(tile.integer("passes", 0)),
                          format_fixed(tile.number("chance"), 4), tile.boolean("refresh") ? "yes" : "no"});
  }
  if (!table.rows.empty()) note.tables.push_back(std::move(table));
}

std::string inertial_text(JsonObject inertial) {
  const std::string grade = valid_utf8(inertial.text("grade"));
  const double factor = inertial.number_or_nan("factor");
  if (std::isnan(factor)) return "Inertial system (" + grade + "): " + valid_utf8(inertial.text("why_not"));
  const auto end = [](double number) {
    return std::isnan(number) ? std::string("not bounded") : format_fixed(number, 2);
  };
  return "The inertial system drifted between fixes like " + format_fixed(factor, 2) + " times its model (" + grade +
         "), 95 % interval " + end(inertial.number_or_nan("low")) + " to " + end(inertial.number_or_nan("high")) +
         ", by " + std::to_string(inertial.integer("innovations", 0)) +
         " gaps; errors of the fixes that their covariance does not hold enlarge it.";
}

std::string factor_title(const std::string& factor, const std::string& world) {
  const std::string where = world.empty() ? "the mission's own imagery, changed" : name_as_utf8(world);
  constexpr std::pair<const char*, const char*> kTitles[] = {
      {"planned", "As planned"},
      {"height_m", "Height above the ground (m)"},
      {"heading_deg", "Nose turned from the course (°)"},
      {"gsd_ratio", "Frame's pixels, times the planned ones"},
      {"attitude_error_deg", "Error of roll, pitch and yaw (°)"},
      {"position_error_m", "Error of the position told, each axis (m)"},
      {"fog_visibility_m", "Fog, visibility (m)"},
      {"cloud_cover", "Share of the frame behind clouds"},
      {"dark_stops", "Factors of two less light"},
      {"motion_blur_px", "Motion blur (px of the frame as rendered)"},
      {"lens_drops", "Drops on the lens"},
      {"jpeg_quality", "Quality of JPEG"}};
  for (const auto& [name, title] : kTitles) {
    if (factor == name) return std::string(title) + ", in " + where;
  }
  return valid_utf8(factor) + ", in " + where;
}

EnvelopeNote::Cell envelope_cell(JsonObject& json) {
  EnvelopeNote::Cell cell;
  const double value = json.number_or_nan("value");
  cell.value = std::isnan(value) ? "planned" : format_number(value);
  const std::int64_t frames = json.integer("frames", 0);
  const double p = json.number_or_nan("p_correct");
  cell.shade = std::isnan(p) ? 0 : std::clamp(p, 0.0, 1.0);
  cell.p = std::isnan(p) ? "–" : format_fixed(p, 2);
  const std::int64_t wrong = json.integer("false", 0);
  const bool says_error = wrong > 0 && json.has_value("largest_error_m");
  cell.said = std::to_string(json.integer("correct", 0)) + " correct and " + std::to_string(wrong) + " false" +
              (says_error ? " (off by up to " + error_text(json.number("largest_error_m")) + ")" : "") + " of " +
              std::to_string(frames) + " frames, " + format_fixed(json.number("p_correct_low"), 2) + " to " +
              format_fixed(json.number("p_correct_high"), 2);
  return cell;
}

std::string reach_text(JsonObject& margin, const char* key) {
  if (!margin.has_value(key)) return "not even at the planned height";
  const std::vector<double> reach_m = margin.numbers(key, 2);
  return "from " + format_fixed(reach_m[0], 0) + " to " + format_fixed(reach_m[1], 0) + " m";
}

std::string note_table_html(const NoteTable& table) {
  std::vector<std::string> heads;
  for (const std::string& column : table.columns) heads.push_back(html_escape(column));
  std::string rows;
  for (const std::vector<std::string>& row : table.rows) {
    rows += "<tr>" + heading_html(row.front());
    for (std::size_t i = 1; i < row.size(); ++i) rows += cell_html(table.columns[i], row[i]);
    rows += "</tr>\n";
  }
  return "  <h3>" + html_escape(table.title) + "</h3>\n" + table_html(table.title, heads, rows);
}

}  // namespace

ReplayNote read_replay_note(const std::filesystem::path& path) {
  const Json json = read_note(path, "pilotage_replay", "replay");
  JsonObject replay(json, path.string());
  ReplayNote note;
  note.file = path.string();
  if (replay.has_value("planned_p")) note.planned_p = replay.number("planned_p");
  note.sentences.push_back(tries_text(replay.object("fixes")));
  read_prediction(replay, note);
  if (replay.has_value("median_error_m")) {
    note.sentences.push_back("Errors of fixes: median " + metres_text(replay.number("median_error_m")) +
                             ", 95 of 100 below " + metres_text(replay.number_or_nan("p95_error_m")) + ".");
  }
  if (replay.has_value("integrity")) {
    const Integrity integrity = integrity_from_json(replay.object("integrity"));
    if (integrity.looked > 0) note.sentences.push_back(capitalized(integrity_text(integrity)) + ".");
  }
  if (replay.has_value("inertial")) note.sentences.push_back(inertial_text(replay.object("inertial")));
  read_legs(replay, note);
  read_suspects(replay.object("contradictions"), note);
  for (const std::string& sentence : replay.texts("notes")) note.notes.push_back(valid_utf8(sentence));
  return note;
}

EnvelopeNote read_envelope_note(const std::filesystem::path& path) {
  const Json json = read_note(path, "pilotage_envelope", "envelope");
  JsonObject envelope(json, path.string());
  EnvelopeNote note;
  note.file = path.string();
  const std::vector<std::string> worlds = envelope.texts("worlds");
  const auto world_of = [&](JsonObject& object) {
    return worlds[static_cast<std::size_t>(object.integer("world", 0, static_cast<std::int64_t>(worlds.size()) - 1))];
  };
  for (JsonObject& cell : envelope.objects("cells")) {
    const std::string title = factor_title(cell.text("factor"), world_of(cell));
    if (note.rows.empty() || note.rows.back().title != title) note.rows.push_back({title, {}});
    note.rows.back().cells.push_back(envelope_cell(cell));
  }
  for (JsonObject& margin : envelope.objects("height_margins")) {
    const std::string world = world_of(margin);
    note.sentences.push_back("Planned height " + format_fixed(envelope.number("planned_height_m"), 0) + " m, in " +
                             (world.empty() ? std::string("the mission's own imagery, changed") : name_as_utf8(world)) +
                             ": P of a right fix is surely above 0.5 " + reach_text(margin, "surely_above_half_m") +
                             ", and at least nine tenths of the planned one " +
                             reach_text(margin, "as_good_as_planned_m") + ".");
  }
  for (const std::string& sentence : envelope.texts("notes")) note.sentences.push_back(valid_utf8(sentence));
  return note;
}

void refuse_other_replay(const ReplayNote& replay, const Selection& selection) {
  if (!replay.planned_p || !selection.probability) return;
  const double here = selection.probability->p_within_limit;
  if (std::abs(*replay.planned_p - here) <= kSameP) return;
  throw DataError(replay.file + ": was held against a plan of P " + probability_text(*replay.planned_p) +
                  ", and here it is " + probability_text(here) + "; run `pilotage replay --plan` again");
}

std::string replay_html(const ReplayNote& note) {
  std::string html = "<section aria-labelledby=\"replay-heading\">\n  <h2 id=\"replay-heading\">Flown " +
                     kind_mark(NumberKind::kMeasured) + "</h2>\n";
  for (const std::string& sentence : note.sentences) html += "  <p>" + html_escape(sentence) + "</p>\n";
  for (const NoteTable& table : note.tables) html += note_table_html(table);
  if (!note.notes.empty())
    html += "  <h3>What was lost, left out or assumed</h3>\n  <ul>\n" + list_html(note.notes) + "  </ul>\n";
  return html + "</section>\n";
}

std::string envelope_html(const EnvelopeNote& note) {
  std::string html =
      "<section aria-labelledby=\"envelope-heading\">\n  <h2 id=\"envelope-heading\">How far the flight may leave its "
      "plan, and how bad its frames may be " +
      kind_mark(NumberKind::kSimulated) +
      "</h2>\n  <p class=\"small\">P of a right fix at the same places and with the same random numbers in every "
      "cell; dark is 1, blank 0; below it the 95 % interval.</p>\n";
  for (const EnvelopeNote::Row& row : note.rows) {
    html += "  <h3>" + html_escape(row.title) +
            "</h3>\n  <div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"" + html_escape(row.title) +
            "\"><table class=\"envelope\"><thead><tr>";
    for (const EnvelopeNote::Cell& cell : row.cells) html += "<th scope=\"col\">" + html_escape(cell.value) + "</th>";
    html += "</tr></thead><tbody><tr>";
    for (const EnvelopeNote::Cell& cell : row.cells) {
      html += "<td style=\"background:rgba(0,114,178," + format_fixed(0.75 * cell.shade, 3) + ")\"><b>" +
              html_escape(cell.p) + "</b><br><span class=\"small\">" + html_escape(cell.said) + "</span></td>";
    }
    html += "</tr></tbody></table></div>\n";
  }
  for (const std::string& sentence : note.sentences) html += "  <p>" + html_escape(sentence) + "</p>\n";
  return html + "</section>\n";
}

}  // namespace pilotage
