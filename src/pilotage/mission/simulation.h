#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "pilotage/base/statistics.h"
#include "pilotage/mission/input_files.h"
#include "pilotage/mission/integrity.h"

#pragma GCC visibility push(default)

// What simulated flights of a mission say (docs/methods/simulate.md): what `simulate` finds and `report` shows.

namespace pilotage {

struct SimulatedLeg {
  int leg = 0;
  double planned_p = 0;  ///< LegStatus::p_within_limit; NaN where no flight of the plan reaches it.
  Share within;          ///< Of the flights that reached it within the limit, those that left it so.
};

/// Where the aircraft truly are: the ellipse around the line's place that holds 95 of 100 flights, in the shape of
/// their second moments. NaN below 60 flights, which do not bound it.
struct TruePlaceEllipse {
  double major_m = 0;  ///< Semi-axes.
  double minor_m = 0;
  double azimuth_deg = 0;  ///< Of the major one, from north to the east, 0 … 180.
};

/// Points of its outline: the first in the direction of the major axis, clockwise; east and north of its centre.
std::vector<Eigen::Vector2d> ellipse_outline_m(const TruePlaceEllipse& ellipse, int corners);

/// Where a flight really was and where it believed to be, from the line's place at each sample of the route.
struct FlightTrack {
  std::vector<Eigen::Vector2d> true_off_line_m;
  std::vector<Eigen::Vector2d> believed_off_line_m;
};

/// Where one of the first flights was.
struct SimulatedTrack {
  FlightTrack places;
  std::size_t lost_at = 0;  ///< The first sample where it was beyond the limit; their number when none.
};
inline constexpr std::size_t kMostTracks = 50;

/// What the errors are where the route has come so far, over all flights.
struct SimulatedMark {
  double distance_m = 0;
  double planned_time_s = 0;  ///< At the planned speed, without wind.
  double p_within = 0;        ///< Share of the flights that were within the limit up to here, and knew it.
  double cep50_m = 0;         ///< Half of the true errors are at most so large;
  double r95_m = 0;           ///< 95 of 100. NaN below 60 flights, which do not bound it.
  double nees = 0;            ///< Mean; an honest filter's lies in nees_band in 95 of 100 simulations.
  Interval nees_band;
  std::int64_t lost = 0;  ///< Flights lost since the mark before.
  TruePlaceEllipse true_place;
};

/// The same flights in the plan's own conditions, where others were given.
struct AsPlanned {
  Share within;
  double cost = 0;  ///< That share less the share in the conditions given.
  Interval cost_interval{-1, 1};
};

/// GNSS lost for good at one place.
struct SimulatedLoss {
  double lost_from_m = 0;
  double planned_p = 0;
  Share within;
};

/// What became of tries to fix, simulated or flown.
struct TryCounts {
  /// Over ground of stored tiles or not; of simulated flights while they know themselves within the limit.
  std::int64_t tries = 0;
  std::int64_t right = 0;        ///< Right fixes that were taken.
  std::int64_t unjudged = 0;     ///< Fixes whose truth is not known, of flown flights.
  std::int64_t missed = 0;       ///< Over a stored tile, and no right fix came.
  std::int64_t not_stored = 0;   ///< None came, over ground that is not stored, where the line leads over none either.
  std::int64_t off_line = 0;     ///< The same, where the line leads over a stored tile: the aircraft was beside it.
  std::int64_t no_frame = 0;     ///< No frame came: dropped, or of ground beyond the imagery that is looked at.
  std::int64_t false_taken = 0;  ///< False fixes that were taken.
  std::int64_t refused = 0;      ///< Fixes, false or right, that the gate of a simulated flight's filter refused.
  std::int64_t resets = 0;       ///< Fixes that it believed after refusals that said the same.
  std::int64_t not_tried = 0;    ///< Frames of flown flights with nothing to match; not among the tries.
};

/// The tries of a bin of predicted P.
struct SimulatedBin {
  double mean_p = 0;
  Share found;  ///< Right fixes of tries, as if tries were independent; they are not, so it is too narrow.
};

/// What `simulate` finds.
struct Simulation {
  std::int64_t flights = 0;
  std::uint64_t seed = 0;
  nlohmann::ordered_json options = nlohmann::ordered_json::object();  ///< All of them, as options_to_json gives them.
  double max_error_m = 0;
  double sigma_multiple = 3;
  double lost_from_m = 0;  ///< Where GNSS is lost first.
  double planned_p = 0;    ///< Of the selection, by the plan's own recursion.
  Share within;            ///< The error stays within the limit all the way, and so does k·σ of the filter.
  Share within_sure;       ///< k·σ of the filter stays within the limit: what the plan's P is of.
  Share within_true;       ///< The true error stays within the limit, whatever the filter knows.
  Share unaware;           ///< Flights that were off while the filter held itself within the limit.
  Integrity integrity;     ///< Over all flights, wherever they fly without GNSS.
  std::optional<AsPlanned> as_planned;
  std::vector<SimulatedLoss> losses;  ///< With `lost_every_km`: by place; all else is of the worst of them.
  std::vector<SimulatedLeg> legs;
  std::vector<SimulatedMark> marks;
  TryCounts fixes;                  ///< Sums over all flights.
  std::vector<SimulatedBin> by_p;   ///< Tries with a frame over stored tiles by their P: bins with tries, ascending.
  nlohmann::ordered_json rendered;  ///< Where fixes come from frames: options, and what the matcher did; else null.
  std::vector<std::string> notes;   ///< What to know of the numbers, as sentences.
  std::vector<std::string> not_simulated;  ///< Sentences.
  std::vector<SimulatedTrack> tracks;      ///< Of the first kMostTracks flights. Not part of simulation.json.
  std::vector<InputFile> inputs;           ///< Plan, scores and selection, when they came from files.

  bool by_frames() const { return !rendered.is_null(); }  ///< The matcher answered to frames; else fixes were drawn.
};

}  // namespace pilotage

#pragma GCC visibility pop
