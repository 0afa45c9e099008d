#include "pilotage/capture/block_start.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>

#include "pilotage/base/angle.h"
#include "pilotage/base/error.h"
#include "pilotage/base/statistics.h"
#include "pilotage/camera/attitude.h"
#include "pilotage/camera/lens.h"

namespace pilotage {
namespace {

using Complex = std::complex<double>;
using ComplexMatrix = Eigen::SparseMatrix<Complex>;

constexpr std::size_t kMatchesOfPair = 40;
constexpr int kRounds = 20;
/// Tilts that are not known, and ground that is not flat, move a point by this share of the height.
constexpr double kTiltShare = 0.05;
/// Rays nearer to the horizon say nothing of the ground below.
constexpr double kSteepest = 0.2;

/// One match: z_first·u_first − z_second·u_second = C_second − C_first.
struct Equation {
  std::size_t first;
  std::size_t second;
  Complex u_first;
  Complex u_second;
};

std::optional<Complex> place_from_1m(const Lens& lens, const Eigen::Matrix3d& enu_from_camera,
                                     const Eigen::Vector2d& pixel) {
  const auto ray = ray_from_pixel(lens, pixel);
  if (!ray) return std::nullopt;
  const Eigen::Vector3d direction = enu_from_camera * *ray;
  if (direction.z() > -kSteepest) return std::nullopt;
  return Complex(direction.x(), direction.y()) / -direction.z();
}

/// Level flight to the north.
Eigen::Matrix3d level_enu_from_camera(const Block& block) {
  return enu_from_camera({}, {}) * body_from_camera({}).transpose() * block.body_from_camera;
}

std::vector<Equation> make_equations(const Block& block, const std::vector<Eigen::Matrix3d>& assumed) {
  const Lens lens = make_lens(block.camera);
  std::vector<Equation> equations;
  for (const FramePair& pair : block.pairs) {
    const auto first = static_cast<std::size_t>(pair.first);
    const auto second = static_cast<std::size_t>(pair.second);
    const std::size_t step = std::max<std::size_t>(1, pair.matches.size() / kMatchesOfPair);
    for (std::size_t i = 0; i < pair.matches.size(); i += step) {
      const auto& [of_first, of_second] = pair.matches[i];
      const auto u_first =
          place_from_1m(lens, assumed[first], block.features[first].pixels[static_cast<std::size_t>(of_first)]);
      const auto u_second =
          place_from_1m(lens, assumed[second], block.features[second].pixels[static_cast<std::size_t>(of_second)]);
      if (u_first && u_second) equations.push_back({first, second, *u_first, *u_second});
    }
  }
  return equations;
}

Complex east_north(const Eigen::Vector3d& enu_m) {
  return {enu_m.x(), enu_m.y()};
}

/// Cauchy's weight of a residual, in units of `width`.
double weight(const Complex& residual, double width) {
  return 1 / (width * width + std::norm(residual));
}

/// z of every frame, then its displacement.
struct Unknowns {
  Eigen::VectorXcd values;
  std::size_t frames;

  Complex z(std::size_t frame) const { return values[static_cast<Eigen::Index>(frame)]; }
  Complex displaced(std::size_t frame) const { return values[static_cast<Eigen::Index>(frames + frame)]; }
};

Complex residual_of(const Equation& equation, const Block& block, const Unknowns& unknowns) {
  const Complex apart = east_north(block.measured[equation.second].center_enu_m) + unknowns.displaced(equation.second) -
                        east_north(block.measured[equation.first].center_enu_m) - unknowns.displaced(equation.first);
  return unknowns.z(equation.first) * equation.u_first - unknowns.z(equation.second) * equation.u_second - apart;
}

/// Adds |row · x − right|² · weight to the normal equations.
struct NormalEquations {
  std::vector<Eigen::Triplet<Complex>> entries;
  Eigen::VectorXcd right;

