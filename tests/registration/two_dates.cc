#include "registration/two_dates.h"

#include <cmath>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/random.h"

namespace pilotage::testing {
namespace {

const GeoTransform kPlace = GeoTransform::north_up(1000, 5000, 1);

/// The raster on a coarser grid; pixels that are not covered as a whole are not valid.
GraySource on_grid(const Raster& raster, const GeoTransform& place, std::int64_t width_px, std::int64_t height_px) {
  const int factor = static_cast<int>(std::lround(place.x_per_col / raster.map_from_pixel.x_per_col));
  const Eigen::Vector2d corner = raster.map_from_pixel.pixel_from_map({place.origin_x, place.origin_y});
  const cv::Size fine(static_cast<int>(width_px) * factor, static_cast<int>(height_px) * factor);
  Raster grid{cv::Mat(fine, CV_8U, cv::Scalar(0)), cv::Mat(fine, CV_8U, cv::Scalar(0)), place};
  const cv::Rect target(-static_cast<int>(std::lround(corner.x())), -static_cast<int>(std::lround(corner.y())),
                        raster.pixels.cols, raster.pixels.rows);
  const cv::Rect inside = target & cv::Rect({0, 0}, fine);
  raster.pixels(inside - target.tl()).copyTo(grid.pixels(inside));
  raster.valid(inside - target.tl()).copyTo(grid.valid(inside));
  const cv::Size coarse(static_cast<int>(width_px), static_cast<int>(height_px));
  cv::resize(grid.pixels, grid.pixels, coarse, 0, 0, cv::INTER_AREA);
  cv::resize(grid.valid, grid.valid, coarse, 0, 0, cv::INTER_AREA);
  grid.valid = grid.valid == 255;
  return gray_source_from(grid);
}

}  // namespace

cv::Mat random_texture(int side_px, std::string_view seed_name) {
  Random random(seed_from_name(seed_name));
  cv::Mat noise(side_px, side_px, CV_32F);
  for (int row = 0; row < side_px; ++row) {
    for (int col = 0; col < side_px; ++col) noise.at<float>(row, col) = static_cast<float>(random.normal());
  }
  cv::Mat sum = cv::Mat::zeros(noise.size(), CV_32F);
  for (const double sigma_px : {1.5, 4.0, 10.0}) {
    cv::Mat smooth;
    cv::GaussianBlur(noise, smooth, {0, 0}, sigma_px);
    sum += smooth * (25 * 2 * sigma_px);  // white noise smoothed by σ keeps 1 / (2 √π σ) of its deviation
  }
  cv::Mat texture;
  cv::Mat(sum + 120).convertTo(texture, CV_8U);
  return texture;
}

TwoDates make_two_dates(int side_px, const TrueField& field, std::string_view seed_name) {
  const cv::Mat valid(side_px, side_px, CV_8U, cv::Scalar(255));
  TwoDates dates{{{}, valid, kPlace}, {random_texture(side_px, seed_name), valid.clone(), kPlace}};
  cv::Mat x(side_px, side_px, CV_32F);
  cv::Mat y(side_px, side_px, CV_32F);
  for (int row = 0; row < side_px; ++row) {
    for (int col = 0; col < side_px; ++col) {
      const Eigen::Vector2d point = kPlace.map_from_pixel({col + 0.5, row + 0.5});
      const Eigen::Vector2d there = kPlace.pixel_from_map(point + field(point));
      x.at<float>(row, col) = static_cast<float>(there.x() - 0.5);
      y.at<float>(row, col) = static_cast<float>(there.y() - 0.5);
    }
  }
  cv::remap(dates.second.pixels, dates.reference.pixels, x, y, cv::INTER_CUBIC, cv::BORDER_REFLECT_101);
  return dates;
}

cv::Mat ground_with_shadows(const cv::Mat& texture, const cv::Point& shadow_px) {
  cv::Mat ground;
  texture.convertTo(ground, CV_8U, 0.25, 130);
  cv::RNG random(7);
  for (int i = 0; i < texture.cols * texture.rows / 800; ++i) {
    const cv::Point at(random.uniform(20, texture.cols - 30), random.uniform(20, texture.rows - 30));
    const cv::Rect shadow(at + shadow_px, cv::Size(random.uniform(4, 9), random.uniform(4, 9)));
    cv::Mat dark = ground(shadow);
    dark *= 0.45;
  }
  return ground;
}

OpenPair open_in_memory(const TwoDates& dates) {
  return [dates](const GeoTransform& place, std::int64_t width_px, std::int64_t height_px) {
    return DatePair{on_grid(dates.reference, place, width_px, height_px),
                    on_grid(dates.second, place, width_px, height_px)};
  };
}

}  // namespace pilotage::testing
