#include "pilotage/ground/place_level.h"

#include <cmath>
#include <limits>

namespace pilotage {
namespace {

std::array<LevelNode, 9> make_level_nodes() {
  std::array<LevelNode, 9> nodes;
  double sum = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const double z = (static_cast<double>(i) - 4) * kLevel80_z / 2;
    nodes[i] = {z, std::exp(-z * z / 2)};
    sum += nodes[i].weight;
  }
  for (LevelNode& node : nodes) node.weight /= sum;
  return nodes;
}

}  // namespace

const std::array<LevelNode, 9>& level_nodes() {
  static const std::array<LevelNode, 9> kNodes = make_level_nodes();
  return kNodes;
}

double logistic(double logit) {
  return 1 / (1 + std::exp(-logit));
}

double p_over_level(double logit, double sigma) {
  if (sigma == 0) return logistic(logit);
  double p = 0;
  for (const LevelNode& node : level_nodes()) p += node.weight * logistic(logit + sigma * node.z);
  return p;
}

double logit_of_p(double p, double sigma) {
  if (p <= 0) return -std::numeric_limits<double>::infinity();
  if (p >= 1) return std::numeric_limits<double>::infinity();
  const double alone = std::log(p) - std::log1p(-p);
  if (sigma == 0) return alone;
  double low = alone - sigma * level_nodes().back().z;  // here the mean is at most p, there at least
  double high = alone + sigma * level_nodes().back().z;
  while (true) {
    const double middle = low + (high - low) / 2;
    if (middle <= low || middle >= high) return middle;
    (p_over_level(middle, sigma) < p ? low : high) = middle;
  }
}

}  // namespace pilotage
