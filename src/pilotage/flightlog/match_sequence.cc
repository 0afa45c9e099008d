#include "pilotage/flightlog/match_sequence.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/flightlog/match_flight.h"

namespace pilotage {
namespace {

constexpr double kLeastSequenceRate = 2e-6;  // half of it is the least that match() takes

void check_rows(const std::vector<FlightFrame>& frames, const MatchOptions& options) {
  if (options.max_false_fix_rate < kLeastSequenceRate) {
    throw UsageError("max_false_fix_rate = " + format_number(options.max_false_fix_rate) + " is below " +
                     format_number(kLeastSequenceRate) + ", the least for frames that are matched in sequence");
  }
  for (const FlightFrame& frame : frames) {
    const FrameRecord& row = frame.frame;
    if (!std::isfinite(row.time_s)) throw UsageError(row.file + ": time_s is not known, which frames in sequence need");
    if (!std::isfinite(row.prior.lon_deg) || !std::isfinite(row.prior.lat_deg) ||
        !std::isfinite(row.attitude.yaw_deg) || !row.prior_covariance_en_m2.allFinite()) {
      throw UsageError(row.file + ": prior and yaw_deg are not known, which frames in sequence need");
    }
  }
}

std::vector<std::size_t> order_of_time(const std::vector<FlightFrame>& frames) {
  std::vector<std::size_t> order(frames.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return frames[a].frame.time_s < frames[b].frame.time_s; });
  return order;
}

}  // namespace

MatchedSequence match_sequence(const OpenMaps& open_maps, const std::vector<FlightFrame>& frames,
                               const MatchOptions& options, const InsErrorModel& model, const Progress& progress) {
  MatchedSequence done;
  if (frames.empty()) return done;
  check_rows(frames, options);
  const std::vector<std::size_t> order = order_of_time(frames);
  const auto row = [&](std::size_t i) -> const FrameRecord& { return frames[order[i]].frame; };
  std::vector<MapReader> maps = open_maps();
  FrameTrack track(options, model, motion_between(row(0), row(frames.size() > 1 ? 1 : 0)), maps.size());
  done.matches.resize(frames.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto go_on = [&, i] {
      return !progress || progress("matching", static_cast<std::int64_t>(i), static_cast<std::int64_t>(order.size()));
    };
    if (!go_on()) throw Interrupted{};
    if (i > 0) track.fly_on(motion_between(row(i - 1), row(i)));
    const FlightFrame& frame = frames[order[i]];
    FrameMatch& match = done.matches[order[i]];
    match = match_frame(frame.path, track.with_prior(frame.frame), frame.camera, maps, track.options(), go_on);
    track.judge(frame, match);
    if (track.summary().rows_jump) {
      done.matches = match_flight(open_maps, frames, options, 1, progress);
      break;
    }
    set_errors(match);
  }
  if (progress) progress("matching", static_cast<std::int64_t>(order.size()), static_cast<std::int64_t>(order.size()));
  require_readable_frame(done.matches);
  done.summary = track.summary();
  return done;
}

}  // namespace pilotage
