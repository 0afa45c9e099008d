#include "pilotage/report/report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "pilotage/base/error.h"
#include "pilotage/base/utf8.h"
#include "pilotage/base/wording.h"
#include "pilotage/ground/imagery_months.h"
#include "pilotage/ground/score_table.h"
#include "pilotage/ins/drift.h"
#include "pilotage/ins/ins_error_model.h"
#include "pilotage/matchability/reasons.h"
#include "pilotage/report/autopilot_sheet.h"
#include "pilotage/report/display.h"
#include "pilotage/report/error_profile.h"
#include "pilotage/report/page_text.h"
#include "pilotage/report/sampled_route.h"
#include "pilotage/report/sketch.h"
#include "pilotage/report/title_block.h"
#include "pilotage/report/what_if.h"
#include "pilotage/verdict/disagreement.h"
#include "pilotage/verdict/map_holds.h"
#include "pilotage/verdict/verdict.h"

namespace pilotage {
namespace {

std::vector<std::string> valid_texts(const std::vector<std::string>& texts) {
  std::vector<std::string> result;
  for (const std::string& text : texts) result.push_back(valid_utf8(text));
  return result;
}

void check_route(const ReportInput& input) {
  const Route& route = input.mission.flight.route;
  const int vertices = static_cast<int>(route.vertices.size());
  const int legs = static_cast<int>(route.legs.size());
  const auto check_leg = [&](int leg, const std::string& what) {
    if (leg >= 0 && leg < legs) return;
    throw DataError("report: " + what + " names leg " + std::to_string(leg) + ", the route has " +
                    std::to_string(legs) + " legs");
  };
  for (const RouteLeg& leg : route.legs) {
    if (leg.from >= 0 && leg.from < vertices && leg.to >= 0 && leg.to < vertices) continue;
    throw DataError("report: a leg of the route joins vertices " + std::to_string(leg.from) + " and " +
                    std::to_string(leg.to) + ", the route has " + std::to_string(vertices) + " vertices");
  }
  double last_m = -std::numeric_limits<double>::infinity();
  for (const FlightSample& sample : input.mission.flight.samples) {
    check_leg(sample.leg, "a sample of the route");
    if (!(sample.distance_m >= last_m))
      throw DataError("report: the samples of the route are not in order of distance");
    last_m = sample.distance_m;
  }
  for (const LegStatus& leg : input.selection.legs) check_leg(leg.leg, "the selection");
  for (const RouteGap& gap : input.selection.gaps) check_leg(gap.leg, "a gap of the selection");
}

void check_imagery(const Raster& imagery) {
  if (imagery.pixels.empty()) return;
  if (imagery.pixels.type() != CV_8UC3 && imagery.pixels.type() != CV_8UC1) {
    throw DataError("report: the overview of the imagery has OpenCV type " + std::to_string(imagery.pixels.type()) +
                    ", allowed are CV_8UC3 and CV_8UC1");
  }
  if (imagery.valid.size() != imagery.pixels.size() || imagery.valid.type() != CV_8UC1) {
    throw DataError("report: the mask of the imagery's overview does not fit its pixels");
  }
  if (!(std::abs(imagery.map_from_pixel.determinant()) > 0)) {
    throw DataError("report: the overview of the imagery has no place (its transform cannot be inverted)");
  }
}

void check_pictures(const ReportInput& input) {
  const TilePictures& pictures = input.pictures;
  if (pictures.sheet.empty() || input.mission.ground.tiles.empty()) return;
  const cv::Rect sheet({0, 0}, pictures.sheet.size());
  const bool whole =
      pictures.sheet.type() == CV_8UC3 && pictures.side_px > 0 && pictures.columns > 0 &&
      pictures.columns * pictures.side_px <= sheet.width &&
      (pictures.place(input.mission.ground.tiles.size() - 1) & sheet).area() == pictures.side_px * pictures.side_px;
  if (!whole) throw DataError("report: the sheet of pictures does not hold one for each tile of the plan");
}

// Why the selection did not store a tile that has scores; `kept` are the words for what it is worth.
std::string left_out_text(const ReportTile& tile, const Selection& selection, const std::string& worth) {
  if (!selection.left_out) return "The selection left it out: " + worth + ".";
  const std::vector<std::int64_t>& beyond = selection.left_out->beyond_budget;
  if (std::binary_search(beyond.begin(), beyond.end(), tile.tile.tile_id)) {
    return "It does not fit into the size budget: " + worth + ".";
  }
  return "It is not among the fewest areas that were asked for (sparse): " + worth + ".";
}

std::string reason_for(const ReportTile& tile, const Selection& selection) {
  if (tile.selected) return "";
  if (tile.score.status == TileStatus::kTooLittleGround) {
    return "Too little ground: the imagery covers " + percent_text(tile.score.valid_fraction) + " of it.";
  }
  if (tile.score.status == TileStatus::kFlat) return "Flat: all its pixels have the same gray value.";
  if (std::isfinite(tile.score.p_correct_fix)) {  // then it is what the selection judges by, not the margin
    const std::string worth = "its P(correct fix) is " + number_text(tile.score.p_correct_fix, 3);
    if (selection.left_out && tile.score.p_correct_fix < selection.left_out->min_p_correct_fix) {
      return "It is too seldom found: " + worth + ", at least " +
             number_text(selection.left_out->min_p_correct_fix, 3) + " is stored.";
    }
    return left_out_text(tile, selection, worth);
  }
  if (tile.score.degraded.margin <= 0) {
    return "A rival in its search area looks as much like it as itself (margin " +
           number_text(tile.score.degraded.margin, 3) + " on degraded copies).";
  }
  // As select judges it: by degraded copies, else by clean ones.
  const double margin = std::isnan(tile.score.degraded.margin) ? tile.score.clean.margin : tile.score.degraded.margin;
  const std::string worth = "its margin over every rival is " + number_text(margin, 3);
  if (selection.left_out && margin < selection.left_out->min_peak_margin) {
    return "It stands out too little: " + worth + ", at least " + number_text(selection.left_out->min_peak_margin, 3) +
           " is stored.";
  }
  return left_out_text(tile, selection, worth);
}

std::vector<ReportTile> report_tiles(const ReportInput& input) {
  const Ground& ground = input.mission.ground;
  const ScoreTable table(ground, input.scores);
  if (input.mission.flight.places.size() != ground.tiles.size()) {
    throw DataError("report: " + std::to_string(input.mission.flight.places.size()) + " places along the route, " +
                    std::to_string(ground.tiles.size()) + " tiles");
  }
  const auto oldest = ageing_imagery(ground);
  std::vector<ReportTile> tiles;
  for (std::size_t i = 0; i < ground.tiles.size(); ++i) {
    tiles.push_back({ground.tiles[i], input.mission.flight.places[i], table.scores[i], false, "", "",
                     half_found_until(oldest, table.scores[i])});
  }
  for (const std::int64_t tile_id : input.selection.tile_ids) {
    ReportTile& tile = tiles[tile_index(ground, tile_id, "report: the selection")];
    if (tile.selected) throw DataError("report: tile " + std::to_string(tile_id) + " is a duplicate in the selection");
    tile.selected = true;
  }
  for (ReportTile& tile : tiles) {
    tile.reason = reason_for(tile, input.selection);
    tile.reasons = reasons_text(tile_reasons(tile.score, reason_context(ground.crs, ground.level_of(tile.tile))));
  }
  return tiles;
}

std::vector<ReportGap> place_gaps(const ReportInput& input) {
  std::vector<ReportGap> gaps;
  for (const RouteGap& gap : input.selection.gaps) {
    ReportGap placed;
    placed.gap = gap;
    placed.length_m = gap.to_distance_m - gap.from_distance_m;
    placed.speed_mps = gap.duration_s > 0 ? placed.length_m / gap.duration_s : std::numeric_limits<double>::quiet_NaN();
    placed.from = route_point_at(input.mission.flight.samples, gap.from_distance_m);
    placed.to = route_point_at(input.mission.flight.samples, gap.to_distance_m);
    placed.quality = judge_gap(gap, input.selection);
    gaps.push_back(placed);
  }
  return gaps;
}

std::vector<ReportLeg> place_legs(const ReportInput& input) {
  const Route& route = input.mission.flight.route;
  const bool numbered = has_item_numbers(route);
  std::map<int, double> starts_m;
  for (const FlightSample& sample : input.mission.flight.samples) starts_m.try_emplace(sample.leg, sample.distance_m);
  std::vector<ReportLeg> legs;
  for (const LegStatus& status : input.selection.legs) {
    const RouteLeg& leg = route.legs[static_cast<std::size_t>(status.leg)];
    ReportLeg placed;
    placed.status = status;
    const auto start = starts_m.find(status.leg);
    placed.from_distance_m = start != starts_m.end() ? start->second : std::numeric_limits<double>::quiet_NaN();
    placed.from = route.vertices[static_cast<std::size_t>(leg.from)].point;
    placed.to = route.vertices[static_cast<std::size_t>(leg.to)].point;
    if (numbered) {
      placed.from_item = route.vertices[static_cast<std::size_t>(leg.from)].source_item;
      placed.to_item = route.vertices[static_cast<std::size_t>(leg.to)].source_item;
    }
    placed.quality = judge_leg(status, input.selection);
    legs.push_back(placed);
  }
  return legs;
}

// Worst first: by probability where there is one; then unknown errors, then the largest; equal ones in the order of
// flight.
std::vector<int> rank_legs(const std::vector<ReportLeg>& legs) {
  std::vector<int> order;
  for (std::size_t i = 0; i < legs.size(); ++i) order.push_back(static_cast<int>(i));
  const auto badness = [&](int i) {
    const LegStatus& status = legs[static_cast<std::size_t>(i)].status;
    // What no flight reaches within the limit is not where flights are lost.
    const double p_excess = std::isnan(status.p_within_limit) ? 0 : 1 - status.p_within_limit;
    return std::pair(p_excess,
                     std::isnan(status.max_error_m) ? std::numeric_limits<double>::infinity() : status.max_error_m);
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return badness(a) > badness(b); });
  order.resize(std::min<std::size_t>(order.size(), 10));
  return order;
}

// As the page shows it: from the worst point on where GNSS may be lost anywhere.
std::vector<DeniedStretch> denied_stretches(const ReportInput& input) {
  const std::vector<FlightSample>& samples = input.mission.flight.samples;
  if (!input.selection.loss_anywhere || samples.empty()) return input.mission.flight.denied.stretches;
  const LossAnywhere& loss = *input.selection.loss_anywhere;
  return {{loss.points[loss.worst].distance_m, samples.back().distance_m}};
}

InertialReach inertial_reach(const ReportInput& input) {
  InertialReach reach;
  const Flight& flight = input.mission.flight;
  const double limit_m = input.selection.max_error_m;
  if (flight.samples.empty() || !(flight.samples.front().speed_mps > 0) || !(limit_m > 0)) return reach;
  const InsErrorModel model = make_error_model(flight.ins, flight.conditions);
  reach.speed_mps = flight.samples.front().speed_mps;
  const auto reach_s = [&](double start_sigma_m) {
    return longest_bridgeable_gap_s(model, reach.speed_mps, limit_m, model.sigma_multiple, start_sigma_m);
  };
  reach.from_start_s = reach_s(model.start_sigma_m);
  reach.after_fix_s = reach_s(model.fixed_position_sigma_m());
  return reach;
}

void add_landmarks(const Mission& mission, const MapLandmarks& landmarks, Report& report) {
  std::vector<double> p_fix;
  for (const ReportLeg& leg : report.legs) p_fix.push_back(leg.status.p_fix);
  report.landmarks = landmark_note(mission, landmarks, p_fix);
  for (std::size_t i = 0; i < report.tiles.size(); ++i) report.tiles[i].p_landmark_fix = report.landmarks->p_fix[i];
}

}  // namespace

