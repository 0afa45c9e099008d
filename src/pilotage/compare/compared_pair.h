#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pilotage/camera/camera.h"
#include "pilotage/camera/ortho_rectify.h"
#include "pilotage/camera/projection.h"
#include "pilotage/compare/compare_options.h"
#include "pilotage/mission/frame_table.h"

namespace pilotage {

/// What is matched with what: a frame, and the reference around the prior. Pixel centres at +0.5. Ground is (east,
/// north) in metres from the prior position, straight on from there.
struct ComparedPair {
  cv::Mat frame;          ///< CV_8UC1: rectified, or as the camera made it.
  cv::Mat frame_allowed;  ///< CV_8UC1, not 0 where features may be.
  cv::Mat reference;      ///< CV_8UC1, north up.
  cv::Mat reference_allowed;
  double gsd_m = 0;                          ///< Of the reference.
  Eigen::Vector2d reference_corner_m{0, 0};  ///< Ground of the reference's north-west corner.
  double frame_area_m2 = 0;                  ///< Ground that frame_allowed shows.
  double expected_scale = 1;                 ///< Pixels of the reference for one of the frame.
  double search_m = 0;                       ///< The point looked for is within this of `expected_m`, east and north.

  Eigen::Vector2d anchor_px{0, 0};      ///< Pixel of the frame that shows the point of which the truth is known.
  Eigen::Vector2d anchor_m{0, 0};       ///< Where prior, attitude and height put it: ground.
  Eigen::Vector2d true_anchor_m{0, 0};  ///< Where it is.
  bool shows_reference = false;         ///< The true point lies within the search window, on imagery.

  std::variant<RectifiedFrame, View> geometry;

  Eigen::Vector2d reference_from_ground(const Eigen::Vector2d& ground_m) const;
  Eigen::Vector2d ground_from_reference(const Eigen::Vector2d& pixel) const;
  /// Where on the ground a pixel of the frame truly is: the truth of the anchor, and the stated attitude and height for
  /// the way from there. Nothing for pixels above the horizon.
  std::optional<Eigen::Vector2d> true_ground(const Eigen::Vector2d& frame_px) const;
};

/// A pair, or why there is none, as a sentence.
using PairOrProblem = std::variant<ComparedPair, std::string>;

/// Reads the reference around the prior of `record` and lays `frame` (CV_8UC1) beside it. The reference is warped onto
/// an azimuthal equidistant projection about the prior, so that north is true north and a metre is a metre. Ground
/// without imagery, and what the frame does not show, get the mean gray value, and no features within kEdgeMarginPx. A
/// frame that shows no ground, or of another size than the camera's, is a problem in words; errors are thrown:
/// DataError for a record without truth, an attitude or height that is not finite, a window above kMaxReferencePx on a
/// side, and as open_gray_on_grid.
PairOrProblem make_compared_pair(const std::vector<std::string>& reference, const FrameRecord& record,
                                 const cv::Mat& frame, const Camera& camera, double gsd_m,
                                 const CompareOptions& options);

inline constexpr int kEdgeMarginPx = 16;
inline constexpr int kMaxReferencePx = 16384;

}  // namespace pilotage
