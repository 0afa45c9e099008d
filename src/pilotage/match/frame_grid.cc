#include "pilotage/match/frame_grid.h"

#include <opencv2/imgproc.hpp>

#include "pilotage/vision/feature_descriptor.h"

namespace pilotage {

namespace {

constexpr std::size_t kPlacesTogether = 16384;  // some ten milliseconds

}  // namespace

FrameGrid describe_frame_grid(const RectifiedFrame& frame, const FeatureOptions& options, int step_px,
                              const Checkpoint& checkpoint) {
  check_feature_options(options);
  FrameGrid grid;
  grid.step_px = step_px;
  grid.columns = (frame.gray.cols + step_px - 1) / step_px;
  grid.rows = (frame.gray.rows + step_px - 1) / step_px;
  grid.index.assign(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows), -1);
  const BinaryDescriptor& descriptor = descriptor_of_bits(options.descriptor_bits);
  grid.points.descriptor_bytes = descriptor.bytes();

  const int radius_px = patch_radius_px(options);
  const int side_px = 2 * radius_px + 1;
  cv::Mat whole_patch;  // the border counts as invalid
  cv::erode(frame.valid, whole_patch, cv::getStructuringElement(cv::MORPH_RECT, {side_px, side_px}), cv::Point(-1, -1),
            1, cv::BORDER_CONSTANT, cv::Scalar(0));
  std::vector<Corner> places;
  std::vector<float> angles_deg;
  const auto describe_places = [&] {
    const auto described = describe_corners(frame.gray, places, angles_deg, descriptor);
    grid.points.descriptors.insert(grid.points.descriptors.end(), described.begin(), described.end());
    places.clear();
    angles_deg.clear();
    pass(checkpoint);
  };
  for (int y = 0; y < frame.gray.rows; y += step_px) {
    if (places.size() >= kPlacesTogether) describe_places();
    for (int x = 0; x < frame.gray.cols; x += step_px) {
      if (whole_patch.at<std::uint8_t>(y, x) == 0) continue;
      const float angle_deg = options.oriented ? centroid_angle_deg(frame.gray, x, y) : 0;
      grid.index[static_cast<std::size_t>(y / step_px) * static_cast<std::size_t>(grid.columns) +
                 static_cast<std::size_t>(x / step_px)] = static_cast<std::int32_t>(grid.points.features.size());
      places.push_back({x, y, 0});
      angles_deg.push_back(angle_deg);
      grid.points.features.push_back({static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F, 0, angle_deg, 0});
    }
  }
  describe_places();
  return grid;
}

}  // namespace pilotage
