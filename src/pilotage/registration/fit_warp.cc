#include "pilotage/registration/fit_warp.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Dense>

#include "pilotage/base/nan.h"
#include "pilotage/base/options.h"
#include "pilotage/base/statistics.h"
#include "pilotage/registration/warp_problem.h"

namespace pilotage {
namespace {

constexpr std::size_t kFewestTies = 8;
constexpr int kFewestNear = 3;  // ties that make a cell known
constexpr double kLossScale = 2;
constexpr std::array<double, 5> kLossScales = {32, 16, 8, 4, kLossScale};
constexpr double kSpacingsPerBlock = 2;  // so that most squares of a block overlap none outside
constexpr int kParts = 5;                // of the ties that are left out in turn
constexpr int kCellsPerSpacing = 4;
constexpr int kSigmaReach = 5;          // control points around one whose σ is computed
constexpr double kMadToSigma = 1.4826;  // of normal deviates

/// Control points under everything that ties reach.
WarpField make_grid(std::span<const Tie> ties, double spacing_m, double reach_px) {
  Bounds bounds;
  for (const Tie& tie : ties) {
    const Eigen::Vector2d reach_m = Eigen::Vector2d::Constant(reach_px * tie.gsd_m);
    bounds.extend(tie.point_m - reach_m);
    bounds.extend(tie.point_m + reach_m);
  }
  WarpField grid;
  grid.spacing_m = spacing_m;
  const auto first = [&](double low_m) { return (std::floor(low_m / spacing_m) - 1) * spacing_m; };
  const auto count = [&](double min_m, double high_m) {
    return static_cast<int>(std::ceil((high_m - min_m) / spacing_m)) + 2;
  };
  grid.min_x_m = first(bounds.min_x_m);
  grid.min_y_m = first(bounds.min_y_m);
  grid.columns = std::max(4, count(grid.min_x_m, bounds.max_x_m));
  grid.rows = std::max(4, count(grid.min_y_m, bounds.max_y_m));
  const auto nodes = static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows);
  grid.control_m.assign(nodes, Eigen::Vector2d::Zero());
  grid.node_sigma_m.assign(nodes, kNaN);
  grid.cell_m = spacing_m / kCellsPerSpacing;
  grid.cell_columns = (grid.columns - 1) * kCellsPerSpacing;
  grid.cell_rows = (grid.rows - 1) * kCellsPerSpacing;
  grid.cell_known.assign(static_cast<std::size_t>(grid.cell_columns) * static_cast<std::size_t>(grid.cell_rows), 0);
  return grid;
}

template <class Use>
void for_each_node_near(const WarpField& grid, int column, int row, int reach, const Use& use) {
  for (int j = std::max(0, row - reach); j <= std::min(grid.rows - 1, row + reach); ++j) {
    for (int i = std::max(0, column - reach); i <= std::min(grid.columns - 1, column + reach); ++i) {
      use(static_cast<std::size_t>(j) * static_cast<std::size_t>(grid.columns) + static_cast<std::size_t>(i));
    }
  }
}

/// Control points that a tie or a cell within reach of one depends on.
std::vector<std::uint8_t> active_nodes(const WarpField& grid, std::span<const Tie> ties, double reach_px) {
  std::vector<std::uint8_t> active(grid.control_m.size(), 0);
  for (const Tie& tie : ties) {
    const int reach = 3 + static_cast<int>(std::ceil(reach_px * tie.gsd_m / grid.spacing_m));
    const TieFootprint footprint = footprint_of(grid, tie.point_m);
    for_each_node_near(grid, footprint.column + 1, footprint.row + 1, reach,
                       [&](std::size_t node) { active[node] = 1; });
  }
  return active;
}

/// Control points without a say take the mean of the neighbours that have a value, ring by ring.
void continue_outwards(WarpField& field, std::vector<std::uint8_t> has_value) {
  for (bool changed = true; changed;) {
    changed = false;
    std::vector<std::uint8_t> now = has_value;
    for (int row = 0; row < field.rows; ++row) {
      for (int column = 0; column < field.columns; ++column) {
        const auto node =
            static_cast<std::size_t>(row) * static_cast<std::size_t>(field.columns) + static_cast<std::size_t>(column);
        if (has_value[node] != 0) continue;
        Eigen::Vector2d sum = Eigen::Vector2d::Zero();
        int count = 0;
        for_each_node_near(field, column, row, 1, [&](std::size_t other) {
          if (has_value[other] == 0) return;
          sum += field.control_m[other];
          ++count;
        });
        if (count == 0) continue;
        field.control_m[node] = sum / count;
        now[node] = 1;
        changed = true;
      }
    }
    has_value = std::move(now);
  }
}

std::vector<Eigen::Vector2d> residuals_of(const WarpField& field, std::span<const Tie> ties) {
  std::vector<Eigen::Vector2d> residuals;
  for (const Tie& tie : ties) {
    residuals.push_back(tie.displacement_m - field.continued_m(tie.point_m.x(), tie.point_m.y()));
  }
  return residuals;
}

/// 1.4826 · the median of both components' magnitudes, in pixels of the ties; outliers do not count.
double robust_sigma_px(std::span<const Tie> ties, const std::vector<Eigen::Vector2d>& residuals,
                       const std::vector<std::uint8_t>& outlier) {
  std::vector<double> magnitudes;
  for (std::size_t i = 0; i < ties.size(); ++i) {
    if (outlier[i] != 0) continue;
    for (const double residual_m : residuals[i]) magnitudes.push_back(std::abs(residual_m) / ties[i].gsd_m);
  }
  return kMadToSigma * quantile(std::move(magnitudes), 0.5);
}

/// Residuals of ties against a field that was fitted without them and their neighbours; starts from `field`.
std::vector<Eigen::Vector2d> left_out_residuals(const WarpProblem& problem, std::span<const Tie> ties,
                                                const WarpField& field) {
  const double block_m = kSpacingsPerBlock * field.spacing_m;
  const auto part_of = [&](const Tie& tie) {
    const auto column = static_cast<std::int64_t>(std::floor((tie.point_m.x() - field.min_x_m) / block_m));
    const auto row = static_cast<std::int64_t>(std::floor((tie.point_m.y() - field.min_y_m) / block_m));
    return static_cast<int>((column + 2 * row) % kParts);
  };
  std::vector<Eigen::Vector2d> residuals(ties.size());
  for (int part = 0; part < kParts; ++part) {
    std::vector<std::uint8_t> use(ties.size());
    for (std::size_t i = 0; i < ties.size(); ++i) use[i] = part_of(ties[i]) == part ? 0 : 1;
    WarpField without = field;
    without.control_m = solve_warp(problem, ties, use, field.control_m, std::array{kLossScale});
    for (std::size_t i = 0; i < ties.size(); ++i) {
      if (use[i] != 0) continue;
      residuals[i] = ties[i].displacement_m - without.continued_m(ties[i].point_m.x(), ties[i].point_m.y());
    }
  }
  return residuals;
}

/// Variance of the fitted field at a control point, m²: vᵀ H⁻¹ v.
double fit_variance(const WarpProblem& problem, const Eigen::SparseMatrix<double>& curvature, int column, int row) {
  std::vector<int> nodes;
  for_each_node_near(problem.grid, column, row, kSigmaReach, [&](std::size_t node) {
    if (problem.active[node] != 0) nodes.push_back(static_cast<int>(node));
  });
  const auto place_of = [&](int node) {
    const auto found = std::lower_bound(nodes.begin(), nodes.end(), node);
    return found != nodes.end() && *found == node ? static_cast<Eigen::Index>(found - nodes.begin()) : -1;
  };
  const auto size = static_cast<Eigen::Index>(nodes.size());
  Eigen::MatrixXd local = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index k = 0; k < size; ++k) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(curvature, nodes[static_cast<std::size_t>(k)]); entry;
         ++entry) {
      const Eigen::Index other = place_of(static_cast<int>(entry.row()));
      if (other >= 0) local(other, k) = entry.value();
    }
  }
  Eigen::VectorXd basis = Eigen::VectorXd::Zero(size);
  const std::array<double, 3> weights = {1.0 / 6, 4.0 / 6, 1.0 / 6};
  for (int j = -1; j <= 1; ++j) {
    for (int i = -1; i <= 1; ++i) {
      const Eigen::Index place = place_of((row + j) * problem.grid.columns + column + i);
      if (place >= 0)
        basis[place] = weights[static_cast<std::size_t>(i + 1)] * weights[static_cast<std::size_t>(j + 1)];
    }
  }
  return basis.dot(local.llt().solve(basis));
}

