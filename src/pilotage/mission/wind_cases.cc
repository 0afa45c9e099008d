#include "pilotage/mission/wind_cases.h"

#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <stdexcept>
#include <string>

namespace pilotage {
namespace {

/// Winds that stand for the share of all that are stronger than `from` of them and calmer than `to`.
struct Ring {
  double from;
  double to;
  std::size_t directions;
};

/// So many as a level of the place is worth: where it is low flights are lost in any wind, where it is high in none.
std::span<const Ring> rings(std::size_t count) {
  static constexpr std::array<Ring, 3> kEleven = {{{0, 0.6, 3}, {0.6, 0.9, 4}, {0.9, 1, 4}}};
  static constexpr std::array<Ring, 3> kEight = {{{0, 0.6, 2}, {0.6, 0.9, 3}, {0.9, 1, 3}}};
  static constexpr std::array<Ring, 2> kFive = {{{0, 0.7, 2}, {0.7, 1, 3}}};
  static constexpr std::array<Ring, 1> kThree = {{{0, 1, 3}}};
  switch (count) {
    case 11:
      return kEleven;
    case 8:
      return kEight;
    case 5:
      return kFive;
    default:
      return kThree;
  }
}

double turned(double x) {
  return x - std::floor(x);
}

}  // namespace

std::vector<WindNode> wind_nodes(double sigma_mps, std::size_t count, double shift) {
  if (sigma_mps == 0) return {{}};
  const std::span<const Ring> all = rings(count);
  std::vector<WindNode> nodes;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Ring& ring = all[k];
    const double within = turned(0.5 + shift + 0.37 * static_cast<double>(k));
    // The outermost ring keeps clear of both ends of its share, where it would not stand for the rest of it.
    const double share = ring.from + (ring.to - ring.from) * (k + 1 < all.size() ? within : 0.2 + 0.6 * within);
    const double speed_mps = sigma_mps * std::sqrt(-2 * std::log1p(-share));
    const auto directions = static_cast<double>(ring.directions);
    for (std::size_t i = 0; i < ring.directions; ++i) {
      const double turn = (static_cast<double>(i) + turned(shift + 0.5 * static_cast<double>(k))) / directions;
      const double angle_rad = 2 * std::numbers::pi * turn;
      nodes.push_back(
          {speed_mps * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad)), (ring.to - ring.from) / directions});
    }
  }
  return nodes;
}

std::vector<WindCase> wind_cases(double sigma_mps, std::size_t levels) {
  constexpr std::array<std::size_t, 9> kWindsOfLevel = {3, 5, 11, 11, 11, 8, 5, 3, 3};
  constexpr std::size_t kSetsAlone = 3;
  if (levels != 1 && levels != kWindsOfLevel.size()) {
    throw std::invalid_argument("wind_cases: " + std::to_string(levels) + " levels");
  }
  const std::size_t sets = levels > 1 || sigma_mps == 0 ? 1 : kSetsAlone;
  std::vector<WindCase> cases;
  for (std::size_t i = 0; i < levels * sets; ++i) {
    const double shift = turned(static_cast<double>(i) * (std::numbers::phi - 1));
    for (const WindNode& node : wind_nodes(sigma_mps, levels > 1 ? kWindsOfLevel[i] : kWindsOfLevel[4], shift)) {
      cases.push_back({i / sets, {node.wind_mps, node.weight / static_cast<double>(sets)}});
    }
  }
  return cases;
}

}  // namespace pilotage
