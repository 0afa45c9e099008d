#include "pilotage/capture/describe_capture.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "pilotage/base/nan.h"
#include "pilotage/base/statistics.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

constexpr double kLargestFocalChange = 0.03;
/// What all check points miss alike is one draw of each axis: three standard deviations of it.
constexpr double kUnlikelyRatio = 3;

}  // namespace

void describe_frames(const CaptureFrames& frames, const Block& block, const AdjustedBlock& adjusted,
                     const GroundSurface& ground, const EastNorthBounds& bounds, const LocalFrame& local,
                     const Contradictions& contradictions, CaptureResult& result) {
  double squares_m2 = 0;
  double squares = 0;
  double counted = 0;
  for (std::size_t i = 0; i < frames.frames.size(); ++i) {
    const FlightFrame& frame = frames.frames[i];
    const FramePose& pose = adjusted.poses[i];
    const Eigen::Matrix3d enu_from_body = pose.enu_from_camera * block.body_from_camera.transpose();
    const Eigen::Matrix3d ned_from_enu = (Eigen::Matrix3d() << 0, 1, 0, 1, 0, 0, 0, 0, -1).finished();
    const Attitude attitude = attitude_of(ned_from_enu * enu_from_body);
    const Eigen::Vector3d& residual = adjusted.position_residuals_m[i];
    CapturedFrame one;
    one.file = frame.frame.file;
    one.path = frame.path;
    one.time_s = frames.taken_s[i];
    one.measured = frame.frame.prior;
    one.measured_sigma_m = block.measured[i].sigma_en_m;
    one.adjusted = point_at(local, pose.center_enu_m.head<2>());
    one.agl_m = pose.center_enu_m.z() -
                ground.heights.height_m(pose.center_enu_m.head<2>().cwiseMax(bounds.low).cwiseMin(bounds.high));
    one.yaw_deg = std::remainder(attitude.yaw_deg + convergence_deg(local, one.adjusted), 360);
    one.pitch_deg = attitude.pitch_deg;
    one.roll_deg = attitude.roll_deg;
    one.residual_east_m = residual.x();
    one.residual_north_m = residual.y();
    one.residual_up_m = residual.z();
    one.sightings = adjusted.frame_sightings[i];
    one.rms_px = adjusted.frame_rms_px[i];
    if (!contradictions.position[i]) {
      squares_m2 += residual.head<2>().squaredNorm();
      squares += residual.head<2>().squaredNorm() / (2 * one.measured_sigma_m * one.measured_sigma_m);
      ++counted;
    }
    result.frames.push_back(std::move(one));
  }
  result.position_rms_m = std::sqrt(squares_m2 / std::max(1.0, counted));
  result.position_ratio = std::sqrt(squares / std::max(1.0, counted));
  result.contradicted_positions = static_cast<std::int64_t>(result.frames.size()) - static_cast<std::int64_t>(counted);
}

void describe_block(const CaptureFrames& frames, const Block& block, const AdjustedBlock& adjusted,
                    CaptureResult& result) {
  result.pairs = static_cast<std::int64_t>(block.pairs.size());
  result.points = static_cast<std::int64_t>(adjusted.points.size());
  result.sightings = adjusted.sightings;
  result.sightings_found = adjusted.sightings_before;
  result.reprojection_rms_px = adjusted.reprojection_rms_px;
  result.camera_source = frames.camera_source;
  result.given_focal_length_px = frames.camera.fx_px;
  result.camera = adjusted.camera;
  result.camera.mount = frames.camera.mount;
  result.boresight_x_deg = adjusted.boresight_deg.x();
  result.boresight_y_deg = adjusted.boresight_deg.y();
  result.boresight_z_deg = adjusted.boresight_deg.z();
  result.clock_offset_s = adjusted.clock_offset_s;
  result.bias_east_m = adjusted.position_bias_m.x();
  result.bias_north_m = adjusted.position_bias_m.y();
  result.control_points = static_cast<int>(block.control_points.size());
  result.control_sigma_m = block.control_sigma_m;
  double squares_m2 = 0;
  for (const ControlMiss& one : adjusted.control_misses) squares_m2 += one.miss_m * one.miss_m;
  result.control_rms_m = result.control_points > 0 ? std::sqrt(squares_m2 / result.control_points) : kNaN;
  if (!adjusted.converged) {
    result.warnings.push_back("the adjustment had not come to an end when its iterations did");
  }
  const double change = adjusted.camera.fx_px / frames.camera.fx_px - 1;
  if (std::abs(change) > kLargestFocalChange) {
    result.warnings.push_back("the focal length that fits the frames is " + format_fixed(adjusted.camera.fx_px, 0) +
                              " px, not the " + format_fixed(frames.camera.fx_px, 0) + " px of " +
                              (frames.camera_is_given ? "the camera given" : frames.camera_source) + " (" +
                              format_fixed(100 * change, 1) + " %)");
  }
}

