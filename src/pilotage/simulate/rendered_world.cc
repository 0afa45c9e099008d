#include "pilotage/simulate/rendered_world.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/ground/ground_imagery.h"
#include "pilotage/raster/gdal_gray.h"
#include "pilotage/raster/gray_stretch.h"

namespace pilotage {
namespace {

constexpr double kLeastMotion_px = 0.1;

}  // namespace

RenderedWorld make_rendered_world(const Mission& mission, const std::string& imagery, const std::string& elevation) {
  const auto knows_height = [](const FlightSample& sample) { return std::isfinite(sample.amsl_m - sample.agl_m); };
  const std::vector<FlightSample>& samples = mission.flight.samples;
  if (!elevation.empty() && !std::all_of(samples.begin(), samples.end(), knows_height)) {
    throw UsageError(elevation +
                     ": the plan knows no heights above sea level, so nobody knows how far above these "
                     "heights it flies: prepare it with an elevation model");
  }
  RenderedWorld world;
  world.elevation = elevation.empty() ? mission.ground.elevation : elevation;
  world.heights_of_the_map = elevation.empty();
  world.of_the_map = imagery.empty();
  world.ground =
      stretch_to_8bit(imagery.empty() ? open_gray(mission.ground, mission.ground.levels.front())
                                      : open_gray(imagery, second_date_options(mission.ground.imagery.options)));
  return world;
}

Eigen::Vector2d motion_in_image(const Camera& camera, const CameraPose& pose, const Eigen::Vector2d& way_m) {
  const auto view = make_view(camera, pose.attitude, pose.height_agl_m);
  if (!view) return {0, 0};
  const Eigen::Vector2d middle(camera.width_px / 2.0, camera.height_px / 2.0);
  const auto ground_m = ground_from_pixel(*view, middle);
  if (!ground_m) return {0, 0};
  const auto moved = pixel_from_ground(*view, *ground_m - way_m);
  return moved ? Eigen::Vector2d(*moved - middle) : Eigen::Vector2d(0, 0);
}

void blur_by_motion(cv::Mat& gray, const Eigen::Vector2d& motion_px) {
  const double length_px = std::min(motion_px.norm(), kMostMotion_px);
  if (!(length_px >= kLeastMotion_px)) return;
  const Eigen::Vector2d motion = motion_px.normalized() * length_px;
  // A kernel of as many dots on the line, each spread over four pixels.
  const int count = static_cast<int>(std::ceil(2 * length_px)) + 1;
  const int half = static_cast<int>(std::ceil(length_px / 2)) + 1;
  cv::Mat kernel = cv::Mat::zeros(2 * half + 1, 2 * half + 1, CV_32FC1);
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d at = motion * ((i + 0.5) / count - 0.5) + Eigen::Vector2d(half, half);
    const int col = static_cast<int>(at.x());
    const int row = static_cast<int>(at.y());
    const double x = at.x() - col;
    const double y = at.y() - row;
    kernel.at<float>(row, col) += static_cast<float>((1 - x) * (1 - y) / count);
    kernel.at<float>(row, col + 1) += static_cast<float>(x * (1 - y) / count);
    kernel.at<float>(row + 1, col) += static_cast<float>((1 - x) * y / count);
    kernel.at<float>(row + 1, col + 1) += static_cast<float>(x * y / count);
  }
  cv::filter2D(gray, gray, CV_8U, kernel, cv::Point(-1, -1), 0, cv::BORDER_REPLICATE);
}

}  // namespace pilotage
