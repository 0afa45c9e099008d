#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pilotage/camera/ortho_rectify.h"
#include "pilotage/match/checkpoint.h"
#include "pilotage/match/chip_mosaic.h"

namespace pilotage {

// Where a rectified frame lies on the map's chips, by zero-mean normalised cross-correlation over the pixels that are
// valid in both: D. Padfield, "Masked object registration in the Fourier domain", IEEE Trans. Image Processing 21(5),
// 2012, eq. 9. Frames are those of ortho_rectify with gsd_m = the ground length of a mosaic pixel and with "north" up
// the columns of the level's grid (the prior's yaw less the convergence of the grid). A position of the frame is the
// position of its nadir point, (0, 0) of RectifiedFrame::ground_from_pixel, in pixels of the level.

/// A turn of the frame about its nadir point, clockwise seen from above, and a factor on its ground lengths: what the
/// error of yaw and of the height above ground make of it.
struct ChipHypothesis {
  double yaw_deg = 0;
  double scale = 1;
};

/// The hypotheses of a search: `yaw_steps` × `scale_steps` evenly spaced over ± yaw_deg and 1 ± scale (odd numbers have
/// the middle). Throws UsageError unless the steps are in [1, 101].
std::vector<ChipHypothesis> chip_hypotheses(double yaw_deg, int yaw_steps, double scale, int scale_steps);

/// Whether a frame and a mosaic are what their types say, and not too large. All searches on chips ask this first.
bool can_be_compared(const RectifiedFrame& frame);
bool can_be_compared(const ChipMosaic& mosaic);

struct ChipSearchOptions {
  /// Frame and mosaic are compared after local_contrast() with this Gaussian, in pixels of the mosaic; 0 compares gray
  /// values as they are.
  double contrast_sigma_px = 1.5;
  /// Positions that share less than this part of the frame's pixels with the mosaic are not looked at.
  double min_overlap = 0.5;
  /// Rivals are farther from the best place than this, in pixels of the mosaic, along a row or a column.
  double exclusion_px = 8;
};

struct ChipMatch {
  bool found = false;              ///< Some position shares enough pixels, and frame and chips have contrast.
  Eigen::Vector2d nadir_px{0, 0};  ///< Where the frame's nadir point lies, in pixels of the level; to a fraction.
  double yaw_deg = 0;              ///< The hypothesis of the best place.
  double scale = 1;
  double ncc = 0;  ///< Its correlation, −1 … 1.
  double rival_ncc =
      0;               ///< The best elsewhere, over all hypotheses; 0 when nothing correlates or there is no elsewhere.
  double overlap = 0;  ///< Share of the frame's pixels that were compared there.
  int pixels = 0;      ///< Their number. Ground of another place correlates as 1/√pixels.
};

/// Compares the frame under every hypothesis at every whole mosaic pixel of the square of half side `half_width_px`
/// (pixels of the level) about `center_px`, the expected position of the nadir point. All hypotheses are compared over
/// the same pixels of the frame, those that all of them show. The best place is refined to a fraction of a pixel by a
/// parabola through its neighbours.
///
/// Never throws but std::bad_alloc and what `checkpoint` throws. A frame or mosaic without ground or of more than
/// kMaxMosaicSidePx, numbers that are not finite, no hypothesis or one with a scale outside [0.5, 2], and a best
/// correlation that is not above 0 give found = false.
ChipMatch search_chips(const RectifiedFrame& frame, const ChipMosaic& mosaic, const Eigen::Vector2d& center_px,
                       double half_width_px, const std::vector<ChipHypothesis>& hypotheses,
                       const ChipSearchOptions& options = {}, const Checkpoint& checkpoint = {});

/// The same from coarse to fine, for windows so wide that search_chips takes long: every second position is compared at
/// half the resolution, under `coarse_hypotheses` (which need be no nearer to each other than `hypotheses` in pixels,
/// so fewer do), and about the best eight places every position under every one of `hypotheses`. The rival is the best
/// of the other seven.
ChipMatch search_chips_coarsely(const RectifiedFrame& frame, const ChipMosaic& mosaic, const Eigen::Vector2d& center_px,
                                double half_width_px, const std::vector<ChipHypothesis>& coarse_hypotheses,
                                const std::vector<ChipHypothesis>& hypotheses, const ChipSearchOptions& options = {},
                                const Checkpoint& checkpoint = {});

/// Bytes that search_chips, or search_chips_coarsely, takes at most at a time, for a frame of this largest side; all
/// lengths in pixels of the mosaic.
double chip_search_bytes(double frame_side_px, double half_width_px, std::size_t hypotheses);

/// Looks around one place only: the frame under the hypothesis of `candidate` and at its nadir_px, moved by up to
/// `reach_px` whole mosaic pixels in every direction; nadir_px, ncc and overlap of the result are those of the best of
/// them, refined to a fraction of a pixel; rival_ncc stays that of `candidate`. found = false as above.
ChipMatch confirm_chip_match(const RectifiedFrame& frame, const ChipMosaic& mosaic, const ChipMatch& candidate,
                             int reach_px, const ChipSearchOptions& options = {});

}  // namespace pilotage
