#include "pilotage/simulate/simulate_flights.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include <Eigen/Eigenvalues>

#include "pilotage/base/angle.h"
#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/parallel.h"
#include "pilotage/base/text.h"
#include "pilotage/mission/flight_time.h"

namespace pilotage {
namespace {

/// Fewer flights than this do not bound the 95th of 100 from above with 95 % confidence: 0.95^59 < 0.05.
constexpr std::size_t kFewestForR95 = 60;
constexpr std::size_t kLargestBatch = 64;
constexpr std::size_t kMostLosses = 200;

void add(const TryCounts& one, TryCounts& sum) {
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
Share share_of(const std::vector<SimulatedFlight>& flights, Condition condition) {
  return {std::count_if(flights.begin(), flights.end(), condition), static_cast<std::int64_t>(flights.size())};
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
    legs.push_back({samples[begin].leg, mission.planned_leg_p[index], {still(end), still(begin)}});
    begin = end;
  }
  return legs;
}

TruePlaceEllipse ellipse_around(const std::vector<Eigen::Vector2d>& places_m) {
  if (places_m.size() < kFewestForR95) return {kNaN, kNaN, kNaN};
  Eigen::Matrix2d moments = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector2d& place_m : places_m) moments += place_m * place_m.transpose();
  moments /= static_cast<double>(places_m.size());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(moments);
  // A millimetre at least, so that flights without an error have an ellipse too.
  const Eigen::Vector2d sigmas_m = axes.eigenvalues().cwiseMax(1e-6).cwiseSqrt();
  std::vector<double> squares;
  for (const Eigen::Vector2d& place_m : places_m) {
    squares.push_back((axes.eigenvectors().transpose() * place_m).cwiseQuotient(sigmas_m).squaredNorm());
  }
  const double scale = std::sqrt(quantile(squares, 0.95));
  const Eigen::Vector2d major = axes.eigenvectors().col(1);
  const double azimuth_deg = std::atan2(major.x(), major.y()) / kRadPerDeg;
  return {scale * sigmas_m(1), scale * sigmas_m(0), azimuth_deg - 180 * std::floor(azimuth_deg / 180)};
}

/// Time from the first sample to each, at the planned speed.
std::vector<double> planned_times_s(const std::vector<FlightSample>& samples) {
  std::vector<double> times_s{0};
  for (std::size_t i = 1; i < samples.size(); ++i) {
    times_s.push_back(times_s.back() + step_time_s(samples[i - 1], samples[i]));
  }
  return times_s;
}

/// Where the errors of mark `m` are those of all flights.
SimulatedMark errors_at(std::size_t m, const std::vector<SimulatedFlight>& flights) {
  SimulatedMark mark;
  const auto count = static_cast<double>(flights.size());
  std::vector<double> errors_m;
  std::vector<Eigen::Vector2d> places_m;
  for (const SimulatedFlight& flight : flights) {
    errors_m.push_back(flight.marks[m].error_m.cast<double>().norm());
    places_m.push_back(flight.marks[m].off_line_m.cast<double>());
    mark.nees += static_cast<double>(flight.marks[m].nees) / count;
  }
  mark.cep50_m = quantile(errors_m, 0.5);
  mark.r95_m = errors_m.size() < kFewestForR95 ? kNaN : quantile(errors_m, 0.95);
  mark.nees_band = {chi_squared_quantile(0.025, 2 * count) / count, chi_squared_quantile(0.975, 2 * count) / count};
  mark.true_place = ellipse_around(places_m);
  return mark;
}

std::vector<SimulatedMark> marks_of(const SimulatedMission& mission, const std::vector<SimulatedFlight>& flights) {
  const std::vector<FlightSample>& samples = mission.path.mission->flight.samples;
  const std::vector<double> times_s = planned_times_s(samples);
  std::vector<std::int64_t> lost_at(samples.size() + 1, 0);
  for (const SimulatedFlight& flight : flights) ++lost_at[flight.lost_at(samples.size())];
  std::vector<SimulatedMark> marks;
  auto still = static_cast<std::int64_t>(flights.size());
  std::size_t sample = 0;
  for (std::size_t m = 0; m < mission.marks_m.size(); ++m) {
    SimulatedMark mark = errors_at(m, flights);
    mark.distance_m = mission.marks_m[m];
    for (; sample < samples.size() && samples[sample].distance_m <= mark.distance_m; ++sample) {
      mark.lost += lost_at[sample];
    }
    still -= mark.lost;
    mark.planned_time_s = times_s[sample > 0 ? sample - 1 : 0];
    mark.p_within = static_cast<double>(still) / static_cast<double>(flights.size());
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
    bins.push_back({sum.sum_p / static_cast<double>(sum.tries), {sum.right, sum.tries}});
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

/// How flights are flown: with these options, with fixes from there.
struct Campaign {
  const SimulatedMission& mission;
  const SimulateOptions& options;
  const FixSource& fixes;
  std::uint64_t seed = 0;
  int threads = 0;
  const Progress& progress;
};

std::vector<SimulatedFlight> fly_all(const Campaign& campaign, const std::string& stage,
                                     std::vector<SimulatedTrack>* tracks) {
  const SimulateOptions& options = campaign.options;
  const auto count = static_cast<std::size_t>(options.flights);
  const std::size_t batch_size = std::clamp<std::size_t>(count / 256, 1, kLargestBatch);
  std::vector<SimulatedFlight> flights(count);
  std::mutex reporting;
  std::int64_t done = 0;
  const std::function<bool()> go_on = [&] {
    const std::lock_guard lock(reporting);
    return !campaign.progress || campaign.progress(stage, done, options.flights);
  };
  parallel_for((count + batch_size - 1) / batch_size, campaign.threads, [&](std::size_t batch, int worker) {
    const std::size_t end = std::min(count, (batch + 1) * batch_size);
    for (std::size_t i = batch * batch_size; i < end; ++i) {
      FlightTrack* track = tracks != nullptr && i < tracks->size() ? &(*tracks)[i].places : nullptr;
      const std::uint64_t flight_seed = derive_seed(campaign.seed, i);
      flights[i] = fly_mission(campaign.mission, flight_seed, campaign.fixes.draws_map_error,
                               campaign.fixes.begin_flight(i, flight_seed, worker, go_on), track);
    }
    const std::lock_guard lock(reporting);
    done += static_cast<std::int64_t>(end - batch * batch_size);
    report_progress(campaign.progress, stage, done, options.flights);
  });
  return flights;
}

/// Conditions are other than the plan's.
bool changes_conditions(const SimulateOptions& options) {
  return options.map_sigma_m || options.map_correlation_m || options.wind_sigma_mps || options.dropped_frames ||
         options.false_fix_rate;
}

SimulateOptions as_planned(SimulateOptions options) {
  options.map_sigma_m = options.map_correlation_m = options.wind_sigma_mps = options.dropped_frames =
      options.false_fix_rate = std::nullopt;
  return options;
}

AsPlanned compare_with_plan(const std::vector<SimulatedFlight>& flights, const std::vector<SimulatedFlight>& planned) {
  AsPlanned result;
  std::int64_t only_planned = 0;
  std::int64_t only_flown = 0;
  for (std::size_t i = 0; i < flights.size(); ++i) {
    only_planned += planned[i].within() && !flights[i].within() ? 1 : 0;
    only_flown += flights[i].within() && !planned[i].within() ? 1 : 0;
  }
  const auto count = static_cast<std::int64_t>(flights.size());
  result.within = share_of(planned, [](const SimulatedFlight& f) { return f.within(); });
  result.cost = static_cast<double>(only_planned - only_flown) / static_cast<double>(count);
  result.cost_interval = paired_difference_interval(only_planned, only_flown, count);
  return result;
}

Simulation sum_up(const Campaign& campaign, const std::vector<SimulatedFlight>& flights) {
  const SimulatedMission& mission = campaign.mission;
  Simulation result;
  result.flights = campaign.options.flights;
  result.seed = campaign.seed;
  result.max_error_m = mission.path.max_error_m;
  result.sigma_multiple = mission.path.model.sigma_multiple;
  result.lost_from_m = mission.lost_from_m;
  result.planned_p = mission.planned_p;
  result.within = share_of(flights, [](const SimulatedFlight& f) { return f.within(); });
  result.within_sure = share_of(flights, [](const SimulatedFlight& f) { return !f.unsure_at; });
  result.within_true = share_of(flights, [](const SimulatedFlight& f) { return !f.off_at; });
  result.unaware = share_of(flights, [](const SimulatedFlight& f) { return f.unaware_at.has_value(); });
  result.legs = legs_of(mission, flights);
  result.marks = marks_of(mission, flights);
  IntegrityCount integrity;
  for (const SimulatedFlight& flight : flights) {
    add(flight.fixes, result.fixes);
    integrity.add(flight.integrity);
  }
  result.integrity = integrity.result(result.max_error_m);
  result.by_p = bins_of(flights);
  result.notes = campaign.fixes.notes;
  result.not_simulated = campaign.fixes.not_simulated;
  for (const std::string& sentence : never_simulated()) result.not_simulated.push_back(sentence);
  return result;
}

/// The flights of one place of loss, with where the first of them were.
struct Flown {
  Simulation simulation;
  std::vector<SimulatedFlight> flights;
};

Flown fly_campaign(const Campaign& campaign) {
  const std::optional<double>& lost_km = campaign.options.lost_from_km;
  const std::string stage =
      campaign.options.lost_every_km ? "flying, lost at " + format_fixed(*lost_km, 1) + " km" : "flying";
  std::vector<SimulatedTrack> tracks(std::min(kMostTracks, static_cast<std::size_t>(campaign.options.flights)));
  Flown flown;
  flown.flights = fly_all(campaign, stage, &tracks);
  flown.simulation = sum_up(campaign, flown.flights);
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    tracks[i].lost_at = flown.flights[i].lost_at(campaign.mission.path.mission->flight.samples.size());
  }
  flown.simulation.tracks = std::move(tracks);
  return flown;
}

/// Where `lost_every_km` loses GNSS. Throws UsageError.
std::vector<double> losses_km(const Mission& mission, const SimulateOptions& options) {
  if (options.lost_from_km) throw UsageError("give --lost-from-km or --lost-every-km, not both");
  const double end_km = mission.flight.samples.back().distance_m / 1000;
  const double places = std::ceil(end_km / *options.lost_every_km);
  if (places > kMostLosses) {
    throw UsageError("lost_every_km = " + format_number(*options.lost_every_km) + " makes " + format_fixed(places, 0) +
                     " places of the route of " + format_fixed(end_km, 2) + " km; " + std::to_string(kMostLosses) +
                     " are the most");
  }
  std::vector<double> all_km;
  for (int i = 0; i * *options.lost_every_km < end_km; ++i) all_km.push_back(i * *options.lost_every_km);
  return all_km;
}

}  // namespace

Simulation simulate_flights(const Mission& mission, const std::vector<TileScores>& scores, const Selection& selection,
                            const SimulateOptions& options, std::uint64_t seed, int threads, const Progress& progress,
                            const FixSource& source) {
  check_options(options);
  if (options.lost_every_km && source.begin_flight) {
    throw UsageError("--lost-every-km flies with fixes that are drawn, or none: not with those of frames");
  }
  std::vector<SimulateOptions> variants;
  if (options.lost_every_km) {
    for (const double lost_km : losses_km(mission, options)) variants.emplace_back(options).lost_from_km = lost_km;
  } else {
    variants.push_back(options);
  }
  std::optional<Simulation> worst;
  std::vector<SimulatedLoss> losses;
  for (const SimulateOptions& variant : variants) {
    const SimulatedMission simulated = make_simulated_mission(mission, scores, selection, variant, threads);
    const FixSource fixes = source.begin_flight ? source : source_of_options(simulated, variant);
    Flown flown = fly_campaign({simulated, variant, fixes, seed, threads, progress});
    const Simulation& found = flown.simulation;
    losses.push_back({found.lost_from_m, found.planned_p, found.within});
    if (worst && worst->within.count <= found.within.count) continue;
    if (variant.fixes == FixesFrom::kDrawn && changes_conditions(variant)) {
      const SimulateOptions planned = as_planned(variant);
      const SimulatedMission in_plan = make_simulated_mission(mission, scores, selection, planned, threads);
      const FixSource drawn = drawn_fixes(in_plan, planned);
      flown.simulation.as_planned = compare_with_plan(
          flown.flights, fly_all({in_plan, planned, drawn, seed, threads, progress}, "flying as planned", nullptr));
    }
    worst = std::move(flown.simulation);
  }
  SimulateOptions described = options;  // list_options takes what can be set
  worst->options = options_to_json(list_options(described));
  if (options.lost_every_km) worst->losses = std::move(losses);
  return *std::move(worst);
}

}  // namespace pilotage
