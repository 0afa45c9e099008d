#include "pilotage/replay/log_frames.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"
#include "pilotage/flightlog/drifting_priors.h"
#include "pilotage/geo/geodesic.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/geo/position_covariance.h"
#include "pilotage/raster/elevation.h"
#include "pilotage/vehiclelog/pose_at.h"

namespace pilotage {
namespace {

constexpr double kReach_s = 1;
constexpr double kGnssReach_s = 2;
constexpr std::size_t kMostMadeUpFrames = 100'000;

/// What the log says of a time.
struct LoggedPose {
  std::optional<LoggedPosition> truth;
  std::optional<LoggedPosition> believed;
  std::optional<Attitude> true_attitude;
  std::optional<Attitude> attitude;  ///< Believed.
  double agl_m = kNaN;
  std::string agl_from;
};

double lowest_amsl_m(const VehicleLog& log) {
  double lowest_m = kNaN;
  for (const LoggedTrack* track : {&log.truth, &log.estimate, &log.gnss}) {
    for (const LoggedPosition& position : track->positions) lowest_m = std::fmin(lowest_m, position.amsl_m);
    if (!std::isnan(lowest_m)) break;
  }
  return lowest_m;
}

/// The height of the ground where nothing measures the height above it.
class GroundBelow {
 public:
  GroundBelow(const VehicleLog& log, const LogFrameOptions& options)
      : options_(options), lowest_m_(lowest_amsl_m(log)) {
    if (options.ground_amsl_m || options.elevation.empty()) return;
    try {
      elevation_.emplace(options.elevation);
    } catch (const DataError& error) {  // the model may lie on the machine that planned
      unreadable_ = error.what();
    }
  }

  void set_height(const LoggedPosition& position, LoggedPose& pose) {
    const auto take = [&](double ground_amsl_m, const std::string& from) {
      pose.agl_m = position.amsl_m - ground_amsl_m;
      pose.agl_from = from;
    };
    const auto at = [](double amsl_m) { return "the ground at " + format_fixed(amsl_m, 1) + " m above sea level, "; };
    if (options_.ground_amsl_m) return take(*options_.ground_amsl_m, at(*options_.ground_amsl_m) + "as given");
    const double below_m = elevation_ ? elevation_->amsl_m(position.point) : kNaN;
    if (!std::isnan(below_m)) return take(below_m, "the elevation model of the plan, " + options_.elevation);
    if (options_.flat_ground_amsl_m) {
      return take(*options_.flat_ground_amsl_m, at(*options_.flat_ground_amsl_m) + "as the plan assumed");
    }
    take(lowest_m_, at(lowest_m_) + "the lowest height of the log: give --ground-amsl-m");
  }
  const std::string& unreadable() const { return unreadable_; }

 private:
  const LogFrameOptions& options_;
  double lowest_m_;
  std::optional<Elevation> elevation_;
  std::string unreadable_;
};

LoggedPose pose_of(const VehicleLog& log, double time_s) {
  LoggedPose pose;
  pose.truth = position_at(log.truth.positions, time_s, kReach_s);
  if (log.truth.positions.empty()) pose.truth = position_at(log.gnss.positions, time_s, kGnssReach_s);
  pose.believed = position_at(log.estimate.positions, time_s, kReach_s);
  pose.attitude = attitude_at(log.estimate.attitudes, time_s, kReach_s);
  pose.true_attitude = attitude_at(log.truth.attitudes, time_s, kReach_s);
  if (!pose.true_attitude) pose.true_attitude = pose.attitude;
  if (!pose.attitude) pose.attitude = pose.true_attitude;
  if (const auto range_m = height_at(log.ranges, time_s, kReach_s)) {
    pose.agl_m = *range_m;
    pose.agl_from = "the range finder";
  } else if (const auto height_m = height_at(log.heights, time_s, kReach_s)) {
    pose.agl_m = *height_m;
    pose.agl_from = "the autopilot's own height above ground";
  }
  return pose;
}

/// Fills what the capture itself says.
void add_capture_to_pose(const LoggedCapture& capture, LoggedPose& pose) {
  if (!pose.attitude) pose.attitude = pose.true_attitude = capture.attitude;
  if (!pose.truth && !pose.believed && capture.point) {
    pose.believed = LoggedPosition{capture.time_s, *capture.point, capture.amsl_m};
  }
  if (std::isnan(capture.agl_m)) return;
  pose.agl_m = capture.agl_m;
  pose.agl_from = "the capture";
}

std::vector<LoggedCapture> made_up_captures(const VehicleLog& log, double every_s) {
  const auto& positions = log.truth.positions.empty() ? log.gnss.positions : log.truth.positions;
  std::vector<LoggedCapture> captures;
  if (positions.empty()) return captures;
  const double first_s = positions.front().time_s;
  const double whole_s = positions.back().time_s - first_s;
  if (whole_s / every_s > static_cast<double>(kMostMadeUpFrames)) {
    throw DataError("a frame every " + format_number(every_s) + " s of " + format_fixed(whole_s, 0) +
                    " s are more than " + std::to_string(kMostMadeUpFrames));
  }
  for (std::size_t i = 0; static_cast<double>(i) * every_s <= whole_s; ++i) {
    LoggedCapture capture;
    capture.time_s = first_s + static_cast<double>(i) * every_s;
    capture.number = static_cast<std::int64_t>(i);
    captures.push_back(std::move(capture));
  }
  return captures;
}

/// Counts of what kept frames out.
struct LeftOutFrames {
  std::int64_t no_position = 0;
  std::int64_t no_attitude = 0;
  std::int64_t no_height = 0;

