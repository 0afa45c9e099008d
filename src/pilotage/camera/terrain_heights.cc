#include "pilotage/camera/terrain_heights.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"
#include "pilotage/geo/bounds.h"
#include "pilotage/geo/local_frame.h"

namespace pilotage {
namespace {

constexpr int kMostNodes = 128;          // a side
constexpr int kMostGrids = 6;            // each for ground lower than the one before
constexpr double kHeightError_m = 1e-3;  // of a crossing
constexpr int kMostRefinements = 60;

TerrainHeights sample_grid(const Bounds& bounds, double spacing_m,
                           const std::function<double(const Eigen::Vector2d&)>& height_m) {
  const Eigen::Vector2d size(bounds.max_x_m - bounds.min_x_m, bounds.max_y_m - bounds.min_y_m);
  const double spacing = std::max(spacing_m, size.maxCoeff() / (kMostNodes - 2));
  const int columns = static_cast<int>(std::ceil(size.x() / spacing)) + 1;
  const int rows = static_cast<int>(std::ceil(size.y() / spacing)) + 1;
  const Eigen::Vector2d south_west(bounds.min_x_m, bounds.min_y_m);
  std::vector<double> heights;
  heights.reserve(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      heights.push_back(height_m(south_west + spacing * Eigen::Vector2d(column, row)));
    }
  }
  return {south_west, spacing, columns, std::move(heights)};
}

}  // namespace

TerrainHeights::TerrainHeights(const Eigen::Vector2d& south_west_m, double spacing_m, int columns,
                               std::vector<double> heights_m)
    : south_west_m_(south_west_m),
      spacing_m_(spacing_m),
      columns_(columns),
      rows_(columns > 0 ? static_cast<int>(heights_m.size() / static_cast<std::size_t>(columns)) : 0),
      heights_m_(std::move(heights_m)),
      lowest_m_(kNaN),
      highest_m_(kNaN) {
  if (!(spacing_m > 0) || columns_ < 2 || rows_ < 2) {
    throw UsageError("heights of the ground: " + std::to_string(columns_) + " x " + std::to_string(rows_) + " nodes " +
                     format_number(spacing_m) + " m apart; at least 2 x 2, more than 0 m apart, are needed");
  }
  for (const double height : heights_m_) {
    if (std::isnan(height)) continue;
    lowest_m_ = std::isnan(lowest_m_) ? height : std::min(lowest_m_, height);
    highest_m_ = std::isnan(highest_m_) ? height : std::max(highest_m_, height);
  }
}

double TerrainHeights::height_m(const Eigen::Vector2d& ground_m) const {
  const Eigen::Vector2d at = (ground_m - south_west_m_) / spacing_m_;
  if (!(at.x() >= 0 && at.y() >= 0 && at.x() <= columns_ - 1 && at.y() <= rows_ - 1)) return kNaN;
  const int column = std::min(static_cast<int>(at.x()), columns_ - 2);
  const int row = std::min(static_cast<int>(at.y()), rows_ - 2);
  const double x = at.x() - column;
  const double y = at.y() - row;
  const double* const south = heights_m_.data() + static_cast<std::ptrdiff_t>(row) * columns_ + column;
  const double* const north = south + columns_;
  return (1 - y) * ((1 - x) * south[0] + x * south[1]) + y * ((1 - x) * north[0] + x * north[1]);
}

TerrainHeights sample_terrain(const View& view, double spacing_m,
                              const std::function<double(const Eigen::Vector2d& ground_m)>& height_m) {
  View to_lowest = view;
  for (int grid = 1;; ++grid) {
    Bounds bounds;
    bounds.extend(Eigen::Vector2d(0, 0));
    for (const Eigen::Vector2d& point : footprint(to_lowest).polygon_m) bounds.extend(point);
    TerrainHeights terrain = sample_grid(bounds.grown(1 + spacing_m), spacing_m, height_m);
    const double drop_m = view.agl_m - terrain.lowest_m();
    if (grid == kMostGrids || !(drop_m > to_lowest.agl_m + kHeightError_m)) return terrain;
    to_lowest.agl_m = drop_m;
  }
}

TerrainHeights terrain_under(const View& view, GeodeticPoint nadir, const Elevation& elevation) {
  const double below_m = elevation.amsl_m(nadir);
  const LocalFrame at_nadir(nadir);
  return sample_terrain(view, elevation.resolution_m(), [&](const Eigen::Vector2d& ground_m) {
    if (std::isnan(below_m)) return kNaN;
    return elevation.amsl_m(at_nadir.geodetic_from_enu({ground_m.x(), ground_m.y(), 0})) - below_m;
  });
}

std::optional<Eigen::Vector2d> terrain_from_pixel(const View& view, const TerrainHeights& terrain,
                                                  const Eigen::Vector2d& pixel) {
  const auto ray_camera = ray_from_pixel(view.lens, pixel);
  return ray_camera ? terrain_from_ray(view, terrain, *ray_camera) : std::nullopt;
}

std::optional<Eigen::Vector2d> terrain_from_ray(const View& view, const TerrainHeights& terrain,
                                                const Eigen::Vector3d& ray_camera) {
  if (std::isnan(terrain.lowest_m())) return std::nullopt;
  const Eigen::Vector3d ray = view.enu_from_camera * ray_camera;
  if (!(ray.z() < 0)) return std::nullopt;
  const Eigen::Vector2d per_drop = ray.head<2>() / -ray.z();
  if (!(per_drop.norm() <= view.max_off_nadir_tan)) return std::nullopt;

  const auto above_m = [&](double drop_m) { return view.agl_m - drop_m - terrain.height_m(drop_m * per_drop); };
  const double first_m = std::max(0.0, view.agl_m - terrain.highest_m() - kHeightError_m);
  const double last_m = view.agl_m - terrain.lowest_m() + kHeightError_m;
  const double steps = std::max(1.0, std::ceil((last_m - first_m) * per_drop.norm() / (terrain.spacing_m() / 2)));
  double high_m = first_m;
  double over_high = above_m(high_m);
  if (!(over_high >= 0)) return std::nullopt;
  for (double step = 1; step <= steps; ++step) {
    double low_m = first_m + (last_m - first_m) * step / steps;
    double over_low = above_m(low_m);
    if (std::isnan(over_low)) return std::nullopt;
    if (over_low > 0) {
      high_m = low_m;
      over_high = over_low;
      continue;
    }
    // Regula falsi (Illinois): halving the value of the end that stays keeps it from crawling.
    for (int i = 0, kept = 0; i < kMostRefinements; ++i) {
      const double middle_m =
          over_high > over_low ? low_m + (high_m - low_m) * over_low / (over_low - over_high) : low_m;
      const double over = above_m(middle_m);
      if (std::abs(over) <= kHeightError_m) return middle_m * per_drop;
      (over > 0 ? high_m : low_m) = middle_m;
      (over > 0 ? over_high : over_low) = over;
      const int side = over > 0 ? 1 : -1;
      if (side == kept) (over > 0 ? over_low : over_high) /= 2;
      kept = side;
    }
    return low_m * per_drop;
  }
  return std::nullopt;
}

}  // namespace pilotage
