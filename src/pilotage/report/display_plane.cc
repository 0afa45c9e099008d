#include "pilotage/report/display_plane.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/LU>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/angle.h"
#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"

namespace pilotage {
namespace {

constexpr double kRadius_m = 6378137;
// The background of the page's map (page.css): ground without imagery is not drawn.
const cv::Scalar kNoGround(0xd9, 0xdd, 0xe1);

using PlaneFunction = std::function<Eigen::Vector2d(const Eigen::Vector2d&)>;

// Solves display_from_map(x) = target by Newton's method with a numeric Jacobian; NaN when it does not converge.
Eigen::Vector2d invert(const PlaneFunction& display_from_map, const Eigen::Vector2d& target, Eigen::Vector2d x,
                       double tolerance_m) {
  const Eigen::Vector2d nowhere(kNaN, kNaN);
  constexpr double kStep = 1.0;
  for (int iteration = 0; iteration < 30; ++iteration) {
    const Eigen::Vector2d value = display_from_map(x);
    if (!value.allFinite()) return nowhere;
    const Eigen::Vector2d residual = target - value;
    if (residual.norm() <= tolerance_m) return x;
    Eigen::Matrix2d jacobian;
    jacobian.col(0) = (display_from_map(x + Eigen::Vector2d(kStep, 0)) - value) / kStep;
    jacobian.col(1) = (display_from_map(x + Eigen::Vector2d(0, kStep)) - value) / kStep;
    const double determinant = jacobian.determinant();
    if (!std::isfinite(determinant) || std::abs(determinant) < 1e-12) return nowhere;
    x += jacobian.inverse() * residual;
  }
  return nowhere;
}

// Grid coordinates at the lattice's nodes: (columns + 1) × (rows + 1) points spread evenly over the picture.
struct Lattice {
  int columns = 1;
  int rows = 1;
  std::vector<Eigen::Vector2d> nodes;

  const Eigen::Vector2d& node(int column, int row) const {
    return nodes[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns + 1) +
                 static_cast<std::size_t>(column)];
  }

  // u, v: position in cells from the top left.
  Eigen::Vector2d at(double u, double v) const {
    const int column = std::clamp(static_cast<int>(u), 0, columns - 1);
    const int row = std::clamp(static_cast<int>(v), 0, rows - 1);
    const double s = u - column;
    const double t = v - row;
    return (1 - t) * ((1 - s) * node(column, row) + s * node(column + 1, row)) +
           t * ((1 - s) * node(column, row + 1) + s * node(column + 1, row + 1));
  }
};

Eigen::Vector2d plane_point(const DisplayGrid& grid, double share_x, double share_y) {
  return {grid.edges_m.min_x_m + share_x * grid.edges_m.width_m(),
          grid.edges_m.max_y_m - share_y * grid.edges_m.height_m()};
}

Lattice make_lattice(const DisplayGrid& grid, int columns, int rows, const PlaneFunction& display_from_map,
                     const Eigen::Vector2d& start) {
  Lattice lattice{columns, rows, {}};
  Eigen::Vector2d row_start = start;
  for (int row = 0; row <= rows; ++row) {
    Eigen::Vector2d guess = row_start;
    for (int column = 0; column <= columns; ++column) {
      const Eigen::Vector2d target =
          plane_point(grid, static_cast<double>(column) / columns, static_cast<double>(row) / rows);
      Eigen::Vector2d node = invert(display_from_map, target, guess, grid.pixel_m * 1e-3);
      if (!node.allFinite()) node = invert(display_from_map, target, start, grid.pixel_m * 1e-3);
      if (node.allFinite()) guess = node;
      if (node.allFinite() && column == 0) row_start = node;
      lattice.nodes.push_back(node);
    }
  }
  return lattice;
}

// Largest interpolation error at the middles of the cells, in display pixels; cells without an image do not count.
double lattice_error_px(const Lattice& lattice, const DisplayGrid& grid, const PlaneFunction& display_from_map) {
  double largest = 0;
  for (int row = 0; row < lattice.rows; ++row) {
    for (int column = 0; column < lattice.columns; ++column) {
      const Eigen::Vector2d wanted = plane_point(grid, (column + 0.5) / lattice.columns, (row + 0.5) / lattice.rows);
      const Eigen::Vector2d got = display_from_map(lattice.at(column + 0.5, row + 0.5));
      if (got.allFinite()) largest = std::max(largest, (got - wanted).norm() / grid.pixel_m);
    }
  }
  return largest;
}

// The part of the imagery that the picture shows, with two pixels around it.
Raster crop_to(const Raster& imagery, const cv::Mat& map_xy) {
  Bounds pixels;
  for (const cv::Vec2d& xy : cv::Mat_<cv::Vec2d>(map_xy)) {
    const Eigen::Vector2d pixel = imagery.map_from_pixel.pixel_from_map({xy[0], xy[1]});
    if (pixel.allFinite()) pixels.extend(pixel);
  }
  if (pixels.empty()) return imagery;
  const auto clamped = [](double value, int limit) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(limit)));
  };
  const int left = clamped(pixels.min_x_m - 2, imagery.pixels.cols - 1);
  const int top = clamped(pixels.min_y_m - 2, imagery.pixels.rows - 1);
  const int right = std::max(left + 1, clamped(pixels.max_x_m + 2, imagery.pixels.cols));
  const int bottom = std::max(top + 1, clamped(pixels.max_y_m + 2, imagery.pixels.rows));
  const cv::Rect window(left, top, right - left, bottom - top);
  return {imagery.pixels(window), imagery.valid(window), imagery.map_from_pixel.shifted(left, top)};
}

