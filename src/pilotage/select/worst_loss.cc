#include "pilotage/select/worst_loss.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "pilotage/base/nan.h"
#include "pilotage/select/fix_attempts.h"
#include "pilotage/select/route_error.h"

namespace pilotage {
namespace {

constexpr std::size_t kSamplesFlownAfterLoss = 60'000;

// How many samples the flights from these on have together.
std::size_t samples_flown(const std::vector<std::size_t>& starts, std::size_t count) {
  std::size_t flown = 0;
  for (const std::size_t start : starts) flown += count - start;
  return flown;
}

std::vector<std::size_t> every(const std::vector<std::size_t>& starts, std::size_t step) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < starts.size(); i += step) kept.push_back(starts[i]);
  return kept;
}

// Every k-th with the smallest k that keeps the bound; the first alone when none does.
std::vector<std::size_t> within_bound(const std::vector<std::size_t>& starts, std::size_t count) {
  std::size_t step = 1;
  while (step < starts.size() && samples_flown(every(starts, step), count) > kSamplesFlownAfterLoss) ++step;
  return every(starts, step);
}

// P of the flight that loses GNSS at the sample to be within the limit at the route's end.
double p_after_loss(FlightPath& path, const std::vector<std::optional<std::size_t>>& tiles, const LossTries& tries,
                    std::size_t sample, double fix_interval_s) {
  const Mission& mission = *path.mission;
  const std::vector<FixAttempt> attempts =
      fix_attempts(mission, tiles_without_gnss(tiles, path.gnss), fix_interval_s, tries.decorrelation_m);
  const RouteChances chances = route_chances(attempts, tries.p_of_tile, tiles.size(), fix_interval_s);
  return fly_stretch(path, chances, sample, tiles.size(), first_branches(path, sample)).p_within_limit.back();
}

}  // namespace

std::vector<std::size_t> loss_samples(const Mission& mission) {
  const std::vector<FlightSample>& samples = mission.flight.samples;
  std::vector<std::size_t> all;
  std::vector<std::size_t> legs;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    all.push_back(i);
    if (i == 0 || samples[i].leg != samples[i - 1].leg) legs.push_back(i);
  }
  std::map<double, std::size_t> at;  // of two samples at one place, where the course changes, the second
  for (const auto& starts : {within_bound(all, samples.size()), within_bound(legs, samples.size())}) {
    for (std::size_t i : starts) {
      while (i + 1 < samples.size() && samples[i + 1].distance_m == samples[i].distance_m) ++i;
      at[samples[i].distance_m] = i;
    }
  }
  if (at.size() > 1) at.erase(samples.back().distance_m);
  std::vector<std::size_t> result;
  for (const auto& [distance_m, i] : at) result.push_back(i);
  return result;
}

LossAnywhere lose_gnss_anywhere(const Mission& mission, const std::vector<std::optional<std::size_t>>& tiles,
                                const std::vector<bool>& stored, const std::optional<LossTries>& tries,
                                double max_error_m, double fix_interval_s) {
  const std::vector<FlightSample>& samples = mission.flight.samples;
  std::optional<FlightPath> path;
  if (tries) path = *tries->path;
  LossAnywhere loss;
  for (const std::size_t sample : loss_samples(mission)) {
    const double distance_m = samples[sample].distance_m;
    const GnssAvailability gnss = gnss_lost_at(mission.flight, distance_m);
    LossPoint point{distance_m, samples[sample].leg, 0, kNaN};
    for (const ErrorSample& at : predict_route_error(mission, gnss, stored, max_error_m, fix_interval_s).profile) {
      point.max_error_m = std::max(point.max_error_m, at.error_m);
    }
    if (path) {
      path->gnss = gnss;
      point.p_within_limit = p_after_loss(*path, tiles, *tries, sample, fix_interval_s);
    }
    if (!loss.points.empty()) loss.step_m = std::max(loss.step_m, distance_m - loss.points.back().distance_m);
    loss.points.push_back(point);
  }
  loss.step_m = std::max(loss.step_m, samples.back().distance_m - loss.points.back().distance_m);
  const auto badness = [&](const LossPoint& point) {
    // Rounded, so that of equal points the first is the worst.
    const double p = std::isnan(point.p_within_limit) ? 1 : std::round(point.p_within_limit * 1e9);
    return std::tuple(point.max_error_m > max_error_m, -p, std::round(point.max_error_m * 1e6));
  };
  for (std::size_t i = 1; i < loss.points.size(); ++i) {
    if (badness(loss.points[i]) > badness(loss.points[loss.worst])) loss.worst = i;
  }
  return loss;
}

}  // namespace pilotage
