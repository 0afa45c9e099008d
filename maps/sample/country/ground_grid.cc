#include "country/ground_grid.h"

#include <algorithm>
#include <cmath>

#include "country/epoch.h"
#include "country/noise.h"

namespace pilotage::scene_detail {
namespace {

constexpr float kWaterLevel_m = 10;

/// Gentle hills of 0 … 80 m with a valley along the water.
float elevation_m(std::uint64_t seed, const Eigen::Vector2d& p, float water_m) {
  const auto octave = [&](int index, double wavelength_m) {
    return gradient_noise(seed + static_cast<std::uint64_t>(index), p.x() / wavelength_m, p.y() / wavelength_m);
  };
  const float hills = 41 + 34 * octave(0, 1150) + 13 * octave(1, 460) + 4.5F * octave(2, 170) + 0.7F * octave(3, 50);
  const float bounded = 40 + 39 * std::tanh((hills - 40) / 39);
  const float away = smooth_step(0, 420, -water_m);
  return water_m >= 0 ? kWaterLevel_m : mix(kWaterLevel_m + 0.4F, std::max(bounded, kWaterLevel_m + 1), away);
}

/// Lambertian light on a slope relative to level ground.
float sunlight(const EpochLook& look, double slope_east, double slope_north) {
  const double facing = look.tan_elevation - (slope_east * look.to_sun.x() + slope_north * look.to_sun.y());
  const double light = facing / look.tan_elevation / std::sqrt(1 + slope_east * slope_east + slope_north * slope_north);
  return static_cast<float>(std::clamp(light, 0.5, 1.4));
}

void add_sunlight(GroundGrid& grid) {
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const auto height = [&](int c, int r) {
        c = std::clamp(c, 0, grid.columns - 1);
        r = std::clamp(r, 0, grid.rows - 1);
        return static_cast<double>(grid.nodes[static_cast<std::size_t>(r) * static_cast<std::size_t>(grid.columns) +
                                              static_cast<std::size_t>(c)]
                                       .elevation_m);
      };
      const double east = (height(column + 1, row) - height(column - 1, row)) / (2 * GroundGrid::kSpacing_m);
      const double north = (height(column, row + 1) - height(column, row - 1)) / (2 * GroundGrid::kSpacing_m);
      auto& node = grid.nodes[static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.columns) +
                              static_cast<std::size_t>(column)];
      node.sunlight = {sunlight(epoch_look(SceneEpoch::kFirst), east, north),
                       sunlight(epoch_look(SceneEpoch::kSecond), east, north)};
    }
  }
}

GroundNode make_node(std::uint64_t seed, const Waters& waters, const Eigen::Vector2d& p) {
  GroundNode node;
  node.lake_m = static_cast<float>(waters.lake_depth_m(p));
  node.water_m = std::max(node.lake_m, static_cast<float>(waters.river_depth_m(p)));
  node.elevation_m = elevation_m(seed, p, node.water_m);
  node.bend_x_m = 16.0F * gradient_noise(seed + 11, p.x() / 420, p.y() / 420);
  node.bend_y_m = 16.0F * gradient_noise(seed + 12, p.x() / 420, p.y() / 420);
  node.soil =
      gradient_noise(seed + 13, p.x() / 110, p.y() / 110) + 0.5F * gradient_noise(seed + 14, p.x() / 42, p.y() / 42);
  node.stand =
      gradient_noise(seed + 15, p.x() / 60, p.y() / 60) + 0.5F * gradient_noise(seed + 16, p.x() / 27, p.y() / 27);
  return node;
}

GroundNode mix_nodes(const GroundNode& a, const GroundNode& b, float t) {
  GroundNode result;
  result.elevation_m = mix(a.elevation_m, b.elevation_m, t);
  result.lake_m = mix(a.lake_m, b.lake_m, t);
  result.water_m = mix(a.water_m, b.water_m, t);
  result.bend_x_m = mix(a.bend_x_m, b.bend_x_m, t);
  result.bend_y_m = mix(a.bend_y_m, b.bend_y_m, t);
  result.soil = mix(a.soil, b.soil, t);
  result.stand = mix(a.stand, b.stand, t);
  result.sunlight = {mix(a.sunlight[0], b.sunlight[0], t), mix(a.sunlight[1], b.sunlight[1], t)};
  return result;
}

}  // namespace

GroundNode GroundGrid::at(const Eigen::Vector2d& p) const {
  const double x = std::clamp((p.x() + kMargin_m) / kSpacing_m, 0.0, static_cast<double>(columns - 1));
  const double y = std::clamp((p.y() + kMargin_m) / kSpacing_m, 0.0, static_cast<double>(rows - 1));
  const int column = std::min(static_cast<int>(x), columns - 2);
  const int row = std::min(static_cast<int>(y), rows - 2);
  const auto tx = static_cast<float>(x - column);
  const auto ty = static_cast<float>(y - row);
  const GroundNode* low =
      &nodes[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column)];
  const GroundNode* high = low + columns;
  return mix_nodes(mix_nodes(low[0], low[1], tx), mix_nodes(high[0], high[1], tx), ty);
}

GroundGrid make_ground(std::uint64_t seed, const Waters& waters) {
  GroundGrid grid;
  grid.columns = static_cast<int>(std::ceil((waters.width_m + 2 * GroundGrid::kMargin_m) / GroundGrid::kSpacing_m)) + 1;
  grid.rows = static_cast<int>(std::ceil((waters.height_m + 2 * GroundGrid::kMargin_m) / GroundGrid::kSpacing_m)) + 1;
  grid.nodes.reserve(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows));
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      grid.nodes.push_back(make_node(seed, waters,
                                     {column * GroundGrid::kSpacing_m - GroundGrid::kMargin_m,
                                      row * GroundGrid::kSpacing_m - GroundGrid::kMargin_m}));
    }
  }
  add_sunlight(grid);
  return grid;
}

Eigen::Vector2d bent_from_ground(const GroundGrid& ground, const Eigen::Vector2d& p) {
  const GroundNode node = ground.at(p);
  return p + Eigen::Vector2d(node.bend_x_m, node.bend_y_m);
}

Eigen::Vector2d ground_from_bent(const GroundGrid& ground, const Eigen::Vector2d& q) {
  Eigen::Vector2d p = q;
  // The bend's slope is below 0.25, so each step removes at least two bits of the error.
  for (int step = 0; step < 14; ++step) p += q - bent_from_ground(ground, p);
  return p;
}

}  // namespace pilotage::scene_detail