/// `sigma_m`: what the finest ties turned out to have, where `expected_m` was expected.
void set_sigmas(const WarpProblem& problem, std::span<const Tie> ties, double sigma_m, double expected_m,
                WarpField& field) {
  const Eigen::SparseMatrix<double> curvature = warp_curvature(problem, ties, field, kLossScale);
  for (int row = 1; row + 1 < field.rows; ++row) {
    for (int column = 1; column + 1 < field.columns; ++column) {
      const auto node =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(field.columns) + static_cast<std::size_t>(column);
      if (problem.active[node] == 0) continue;
      field.node_sigma_m[node] =
          sigma_m * std::sqrt(1 + fit_variance(problem, curvature, column, row) / (expected_m * expected_m));
    }
  }
}

/// Cells with at least three good ties within reach of their middle.
void set_known(std::span<const Tie> ties, const std::vector<std::uint8_t>& outlier, double reach_px, WarpField& field) {
  std::vector<int> near(field.cell_known.size(), 0);
  for (std::size_t i = 0; i < ties.size(); ++i) {
    if (outlier[i] != 0) continue;
    const double reach_m = reach_px * ties[i].gsd_m;
    const int reach = static_cast<int>(std::ceil(reach_m / field.cell_m)) + 1;
    const Eigen::Vector2d point = (ties[i].point_m - Eigen::Vector2d(field.min_x_m, field.min_y_m)) / field.cell_m;
    const int column = static_cast<int>(point.x());
    const int row = static_cast<int>(point.y());
    for (int y = std::max(0, row - reach); y <= std::min(field.cell_rows - 1, row + reach); ++y) {
      for (int x = std::max(0, column - reach); x <= std::min(field.cell_columns - 1, column + reach); ++x) {
        if ((Eigen::Vector2d(x + 0.5, y + 0.5) - point).norm() * field.cell_m > reach_m) continue;
        ++near[static_cast<std::size_t>(y) * static_cast<std::size_t>(field.cell_columns) +
               static_cast<std::size_t>(x)];
      }
    }
  }
  std::transform(near.begin(), near.end(), field.cell_known.begin(),
                 [](int count) { return static_cast<std::uint8_t>(count >= kFewestNear ? 1 : 0); });
}

