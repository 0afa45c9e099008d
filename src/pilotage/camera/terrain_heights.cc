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

constexpr int kMostNodes = 128;  // a side
constexpr int kMostGrids = 6;    // each for ground lower than the one before
constexpr double kInfinity = std::numeric_limits<double>::infinity();
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

/// Columns and rows of eight points on a grid of heights, and, once the node before each is known, what is left.
struct GridPlaces {
  Together column;
  Together row;
};

struct NodeHeights {
  Together south_west;
  Together south_east;
  Together north_west;
  Together north_east;
};

PILOTAGE_WIDE_CLONES
void place_in_grid(const Together& east_m, const Together& north_m, const Eigen::Vector2d& south_west_m,
                   double spacing_m, GridPlaces& places) {
  const double west = south_west_m.x();
  const double south = south_west_m.y();
  GridPlaces found;
  for (std::size_t i = 0; i < kTogether; ++i) {
    found.column[i] = (east_m[i] - west) / spacing_m;
    found.row[i] = (north_m[i] - south) / spacing_m;
  }
  places = found;
}

PILOTAGE_WIDE_CLONES
void interpolate(const GridPlaces& places, const NodeHeights& nodes, Together& heights_m) {
  Together found;
  for (std::size_t i = 0; i < kTogether; ++i) {
    const double x = places.column[i];
    const double y = places.row[i];
    found[i] = (1 - y) * ((1 - x) * nodes.south_west[i] + x * nodes.south_east[i]) +
               y * ((1 - x) * nodes.north_west[i] + x * nodes.north_east[i]);
  }
  heights_m = found;
}

/// Follows eight rays at a time down to the ground.
class Descent {
 public:
  Descent(const View& view, const TerrainHeights& terrain)
      : view_(view),
        terrain_(terrain),
        first_m_(std::max(0.0, view.agl_m - terrain.highest_m() - kHeightError_m)),
        last_m_(view.agl_m - terrain.lowest_m() + kHeightError_m) {}

  /// `ground_m` is NaN, and stays so where a ray meets nothing.
  void follow(std::span<const Eigen::Vector3d> rays_camera, std::span<Eigen::Vector2d> ground_m) {
    take_aim(rays_camera);
    find_crossings();
    refine();
    for (std::size_t i = 0; i < rays_camera.size(); ++i) {
      if (state_[i] == State::kMet) ground_m[i] = {met_m_[i] * east_per_drop_[i], met_m_[i] * north_per_drop_[i]};
    }
  }

 private:
  enum class State { kLost, kAbove, kCrossing, kMet };

  bool any(State state) const { return std::find(state_.begin(), state_.end(), state) != state_.end(); }

  void take_aim(std::span<const Eigen::Vector3d> rays_camera) {
    state_.fill(State::kLost);
    east_per_drop_.fill(0);
    north_per_drop_.fill(0);
    steps_.fill(1);
    for (std::size_t i = 0; i < rays_camera.size(); ++i) {
      const Eigen::Vector3d ray = view_.enu_from_camera * rays_camera[i];
      if (!(ray.z() < 0)) continue;
      const Eigen::Vector2d per_drop = ray.head<2>() / -ray.z();
      const double tangent = per_drop.norm();
      if (!(tangent <= view_.max_off_nadir_tan)) continue;
      state_[i] = State::kAbove;
      east_per_drop_[i] = per_drop.x();
      north_per_drop_[i] = per_drop.y();
      tangent_[i] = tangent;
      steps_[i] = std::max(1.0, std::ceil((last_m_ - first_m_) * tangent / (terrain_.spacing_m() / 2)));
    }
  }

  /// How far the rays are above the ground where they have come down by `drop_m`.
  void measure_above(const Together& drop_m, Together& above_m) const {
    Together east_m;
    Together north_m;
    for (std::size_t i = 0; i < kTogether; ++i) {
      east_m[i] = drop_m[i] * east_per_drop_[i];
      north_m[i] = drop_m[i] * north_per_drop_[i];
    }
    Together height_m;
    terrain_.heights_m(east_m, north_m, height_m);
    for (std::size_t i = 0; i < kTogether; ++i) above_m[i] = view_.agl_m - drop_m[i] - height_m[i];
  }