  void add(const std::array<std::pair<Eigen::Index, Complex>, 4>& row, int used, const Complex& value, double w) {
    for (int i = 0; i < used; ++i) {
      const auto& [at_i, factor_i] = row[static_cast<std::size_t>(i)];
      right[at_i] += w * std::conj(factor_i) * value;
      for (int j = 0; j < used; ++j) {
        const auto& [at_j, factor_j] = row[static_cast<std::size_t>(j)];
        entries.emplace_back(at_i, at_j, w * std::conj(factor_i) * factor_j);
      }
    }
  }
};

/// How residuals count in a round: those of matches as `match_width_m` says, by Cauchy's weights if `robust`; those of
/// places by Cauchy's weights, but in the first round, which does not let them go.
struct RoundWeights {
  double match_width_m;
  bool robust;
  bool places_fixed;
};

Unknowns solve_round(const Block& block, const std::vector<Equation>& equations, const Unknowns& before,
                     const RoundWeights& weights) {
  const std::size_t frames = block.measured.size();
  const auto z_at = [](std::size_t frame) { return static_cast<Eigen::Index>(frame); };
  const auto displaced_at = [&](std::size_t frame) { return static_cast<Eigen::Index>(frames + frame); };
  NormalEquations normal;
  normal.right = Eigen::VectorXcd::Zero(static_cast<Eigen::Index>(2 * frames));
  for (const Equation& one : equations) {
    const Complex apart =
        east_north(block.measured[one.second].center_enu_m) - east_north(block.measured[one.first].center_enu_m);
    const double w = weight(weights.robust ? residual_of(one, block, before) : 0.0, weights.match_width_m);
    normal.add({{{z_at(one.first), one.u_first},
                 {z_at(one.second), -one.u_second},
                 {displaced_at(one.first), 1.0},
                 {displaced_at(one.second), -1.0}}},
               4, apart, w);
  }
  for (std::size_t i = 0; i < frames; ++i) {
    // A match stands for one of some dozens of its pair: a place outweighs a single one.
    const double width_m = weights.places_fixed ? 1e-3 : block.measured[i].sigma_en_m;
    normal.add({{{displaced_at(i), 1.0}}}, 1, 0.0, 100 * weight(before.displaced(i), width_m));
    normal.add({{{z_at(i), 1.0}}}, 1, before.z(i), 1e-9);  // frames of no pair keep what they had
  }
  ComplexMatrix matrix(static_cast<Eigen::Index>(2 * frames), static_cast<Eigen::Index>(2 * frames));
  matrix.setFromTriplets(normal.entries.begin(), normal.entries.end());
  const Eigen::SimplicialLDLT<ComplexMatrix> solver(matrix);
  if (solver.info() != Eigen::Success) throw DataError("the frames' places and pictures do not fit together at all");
  return {solver.solve(normal.right), frames};
}

}  // namespace

BlockStart start_block(const Block& block) {
  const std::size_t frames = block.measured.size();
  std::vector<Eigen::Matrix3d> assumed;
  for (const MeasuredPose& measured : block.measured) {
    assumed.push_back(measured.enu_from_camera.value_or(level_enu_from_camera(block)));
  }
  const std::vector<Equation> equations = make_equations(block, assumed);
  if (equations.empty()) throw DataError("no two frames show the same ground");
  Unknowns unknowns{Eigen::VectorXcd::Zero(static_cast<Eigen::Index>(2 * frames)), frames};
  double agl_m = 0;
  for (int round = 0; round < kRounds; ++round) {
    // Matches are believed before places: a frame whose place is wrong by far moves to where its pictures put it, and
    // only then may matches be doubted.
    unknowns = solve_round(block, equations, unknowns,
                           {round == 0 ? 1.0 : std::max(0.1, kTiltShare * agl_m), round >= kRounds / 2, round == 0});
    std::vector<double> heights_m;
    for (std::size_t i = 0; i < frames; ++i) heights_m.push_back(std::abs(unknowns.z(i)));
    agl_m = quantile(heights_m, 0.5);
  }
  if (!(agl_m > 0.1)) throw DataError("the frames' places and pictures do not fit together: no height comes out");
  BlockStart start;
  start.agl_m = agl_m;
  // Heights come from the pictures' scale, above ground that most of the stated ones agree on: a wrong one has no say.
  std::vector<double> grounds_m;
  for (std::size_t i = 0; i < frames; ++i) {
    grounds_m.push_back(block.measured[i].center_enu_m.z() - std::abs(unknowns.z(i)));
  }
  const double ground_m = quantile(grounds_m, 0.5);
  for (std::size_t i = 0; i < frames; ++i) {
    const Complex z = unknowns.z(i);
    const double turn_rad = std::arg(z);  // counter-clockwise, seen from above
    const Eigen::Matrix3d turned =
        Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix() * assumed[i];
    const Complex place = east_north(block.measured[i].center_enu_m) + unknowns.displaced(i);
    start.poses.push_back({turned, {place.real(), place.imag(), ground_m + std::abs(z)}});
    start.turned_deg.push_back(block.measured[i].enu_from_camera ? -turn_rad / kRadPerDeg : 0);
    start.displaced_m.push_back(std::abs(unknowns.displaced(i)));
  }
  return start;
}

}  // namespace pilotage
