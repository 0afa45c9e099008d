#include "pilotage/flightlog/frame_track.h"

#include <algorithm>

#include <Eigen/LU>

#include "pilotage/camera/projection.h"
#include "pilotage/geo/geodesic.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/match/confirmation.h"
#include "pilotage/match/position_measurement.h"
#include "pilotage/match/refined_fix.h"

namespace pilotage {
namespace {

MatchPrior prior_of(const FrameRecord& row) {
  return {row.prior, row.prior_covariance_en_m2, row.height_agl_m, row.attitude};
}

}  // namespace

std::string rows_jump_warning(const SequenceSummary& summary) {
  if (!summary.rows_jump) return "";
  return "the positions that the frames were taken at, as told, move against each other by more than the inertial "
         "grade allows: they are not those of one drifting system (or --ins-grade is another). Each frame was matched "
         "with its own prior, as without --sequential";
}

FrameMotion motion_between(const FrameRecord& from, const FrameRecord& to) {
  FrameMotion motion{to.time_s - from.time_s, to.attitude.yaw_deg, 0};
  const GeodesicLeg leg = geodesic_between(from.prior, to.prior);
  if (!(motion.dt_s > 0) || !(leg.length_m > 0)) return motion;
  motion.heading_deg = leg.start_azimuth_deg;
  motion.speed_mps = std::min(leg.length_m / motion.dt_s, 1e4);
  return motion;
}

FrameTrack::FrameTrack(const MatchOptions& options, const InsErrorModel& model, const FrameMotion& first,
                       std::size_t map_count)
    : options_(options),
      map_count_(static_cast<double>(map_count)),
      filter_(model, first.heading_deg, first.speed_mps) {
  options_.max_false_fix_rate /= 2;
}

void FrameTrack::fly_on(const FrameMotion& motion) {
  filter_.fly_on(motion.dt_s, motion.heading_deg, motion.speed_mps);
  if (track_) track_->filter.fly_on(motion.dt_s, motion.heading_deg, motion.speed_mps);
  if (given_up_) given_up_->fly_on(motion.dt_s, motion.heading_deg, motion.speed_mps);
}

FrameRecord FrameTrack::with_prior(const FrameRecord& row) {
  narrowed_ = false;
  if (!track_ || !track_->established) return row;
  const Eigen::Matrix2d covariance = track_->filter.covariance_m2() + isotropic_covariance_m2(track_->map_sigma_m);
  if (!(covariance.determinant() < row.prior_covariance_en_m2.determinant())) return row;
  narrowed_ = true;
  ++summary_.narrowed;
  FrameRecord narrowed = row;
  const Eigen::Vector2d error_m = track_->filter.error_m();
  narrowed.prior = LocalFrame(row.prior).geodetic_from_enu({-error_m.x(), -error_m.y(), 0});
  narrowed.prior_covariance_en_m2 = covariance;
  return narrowed;
}

void FrameTrack::judge(const FlightFrame& frame, FrameMatch& match) {
  MatchResult& result = match.result;
  if (!match.readable() || !result.candidate) return;
  const MeasuredError measured = measured_error(frame.frame, match);
  if (result.status == MatchStatus::kFix) return take_fix(measured, result);
  if (result.status == MatchStatus::kInconsistent &&
      !is_outside_gate(*result.candidate, prior_of(match.frame), options_)) {
    if (confirms(frame, measured, result.stats)) return take_confirmed(measured, match);
    remember(frame, measured, result.stats);
  }
  refuse();
}

FrameTrack::MeasuredError FrameTrack::measured_error(const FrameRecord& row, const FrameMatch& match) const {
  const PositionMeasurement alone = without_prior(*match.result.candidate, prior_of(match.frame));
  const Eigen::Vector3d error_m = -LocalFrame(row.prior).enu_from_geodetic(alone.position);
  return {error_m.head<2>(), covariance_within_map(alone), match.result.candidate->map_sigma_m};
}

Eigen::Matrix2d FrameTrack::difference_covariance(const MeasuredError& measured) const {
  return track_->filter.covariance_m2() + measured.covariance_m2;
}

/// Of candidates of other ground: each map has one that may lie where the track says.
double FrameTrack::confirmation_rate(const MeasuredError& measured, const MatchStats& stats) const {
  return std::min(1.0,
                  map_count_ * false_confirmation_rate(stats.vote_peak, difference_covariance(measured), stats.gsd_m));
}

/// Whether the filter, as it was flown on, does not let the error be what was measured.
bool FrameTrack::contradicts(const MeasuredError& measured, const DriftFilter& filter) {
  return mahalanobis_squared(measured.error_m - filter.error_m(), filter.covariance_m2() + measured.covariance_m2) >
         kInnovationGateChiSquared;
}

void FrameTrack::take_fix(const MeasuredError& measured, MatchResult& result) {
  if (!track_ || !track_->established) {
    judge_given_up(measured);
    track_ = Track{filter_, true, 0, {}, 0, measured.map_sigma_m};
    track_->filter.start(measured.error_m, measured.covariance_m2);
    refusals_ = 0;
    return;
  }
  if (contradicts(measured, track_->filter)) {
    ++summary_.gate_refusals;
    result.status = MatchStatus::kOutsideGate;
    result.fix.reset();
    return refuse();
  }
  track_->filter.update(measured.error_m, measured.covariance_m2);
  track_->map_sigma_m = measured.map_sigma_m;
  refusals_ = jumps_ = 0;
}

/// Whether a weak candidate lies where the track says, seldom enough by chance.
bool FrameTrack::confirms(const FlightFrame& frame, const MeasuredError& measured, const MatchStats& stats) const {
  if (!track_ || (!track_->established && shows_ground_of_candidate(frame))) return false;
  if (!agrees_with_track(measured.error_m - track_->filter.error_m(), difference_covariance(measured))) return false;
  return confirmation_rate(measured, stats) <= options_.max_false_fix_rate;
}

void FrameTrack::take_confirmed(const MeasuredError& measured, FrameMatch& match) {
  MatchResult& result = match.result;
  result.stats.confidence = 1 - confirmation_rate(measured, result.stats);
  result.status = MatchStatus::kFix;
  result.fix = result.candidate;
  match.confirmed = true;
  ++summary_.confirmed;
  track_->established = true;
  track_->filter.update(measured.error_m, measured.covariance_m2);
  track_->map_sigma_m = measured.map_sigma_m;
  refusals_ = 0;
}

/// Frames that share ground are deceived by the same likeness: they cannot confirm each other.
bool FrameTrack::shows_ground_of_candidate(const FlightFrame& frame) const {
  return geodesic_between(track_->seen_from, frame.frame.prior).length_m < track_->ground_side_m;
}

/// Keeps a weak candidate for a later frame; of those that share ground the strongest.
void FrameTrack::remember(const FlightFrame& frame, const MeasuredError& measured, const MatchStats& stats) {
  if (track_ && track_->established) return;
  const bool shared = track_ && shows_ground_of_candidate(frame);
  if (shared && track_->evidence >= stats.vote_peak) return;
  const Footprint ground = footprint(frame.camera, {}, frame.frame.height_agl_m);
  track_ = Track{filter_,
                 false,
                 stats.vote_peak,
                 frame.frame.prior,
                 std::max(ground.across_m, ground.along_m),
                 measured.map_sigma_m};
  track_->filter.start(measured.error_m, measured.covariance_m2);
}

/// A frame that looked where the track says and found nothing there.
void FrameTrack::refuse() {
  if (!narrowed_ || ++refusals_ < kTrackRefusals) return;
  ++summary_.resets;
  given_up_ = track_->filter;
  track_.reset();
  refusals_ = 0;
}

/// A fix by the row's own prior, after a track was given up: did the rows' errors drift from there to here as the model
/// lets them? Where they did not, time and again, they are no drift.
void FrameTrack::judge_given_up(const MeasuredError& measured) {
  if (!given_up_) return;
  jumps_ = contradicts(measured, *given_up_) ? jumps_ + 1 : 0;
  given_up_.reset();
  summary_.rows_jump = summary_.rows_jump || jumps_ >= kTrackJumps;
}

}  // namespace pilotage
