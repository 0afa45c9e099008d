#include "pilotage/select/leg_advice.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pilotage/base/parallel.h"
#include "pilotage/base/text.h"
#include "pilotage/mission/tile_under.h"

namespace pilotage {
namespace {

struct LegSamples {
  std::size_t begin = 0;
  std::size_t end = 0;
};

std::vector<LegSamples> samples_of_legs(const Mission& mission) {
  std::vector<LegSamples> legs(mission.flight.route.legs.size());
  for (std::size_t i = 0; i < mission.flight.samples.size(); ++i) {
    LegSamples& leg = legs[static_cast<std::size_t>(mission.flight.samples[i].leg)];
    if (leg.end == 0) leg.begin = i;
    leg.end = i + 1;
  }
  return legs;
}

// The sample moved to the right of the track (negative: to the left), on the mission grid. The direction is that of the
// leg's neighbouring samples, so the grid's convergence does not matter.
FlightSample moved_aside(const Mission& mission, const LegSamples& leg, std::size_t i, double right_m) {
  FlightSample sample = mission.flight.samples[i];
  const std::size_t a = i > leg.begin ? i - 1 : i;
  const std::size_t b = i + 1 < leg.end ? i + 1 : i;
  const Eigen::Vector2d along = mission.flight.samples[b].point_map_m - mission.flight.samples[a].point_map_m;
  if (along.norm() > 0) sample.point_map_m += right_m / along.norm() * Eigen::Vector2d(along.y(), -along.x());
  return sample;
}

// One stride of the coarsest level that the leg uses.
double stride_m(const Mission& mission, const LegSamples& leg) {
  double stride = 0;
  for (std::size_t i = leg.begin; i < leg.end; ++i) {
    const int level = mission.flight.samples[i].level;
    if (level == FlightSample::kNoLevel) continue;
    const TileMatrix& matrix = mission.ground.levels[static_cast<std::size_t>(level)].matrix;
    stride = std::max(stride, matrix.stride_px * std::abs(matrix.map_from_pixel.x_per_col));
  }
  return stride;
}

}  // namespace

std::vector<LegAdvice> advise_legs(const FlightPath& path, const RouteSurvival& survival,
                                   const TileChances& tile_chances, const AdviceOptions& options) {
  const Mission& mission = *path.mission;
  const std::vector<std::optional<std::size_t>> tiles = tiles_under_route(mission);
  const std::vector<LegSamples> legs = samples_of_legs(mission);
  std::vector<LegAdvice> result;
  for (std::size_t leg = 0; leg < legs.size(); ++leg) {
    const double p_before = survival.leg_p_within_limit[leg];
    if (!(p_before < options.min_leg_probability)) continue;
    const LegSamples samples = legs[leg];
    double entering = 0;
    const auto weight = [&](std::size_t k) {
      return tile_chances.levels[path.cases[k].level].weight * path.cases[k].weight;
    };
    for (std::size_t k = 0; k < path.cases.size(); ++k) {
      for (const FlightBranch& branch : survival.leg_entries[leg][k]) entering += weight(k) * branch.probability;
    }
    LegAdvice best{static_cast<int>(leg), AdviceSide::kNone, 0, p_before, p_before, false};
    const auto try_line = [&](double right_m) {
      auto moved = tiles;
      std::vector<FlightSample> line = mission.flight.samples;
      for (std::size_t i = samples.begin; i < samples.end; ++i) {
        line[i] = moved_aside(mission, samples, i, right_m);
        moved[i] = tile_under(mission, line[i]);
      }
      const auto attempts = fix_attempts(mission, moved, options.tries.interval_s, options.tries.decorrelation_m);
      const auto levels = level_chances(mission, line, attempts, tile_chances, options.tries);
      std::vector<double> staying_in(path.cases.size());
      parallel_for(path.cases.size(), options.threads, [&](std::size_t k, int) {
        const FlightCase& one = path.cases[k];
        const FlightStretch stretch = fly_stretch(path, one.steps, levels[one.level].chances, samples.begin,
                                                  samples.end, survival.leg_entries[leg][k]);
        staying_in[k] = weight(k) * stretch.p_within_limit.back();
      });
      const double staying = std::accumulate(staying_in.begin(), staying_in.end(), 0.0);
      const double p_after = std::min(1.0, staying / entering);
      if (p_after <= best.p_after) return;
      best.p_after = p_after;
      best.offset_m = std::abs(right_m);
      best.side = right_m == 0 ? AdviceSide::kNone : right_m < 0 ? AdviceSide::kLeft : AdviceSide::kRight;
      best.good = p_after >= options.min_leg_probability;
    };
    try_line(0);
    const double stride = stride_m(mission, legs[leg]);
    for (double offset_m = stride; stride > 0 && offset_m <= mission.flight.corridor_half_width_m; offset_m += stride) {
      if (!best.good) try_line(-offset_m);
      if (!best.good) try_line(offset_m);
    }
    result.push_back(best);
  }
  return result;
}

std::string advice_text(const LegAdvice& advice, double min_leg_probability, double half_width_m) {
  const std::string leg = "leg " + std::to_string(advice.leg + 1) +
                          " stays within the limit with P = " + probability_text(advice.p_before) +
                          " (asked for: " + probability_text(min_leg_probability) + "); ";
  if (advice.p_after <= advice.p_before) {
    return leg + "no parallel line up to " + format_fixed(half_width_m, 0) +
           " m aside, where tiles are scored, is better";
  }
  const std::string line = advice.side == AdviceSide::kNone
                               ? "with every tile stored that can be matched it has "
                               : "flown " + format_fixed(advice.offset_m, 0) + " m to the " +
                                     (advice.side == AdviceSide::kLeft ? "left" : "right") + " it has ";
  if (advice.good) return leg + line + probability_text(advice.p_after);
  return leg + "no parallel line up to " + format_fixed(half_width_m, 0) +
         " m aside, where tiles are scored, makes it good; the best: " + line + probability_text(advice.p_after);
}

}  // namespace pilotage
