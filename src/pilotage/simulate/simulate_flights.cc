#include "pilotage/simulate/simulate_flights.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/parallel.h"

namespace pilotage {
namespace {

/// Fewer flights than this do not bound the 95th of 100 from above with 95 % confidence: 0.95^59 < 0.05.
constexpr std::size_t kFewestForR95 = 60;
constexpr std::size_t kLargestBatch = 64;

void add(const TriedFixes& one, TriedFixes& sum) {
  sum.tries += one.tries;
  sum.right += one.right;
  sum.missed += one.missed;
  sum.not_stored += one.not_stored;
  sum.off_line += one.off_line;
  sum.no_frame += one.no_frame;
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

std::vector<SimulatedBin> bins_of(const std::vector<SimulatedFlight>& flights) {
  std::vector<SimulatedBin> bins;
  for (std::size_t b = 0; b < FoundByP::kBins; ++b) {
    FoundByP::Bin sum;
    for (const SimulatedFlight& flight : flights) {
      sum.tries += flight.found.bins[b].tries;
      sum.right += flight.found.bins[b].right;
      sum.sum_p += flight.found.bins[b].sum_p;
    }
    if (sum.tries == 0) continue;
    bins.push_back({sum.sum_p / static_cast<double>(sum.tries), simulated_share(sum.right, sum.tries)});
  }
  return bins;
}

/// Whatever fixes come from.
std::vector<std::string> never_simulated() {
  return {
      "gusts, turns flown wide, and speeds that the autopilot changes: wind is steady and the line is steered back to",
      "P for priors wider than the limit: a flight whose k sigma is beyond it gets no more fixes, as in the plan"};
}

FixSource source_of_options(const SimulatedMission& mission, const SimulateOptions& options) {
  if (options.fixes == FixesFrom::kNone) return no_fixes();
  if (options.fixes == FixesFrom::kDrawn) return drawn_fixes(mission, options);
  throw UsageError("fixes = " + std::string(options_detail::enum_to_name(options.fixes)) + " needs a source of frames");
}

}  // namespace

double SimulatedShare::share() const {
  return of > 0 ? static_cast<double>(count) / static_cast<double>(of) : kNaN;
}

SimulatedShare simulated_share(std::int64_t count, std::int64_t of) {
  return {of, count, binomial_interval(count, of)};
}

Simulation simulate_flights(const Mission& mission, const std::vector<TileScores>& scores, const Selection& selection,
                            const SimulateOptions& options, std::uint64_t seed, int threads, const Progress& progress,
                            const FixSource& source) {
  check_options(options);
  const SimulatedMission simulated = make_simulated_mission(mission, scores, selection, options);
  const FixSource fixes = source.begin_flight ? source : source_of_options(simulated, options);
  const MapError map{options.map_sigma_m, options.map_correlation_m, fixes.draws_map_error};
  const auto count = static_cast<std::size_t>(options.flights);
  const std::size_t batch_size = std::clamp<std::size_t>(count / 256, 1, kLargestBatch);
  std::vector<SimulatedFlight> flights(count);
  std::mutex reporting;
  std::int64_t done = 0;
  const std::function<bool()> go_on = [&] {
    const std::lock_guard lock(reporting);
    return !progress || progress("flying", done, options.flights);
  };
  parallel_for((count + batch_size - 1) / batch_size, threads, [&](std::size_t batch, int worker) {
    const std::size_t end = std::min(count, (batch + 1) * batch_size);
    for (std::size_t i = batch * batch_size; i < end; ++i) {
      const std::uint64_t flight_seed = derive_seed(seed, i);
      flights[i] = fly_mission(simulated, options, flight_seed, map, fixes.begin_flight(i, flight_seed, worker, go_on));
    }
    const std::lock_guard lock(reporting);
    done += static_cast<std::int64_t>(end - batch * batch_size);
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
  result.by_p = bins_of(flights);
  result.notes = fixes.notes;
  result.not_simulated = fixes.not_simulated;
  for (const std::string& sentence : never_simulated()) result.not_simulated.push_back(sentence);
  return result;
}

}  // namespace pilotage
