#include "pilotage/simulate/simulated_mission.h"

#include <algorithm>
#include <cmath>

#include "pilotage/base/angle.h"
#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/ground/place_level.h"
#include "pilotage/ground/tile_chances.h"
#include "pilotage/select/planned_flight.h"

namespace pilotage {
namespace {

SimulatedMission::TileChance tile_chance(const TileScores& score, bool stored) {
  const double p = std::isnan(score.p_correct_fix) ? 1 : score.p_correct_fix;  // as the plan counts it
  const double sigma = score.level_sigma > 0 ? score.level_sigma : 0;
  return {stored, logit_of_p(p, sigma), sigma, p};
}

/// Grid axes of east and north: the way to the next sample is known in both.
Eigen::Matrix2d axes_at(const std::vector<FlightSample>& samples, std::size_t i) {
  const auto distinct = [&](std::size_t a, std::size_t b) {
    return (samples[b].point_map_m - samples[a].point_map_m).norm() > 1e-3;
  };
  std::size_t from = i;
  std::size_t to = i;
  if (i + 1 < samples.size() && distinct(i, i + 1) && samples[i + 1].leg == samples[i].leg) {
    to = i + 1;
  } else if (i > 0 && distinct(i - 1, i) && samples[i - 1].leg == samples[i].leg) {
    from = i - 1;
  } else {
    return Eigen::Matrix2d::Identity();
  }
  const Eigen::Vector2d along = (samples[to].point_map_m - samples[from].point_map_m).normalized();
  const double azimuth_rad = samples[from].azimuth_deg * kRadPerDeg;
  const Eigen::Vector2d flown(std::sin(azimuth_rad), std::cos(azimuth_rad));
  Eigen::Matrix2d grid;
  grid << along, Eigen::Vector2d(along.y(), -along.x());
  Eigen::Matrix2d east_north;
  east_north << flown, Eigen::Vector2d(flown.y(), -flown.x());
  return grid * east_north.transpose();
}

/// From 100 m on, in steps of 1, 2 and 5 of a power of ten, so that many flights leave room for their marks.
double mark_step_m(double route_m, std::int64_t flights) {
  constexpr double kMostErrors = 2e7;
  const double most = std::clamp(kMostErrors / static_cast<double>(flights), 10.0, 100.0);
  for (double power_m = 100;; power_m *= 10) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      if (route_m / (factor * power_m) <= most) return factor * power_m;
    }
  }
}

GnssAvailability availability(const Mission& mission, const Selection& selection, const SimulateOptions& options) {
  const double end_m = mission.flight.samples.back().distance_m;
  if (options.lost_from_km) {
    const double lost_m = *options.lost_from_km * 1000;
    if (lost_m >= end_m) {
      throw UsageError("lost_from_km = " + format_number(*options.lost_from_km) + " is not on the route, which is " +
                       format_fixed(end_m / 1000, 2) + " km long");
    }
    return gnss_lost_at(mission.flight, lost_m);
  }
  return planned_gnss(mission, selection);
}

FlightConditions conditions_flown(FlightConditions conditions, const SimulateOptions& options) {
  conditions.wind_sigma_mps = options.wind_sigma_mps.value_or(conditions.wind_sigma_mps);
  conditions.map_sigma_m = options.map_sigma_m ? options.map_sigma_m : conditions.map_sigma_m;
  conditions.map_correlation_m = options.map_correlation_m ? options.map_correlation_m : conditions.map_correlation_m;
  conditions.dropped_frames = options.dropped_frames.value_or(conditions.dropped_frames);
  return conditions;
}

}  // namespace

SimulatedMission make_simulated_mission(const Mission& mission, const std::vector<TileScores>& scores,
                                        const Selection& selection, const SimulateOptions& options, int threads) {
  if (!selection.tries) {
    throw DataError(
        "the selection does not say when fixes are tried; `pilotage select` or `prepare` writes one that does");
  }
  SimulatedMission simulated;
  simulated.tries = *selection.tries;
  const std::vector<bool> stored = stored_tiles(mission, selection);
  const TileChances chances = tile_chances(scores, stored);
  simulated.path = make_flight_path(mission, selection.max_error_m, chances.levels.size());
  simulated.path.gnss = availability(mission, selection, options);
  for (std::size_t i = 0; i < scores.size(); ++i) simulated.tiles.push_back(tile_chance(scores[i], stored[i]));
  simulated.attempts =
      fix_attempts(mission, tiles_under_route(mission), selection.tries->interval_s, selection.tries->decorrelation_m);
  const std::vector<FlightSample>& samples = mission.flight.samples;
  for (std::size_t i = 0; i < samples.size(); ++i) simulated.map_from_en.push_back(axes_at(samples, i));
  const double end_m = samples.back().distance_m;
  const double step_m = mark_step_m(end_m, options.flights);
  for (int i = 1; i * step_m < end_m; ++i) simulated.marks_m.push_back(i * step_m);
  simulated.marks_m.push_back(end_m);
  const std::vector<bool>& had = simulated.path.gnss.at_sample;
  const auto lost = static_cast<std::size_t>(std::find(had.begin(), had.end(), false) - had.begin());
  simulated.lost_from_m = lost < samples.size() ? samples[lost].distance_m : end_m;

  const RouteSurvival planned = predict_survival(
      simulated.path, level_chances(mission, samples, simulated.attempts, chances, *selection.tries), threads);
  simulated.planned_p = planned.p_within_limit.back();
  simulated.planned_leg_p = planned.leg_p_within_limit;
  simulated.conditions = conditions_flown(mission.flight.conditions, options);
  simulated.path.model = make_error_model(mission.flight.ins, simulated.conditions);
  return simulated;
}

double p_at_level(const SimulatedMission::TileChance& tile, double level_z) {
  return tile.stored ? logistic(tile.logit + tile.level_sigma * level_z) : 0;
}

}  // namespace pilotage