void describe_checks(std::size_t given, CaptureResult& result) {
  const std::vector<CheckedPoint>& checks = result.check_points;
  result.check_rms_m = result.check_ratio = kNaN;
  if (checks.size() < given) {
    result.warnings.push_back(std::to_string(given - checks.size()) + " of " + std::to_string(given) +
                              " check points are marked in no frame of the map, or lie where it shows nothing");
  }
  if (checks.empty()) return;
  double squares_m2 = 0;
  double squares = 0;
  double judged = 0;
  for (const CheckedPoint& one : checks) {
    const double miss2_m2 = (one.miss_east_m * one.miss_east_m + one.miss_north_m * one.miss_north_m) / 2;
    squares_m2 += miss2_m2;
    if (!std::isfinite(one.map_sigma_m) || one.map_sigma_m <= 0) continue;  // the map says nothing there
    squares += miss2_m2 / (one.map_sigma_m * one.map_sigma_m);
    ++judged;
  }
  result.check_rms_m = std::sqrt(squares_m2 / static_cast<double>(checks.size()));
  if (judged > 0) result.check_ratio = std::sqrt(squares / judged);
  if (result.check_ratio > kUnlikelyRatio) {
    result.warnings.push_back("check points lie " + format_fixed(result.check_ratio, 1) +
                              " times as far off as the map says of itself: what was stated of positions, control "
                              "points or the other map is not so good");
  }
}

bool is_farther(const MapAlignment& alignment) {
  return alignment.after.shift_m.quantile_95 >
         alignment.before.shift_m.quantile_95 + alignment.before.registration.fit.left_out_m.median;
}

void describe_alignment(CaptureResult& result) {
  const MapAlignment& alignment = *result.alignment;
  result.warnings.insert(result.warnings.end(), alignment.before.warnings.begin(), alignment.before.warnings.end());
  if (alignment.counted_sigma_m > alignment.reference_sigma_m) {
    result.warnings.push_back(alignment.reference + ": is bent: its ties miss by " +
                              format_fixed(alignment.tie_rms_m, 2) + " m, each axis, and it counted as good to " +
                              format_fixed(alignment.counted_sigma_m, 2) + " m alone");
  }
  if (alignment.after.verdict == AuditVerdict::kNotKnown) {
    result.warnings.push_back(alignment.reference + ": the map that was tied to it can no longer be compared with it");
  } else if (is_farther(alignment)) {
    result.warnings.push_back(alignment.reference + ": the map lies farther from it than before it was tied to it");
  }
}

std::vector<std::string> assumptions_of(const CaptureFrames& frames, const Block& block, const std::string& elevation,
                                        const CaptureResult& result, const RegistrationOptions& registration) {
  std::vector<double> sigmas_m;
  for (const MeasuredPose& pose : block.measured) sigmas_m.push_back(pose.sigma_en_m);
  std::vector<std::string> assumptions{"frames' positions are good to " + format_number(quantile(sigmas_m, 0.5)) +
                                       " m (one standard deviation, each axis)"};
  assumptions.push_back(frames.heights == FrameHeights::kAmsl
                            ? "heights of the frames are above mean sea level"
                            : "heights of the frames are above one level, as take-off");
  if (!elevation.empty()) assumptions.push_back("elevation model: " + elevation);
  if (result.alignment) {
    assumptions.push_back("the other map, " + result.alignment->reference + ", lies off by " +
                          format_number(std::round(1000 * result.alignment->counted_sigma_m) / 1000) +
                          " m (one standard deviation, each axis; " +
                          options_detail::enum_to_name(result.alignment->sigma_source) +
                          "), which has nothing to do with what the frames' positions miss");
    assumptions.push_back("of the frames and the other map: " +
                          shadows_assumption(registration, result.alignment->after.registration.gsd_m));
  } else if (block.control_points.empty()) {
    assumptions.push_back(
        "what all positions and tilts miss alike is not known without control points, and shifts the whole map; taken "
        "for " +
        format_number(block.position_bias_sigma_m) + " m (one standard deviation, each axis)");
  }
  if (frames.frames.size() < kFewFrames) {
    assumptions.push_back("the focal length is held to " + format_fixed(100 * kHeldSigma, 0) + " % of that of " +
                          (frames.camera_is_given ? "the camera given" : frames.camera_source) + ": fewer than " +
                          std::to_string(kFewFrames) + " frames do not tell it from the height");
  }
  assumptions.push_back(!elevation.empty()
                            ? "what stands on the elevation model's ground leans away from where it was seen from"
                            : "the ground is smooth: what stands on it leans away from where it was seen from");
  return assumptions;
}

}  // namespace pilotage
