#include "pilotage/simulate/simulate_flights.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "pilotage/base/nan.h"
#include "pilotage/base/parallel.h"

namespace pilotage {
namespace {

/// Fewer flights than this do not bound the 95th of 100 from above with 95 % confidence: 0.95^59 < 0.05.
constexpr std::size_t kFewestForR95 = 60;
constexpr std::size_t kBatch = 64;

void add(const TriedFixes& one, TriedFixes& sum) {
  sum.tries += one.tries;
  sum.right += one.right;
  sum.missed += one.missed;
  sum.not_stored += one.not_stored;
  sum.off_line += one.off_line;
  sum.false_taken += one.false_taken;
  sum.refused += one.refused;
  sum.resets += one.resets;
}

template <class Condition>
SimulatedShare share_of(const std::vector<SimulatedFlight>& flights, Condition condition) {
  return simulated_share(std::count_if(flights.begin(), flights.end(), condition),
                         static_cast<std::int64_t>(flights.size()));
}

std::vector<SimulatedLeg> legs_of(const SimulatedMission& mission, const std::vector<SimulatedFlight>& flights) {
  const std::vector<FlightSample>& samples = mission.path.mission->flight.samples;
  std::vector<SimulatedLeg> legs;
  for (std::size_t begin = 0; begin < samples.size();) {
    std::size_t end = begin;
    while (end < samples.size() && samples[end].leg == samples[begin].leg) ++end;
    const auto index = static_cast<std::size_t>(samples[begin].leg);
    const auto still = [&](std::size_t at) {
      return std::count_if(flights.begin(), flights.end(),
                           [&](const SimulatedFlight& f) { return f.lost_at(samples.size()) >= at; });
    };
    legs.push_back({samples[begin].leg, mission.planned_leg_p[index], simulated_share(still(end), still(begin))});
    begin = end;
  }
  return legs;
}

std::vector<SimulatedMark> marks_of(const SimulatedMission& mission, const std::vector<SimulatedFlight>& flights) {
  const std::vector<FlightSample>& samples = mission.path.mission->flight.samples;
  const auto count = static_cast<double>(flights.size());
  std::vector<SimulatedMark> marks;
  double before = count;
  for (std::size_t m = 0; m < mission.marks_m.size(); ++m) {
    SimulatedMark mark;
    mark.distance_m = mission.marks_m[m];
    std::vector<double> errors_m;
    double still = 0;
    for (const SimulatedFlight& flight : flights) {
      errors_m.push_back(flight.marks[m].error_m);
      mark.nees += flight.marks[m].nees / count;
      const std::size_t lost = flight.lost_at(samples.size());
      still += lost >= samples.size() || samples[lost].distance_m > mark.distance_m ? 1 : 0;
    }
    mark.p_within = still / count;
    mark.lost = static_cast<std::int64_t>(before - still);
    before = still;
    mark.cep50_m = quantile(errors_m, 0.5);
    mark.r95_m = errors_m.size() < kFewestForR95 ? kNaN : quantile(errors_m, 0.95);
    mark.nees_band = {chi_squared_quantile(0.025, 2 * count) / count, chi_squared_quantile(0.975, 2 * count) / count};
    marks.push_back(mark);
  }
  return marks;
}

std::vector<std::string> what_was_left_out() {
  return {
      "frames and the matcher: whether a fix comes is drawn by the P of the tile below",
      "heights: the barometer, the altimeter and the terrain's error move no drawn fix",
      "attitude of the aircraft and of the camera's mount, exposure, blur, frames that are dropped or answered late",
      "gusts, turns flown wide, and speeds that the autopilot changes: wind is steady and the line is steered back to",
      "P for priors wider than the limit: a flight whose k sigma is beyond it gets no more fixes, as in the plan"};
}

}  // namespace

double SimulatedShare::share() const {
  return of > 0 ? static_cast<double>(count) / static_cast<double>(of) : kNaN;
}

SimulatedShare simulated_share(std::int64_t count, std::int64_t of) {
  return {of, count, binomial_interval(count, of)};
}

Simulation simulate_flights(const Mission& mission, const std::vector<TileScores>& scores, const Selection& selection,
                            const SimulateOptions& options, std::uint64_t seed, int threads, const Progress& progress) {
  check_options(options);
  const SimulatedMission simulated = make_simulated_mission(mission, scores, selection, options);
  const auto count = static_cast<std::size_t>(options.flights);
  std::vector<SimulatedFlight> flights(count);
  std::mutex reporting;
  std::int64_t done = 0;
  parallel_for((count + kBatch - 1) / kBatch, threads, [&](std::size_t batch, int) {
    for (std::size_t i = batch * kBatch; i < std::min(count, (batch + 1) * kBatch); ++i) {
      flights[i] = fly_mission(simulated, options, derive_seed(seed, i));
    }
    const std::lock_guard lock(reporting);
    done += static_cast<std::int64_t>(std::min(count, (batch + 1) * kBatch) - batch * kBatch);
    report_progress(progress, "flying", done, options.flights);
  });

  Simulation result;
  result.flights = options.flights;
  result.seed = seed;
  result.options = options;
  result.max_error_m = simulated.path.max_error_m;
  result.sigma_multiple = simulated.path.model.sigma_multiple;
  result.lost_from_m = simulated.lost_from_m;
  result.planned_p = simulated.planned_p;
  result.within = share_of(flights, [](const SimulatedFlight& f) { return f.within(); });
  result.within_sure = share_of(flights, [](const SimulatedFlight& f) { return !f.unsure_at; });
  result.within_true = share_of(flights, [](const SimulatedFlight& f) { return !f.off_at; });
  result.unaware = share_of(flights, [](const SimulatedFlight& f) { return f.unaware_at.has_value(); });
  result.legs = legs_of(simulated, flights);
  result.marks = marks_of(simulated, flights);
  for (const SimulatedFlight& flight : flights) add(flight.fixes, result.fixes);
  result.not_simulated = what_was_left_out();
  return result;
}

}  // namespace pilotage