// Shrinks imagery by whole factors until it is at most twice as fine as the picture, so that bilinear sampling sees
// every pixel; invalid pixels do not bleed into valid ones.
Raster shrink(const Raster& imagery, double picture_pixel_m) {
  Raster result = imagery;
  const double imagery_pixel_m = std::sqrt(std::abs(imagery.map_from_pixel.determinant()));
  const int factor = static_cast<int>(std::clamp(picture_pixel_m / imagery_pixel_m, 1.0, 1e6));
  if (factor < 2) return result;
  const cv::Size size((imagery.pixels.cols + factor - 1) / factor, (imagery.pixels.rows + factor - 1) / factor);
  cv::Mat pixels;
  cv::Mat weight;
  imagery.pixels.convertTo(pixels, CV_32F);
  imagery.valid.convertTo(weight, CV_32F, 1.0 / 255);
  pixels.setTo(cv::Scalar::all(0), imagery.valid == 0);
  cv::copyMakeBorder(pixels, pixels, 0, size.height * factor - pixels.rows, 0, size.width * factor - pixels.cols,
                     cv::BORDER_CONSTANT);
  cv::copyMakeBorder(weight, weight, 0, size.height * factor - weight.rows, 0, size.width * factor - weight.cols,
                     cv::BORDER_CONSTANT);
  cv::resize(pixels, pixels, size, 0, 0, cv::INTER_AREA);
  cv::resize(weight, weight, size, 0, 0, cv::INTER_AREA);
  cv::Mat weights;
  cv::merge(std::vector<cv::Mat>(static_cast<std::size_t>(pixels.channels()), cv::max(weight, 1e-6)), weights);
  cv::Mat(pixels / weights).convertTo(result.pixels, CV_8U);
  result.valid = weight >= 0.5;
  GeoTransform& t = result.map_from_pixel;
  t.x_per_col *= factor;
  t.x_per_row *= factor;
  t.y_per_col *= factor;
  t.y_per_row *= factor;
  return result;
}

}  // namespace

Eigen::Vector2d mercator_from_geodetic(GeodeticPoint point) {
  if (!(std::abs(point.lat_deg) <= kMercatorMaxLat_deg) || !std::isfinite(point.lon_deg)) return {kNaN, kNaN};
  return {kRadius_m * point.lon_deg * kRadPerDeg, kRadius_m * std::asinh(std::tan(point.lat_deg * kRadPerDeg))};
}

PlaneFunction mercator_from_map(std::function<GeodeticPoint(Eigen::Vector2d)> geodetic_from_map,
                                double reference_lon_deg) {
  return [from_map = std::move(geodetic_from_map), reference_lon_deg](const Eigen::Vector2d& xy) -> Eigen::Vector2d {
    GeodeticPoint point = from_map(xy);
    if (!std::isfinite(point.lon_deg)) return {kNaN, kNaN};
    point.lon_deg = unwrap_lon_deg(point.lon_deg, reference_lon_deg);
    return mercator_from_geodetic(point);
  };
}

DisplayGrid display_grid(const Bounds& bounds_m, int longer_side_px) {
  DisplayGrid grid;
  grid.pixel_m = std::max(bounds_m.width_m(), bounds_m.height_m()) / longer_side_px;
  // The tolerance keeps a side that is a whole number of pixels from gaining one through rounding.
  grid.width_px = std::max(1, static_cast<int>(std::ceil(bounds_m.width_m() / grid.pixel_m - 1e-6)));
  grid.height_px = std::max(1, static_cast<int>(std::ceil(bounds_m.height_m() / grid.pixel_m - 1e-6)));
  const Eigen::Vector2d center = bounds_m.center_m();
  const Eigen::Vector2d half = Eigen::Vector2d(grid.width_px, grid.height_px) * grid.pixel_m / 2;
  grid.edges_m = {center.x() - half.x(), center.y() - half.y(), center.x() + half.x(), center.y() + half.y()};
  return grid;
}