  std::string text() const {
    std::vector<std::string> parts;
    if (no_position > 0) parts.push_back(std::to_string(no_position) + " without a position within 1 s");
    if (no_attitude > 0) parts.push_back(std::to_string(no_attitude) + " without an attitude within 1 s");
    if (no_height > 0) parts.push_back(std::to_string(no_height) + " without a height above the ground");
    return parts.empty() ? "" : "frames left out: " + join(parts, ", ");
  }
};

}  // namespace

void draw_priors(std::vector<FrameRecord>& rows, const InsErrorModel& model, std::uint64_t seed) {
  double way_m = 0;
  std::vector<FlownPlace> places;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const FrameRecord& row = rows[i];
    if (!row.true_nadir) {
      throw DataError("priors cannot be drawn: no true position is known at " + format_fixed(row.time_s, 1) +
                      " s; give --priors log");
    }
    double heading_deg = row.attitude.yaw_deg;
    if (i > 0) {
      const GeodesicLeg leg = geodesic_between(*rows[i - 1].true_nadir, *row.true_nadir);
      way_m += leg.length_m;
      if (leg.length_m > 1) heading_deg = leg.end_azimuth_deg;
    }
    places.push_back({row.time_s, heading_deg});
  }
  const double flown_s = rows.back().time_s - rows.front().time_s;
  const double speed_mps = flown_s > 0 ? std::min(way_m / flown_s, 1000.0) : 0;
  const std::vector<DriftingPrior> priors = drifting_priors(places, speed_mps, model, seed);
  for (std::size_t i = 0; i < priors.size(); ++i) {
    const Eigen::Vector2d& error_m = priors[i].error_en_m;
    rows[i].prior = LocalFrame(*rows[i].true_nadir).geodetic_from_enu({error_m.x(), error_m.y(), 0});
    rows[i].prior_covariance_en_m2 = priors[i].covariance_en_m2;
  }
}

LogFrames frames_of_log(const VehicleLog& log, const LogFrameOptions& options, const InsErrorModel& model, bool make_up,
                        std::uint64_t seed) {
  LogFrames frames;
  const bool made_up = log.captures.empty() && make_up;
  const std::vector<LoggedCapture> captures = made_up ? made_up_captures(log, options.every_s) : log.captures;
  GroundBelow ground(log, options);
  LeftOutFrames left_out;
  std::map<std::string, std::int64_t> heights_from;
  for (const LoggedCapture& capture : captures) {
    LoggedPose pose = pose_of(log, capture.time_s);
    add_capture_to_pose(capture, pose);
    const auto& position = pose.truth ? pose.truth : pose.believed;
    const bool wants_estimate = options.priors == LogPriors::kLog && !pose.believed;
    if (!position || wants_estimate) {
      ++left_out.no_position;
      continue;
    }
    if (!pose.attitude) {
      ++left_out.no_attitude;
      continue;
    }
    if (std::isnan(pose.agl_m)) ground.set_height(*position, pose);
    if (!(pose.agl_m > 0)) {
      ++left_out.no_height;
      continue;
    }
    FrameRecord row;
    row.file = capture.file.empty() ? "frame_" + std::to_string(frames.rows.size() + 1) + ".png" : capture.file;
    row.time_s = capture.time_s;
    row.prior = pose.believed ? pose.believed->point : position->point;
    row.prior_covariance_en_m2 = isotropic_covariance_m2(options.prior_sigma_m);
    row.height_agl_m = pose.agl_m;
    row.attitude = *pose.attitude;
    if (pose.truth) row.true_nadir = pose.truth->point;
    ++heights_from[pose.agl_from];
    frames.rows.push_back(std::move(row));
    frames.true_agl_m.push_back(pose.agl_m);
    frames.true_attitude.push_back(*pose.true_attitude);
  }
  if (const std::string text = left_out.text(); !text.empty()) frames.notes.push_back(text);
  if (frames.rows.empty()) {
    if (!captures.empty()) throw DataError("no frame has all that matching needs; " + left_out.text());
    throw DataError(make_up ? "the log has no true position, of GNSS or a simulator, to render frames at"
                            : "the log has no capture or trigger of a camera, and no imagery to render from is given");
  }
  if (!ground.unreadable().empty()) {
    frames.notes.push_back("the plan's elevation model is not used: " + ground.unreadable());
  }
  for (const auto& [from, count] : heights_from) {
    frames.notes.push_back("height above ground of " + std::to_string(count) + " frames: by " + from);
  }
  if (log.truth.positions.empty() && !log.gnss.positions.empty()) {
    frames.notes.emplace_back("GNSS counts as the truth");
  }
  if (options.priors == LogPriors::kDrawn) draw_priors(frames.rows, model, seed);
  return frames;
}

}  // namespace pilotage
