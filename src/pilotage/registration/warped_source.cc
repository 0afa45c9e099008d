#include "pilotage/registration/warped_source.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/geo/tile_matrix.h"

namespace pilotage {
namespace {

constexpr int kBlock_px = 512;
constexpr int kStep_px = 16;   // from one evaluation of the field to the next; blocks begin at multiples of it
constexpr int kMargin_px = 3;  // what cubic interpolation and the eroded mask need

/// A block of the grid, its corner at multiples of kBlock_px, or what of it is asked for.
struct RemapTables {
  cv::Mat x;  // CV_32F, position in the source's pixels, OpenCV's convention, less the first pixel of `needed`
  cv::Mat y;
  PixelWindow needed;
};

/// Displacement in pixels on the lattice around a window.
cv::Mat lattice(const GraySource& source, const WarpField& field, std::int64_t first_col, std::int64_t first_row,
                int columns, int rows) {
  const GeoTransform& place = source.map_from_pixel;
  cv::Mat shift(rows, columns, CV_64FC2);
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const Eigen::Vector2d point = place.map_from_pixel(
          {static_cast<double>((first_col + i) * kStep_px), static_cast<double>((first_row + j) * kStep_px)});
      const Eigen::Vector2d moved = field.continued_m(point.x(), point.y());
      shift.at<cv::Vec2d>(j, i) = {moved.x() / place.x_per_col, moved.y() / place.y_per_row};
    }
  }
  return shift;
}

/// cv::remap works in 1/32 px; rounded to them here, a position minus a whole number stays the same as float.
double in_steps_of_remap(double position_px) {
  return std::round(position_px * 32) / 32;
}

RemapTables make_remap_tables(const GraySource& source, const WarpField& field, const PixelWindow& window) {
  const std::int64_t first_col = window.col / kStep_px;
  const std::int64_t first_row = window.row / kStep_px;
  const int columns = static_cast<int>((window.col + window.width) / kStep_px - first_col) + 2;
  const int rows = static_cast<int>((window.row + window.height) / kStep_px - first_row) + 2;
  const cv::Mat shift = lattice(source, field, first_col, first_row, columns, rows);
  cv::Mat x(window.height, window.width, CV_64F);
  cv::Mat y(window.height, window.width, CV_64F);
  for (int row = 0; row < window.height; ++row) {
    const double v = static_cast<double>(window.row + row) + 0.5;
    const int j = static_cast<int>((window.row + row) / kStep_px - first_row);
    const double b = v / kStep_px - static_cast<double>(first_row + j);
    for (int col = 0; col < window.width; ++col) {
      const double u = static_cast<double>(window.col + col) + 0.5;
      const int i = static_cast<int>((window.col + col) / kStep_px - first_col);
      const double a = u / kStep_px - static_cast<double>(first_col + i);
      const cv::Vec2d moved = (1 - b) * ((1 - a) * shift.at<cv::Vec2d>(j, i) + a * shift.at<cv::Vec2d>(j, i + 1)) +
                              b * ((1 - a) * shift.at<cv::Vec2d>(j + 1, i) + a * shift.at<cv::Vec2d>(j + 1, i + 1));
      x.at<double>(row, col) = in_steps_of_remap(u + moved[0] - 0.5);
      y.at<double>(row, col) = in_steps_of_remap(v + moved[1] - 0.5);
    }
  }
  double low_x = 0;
  double high_x = 0;
  double low_y = 0;
  double high_y = 0;
  cv::minMaxLoc(x, &low_x, &high_x);
  cv::minMaxLoc(y, &low_y, &high_y);
  const auto cut = [](double value, std::int64_t size) {
    return static_cast<std::int64_t>(std::clamp(std::floor(value), 0.0, static_cast<double>(size)));
  };
  const std::int64_t left = cut(low_x - kMargin_px, source.width_px);
  const std::int64_t top = cut(low_y - kMargin_px, source.height_px);
  const std::int64_t right = cut(high_x + kMargin_px + 2, source.width_px);
  const std::int64_t bottom = cut(high_y + kMargin_px + 2, source.height_px);
  RemapTables tables;
  tables.needed = {left, top, static_cast<int>(right - left), static_cast<int>(bottom - top)};
  x -= static_cast<double>(left);
  y -= static_cast<double>(top);
  x.convertTo(tables.x, CV_32F);
  y.convertTo(tables.y, CV_32F);
  return tables;
}

void hide_unknown(const GraySource& source, const WarpField& field, const PixelWindow& window, cv::Mat& valid) {
  for (int row = 0; row < window.height; ++row) {
    auto* mask = valid.ptr<std::uint8_t>(row);
    for (int col = 0; col < window.width; ++col) {
      if (mask[col] == 0) continue;
      const Eigen::Vector2d point = source.map_from_pixel.map_from_pixel(
          {static_cast<double>(window.col + col) + 0.5, static_cast<double>(window.row + row) + 0.5});
      if (!field.known(point.x(), point.y())) mask[col] = 0;
    }
  }
}

void draw_block(const GraySource& source, const WarpField& field, bool everywhere, const PixelWindow& window,
                cv::Mat pixels, cv::Mat valid) {
  const RemapTables tables = make_remap_tables(source, field, window);
  if (tables.needed.width < 1 || tables.needed.height < 1) return;
  const Raster read = source.read(tables.needed);
  cv::Mat known;
  // A pixel counts when all that cubic interpolation may take into it do.
  cv::erode(read.valid, known, cv::Mat::ones(5, 5, CV_8U), {-1, -1}, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::Mat clean = read.pixels;
  if (clean.depth() == CV_64F) {  // what is not valid may be NaN, which would spread
    clean = clean.clone();
    clean.setTo(0, read.valid == 0);
  }
  cv::remap(clean, pixels, tables.x, tables.y, cv::INTER_CUBIC, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::remap(known, valid, tables.x, tables.y, cv::INTER_NEAREST, cv::BORDER_CONSTANT, cv::Scalar(0));
  if (!everywhere) hide_unknown(source, field, window, valid);
}

}  // namespace

GraySource warped_source(const GraySource& source, const std::shared_ptr<const WarpField>& field, bool everywhere) {
  GraySource warped = source;
  warped.read = [source, field, everywhere](const PixelWindow& window) {
    Raster result{cv::Mat(window.height, window.width, CV_MAKETYPE(source.depth, 1), cv::Scalar::all(0)),
                  cv::Mat(window.height, window.width, CV_8U, cv::Scalar(0)),
                  source.map_from_pixel.shifted(static_cast<double>(window.col), static_cast<double>(window.row))};
    for (std::int64_t row = window.row / kBlock_px * kBlock_px; row < window.row + window.height; row += kBlock_px) {
      for (std::int64_t col = window.col / kBlock_px * kBlock_px; col < window.col + window.width; col += kBlock_px) {
        const std::int64_t left = std::max(col, window.col);
        const std::int64_t top = std::max(row, window.row);
        const auto width = static_cast<int>(std::min(col + kBlock_px, window.col + window.width) - left);
        const auto height = static_cast<int>(std::min(row + kBlock_px, window.row + window.height) - top);
        const cv::Rect part(static_cast<int>(left - window.col), static_cast<int>(top - window.row), width, height);
        draw_block(source, *field, everywhere, {left, top, width, height}, result.pixels(part), result.valid(part));
      }
    }
    return result;
  };
  return warped;
}

}  // namespace pilotage
