#include "pilotage/match/frame_grid.h"

#include <opencv2/imgproc.hpp>

#include "pilotage/vision/feature_descriptor.h"

namespace pilotage {

namespace {

constexpr std::size_t kPlacesTogether = 16384;  // some ten milliseconds

/// The picture with `border_px` more on each side, and everything that is not valid as the valid pixel nearest to it.
cv::Mat continued(const cv::Mat& gray, const cv::Mat& valid, int border_px) {
  cv::Mat picture;
  cv::Mat unknown;
  cv::copyMakeBorder(gray, picture, border_px, border_px, border_px, border_px, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::copyMakeBorder(valid == 0, unknown, border_px, border_px, border_px, border_px, cv::BORDER_CONSTANT,
                     cv::Scalar(255));
  cv::Mat distance;
  cv::Mat nearest;  // the number of the valid pixel
  cv::distanceTransform(unknown, distance, nearest, cv::DIST_L2, 5, cv::DIST_LABEL_PIXEL);
  std::vector<std::uint8_t> values(picture.total() + 1);
  const auto for_pixels = [&](bool of_valid, const auto& act) {
    for (int row = 0; row < picture.rows; ++row) {
      const auto* const is_unknown = unknown.ptr<std::uint8_t>(row);
      const auto* const number = nearest.ptr<std::int32_t>(row);
      auto* const pixel = picture.ptr<std::uint8_t>(row);
      for (int col = 0; col < picture.cols; ++col) {
        if ((is_unknown[col] == 0) == of_valid) act(values[static_cast<std::size_t>(number[col])], pixel[col]);
      }
    }
  };
  for_pixels(true, [](std::uint8_t& value, const std::uint8_t& pixel) { value = pixel; });
  for_pixels(false, [](const std::uint8_t& value, std::uint8_t& pixel) { pixel = value; });
  return picture;
}

/// How far a described point lies within the valid pixels at least.
int inside_px(const BinaryDescriptor& descriptor) {
  return std::min(descriptor.reach_px, kLeastInsidePx);
}

/// How far beyond them a descriptor may ask for pixels.
int border_px_of(const BinaryDescriptor& descriptor) {
  return descriptor.reach_px - inside_px(descriptor);
}

/// `picture_of(border_px)`: the frame's picture, continued so far on each side.
template <typename PictureOf>
FrameGrid describe_grid(const RectifiedFrame& frame, const FeatureOptions& options, int step_px,
                        const Checkpoint& checkpoint, const PictureOf& picture_of) {
  check_feature_options(options);
  FrameGrid grid;
  grid.step_px = step_px;
  grid.columns = (frame.gray.cols + step_px - 1) / step_px;
  grid.rows = (frame.gray.rows + step_px - 1) / step_px;
  grid.index.assign(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows), -1);
  const BinaryDescriptor& descriptor = descriptor_of(options);
  grid.points.pattern = descriptor.pattern;
  grid.points.descriptor_bytes = descriptor.bytes();

  const int side_px = 2 * inside_px(descriptor) + 1;
  cv::Mat far_inside;  // the border counts as invalid
  cv::erode(frame.valid, far_inside, cv::getStructuringElement(cv::MORPH_RECT, {side_px, side_px}), cv::Point(-1, -1),
            1, cv::BORDER_CONSTANT, cv::Scalar(0));
  if (cv::countNonZero(far_inside) == 0) return grid;
  const int border_px = border_px_of(descriptor);
  const cv::Mat picture = picture_of(border_px);
  std::vector<Corner> places;
  const auto describe_places = [&] {
    const auto described = describe_corners(picture, places, descriptor);
    grid.points.descriptors.insert(grid.points.descriptors.end(), described.begin(), described.end());
    places.clear();
    pass(checkpoint);
  };
  for (int y = 0; y < frame.gray.rows; y += step_px) {
    if (places.size() >= kPlacesTogether) describe_places();
    for (int x = 0; x < frame.gray.cols; x += step_px) {
      if (far_inside.at<std::uint8_t>(y, x) == 0) continue;
      grid.index[static_cast<std::size_t>(y / step_px) * static_cast<std::size_t>(grid.columns) +
                 static_cast<std::size_t>(x / step_px)] = static_cast<std::int32_t>(grid.points.features.size());
      places.push_back({x + border_px, y + border_px, 0});
      grid.points.features.push_back({static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F, 0, 0});
    }
  }
  describe_places();
  return grid;
}

}  // namespace

FrameGrid describe_frame_grid(const RectifiedFrame& frame, const FeatureOptions& options, int step_px,
                              const Checkpoint& checkpoint) {
  return describe_grid(frame, options, step_px, checkpoint,
                       [&](int border_px) { return continued(frame.gray, frame.valid, border_px); });
}

FrameGrid describe_continued_grid(const RectifiedFrame& frame, const FeatureOptions& options, int step_px,
                                  const Checkpoint& checkpoint) {
  return describe_grid(frame, options, step_px, checkpoint, [&](int border_px) {
    cv::Mat picture;
    cv::copyMakeBorder(frame.gray, picture, border_px, border_px, border_px, border_px, cv::BORDER_REPLICATE);
    return picture;
  });
}

RectifiedFrame continued_frame(const RectifiedFrame& frame, const FeatureOptions& options) {
  const int border_px = border_px_of(descriptor_of(options));
  RectifiedFrame wide = frame;
  wide.gray = continued(frame.gray, frame.valid, border_px);
  wide.valid = cv::Mat();  // not that of `frame`
  cv::copyMakeBorder(frame.valid, wide.valid, border_px, border_px, border_px, border_px, cv::BORDER_CONSTANT,
                     cv::Scalar(0));
  wide.origin_m += frame.gsd_m * border_px * Eigen::Vector2d(-1, 1);
  return wide;
}

}  // namespace pilotage
