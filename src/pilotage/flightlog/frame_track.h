#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "pilotage/flightlog/drift_filter.h"
#include "pilotage/flightlog/flight_frames.h"
#include "pilotage/flightlog/frame_match.h"

namespace pilotage {

/// What carrying knowledge from frame to frame did.
struct SequenceSummary {
  std::int64_t narrowed = 0;       ///< Frames whose prior the fixes before had narrowed.
  std::int64_t confirmed = 0;      ///< Fixes too weak by themselves that lie where the track says.
  std::int64_t gate_refusals = 0;  ///< Fixes that contradict the track.
  std::int64_t resets = 0;         ///< Tracks given up after kTrackRefusals frames in a row that did not agree.
  /// The rows' positions are not those of one drifting system, by the model's figures: match_sequence() then matches
  /// each frame with its own prior, and the numbers above are those of the attempt.
  bool rows_jump = false;
};

/// "the positions of frames.csv move against each other …": for the planner; "" where rows do not jump.
std::string rows_jump_warning(const SequenceSummary& summary);

/// How the row's inertial system flew from a frame to the next.
struct FrameMotion {
  double dt_s = 0;
  double heading_deg = 0;
  double speed_mps = 0;
};

/// Along the line between the rows' positions; the yaw's direction and no speed where they or the times are the same.
FrameMotion motion_between(const FrameRecord& from, const FrameRecord& to);

/// Knowledge that is carried from frame to frame; what it does with it says match_sequence(). For each frame: fly_on(),
/// with_prior(), then judge() with the answer to the frame under options().
class FrameTrack {
 public:
  /// `first` is how the aircraft flies at the first frame; each frame is matched on `map_count` maps.
  FrameTrack(const MatchOptions& options, const InsErrorModel& model, const FrameMotion& first, std::size_t map_count);

  /// Those to match with: half the rate of false fixes.
  const MatchOptions& options() const { return options_; }
  const SequenceSummary& summary() const { return summary_; }

  void fly_on(const FrameMotion& motion);

  /// The row with the prior that the track narrows, if it does.
  FrameRecord with_prior(const FrameRecord& row);

  /// Learns from an answer, and changes it where the track says more than the frame alone. `match.frame` is what
  /// with_prior() gave.
  void judge(const FlightFrame& frame, FrameMatch& match);

 private:
  /// Where the aircraft may be, after a fix or a candidate.
  struct Track {
    DriftFilter filter;
    bool established = false;  ///< By a fix; else by a candidate too weak to be one:
    double evidence = 0;
    GeodeticPoint seen_from;   ///< Where its row says it was taken.
    double ground_side_m = 0;  ///< The larger side of the ground that its frame shows.
    double map_sigma_m = 0;    ///< Of the map's own georeference, where it was seen last.
  };
  /// What a candidate says of the error of the row's inertial position.
  struct MeasuredError {
    Eigen::Vector2d error_m;
    Eigen::Matrix2d covariance_m2;
    double map_sigma_m = 0;  ///< Of the map, of which the covariance holds what fixes do not share.
  };

  MeasuredError measured_error(const FrameRecord& row, const FrameMatch& match) const;
  Eigen::Matrix2d difference_covariance(const MeasuredError& measured) const;
  double confirmation_rate(const MeasuredError& measured, const MatchStats& stats) const;
  static bool contradicts(const MeasuredError& measured, const DriftFilter& filter);
  void take_fix(const MeasuredError& measured, MatchResult& result);
  bool confirms(const FlightFrame& frame, const MeasuredError& measured, const MatchStats& stats) const;
  void take_confirmed(const MeasuredError& measured, FrameMatch& match);
  bool shows_ground_of_candidate(const FlightFrame& frame) const;
  void remember(const FlightFrame& frame, const MeasuredError& measured, const MatchStats& stats);
  void refuse();
  void judge_given_up(const MeasuredError& measured);

  MatchOptions options_;
  double map_count_;
  DriftFilter filter_;  ///< Without any fix: what new tracks begin with.
  std::optional<Track> track_;
  std::optional<DriftFilter> given_up_;  ///< The track before, until a fix says whether it was right.
  int jumps_ = 0;                        ///< Tracks in a row that were given up and contradicted by the next fix.
  SequenceSummary summary_;
  bool narrowed_ = false;
  int refusals_ = 0;
};

inline constexpr int kTrackRefusals = 4;
/// One track may have begun with a false fix; the next one not, too.
inline constexpr int kTrackJumps = 2;

}  // namespace pilotage
