#include "pilotage/select/fix_attempts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pilotage/mission/flight_time.h"
#include "pilotage/mission/tile_under.h"

namespace pilotage {
namespace {

// Along which way tries succeed or fail together at this sample, or one fix interval lasts.
double window_length_m(const Mission& mission, const FlightSample& sample, double fix_interval_s,
                       std::optional<double> decorrelation_m) {
  double apart_m = decorrelation_m.value_or(mission.flight.footprint_width_m);
  if (!decorrelation_m && sample.level != FlightSample::kNoLevel) {
    const TileMatrix& matrix = mission.ground.levels[static_cast<std::size_t>(sample.level)].matrix;
    apart_m = matrix.tile_size_px * std::abs(matrix.map_from_pixel.x_per_col);
  }
  return std::max({apart_m, fix_interval_s * sample.speed_mps, 1.0});
}

// The way from the start to each sample, counted in windows.
std::vector<double> windows_flown(const Mission& mission, double fix_interval_s,
                                  std::optional<double> decorrelation_m) {
  std::vector<double> flown(mission.flight.samples.size(), 0.0);
  for (std::size_t i = 1; i < flown.size(); ++i) {
    const FlightSample& from = mission.flight.samples[i - 1];
    flown[i] = flown[i - 1] + (mission.flight.samples[i].distance_m - from.distance_m) /
                                  window_length_m(mission, from, fix_interval_s, decorrelation_m);
  }
  return flown;
}

}  // namespace

std::vector<std::optional<std::size_t>> tiles_under_route(const Mission& mission) {
  std::vector<std::optional<std::size_t>> tiles;
  for (const FlightSample& sample : mission.flight.samples) tiles.push_back(tile_under(mission, sample));
  return tiles;
}

std::vector<std::optional<std::size_t>> tiles_without_gnss(std::vector<std::optional<std::size_t>> tiles,
                                                           const GnssAvailability& gnss) {
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    if (gnss.at_sample[i]) tiles[i].reset();
  }
  return tiles;
}

std::vector<FixAttempt> fix_attempts(const Mission& mission, const std::vector<std::optional<std::size_t>>& tiles,
                                     double fix_interval_s, std::optional<double> decorrelation_m) {
  const std::vector<double> flown = windows_flown(mission, fix_interval_s, decorrelation_m);
  std::vector<FixAttempt> attempts;
  for (std::size_t first = 0; first < tiles.size();) {
    std::size_t end = first + 1;
    while (end < tiles.size() && tiles[end] == tiles[first]) ++end;
    if (tiles[first]) {
      // From half way to the sample before to half way to the one after, so that neighbours share the ground.
      const double from = first == 0 ? flown[0] : (flown[first - 1] + flown[first]) / 2;
      const double to = end == tiles.size() ? flown.back() : (flown[end - 1] + flown[end]) / 2;
      const auto parts = std::max<std::size_t>(1, static_cast<std::size_t>(std::llround(to - from)));
      for (std::size_t part = 0; part < parts; ++part) {
        const double middle = from + (to - from) * (static_cast<double>(part) + 0.5) / static_cast<double>(parts);
        const auto begin_at = flown.begin() + static_cast<std::ptrdiff_t>(first);
        const auto end_at = flown.begin() + static_cast<std::ptrdiff_t>(end);
        auto nearest = std::lower_bound(begin_at, end_at, middle);
        if (nearest == end_at || (nearest != begin_at && middle - *(nearest - 1) <= *nearest - middle)) --nearest;
        attempts.push_back({static_cast<std::size_t>(nearest - flown.begin()), *tiles[first],
                            static_cast<std::int64_t>(std::floor(middle))});
      }
    }
    first = end;
  }
  return attempts;
}

std::vector<std::size_t> counted_attempts(const std::vector<FixAttempt>& attempts,
                                          const std::vector<double>& p_of_tile) {
  std::vector<std::size_t> counted;
  for (std::size_t i = 0; i < attempts.size();) {
    std::size_t best = i;
    std::size_t next = i;
    for (; next < attempts.size() && attempts[next].window == attempts[i].window; ++next) {
      if (p_of_tile[attempts[next].tile] > p_of_tile[attempts[best].tile]) best = next;
    }
    if (p_of_tile[attempts[best].tile] > 0) counted.push_back(best);
    i = next;
  }
  return counted;
}

RouteChances route_chances(const std::vector<FixAttempt>& attempts, const std::vector<double>& p_of_tile,
                           std::size_t sample_count, const FixTries& tries) {
  RouteChances chances{std::vector<double>(sample_count, 0.0),
                       std::vector<std::int64_t>(sample_count, 0),
                       tries.interval_s,
                       tries.false_fix_rate,
                       {}};
  for (const FixAttempt& attempt : attempts) {
    chances.p[attempt.sample] = p_of_tile[attempt.tile];
    chances.window[attempt.sample] = attempt.window;
  }
  return chances;
}

std::vector<LevelChances> level_chances(const Mission& mission, const std::vector<FlightSample>& samples,
                                        const std::vector<FixAttempt>& attempts, const TileChances& tiles,
                                        const FixTries& tries) {
  std::vector<ChancesBesideLine> beside_line(samples.size());
  for (const FixAttempt& attempt : attempts) {
    if (tiles.p[attempt.tile] > 0) {
      beside_line[attempt.sample] = chances_beside_line(mission, samples[attempt.sample], tiles.p);
    }
  }
  std::vector<LevelChances> levels;
  for (const TileChances::AtLevel& level : tiles.levels) {
    levels.push_back({level.weight, route_chances(attempts, level.p, samples.size(), tries)});
    levels.back().chances.beside_line = beside_line;
  }
  return levels;
}

ExpectedFixes expected_fixes(const Mission& mission, const std::vector<std::optional<std::size_t>>& tiles,
                             const std::vector<bool>& stored, const std::vector<double>& p_of_tile,
                             const FixTries& tries) {
  const double frames = 1 - mission.flight.conditions.dropped_frames;
  ExpectedFixes expected;
  double time_s = 0;
  double last_try_s = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    if (i > 0) time_s += step_time_s(mission.flight.samples[i - 1], mission.flight.samples[i]);
    if (!tiles[i] || !stored[*tiles[i]] || time_s - last_try_s < tries.interval_s) continue;
    last_try_s = time_s;
    expected.correct += frames * p_of_tile[*tiles[i]];
    expected.wrong += frames * (1 - p_of_tile[*tiles[i]]) * tries.false_fix_rate;
  }
  return expected;
}

}  // namespace pilotage