Report make_report(const ReportInput& input) {
  check_route(input);
  check_imagery(input.imagery);
  check_pictures(input);
  const Mission& mission = input.mission;
  const Selection& selection = input.selection;
  const JudgedPlan plan = judged_plan(input);
  Report report;
  report.tiles = report_tiles(input);
  report.quality = quality_rows(plan);
  report.verdict = verdict_of(report.quality);
  report.headline = valid_utf8(headline(report.quality, selection));
  report.verdict_detail = valid_utf8(verdict_detail(report.verdict, report.quality, selection));
  report.verdict_text = valid_utf8(verdict_sentence(report.verdict, report.quality, selection));
  report.assumptions = assumptions_line(mission, selection);
  for (QualityRow& row : report.quality) row.value = valid_utf8(row.value);

  report.route_name = valid_utf8(mission.flight.route.name);
  report.route_format = valid_utf8(mission.flight.route.format);
  report.title = valid_utf8(input.title.empty() ? mission.flight.route.name : input.title);
  report.title_block = title_block(input);
  report.software_version = valid_utf8(input.software_version);
  report.route_length_m = route_length_m(mission.flight.route);
  report.matchable_fraction = selection.matchable_fraction;
  report.largest_error_m = largest_error_m(selection);
  report.max_error_m = selection.max_error_m;
  report.sigma_multiple = selection.sigma_multiple;
  report.heights = height_profile(mission.flight);
  report.waypoints = waypoints(mission.flight);
  report.legs = place_legs(input);
  report.worst_legs = rank_legs(report.legs);
  if (input.landmarks) add_landmarks(mission, *input.landmarks, report);
  report.gaps = place_gaps(input);
  report.probability = selection.probability;
  report.denied = denied_stretches(input);
  report.loss_anywhere = selection.loss_anywhere;
  report.inertial_reach = inertial_reach(input);
  report.fixes = fix_stretches(selection.error_profile);
  report.error_profile = thin_profile(selection.error_profile, 2000);

  for (const Measure* measure : heat_maps()) report.measures.push_back(measure_scale(*measure, input.scores));
  report.selected_tiles = static_cast<std::int64_t>(selection.tile_ids.size());
  report.estimated_bytes = selection.estimated_bytes;

  report.crs_name = mission.ground.crs.empty() ? "" : valid_utf8(mission.ground.crs.name());
  report.max_scale_distortion = mission.ground.max_scale_distortion;
  report.corridor_half_width_m = mission.flight.corridor_half_width_m;
  report.footprint_width_m = mission.flight.footprint_width_m;
  report.footprint_height_m = mission.flight.footprint_height_m;
  report.levels = mission.ground.levels;
  for (const ImageryDataset& imagery : mission.ground.imagery.datasets) {
    ImageryDataset& copy = report.imagery.emplace_back(imagery);
    copy.dataset = name_as_utf8(imagery.dataset);
    copy.crs = valid_utf8(imagery.crs);
    copy.acquired = valid_utf8(imagery.acquired);
  }
  report.elevation = name_as_utf8(mission.ground.elevation);
  for (const InputFile& file : input.inputs) {
    report.inputs.push_back({valid_utf8(file.role),
                             valid_utf8(file.name),
                             valid_utf8(file.date),
                             valid_utf8(file.digest),
                             {valid_utf8(file.licence.terms), valid_utf8(file.licence.attribution)}});
  }
  report.parameters = valid_utf8_json(input.parameters);
  report.warnings = valid_texts(mission.warnings);
  if (const std::string warning = disagreement_warning(plan); !warning.empty()) report.warnings.push_back(warning);
  if (const auto& autopilot = mission.flight.autopilot) {
    for (std::string& warning : autopilot_warnings(input, report, *autopilot)) {
      report.warnings.push_back(std::move(warning));
    }
  }
  report.notes = valid_texts(mission.flight.route.notes);
  for (const auto* more : {&selection.notes, &input.assumptions}) {
    for (const std::string& text : *more) report.notes.push_back(valid_utf8(text));
  }
  report.evaluation = input.evaluation;
  report.simulations = input.simulations;
  report.envelope = input.envelope;
  report.replay = input.replay;
  for (Simulation& simulation : report.simulations) simulation.not_simulated = valid_texts(simulation.not_simulated);
  report.imagery_age = imagery_age(mission);
  report.ageing = map_ageing(mission, selection, report.tiles);
  report.weak_places = weak_places(report, selection.advice);
  report.what_if = what_if_data(input, report.quality);
  report.sketch = valid_utf8_json(sketch_data(input.mission, input.scores, input.selection,
                                              sketch_mission(input.parameters, input.mission.ground)));
  report.seen = input.seen;
  report.seen.sheet.release();
  report.display = make_display(input, report);
  return report;
}

}  // namespace pilotage
