#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pilotage/camera/ortho_rectify.h"
#include "pilotage/match/checkpoint.h"
#include "pilotage/match/chip_mosaic.h"

namespace pilotage {

// Where a rectified frame lies on the map's chips, by zero-mean normalised cross-correlation of their direction fields
// (direction_field.h), the real part of the correlation of complex numbers, over the pixels that are valid in both: D.
// Padfield, "Masked object registration in the Fourier domain", IEEE Trans. Image Processing 21(5), 2012, eq. 9. Frames
// are those of ortho_rectify with gsd_m = the ground length of a mosaic pixel and with "north" up the columns of the
// level's grid (the prior's yaw less the convergence of the grid). A position of the frame is the position of its nadir
// point, (0, 0) of RectifiedFrame::ground_from_pixel, in pixels of the level.

/// A turn of the frame about its nadir point, clockwise seen from above, and a factor on its ground lengths: what the
/// error of yaw and of the height above ground make of it.
struct ChipHypothesis {
  double yaw_deg = 0;
  double scale = 1;
};

/// The hypotheses of a search: `yaw_steps` × `scale_steps` evenly spaced over ± yaw_deg and 1 ± scale (odd numbers have
/// the middle). Throws UsageError unless the steps are in [1, 101].
std::vector<ChipHypothesis> chip_hypotheses(double yaw_deg, int yaw_steps, double scale, int scale_steps);

/// The frame as it is compared.
struct ChipFrame {
  cv::Mat z;                       ///< CV_32FC2: direction_field() of the frame. Empty when it cannot be compared.
  cv::Mat valid;                   ///< CV_8UC1, of the field.
  Eigen::Vector2d nadir_px{0, 0};  ///< The point straight below the camera, in pixels of z.
};

/// Of a frame without ground, of more than kMaxMosaicSidePx or with numbers that are not finite, an empty one.
ChipFrame make_chip_frame(const RectifiedFrame& frame);

struct ChipSearchOptions {
  /// Positions that share less than this part of the frame's pixels with the mosaic are not looked at.
  double min_overlap = 0.5;
  /// Places are farther from each other than this, in pixels of the mosaic, along a row or a column.
  double exclusion_px = 16;
};

struct ChipMatch {
  bool found = false;              ///< The place shares enough pixels, frame and chips have edges, and ncc > 0.
  Eigen::Vector2d nadir_px{0, 0};  ///< Where the frame's nadir point lies, in pixels of the level; to a fraction.
  double yaw_deg = 0;              ///< The hypothesis.
  double scale = 1;
  double ncc = 0;      ///< Its correlation, −1 … 1.
  double overlap = 0;  ///< Share of the frame's pixels that were compared there.
  int pixels = 0;      ///< Their number.
};

/// The places of the square of half side `half_width_px` (pixels of the level) about `center_px`, the expected position
/// of the nadir point, that the frame fits best, the best first and at most eight; each found. From coarse to fine: at
/// half the resolution (in wide windows a quarter) every second one of `hypotheses` is compared at every second
/// position (fourth), and the highest places there, each under its hypothesis, at the full one; the best of them under
/// all hypotheses. All hypotheses are compared over the same pixels of the frame, those that all of them show. Places
/// are told to a fraction of a pixel.
///
/// Never throws but std::bad_alloc and what `checkpoint` throws. An empty frame or mosaic, numbers that are not finite,
/// no hypothesis or one with a scale outside [0.5, 2] give no place.
std::vector<ChipMatch> search_chips(const ChipFrame& frame, const ChipMosaic& mosaic, const Eigen::Vector2d& center_px,
                                    double half_width_px, const std::vector<ChipHypothesis>& hypotheses,
                                    const ChipSearchOptions& options = {}, const Checkpoint& checkpoint = {});

/// The best correlation of `matches` farther than exclusion_px (here pixels of the level) from a place along a row or a
/// column; 0 when there is none.
double rival_ncc(const std::vector<ChipMatch>& matches, const Eigen::Vector2d& nadir_px, double exclusion_px);

/// Bytes that search_chips takes at most at a time, for a frame of this largest side; all
/// lengths in pixels of the mosaic.
double chip_search_bytes(double frame_side_px, double half_width_px, std::size_t hypotheses);

/// Looks around one place only: the frame under the hypothesis of `candidate`, from the whole mosaic pixel at its
/// nadir_px to the nearest peak, at most `reach_px` pixels of the mosaic away along each axis. found = false when there
/// is none, and for input that gives search_chips no place.
ChipMatch confirm_chip_match(const ChipFrame& frame, const ChipMosaic& mosaic, const ChipMatch& candidate, int reach_px,
                             const ChipSearchOptions& options = {});

}  // namespace pilotage