  double drop_at(std::size_t ray, double step) const { return first_m_ + (last_m_ - first_m_) * step / steps_[ray]; }

  /// How many more steps of a ray lie above the ground for certain: no slope is steeper than terrain_.steepest().
  double surely_above(std::size_t ray, double over_m) const {
    const double step_m = (last_m_ - first_m_) / steps_[ray];
    const double least_m = over_m / (1 + terrain_.steepest() * tangent_[ray]);
    return std::max(0.0, std::floor((least_m - kHeightError_m) / step_m));
  }

  /// Brackets the first crossing of each ray: above the ground at high_m_, not so at low_m_, a step apart.
  void find_crossings() {
    high_m_.fill(first_m_);
    measure_above(high_m_, over_high_);
    Together step;
    for (std::size_t i = 0; i < kTogether; ++i) {
      if (!(over_high_[i] >= 0)) state_[i] = State::kLost;
      step[i] = state_[i] == State::kAbove ? 1 + surely_above(i, over_high_[i]) : 1;
    }
    while (any(State::kAbove)) {
      Together drop_m;
      for (std::size_t i = 0; i < kTogether; ++i) drop_m[i] = drop_at(i, std::min(step[i], steps_[i]));
      Together over;
      measure_above(drop_m, over);
      for (std::size_t i = 0; i < kTogether; ++i) {
        if (state_[i] != State::kAbove) continue;
        if (step[i] > steps_[i] || std::isnan(over[i])) {
          state_[i] = State::kLost;
        } else if (over[i] > 0) {
          step[i] += 1 + surely_above(i, over[i]);
        } else {
          high_m_[i] = drop_at(i, step[i] - 1);
          low_m_[i] = drop_m[i];
          over_low_[i] = over[i];
          state_[i] = State::kCrossing;
        }
      }
    }
    measure_above(high_m_, over_high_);
  }

  /// Regula falsi (Illinois): halving the value of the end that stays keeps it from crawling.
  void refine() {
    std::array<int, kTogether> kept = {};
    for (int round = 0; round < kMostRefinements && any(State::kCrossing); ++round) {
      Together middle_m = {};
      for (std::size_t i = 0; i < kTogether; ++i) {
        if (state_[i] != State::kCrossing) continue;
        middle_m[i] = over_high_[i] > over_low_[i]
                          ? low_m_[i] + (high_m_[i] - low_m_[i]) * over_low_[i] / (over_low_[i] - over_high_[i])
                          : low_m_[i];
      }
      Together over;
      measure_above(middle_m, over);
      for (std::size_t i = 0; i < kTogether; ++i) {
        if (state_[i] != State::kCrossing) continue;
        if (std::isnan(over[i])) {
          state_[i] = State::kLost;  // a hole between the two ends
          continue;
        }
        if (std::abs(over[i]) <= kHeightError_m) {
          met_m_[i] = middle_m[i];
          state_[i] = State::kMet;
          continue;
        }
        (over[i] > 0 ? high_m_ : low_m_)[i] = middle_m[i];
        (over[i] > 0 ? over_high_ : over_low_)[i] = over[i];
        const int side = over[i] > 0 ? 1 : -1;
        if (side == kept[i]) (over[i] > 0 ? over_low_ : over_high_)[i] /= 2;
        kept[i] = side;
      }
    }
    for (std::size_t i = 0; i < kTogether; ++i) {
      if (state_[i] != State::kCrossing) continue;
      met_m_[i] = low_m_[i];
      state_[i] = State::kMet;
    }
  }

  const View& view_;
  const TerrainHeights& terrain_;
  double first_m_;  // how far down rays have come above all ground, and below all
  double last_m_;
  std::array<State, kTogether> state_ = {};
  Together east_per_drop_ = {};
  Together north_per_drop_ = {};
  Together tangent_ = {};  // of their angle to the vertical
  Together steps_ = {};    // from first_m_ to last_m_
  Together high_m_ = {};
  Together over_high_ = {};
  Together low_m_ = {};
  Together over_low_ = {};
  Together met_m_ = {};
};

}  // namespace

