#include "pilotage/reroute/judged_line.h"

#include <cmath>
#include <span>
#include <utility>

#include "pilotage/build_map/build_map.h"
#include "pilotage/geo/geodesic.h"
#include "pilotage/mission/flight_time.h"
#include "pilotage/score/score_ground.h"
#include "pilotage/select/select_tiles.h"
#include "pilotage/tile/plan_tiles.h"
#include "pilotage/verdict/verdict.h"

namespace pilotage {
namespace {

constexpr double kTurn_deg = 5;

double p_or_zero(const Selection& selection) {
  return selection.probability ? selection.probability->p_within_limit : 0;
}

}  // namespace

void judge(JudgedLine& line, const std::optional<Simulation>& simulation) {
  const std::span<const Simulation> simulations(simulation ? &*simulation : nullptr, simulation ? 1 : 0);
  const std::vector<QualityRow> rows = quality_rows({line.mission, line.scores, line.selection, simulations});
  line.status = verdict_of(rows);
  line.text = verdict_sentence(line.status, rows, line.selection);
  line.headline = headline(rows, line.selection);
  line.detail = verdict_detail(line.status, rows, line.selection);
}

bool is_safer(const JudgedLine& a, const JudgedLine& b) {
  if (a.status != b.status) return a.status < b.status;
  if (p_or_zero(a.selection) != p_or_zero(b.selection)) return p_or_zero(a.selection) > p_or_zero(b.selection);
  return largest_error_m(a.selection) < largest_error_m(b.selection);
}

RerouteLine figures_of(const JudgedLine& line, const NoFlyZones& zones) {
  RerouteLine figures;
  figures.verdict = line.status;
  figures.verdict_text = line.text;
  figures.headline = line.headline;
  figures.verdict_detail = line.detail;
  if (line.selection.probability) figures.p_within_limit = line.selection.probability->p_within_limit;
  figures.largest_error_m = largest_error_m(line.selection);
  figures.matchable_fraction = line.selection.matchable_fraction;
  const std::vector<FlightSample>& samples = line.mission.flight.samples;
  figures.length_m = route_length_m(line.mission.flight.route);
  figures.duration_s = flight_time_s(samples);
  const Route& route = line.mission.flight.route;
  for (std::size_t i = 0; i < route.legs.size(); ++i) {
    const GeodeticPoint from = route.vertices[static_cast<std::size_t>(route.legs[i].from)].point;
    const GeodeticPoint to = route.vertices[static_cast<std::size_t>(route.legs[i].to)].point;
    if (i == 0) figures.points.push_back(from);
    figures.points.push_back(to);
    if (i == 0) continue;
    const GeodeticPoint before = route.vertices[static_cast<std::size_t>(route.legs[i - 1].from)].point;
    const double turned_deg = std::abs(std::remainder(
        geodesic_between(from, to).start_azimuth_deg - geodesic_between(before, from).end_azimuth_deg, 360.0));
    figures.turned_deg += turned_deg;
    if (turned_deg > kTurn_deg) ++figures.turns;
  }
  figures.no_fly_m = forbidden_way(zones, samples).length_m;
  return figures;
}

JudgedLine judge_as_prepare(const PrepareOptions& options, const TileOptions& tile, const RerouteRun& run,
                            const Progress& progress) {
  JudgedLine line;
  line.mission = plan_tiles(tile, progress);
  GroundScores scored = score_ground(line.mission.ground, score_options_of(options), run.seed, run.threads, progress);
  line.scores = std::move(scored.scores);
  if (scored.second_epoch) {
    line.second_date = second_date_assumption(*scored.second_epoch, options.score.registration);
  }
  line.selection = select_tiles(line.mission, line.scores, stored_size(options.build, line.mission.ground),
                                options.select, run.threads);
  judge(line, fly_plan(line.mission, line.scores, line.selection, options, run.seed, run.threads, progress));
  return line;
}

}  // namespace pilotage