cv::Mat map_from_display(const DisplayGrid& grid, const PlaneFunction& display_from_map, const Eigen::Vector2d& start) {
  constexpr double kMaxError_px = 0.25;
  int columns = std::max(1, grid.width_px / 64);
  int rows = std::max(1, grid.height_px / 64);
  Lattice lattice = make_lattice(grid, columns, rows, display_from_map, start);
  for (int halvings = 0; halvings < 3 && lattice_error_px(lattice, grid, display_from_map) > kMaxError_px; ++halvings) {
    columns *= 2;
    rows *= 2;
    lattice = make_lattice(grid, columns, rows, display_from_map, start);
  }
  cv::Mat map_xy(grid.height_px, grid.width_px, CV_64FC2);
  for (int row = 0; row < grid.height_px; ++row) {
    for (int col = 0; col < grid.width_px; ++col) {
      const Eigen::Vector2d xy = lattice.at((col + 0.5) * columns / grid.width_px, (row + 0.5) * rows / grid.height_px);
      map_xy.at<cv::Vec2d>(row, col) = {xy.x(), xy.y()};
    }
  }
  return map_xy;
}

cv::Mat warp_imagery(const Raster& imagery, const cv::Mat& map_xy) {
  // Ground covered by a pixel of the picture, from two neighbours at its middle.
  const int middle_row = map_xy.rows / 2;
  const int middle_col = std::min(map_xy.cols / 2, std::max(0, map_xy.cols - 2));
  double pixel_m = 0;
  if (map_xy.cols > 1) {
    const cv::Vec2d step =
        map_xy.at<cv::Vec2d>(middle_row, middle_col + 1) - map_xy.at<cv::Vec2d>(middle_row, middle_col);
    pixel_m = cv::norm(step);
  }
  const Raster source = shrink(crop_to(imagery, map_xy), std::isfinite(pixel_m) ? pixel_m : 0);
  cv::Mat positions(map_xy.size(), CV_32FC2);
  for (int row = 0; row < map_xy.rows; ++row) {
    for (int col = 0; col < map_xy.cols; ++col) {
      const auto& xy = map_xy.at<cv::Vec2d>(row, col);
      // remap() counts from pixel centres, we count from pixel corners.
      const Eigen::Vector2d pixel = source.map_from_pixel.pixel_from_map({xy[0], xy[1]}) - Eigen::Vector2d(0.5, 0.5);
      const bool inside = std::abs(pixel.x()) < 1e6 && std::abs(pixel.y()) < 1e6;  // false for NaN
      positions.at<cv::Vec2f>(row, col) =
          inside ? cv::Vec2f(static_cast<float>(pixel.x()), static_cast<float>(pixel.y())) : cv::Vec2f(-10, -10);
    }
  }
  cv::Mat picture;
  cv::Mat valid;
  cv::remap(source.pixels, picture, positions, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  cv::remap(source.valid, valid, positions, cv::noArray(), cv::INTER_NEAREST, cv::BORDER_CONSTANT, 0);
  if (picture.channels() == 1) cv::cvtColor(picture, picture, cv::COLOR_GRAY2RGB);
  picture.setTo(kNoGround, valid == 0);
  return picture;
}

std::string encode_jpeg(const cv::Mat& picture, std::size_t max_bytes) {
  cv::Mat bgr = picture;
  if (picture.channels() == 3) cv::cvtColor(picture, bgr, cv::COLOR_RGB2BGR);
  std::vector<std::uint8_t> bytes;
  for (const int quality : {88, 80, 70, 60, 45, 30}) {
    if (!cv::imencode(".jpg", bgr, bytes, {cv::IMWRITE_JPEG_QUALITY, quality})) {
      throw DataError("the report's picture of the imagery could not be encoded as JPEG");
    }
    if (bytes.size() <= max_bytes) break;
  }
  return {bytes.begin(), bytes.end()};
}

std::string encode_png(const cv::Mat& picture) {
  cv::Mat bgr;
  cv::cvtColor(picture, bgr, picture.channels() == 4 ? cv::COLOR_RGBA2BGRA : cv::COLOR_RGB2BGR);
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(".png", bgr, bytes)) throw DataError("a picture cannot be written as PNG");
  return {bytes.begin(), bytes.end()};
}

}  // namespace pilotage
