#include "pilotage/capture/ground_surface.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/SparseCholesky>

#include "pilotage/base/error.h"
#include "pilotage/base/statistics.h"

namespace pilotage {
namespace {

constexpr int kMostNodes = 64;
constexpr int kMostSampledNodes = 512;
constexpr std::size_t kFewestPoints = 10;
/// How much a change of slope from node to node weighs against a point.
constexpr double kSmoothness = 0.3;

struct SurfaceGrid {
  Eigen::Vector2d south_west_m;
  double spacing_m;
  int columns;
  int rows;

  Eigen::Index node(int column, int row) const { return Eigen::Index{row} * columns + column; }
  Eigen::Vector2d place(int column, int row) const { return south_west_m + spacing_m * Eigen::Vector2d(column, row); }
};

SurfaceGrid make_grid(const Eigen::Vector2d& low, const Eigen::Vector2d& high, double spacing_m, int most) {
  const Eigen::Vector2d extent = high - low;
  const double spacing = std::max(spacing_m, extent.maxCoeff() / (most - 2));
  return {low, spacing, static_cast<int>(std::ceil(extent.x() / spacing)) + 2,
          static_cast<int>(std::ceil(extent.y() / spacing)) + 2};
}

/// The four nodes around a point, and how much each counts.
std::array<std::pair<Eigen::Index, double>, 4> nodes_around(const SurfaceGrid& grid, const Eigen::Vector2d& en_m) {
  const Eigen::Array2d at = ((en_m - grid.south_west_m) / grid.spacing_m).array();
  const int column = std::clamp(static_cast<int>(std::floor(at.x())), 0, grid.columns - 2);
  const int row = std::clamp(static_cast<int>(std::floor(at.y())), 0, grid.rows - 2);
  const double x = std::clamp(at.x() - column, 0.0, 1.0);
  const double y = std::clamp(at.y() - row, 0.0, 1.0);
  return {{{grid.node(column, row), (1 - x) * (1 - y)},
           {grid.node(column + 1, row), x * (1 - y)},
           {grid.node(column, row + 1), (1 - x) * y},
           {grid.node(column + 1, row + 1), x * y}}};
}

/// Three nodes in a row: the first less twice the second plus the third is 0.
void add_smoothness(const SurfaceGrid& grid, std::vector<Eigen::Triplet<double>>& entries) {
  const auto add = [&](const std::array<Eigen::Index, 3>& nodes) {
    constexpr std::array<double, 3> kSecondDifference{1, -2, 1};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        entries.emplace_back(nodes[i], nodes[j], kSmoothness * kSecondDifference[i] * kSecondDifference[j]);
      }
    }
  };
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      if (column > 1) add({grid.node(column - 2, row), grid.node(column - 1, row), grid.node(column, row)});
      if (row > 1) add({grid.node(column, row - 2), grid.node(column, row - 1), grid.node(column, row)});
    }
  }
}

}  // namespace

GroundSurface fit_surface(const std::vector<AdjustedPoint>& points, const Eigen::Vector2d& low,
                          const Eigen::Vector2d& high) {
  if (points.size() < kFewestPoints) {
    throw DataError("the frames have only " + std::to_string(points.size()) + " points in common: no ground comes out");
  }
  const double area_m2 = (high - low).prod();
  const double between_points_m = std::sqrt(area_m2 / static_cast<double>(points.size()));
  const SurfaceGrid grid = make_grid(low, high, 2 * between_points_m, kMostNodes);
  const Eigen::Index nodes = Eigen::Index{grid.columns} * grid.rows;
  std::vector<double> all_m;
  for (const AdjustedPoint& point : points) all_m.push_back(point.enu_m.z());
  Eigen::VectorXd heights_m = Eigen::VectorXd::Constant(nodes, quantile(all_m, 0.5));
  double spread_m = 0;
  for (int round = 0; round < 8; ++round) {
    std::vector<double> misses_m;
    for (const AdjustedPoint& point : points) {
      double height_m = 0;
      for (const auto& [node, share] : nodes_around(grid, point.enu_m.head<2>())) height_m += share * heights_m[node];
      misses_m.push_back(std::abs(point.enu_m.z() - height_m));
    }
    spread_m = 1.4826 * quantile(misses_m, 0.5);
    if (round == 7) break;
    const double width_m = std::max(2 * spread_m, 1e-3);
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(nodes);
    add_smoothness(grid, entries);
    // Points on one line leave a slope open: the plane that the last round had is kept there.
    constexpr double kRidge = 1e-6;
    for (Eigen::Index node = 0; node < nodes; ++node) {
      entries.emplace_back(node, node, kRidge);
      right[node] += kRidge * heights_m[node];
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto around = nodes_around(grid, points[i].enu_m.head<2>());
      const double weight = 1 / (1 + misses_m[i] * misses_m[i] / (width_m * width_m));
      for (const auto& [node, share] : around) {
        right[node] += weight * share * points[i].enu_m.z();
        for (const auto& [other, other_share] : around) entries.emplace_back(node, other, weight * share * other_share);
      }
    }
    Eigen::SparseMatrix<double> normal(nodes, nodes);
    normal.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(normal);
    if (solver.info() != Eigen::Success) throw DataError("no surface goes through the points of the block");
    heights_m = solver.solve(right);
  }
  return {TerrainHeights(grid.south_west_m, grid.spacing_m, grid.columns, {heights_m.begin(), heights_m.end()}),
          spread_m};
}

GroundSurface sample_surface(const GroundPrior& ground, double spacing_m, const std::vector<AdjustedPoint>& points,
                             const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  const GroundSurface smooth = fit_surface(points, low, high);
  const SurfaceGrid grid = make_grid(low, high, spacing_m, kMostSampledNodes);
  std::vector<double> heights_m;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const Eigen::Vector2d place = grid.place(column, row);
      const double known_m = ground.height_m(place);
      const Eigen::Vector2d inside = place.cwiseMin(high).cwiseMax(low);
      heights_m.push_back(std::isfinite(known_m) ? known_m : smooth.heights.height_m(inside));
    }
  }
  GroundSurface surface{TerrainHeights(grid.south_west_m, grid.spacing_m, grid.columns, std::move(heights_m)), 0};
  std::vector<double> misses_m;
  for (const AdjustedPoint& point : points) {
    const double height_m = surface.heights.height_m(point.enu_m.head<2>());
    if (std::isfinite(height_m)) misses_m.push_back(std::abs(point.enu_m.z() - height_m));
  }
  if (!misses_m.empty()) surface.spread_m = 1.4826 * quantile(misses_m, 0.5);
  return surface;
}

}  // namespace pilotage
