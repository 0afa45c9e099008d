#include "pilotage/report/explain.h"

#include <algorithm>
#include <cmath>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/base/wording.h"
#include "pilotage/ground/measures.h"
#include "pilotage/matchability/reason_words.h"
#include "pilotage/report/report.h"
#include "pilotage/report/stretch_reasons.h"
#include "pilotage/report/tile_fields.h"
#include "pilotage/verdict/evidence.h"
#include "pilotage/verdict/tile_class.h"

namespace pilotage {
namespace {

std::string tiles_text(const Report& report, const ReportLeg& leg) {
  const double to_m = leg.from_distance_m + leg.status.length_m;
  std::int64_t all = 0;
  std::int64_t chosen = 0;
  for (const ReportTile& tile : report.tiles) {
    if (tile.place.distance_m < leg.from_distance_m || tile.place.distance_m > to_m) continue;
    ++all;
    if (tile.selected) ++chosen;
  }
  return percent_text(leg.status.matchable_fraction) +
         " of its length lies over stored tiles: " + std::to_string(chosen) + " of the " + std::to_string(all) +
         " tiles along it are stored.";
}

std::string probability_lines(const Report& report, const LegStatus& leg) {
  if (!report.probability) return "No tile has a P of a correct fix, so the leg has no probability.";
  if (std::isnan(leg.p_within_limit)) return "By the model no flight reaches it within the limit.";
  return "Modelled: of the flights that reach it within the limit a share of " + probability_text(leg.p_within_limit) +
         " stays within it, and " + probability_text(leg.p_fix) + " get a correct fix on it.";
}

void add_gaps(const Report& report, const ReportLeg& leg, std::vector<std::string>& lines) {
  const double to_m = leg.from_distance_m + leg.status.length_m;
  for (const ReportGap& entry : report.gaps) {
    const RouteGap& gap = entry.gap;
    if (gap.to_distance_m <= leg.from_distance_m || gap.from_distance_m >= to_m) continue;
    lines.push_back("No fix from " + where_text(report, gap.from_distance_m, gap.to_distance_m, gap.leg) + ": " +
                    gap_text(gap) + "; predicted error at its end " + comparison_text(gap.error_m, report.max_error_m) +
                    ": " + std::string(status_name(entry.quality)) + ".");
  }
}

std::string measure_line(const Measure& measure, double value) {
  const std::string unit = shown_unit(measure);
  return "  " + measure.label + ": " + format_number(rounded(value, 4)) +
         (unit.empty() || unit == "1" ? "" : " " + unit);
}

}  // namespace

std::string leg_items_text(const ReportLeg& leg) {
  const auto number = [](int item) { return item < 0 ? std::string("–") : std::to_string(item); };
  return leg.from_item < 0 && leg.to_item < 0 ? "–" : number(leg.from_item) + " → " + number(leg.to_item);
}

std::vector<std::string> explain_leg(const Report& report, const std::vector<LegAdvice>& advice, std::int64_t number) {
  if (number < 1 || number > std::ssize(report.legs)) {
    throw UsageError("explain = \"leg " + std::to_string(number) + "\": the route has legs 1 to " +
                     std::to_string(report.legs.size()));
  }
  const ReportLeg& leg = report.legs[static_cast<std::size_t>(number - 1)];
  const double to_m = leg.from_distance_m + leg.status.length_m;
  const bool has_items = leg.from_item >= 0 || leg.to_item >= 0;
  std::vector<std::string> lines = {
      "Leg " + std::to_string(number) + (has_items ? " (items " + leg_items_text(leg) + ")" : "") + ", " +
          length_text(leg.from_distance_m) + " – " + length_text(to_m) +
          " along the route: " + std::string(status_name(leg.quality)) + ".",
      "Largest predicted error (" + format_fixed(report.sigma_multiple, 0) +
          "σ, modelled, where every fix comes): " + comparison_text(leg.status.max_error_m, report.max_error_m) + ".",
      probability_lines(report, leg.status), tiles_text(report, leg)};
  add_gaps(report, leg, lines);
  const bool lost = leg.status.within_limit && judge_error(leg.status.max_error_m, report.max_error_m) != leg.quality;
  const StretchReasons reasons = stretch_reasons(report, leg.from_distance_m, to_m, lost);
  if (leg.quality == QualityStatus::kGood) {
    if (leg.status.matchable_fraction < 1 && !reasons.why.empty()) lines.push_back("Not stored: " + reasons.why);
    return lines;
  }
  const std::string advised = advice_text(report, advice, leg.from_distance_m, to_m);
  if (!reasons.why.empty()) lines.push_back("Why: " + reasons.why);
  const std::string todo = advised.empty() ? reasons.todo : advised;
  if (!todo.empty()) lines.push_back("What to change: " + todo);
  return lines;
}

std::vector<std::string> explain_tile(const Report& report, std::int64_t tile_id) {
  const auto found = std::lower_bound(report.tiles.begin(), report.tiles.end(), tile_id,
                                      [](const ReportTile& tile, std::int64_t id) { return tile.tile.tile_id < id; });
  if (found == report.tiles.end() || found->tile.tile_id != tile_id) {
    throw UsageError("explain = \"tile " + std::to_string(tile_id) + "\": the plan has no such tile" +
                     (report.tiles.empty() ? ""
                                           : "; it has " + std::to_string(report.tiles.size()) + ", from " +
                                                 std::to_string(report.tiles.front().tile.tile_id) + " to " +
                                                 std::to_string(report.tiles.back().tile.tile_id)));
  }
  const ReportTile& tile = *found;
  std::vector<std::string> lines = {
      "Tile " + std::to_string(tile_id) + " (level " + std::to_string(tile.tile.level) + ", row " +
          std::to_string(tile.tile.row) + ", column " + std::to_string(tile.tile.column) + "), centre lon " +
          format_fixed(tile.tile.center.lon_deg, 7) + ", lat " + format_fixed(tile.tile.center.lat_deg, 7) + "; " +
          length_text(tile.place.distance_m) + " along the route, " + error_text(std::abs(tile.place.offset_m)) +
          " beside it.",
      tile.selected ? "It is stored in the map." : "It is not stored: " + tile.reason};
  if (const auto known = tile_class(tile.score)) {
    lines.push_back("Its ground is " + tile_classes()[static_cast<std::size_t>(*known)].name + " (" +
                    tile_classes_meaning() + ").");
  }
  if (!tile.reasons.empty()) lines.push_back("What speaks against it: " + tile.reasons);
  const ReasonCounts causes = count_reasons({&tile.score});
  if (!tile.selected && !causes.empty()) {
    lines.push_back("What to change: " + std::string(reason_words(causes.front().first).todo));
  }
  lines.emplace_back(
      "Measures (P is modelled from the others, \"degraded\" simulated, the rest measured on the imagery):");
  for (const Measure* measure : measures_by_group()) {
    const double value = measure->get(tile.score);
    if (std::isfinite(value)) lines.push_back(measure_line(*measure, value));
  }
  return lines;
}

std::vector<std::string> explain_verdict(const Report& report) {
  std::vector<std::string> lines = {std::string(verdict_name(report.verdict)) +
                                    " is the lowest of what decides. Evidence, strongest first:"};
  for (const std::string& line : evidence_lines(report.quality)) lines.push_back("  " + line);
  for (const QualityRow& row : report.quality) {
    if (!row.decides || row.status == QualityStatus::kGood) continue;
    lines.push_back(row.label + ": " + row.value + ": " + std::string(status_name(row.status)) + " (" + row.threshold +
                    ")");
    if (!row.advice.empty()) lines.push_back("  What to do: " + row.advice);
  }
  return lines;
}

std::vector<std::string> explain(const Report& report, const std::vector<LegAdvice>& advice, const std::string& what) {
  if (what == "verdict") return explain_verdict(report);
  const std::size_t space = std::min(what.find(' '), what.size());
  const std::string kind = what.substr(0, space);
  constexpr double kMostDigits = 1e15;  // whole numbers that a double holds
  const double number = parse_number(std::string_view(what).substr(std::min(space + 1, what.size()))).value_or(-1);
  if (number >= 0 && number < kMostDigits && std::floor(number) == number) {
    const auto whole = static_cast<std::int64_t>(number);
    if (kind == "leg") return explain_leg(report, advice, whole);
    if (kind == "tile") return explain_tile(report, whole);
  }
  throw UsageError("explain = \"" + what + "\": allowed are \"verdict\", \"leg NUMBER\" and \"tile ID\"");
}

}  // namespace pilotage
