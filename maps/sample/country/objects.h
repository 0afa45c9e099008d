#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "country/colour.h"

namespace pilotage::scene_detail {

enum class BoxKind : std::uint8_t { kGable, kHip, kFlat, kVehicle, kTank, kRoundabout, kRing };

/// What is round: a disc inside its square.
inline bool is_round(BoxKind kind) {
  return kind == BoxKind::kTank || kind == BoxKind::kRoundabout || kind == BoxKind::kRing;
}

/// A quarter turn against the clock.
inline Eigen::Vector2d left_of(const Eigen::Vector2d& v) {
  return {-v.y(), v.x()};
}

/// A building or a vehicle: an upright box on a rectangle, in ground coordinates. What is round stands on the disc in
/// a square.
struct Box {
  Eigen::Vector2d center_m;
  Eigen::Vector2d along;  ///< Unit vector of the long side; the ridge of a roof runs this way.
  double half_length_m = 0;
  double half_width_m = 0;
  double height_m = 0;  ///< Of the eaves; flat roofs and vehicles end here.
  double rise_m = 0;    ///< From eaves to ridge.
  BoxKind kind = BoxKind::kGable;
  Rgb colour;
  std::uint64_t seed = 0;
  std::uint8_t epochs = 3;  ///< Bit e is set when it stands there at date e.
};

/// A tree that stands alone or in a hedge.
struct Tree {
  Eigen::Vector2d center_m;
  double radius_m = 0;
  double height_m = 0;
  std::uint64_t seed = 0;
};

/// Boxes and trees, and for each cell of a grid those that may cover or shade a point of it.
struct ObjectIndex {
  static constexpr double kCell_m = 16;
  std::vector<Box> boxes;
  std::vector<Tree> trees;
  Eigen::Vector2d origin_m;
  int columns = 0;
  int rows = 0;
  std::vector<std::uint32_t> box_starts;  ///< Of cell i: box_ids[box_starts[i]] … box_ids[box_starts[i + 1]] − 1.
  std::vector<std::uint32_t> box_ids;
  std::vector<std::uint32_t> tree_starts;
  std::vector<std::uint32_t> tree_ids;

  /// Index of the cell of a point, or −1 outside the grid.
  int cell_of(const Eigen::Vector2d& p) const;
};

/// Builds the cell lists over the rectangle from `min` to `max`.
ObjectIndex index_objects(std::vector<Box> boxes, std::vector<Tree> trees, const Eigen::Vector2d& min,
                          const Eigen::Vector2d& max);

}  // namespace pilotage::scene_detail
