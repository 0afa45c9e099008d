#include "pilotage/select/worst_loss.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "pilotage/base/nan.h"
#include "pilotage/base/parallel.h"
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
std::vector<std::size_t> within_bound(const std::vector<std::size_t>& starts, std::size_t count, std::size_t cases) {
  std::size_t step = 1;
  while (step < starts.size() && cases * samples_flown(every(starts, step), count) > kSamplesFlownAfterLoss) ++step;
  return every(starts, step);
}

// P of each flight that loses GNSS at one of the samples to be within the limit at the route's end, over the cases.
std::vector<double> p_of_losses(FlightPath path, std::span<const LevelChances> levels,
                                const std::vector<std::size_t>& losses, int threads) {
  const Flight& flight = path.mission->flight;
  FlightPath with_gnss = path;
  with_gnss.gnss = gnss_everywhere(flight, true);
  path.gnss = gnss_everywhere(flight, false);
  std::vector<double> p(losses.size(), 0.0);
  std::vector<std::vector<double>> p_of_case(path.cases.size(), std::vector<double>(losses.size()));
  parallel_for(path.cases.size(), threads, [&](std::size_t k, int) {
    const FlightCase& one = path.cases[k];
    const LevelChances& level = levels[one.level];
    const double weight = level.weight * one.weight;
    std::vector<FlightBranch> branches = first_branches(path);
    std::size_t at = 0;
    for (std::size_t i = 0; i < losses.size(); ++i) {
      branches = fly_stretch(with_gnss, one.steps, level.chances, at, losses[i], std::move(branches)).branches;
      at = losses[i];
      const FlightStretch rest = fly_stretch(path, one.steps, level.chances, at, flight.samples.size(), branches);
      p_of_case[k][i] = weight * rest.p_within_limit.back();
    }
  });
  for (const std::vector<double>& of_case : p_of_case) {
    for (std::size_t i = 0; i < p.size(); ++i) p[i] += of_case[i];
  }
  for (double& each : p) each = std::min(1.0, each);  // but for rounding
  return p;
}

}  // namespace

std::vector<std::size_t> loss_samples(const Mission& mission, std::size_t cases) {
  const std::vector<FlightSample>& samples = mission.flight.samples;
  std::vector<std::size_t> all;
  std::vector<std::size_t> legs;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    all.push_back(i);
    if (i == 0 || samples[i].leg != samples[i - 1].leg) legs.push_back(i);
  }
  std::map<double, std::size_t> at;  // of two samples at one place, where the course changes, the second
  for (const auto& starts : {within_bound(all, samples.size(), cases), within_bound(legs, samples.size(), cases)}) {
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

LossAnywhere lose_gnss_anywhere(const Mission& mission, const std::vector<bool>& stored, const FlightPath* path,
                                std::span<const LevelChances> levels, double max_error_m, double fix_interval_s,
                                int threads) {
  const std::vector<FlightSample>& samples = mission.flight.samples;
  const std::vector<std::size_t> losses = loss_samples(mission, path != nullptr ? path->cases.size() : 1);
  const std::vector<double> largest_m = largest_errors_of_losses(mission, losses, stored, fix_interval_s);
  const std::vector<double> p_within_limit =
      path != nullptr ? p_of_losses(*path, levels, losses, threads) : std::vector<double>(losses.size(), kNaN);
  LossAnywhere loss;
  for (std::size_t i = 0; i < losses.size(); ++i) {
    const FlightSample& at = samples[losses[i]];
    if (i > 0) loss.step_m = std::max(loss.step_m, at.distance_m - loss.points.back().distance_m);
    loss.points.push_back({at.distance_m, at.leg, largest_m[i], p_within_limit[i]});
  }
  loss.step_m = std::max(loss.step_m, samples.back().distance_m - loss.points.back().distance_m);
  // What differs by less than merging rounds, or is printed, counts as equal.
  std::vector<std::size_t> worst;
  const auto keep_worst = [&](const auto& badness, double alike) {
    double most = -std::numeric_limits<double>::infinity();
    for (const std::size_t i : worst) most = std::max(most, badness(loss.points[i]));
    std::erase_if(worst, [&](std::size_t i) { return badness(loss.points[i]) < most - alike; });
  };
  for (std::size_t i = 0; i < loss.points.size(); ++i) worst.push_back(i);
  keep_worst([&](const LossPoint& point) { return point.max_error_m > max_error_m ? 1.0 : 0.0; }, 0);
  keep_worst([](const LossPoint& point) { return std::isnan(point.p_within_limit) ? 0 : -point.p_within_limit; }, 1e-3);
  keep_worst([](const LossPoint& point) { return point.max_error_m; }, 0.1);
  loss.worst = worst.front();
  return loss;
}

}  // namespace pilotage