TerrainHeights::TerrainHeights(const Eigen::Vector2d& south_west_m, double spacing_m, int columns,
                               std::vector<double> heights_m)
    : south_west_m_(south_west_m),
      spacing_m_(spacing_m),
      columns_(columns),
      rows_(columns > 0 ? static_cast<int>(heights_m.size() / static_cast<std::size_t>(columns)) : 0),
      heights_m_(std::move(heights_m)),
      lowest_m_(kNaN),
      highest_m_(kNaN),
      steepest_(0) {
  if (!(spacing_m > 0) || columns_ < 2 || rows_ < 2) {
    throw UsageError("heights of the ground: " + std::to_string(columns_) + " x " + std::to_string(rows_) + " nodes " +
                     format_number(spacing_m) + " m apart; at least 2 x 2, more than 0 m apart, are needed");
  }
  for (const double height : heights_m_) {
    if (std::isnan(height)) continue;
    lowest_m_ = std::isnan(lowest_m_) ? height : std::min(lowest_m_, height);
    highest_m_ = std::isnan(highest_m_) ? height : std::max(highest_m_, height);
  }
  for (int row = 0; row + 1 < rows_; ++row) {
    for (int column = 0; column + 1 < columns_; ++column) {
      const double* const south = heights_m_.data() + static_cast<std::ptrdiff_t>(row) * columns_ + column;
      const double* const north = south + columns_;
      const double across = std::max(std::abs(south[1] - south[0]), std::abs(north[1] - north[0]));
      const double along = std::max(std::abs(north[0] - south[0]), std::abs(north[1] - south[1]));
      const bool known = !std::isnan(south[0] + south[1] + north[0] + north[1]);
      steepest_ = std::max(steepest_, known ? std::hypot(across, along) / spacing_m_ : kInfinity);
    }
  }
}

double TerrainHeights::height_m(const Eigen::Vector2d& ground_m) const {
  Together east_m;
  Together north_m;
  Together found_m;
  east_m.fill(ground_m.x());
  north_m.fill(ground_m.y());
  heights_m(east_m, north_m, found_m);
  return found_m[0];
}

void TerrainHeights::heights_m(const Together& east_m, const Together& north_m, Together& found_m) const {
  GridPlaces places;
  place_in_grid(east_m, north_m, south_west_m_, spacing_m_, places);
  NodeHeights nodes;
  for (std::size_t i = 0; i < kTogether; ++i) {
    const double x = places.column[i];
    const double y = places.row[i];
    const bool inside = x >= 0 && y >= 0 && x <= columns_ - 1 && y <= rows_ - 1;
    const int column = inside ? std::min(static_cast<int>(x), columns_ - 2) : 0;
    const int row = inside ? std::min(static_cast<int>(y), rows_ - 2) : 0;
    places.column[i] = inside ? x - column : kNaN;
    places.row[i] = y - row;
    const double* const south = heights_m_.data() + static_cast<std::ptrdiff_t>(row) * columns_ + column;
    const double* const north = south + columns_;
    nodes.south_west[i] = south[0];
    nodes.south_east[i] = south[1];
    nodes.north_west[i] = north[0];
    nodes.north_east[i] = north[1];
  }
  interpolate(places, nodes, found_m);
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
  if (!ray_camera) return std::nullopt;
  Eigen::Vector2d ground_m;
  terrain_from_rays(view, terrain, {&*ray_camera, 1}, {&ground_m, 1});
  return std::isnan(ground_m.x()) ? std::nullopt : std::optional(ground_m);
}

void terrain_from_rays(const View& view, const TerrainHeights& terrain, std::span<const Eigen::Vector3d> rays_camera,
                       std::span<Eigen::Vector2d> ground_m) {
  std::fill(ground_m.begin(), ground_m.end(), Eigen::Vector2d(kNaN, kNaN));
  if (std::isnan(terrain.lowest_m())) return;
  Descent descent(view, terrain);
  for (std::size_t first = 0; first < rays_camera.size(); first += kTogether) {
    const std::size_t count = std::min(kTogether, rays_camera.size() - first);
    descent.follow(rays_camera.subspan(first, count), ground_m.subspan(first, count));
  }
}

}  // namespace pilotage
