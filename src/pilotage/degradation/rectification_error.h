#pragma once

namespace pilotage {

/// One-sigma errors of what a frame is ortho-rectified with; flat ground, camera looking straight down.
struct RectificationSigma {
  double heading_sigma_deg = 0;
  double tilt_sigma_deg = 0;  ///< Of roll and of pitch.
  double height_sigma_m = 0;  ///< Of the height above ground.
  double height_m = 100;      ///< Above ground.
  double half_fov_deg = 30;   ///< From the optical axis to the middle of a side of a square frame.
};

/// What they do to the rectified frame: DegradationOptions::rotation_deg and scale_percent.
struct RectificationError {
  double rotation_deg = 0;
  double scale_percent = 0;
};

/// Root mean square, over the errors and over the frame, of the local rotation and the local change of scale, to first
/// order in the errors. A heading error turns the frame by itself, a relative height error scales it. A pitch error δ
/// moves the point with tangents (u, v) off the axis to (u + δ(1 + u²), v(1 + δu)); the Jacobian of that turns by δv/2
/// and scales by 1 + 3δu/2, and roll does the same with u and v exchanged. With t = tan(half_fov) the mean of u² + v²
/// over the frame is 2t²/3, so
///
///   rotation² = heading² + tilt²·t²/6        (scale)² = (height_sigma/height)² + tilt²·3t²/2
///
/// (angles in radians). Degraded copies take rotation and scale in full size with either sign, so these root mean
/// squares give them the variance of the errors. The displacement of the whole frame, height·tilt, is the search
/// radius' matter. Throws UsageError for a negative or not finite sigma, a height not above 0, or half_fov_deg outside
/// (0, 80].
RectificationError rectification_error(const RectificationSigma& sigma);

}  // namespace pilotage
