#include "pilotage/registration/warp_problem.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include <ceres/ceres.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

/// Keeps a group of control points that only one tie touches from turning freely; too weak to be seen elsewhere.
constexpr double kSlopeWeight = 0.01;

/// What a linear combination of control displacements should be: Σ weight_k · c_k = target.
class LinearCost : public ceres::CostFunction {
 public:
  LinearCost(std::vector<double> weights, const Eigen::Vector2d& target)
      : weights_(std::move(weights)), target_(target) {
    set_num_residuals(2);
    mutable_parameter_block_sizes()->assign(weights_.size(), 2);
  }

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    for (int axis = 0; axis < 2; ++axis) {
      double sum = -target_[axis];
      for (std::size_t k = 0; k < weights_.size(); ++k) sum += weights_[k] * parameters[k][axis];
      residuals[axis] = sum;
    }
    if (jacobians == nullptr) return true;
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      if (jacobians[k] == nullptr) continue;
      jacobians[k][0] = jacobians[k][3] = weights_[k];
      jacobians[k][1] = jacobians[k][2] = 0;
    }
    return true;
  }

 private:
  std::vector<double> weights_;
  Eigen::Vector2d target_;
};

std::size_t node_index(const WarpField& grid, int column, int row) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.columns) + static_cast<std::size_t>(column);
}

std::vector<std::size_t> nodes_of(const WarpField& grid, const TieFootprint& footprint) {
  std::vector<std::size_t> nodes;
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) nodes.push_back(node_index(grid, footprint.column + i, footprint.row + j));
  }
  return nodes;
}

using Stiffness = std::function<void(const std::vector<std::size_t>& nodes, const std::vector<double>& weights)>;

/// Every smoothness term whose control points are all active.
void for_each_stiffness(const WarpProblem& problem, const Stiffness& use) {
  struct Step {
    int column, row;
    double weight;
  };
  static const std::vector<std::vector<Step>> kShapes = {
      {{0, 0, 1}, {1, 0, -2}, {2, 0, 1}},
      {{0, 0, 1}, {0, 1, -2}, {0, 2, 1}},
      {{0, 0, std::sqrt(2.0)}, {1, 0, -std::sqrt(2.0)}, {0, 1, -std::sqrt(2.0)}, {1, 1, std::sqrt(2.0)}},
      {{0, 0, kSlopeWeight}, {1, 0, -kSlopeWeight}},
      {{0, 0, kSlopeWeight}, {0, 1, -kSlopeWeight}}};
  const WarpField& grid = problem.grid;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      for (const auto& shape : kShapes) {
        std::vector<std::size_t> nodes;
        std::vector<double> weights;
        for (const Step& step : shape) {
          if (column + step.column >= grid.columns || row + step.row >= grid.rows) break;
          const std::size_t node = node_index(grid, column + step.column, row + step.row);
          if (problem.active[node] == 0) break;
          nodes.push_back(node);
          weights.push_back(step.weight / problem.bending_m);
        }
        if (nodes.size() == shape.size()) use(nodes, weights);
      }
    }
  }
}

void solve_once(const WarpProblem& problem, std::span<const Tie> ties, const std::vector<std::uint8_t>& use,
                double loss_scale, std::vector<Eigen::Vector2d>& control_m) {
  ceres::Problem ceres_problem;
  const auto blocks_of = [&](const std::vector<std::size_t>& nodes) {
    std::vector<double*> blocks;
    for (const std::size_t node : nodes) blocks.push_back(control_m[node].data());
    return blocks;
  };
  for (std::size_t i = 0; i < ties.size(); ++i) {
    if (use[i] == 0) continue;
    const TieFootprint footprint = footprint_of(problem.grid, ties[i].point_m);
    const double scale = std::sqrt(tie_precision(ties[i], problem.tie_sigma_px));
    std::vector<double> weights(16);
    for (std::size_t k = 0; k < 16; ++k) weights[k] = scale * footprint.weights[static_cast<Eigen::Index>(k)];
    ceres_problem.AddResidualBlock(new LinearCost(weights, scale * ties[i].displacement_m),
                                   new ceres::CauchyLoss(loss_scale), blocks_of(nodes_of(problem.grid, footprint)));
  }
  for_each_stiffness(problem, [&](const std::vector<std::size_t>& nodes, const std::vector<double>& weights) {
    ceres_problem.AddResidualBlock(new LinearCost(weights, Eigen::Vector2d::Zero()), nullptr, blocks_of(nodes));
  });
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  options.num_threads = 1;
  options.max_num_iterations = 50;
  options.initial_trust_region_radius = 1e8;  // but for the loss the problem is linear
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);
  if (!summary.IsSolutionUsable()) throw DataError("the warp cannot be fitted: " + summary.message);
}

}  // namespace

TieFootprint footprint_of(const WarpField& grid, const Eigen::Vector2d& point_m) {
  const auto span = [&](double coordinate_m, double min_m, int count) {
    const double position = std::clamp((coordinate_m - min_m) / grid.spacing_m, 1.0, static_cast<double>(count - 2));
    const int node = std::min(static_cast<int>(position), count - 3);
    return std::pair{node - 1, bspline_weights(position - node)};
  };
  const auto [column, wx] = span(point_m.x(), grid.min_x_m, grid.columns);
  const auto [row, wy] = span(point_m.y(), grid.min_y_m, grid.rows);
  TieFootprint footprint{column, row, {}};
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) footprint.weights[4 * j + i] = wx[i] * wy[j];
  }
  return footprint;
}

double tie_precision(const Tie& tie, double tie_sigma_px) {
  const double power = tie.ncc * tie.ncc;
  const double weight = power >= 0.5 ? 1 : power / (1 - power);
  const double sigma_m = tie_sigma_px * tie.gsd_m;
  return weight / (sigma_m * sigma_m);
}

std::vector<Eigen::Vector2d> solve_warp(const WarpProblem& problem, std::span<const Tie> ties,
                                        const std::vector<std::uint8_t>& use, std::vector<Eigen::Vector2d> start,
                                        std::span<const double> loss_scales) {
  for (const double scale : loss_scales) solve_once(problem, ties, use, scale, start);
  return start;
}

Eigen::SparseMatrix<double> warp_curvature(const WarpProblem& problem, std::span<const Tie> ties,
                                           const WarpField& field, double loss_scale) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](const std::vector<std::size_t>& nodes, const std::vector<double>& weights) {
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      for (std::size_t b = 0; b < nodes.size(); ++b) {
        entries.emplace_back(static_cast<int>(nodes[a]), static_cast<int>(nodes[b]), weights[a] * weights[b]);
      }
    }
  };
  for (const Tie& tie : ties) {
    const TieFootprint footprint = footprint_of(problem.grid, tie.point_m);
    const double precision = tie_precision(tie, problem.tie_sigma_px);
    const Eigen::Vector2d residual_m = field.continued_m(tie.point_m.x(), tie.point_m.y()) - tie.displacement_m;
    const double robust = 1 / (1 + precision * residual_m.squaredNorm() / (loss_scale * loss_scale));
    std::vector<double> weights(16);
    for (std::size_t k = 0; k < 16; ++k) {
      weights[k] = std::sqrt(precision * robust) * footprint.weights[static_cast<Eigen::Index>(k)];
    }
    add(nodes_of(problem.grid, footprint), weights);
  }
  for_each_stiffness(problem, add);
  const auto size = static_cast<Eigen::Index>(problem.active.size());
  Eigen::SparseMatrix<double> curvature(size, size);
  curvature.setFromTriplets(entries.begin(), entries.end());
  return curvature;
}

}  // namespace pilotage
