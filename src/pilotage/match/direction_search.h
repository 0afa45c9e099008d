#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pilotage/camera/ortho_rectify.h"
#include "pilotage/match/checkpoint.h"
#include "pilotage/match/chip_mosaic.h"

namespace pilotage {

// Where a frame lies on the map's chips by the directions of its edges, part by part: these stay from one season, or
// sensor, to another more often than gray values do. What it is, what it gives and what was tried beside it:
// docs/decisions/directions.md. Frames, mosaics and positions of the nadir point are those of chip_search.h.

/// What is compared of each pixel. Its gradient as the first three terms of a Fourier series of its direction,
/// smoothed, all six together at most of unit length: what eight bins of a histogram of oriented gradients hold, but
/// for their fourth term (cells of N. Dalal, B. Triggs, CVPR 2005). Then its local contrast at two widths. Each less
/// its surroundings. Eight CV_32FC1; 0 where not valid, and beside.
std::vector<cv::Mat> direction_field(const cv::Mat& gray, const cv::Mat& valid);

/// A place of the nadir point, in pixels of the level, and how far the frame is turned there.
struct DirectionPlace {
  Eigen::Vector2d nadir_px{0, 0};
  double turn_deg = 0;  ///< Clockwise seen from above.
  double agreement = 0;
};

/// How well a frame agrees with the chips at every position of its nadir point in a window.
struct DirectionSurface {
  /// CV_32FC1: over the median of the window, in standard deviations of what the parts do elsewhere; kNotCompared where
  /// the frame shares too few pixels with the chips.
  cv::Mat agreement;
  cv::Mat turn;                    ///< CV_8UC1: of turns_deg that of the agreement.
  std::vector<double> turns_deg;   ///< That were compared: of those asked for all that take no part too far.
  Eigen::Vector2d first_px{0, 0};  ///< The position of its first pixel, in pixels of the level.
  double step_px = 1;              ///< From one of its pixels to the next, likewise.

  static constexpr float kNotCompared = -100;

  /// How many of its pixels lie to each side of the middle.
  double reach() const { return (agreement.cols - 1) / 2.0; }

  /// The most within one of its pixels of a place of the nadir, in pixels of the level; 0 outside the window, at least
  /// 0.
  double at(const Eigen::Vector2d& nadir_px) const;
};

/// The frame is cut into 3 × 3 parts. Each is correlated with the chips over all that is compared, its surface may move
/// by two pixels at a price, and is divided by its own spread over the window, so that no road or roof rules; their sum
/// is N(0, 1) where nothing fits. Positions at which a part lies on no chips do not count. For each turn, in degrees
/// clockwise, the parts stand where it takes them, but are not turned themselves; the best counts. A frame or a window
/// that is larger than kMostDirectionSide or kMostDirectionReach is compared at half the resolution of the chips, a
/// quarter, and so on. `center_px` and `half_width_px`, in pixels of the level, are those of search_chips(); the spread
/// is that of 29 pixels to each side at least.
///
/// Never throws but std::bad_alloc and what `checkpoint` throws. Nothing where frame, mosaic or numbers are not usable
/// (search_chips), at no turn or more than 255, where no three parts show ground, or where less than
/// kLeastDirectionPixels are left to compare.
std::optional<DirectionSurface> search_directions(const RectifiedFrame& frame, const ChipMosaic& mosaic,
                                                  const Eigen::Vector2d& center_px, double half_width_px,
                                                  const std::vector<double>& turns_deg,
                                                  const Checkpoint& checkpoint = {});

/// The `count` highest places that are farther apart than `exclusion_px` along a row or a column, the highest first.
std::vector<DirectionPlace> direction_places(const DirectionSurface& surface, std::size_t count, double exclusion_px);

/// Bytes that search_directions takes at most at a time, for a frame of this largest side; all lengths in pixels of the
/// mosaic.
double direction_search_bytes(double frame_side_px, double half_width_px);

/// Of a frame's larger side and of a window to each side of its middle, in pixels of what is compared: what a search
/// takes no more than some 50 ms for.
inline constexpr int kMostDirectionSide = 112;
inline constexpr int kMostDirectionReach = 80;
/// Of the frame, likewise: 36 to a side. Smaller ones were not measured.
inline constexpr int kLeastDirectionPixels = 1296;

}  // namespace pilotage