std::vector<double> disagreements(const WarpField& field) {
  std::vector<double> values;
  for (int row = 0; row < field.cell_rows; ++row) {
    for (int column = 0; column < field.cell_columns; ++column) {
      const Eigen::Vector2d moved = field.displacement_m(field.min_x_m + (column + 0.5) * field.cell_m,
                                                         field.min_y_m + (row + 0.5) * field.cell_m);
      if (!moved.hasNaN()) values.push_back(moved.norm());
    }
  }
  return values;
}

/// Outliers, and what was taken because it lies near the field.
std::vector<std::uint8_t> of_no_account(std::span<const Tie> ties, const std::vector<std::uint8_t>& outlier) {
  std::vector<std::uint8_t> without = outlier;
  for (std::size_t i = 0; i < ties.size(); ++i) without[i] = outlier[i] != 0 || ties[i].is_confirmed ? 1 : 0;
  return without;
}

/// Of the finest ties that are not left out.
Spread spread_of_good(std::span<const Tie> ties, double gsd_m, const std::vector<Eigen::Vector2d>& residuals,
                      const std::vector<std::uint8_t>& without) {
  std::vector<double> lengths;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (without[i] == 0 && ties[i].gsd_m <= gsd_m * 1.001) lengths.push_back(residuals[i].norm());
  }
  return spread_of(lengths);
}

}  // namespace

Spread spread_of(const std::vector<double>& values) {
  return {quantile(values, 0.5), quantile(values, 0.95), quantile(values, 1)};
}

WarpFit fit_warp(std::span<const Tie> ties, double gsd_m, const WarpOptions& options) {
  check_options(options);
  WarpFit fit;
  fit.outlier.assign(ties.size(), 1);
  fit.outliers = static_cast<std::int64_t>(ties.size());
  fit.residual_m = fit.left_out_m = fit.disagreement_m = spread_of({});
  if (ties.size() < kFewestTies) return fit;

  WarpProblem problem;
  problem.grid = make_grid(ties, options.control_spacing_px * gsd_m, options.reach_px);
  problem.active = active_nodes(problem.grid, ties, options.reach_px);
  problem.tie_sigma_px = options.tie_sigma_px;
  problem.bending_m = options.bending_px * gsd_m;
  fit.field = problem.grid;
  fit.field.control_m =
      solve_warp(problem, ties, std::vector<std::uint8_t>(ties.size(), 1), std::move(fit.field.control_m), kLossScales);

  const std::vector<Eigen::Vector2d> residuals = residuals_of(fit.field, ties);
  const std::vector<std::uint8_t> none(ties.size(), 0);
  const double limit_px = 4 * std::max(options.tie_sigma_px, robust_sigma_px(ties, residuals, none));
  for (std::size_t i = 0; i < ties.size(); ++i) fit.outlier[i] = residuals[i].norm() > limit_px * ties[i].gsd_m ? 1 : 0;
  fit.outliers = std::count(fit.outlier.begin(), fit.outlier.end(), 1);
  const std::vector<std::uint8_t> without = of_no_account(ties, fit.outlier);
  fit.residual_m = spread_of_good(ties, gsd_m, residuals, without);
  const std::vector<Eigen::Vector2d> left_out = left_out_residuals(problem, ties, fit.field);
  fit.left_out_m = spread_of_good(ties, gsd_m, left_out, without);
  set_sigmas(problem, ties, robust_sigma_px(ties, left_out, without) * gsd_m, options.tie_sigma_px * gsd_m, fit.field);
  set_known(ties, fit.outlier, options.reach_px, fit.field);
  continue_outwards(fit.field, problem.active);
  fit.disagreement_m = spread_of(disagreements(fit.field));
  return fit;
}

}  // namespace pilotage
