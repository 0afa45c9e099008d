#include "pilotage/evaluate/registered_place.h"

#include <algorithm>
#include <limits>

namespace pilotage {
namespace {

constexpr int kIterations = 5;

Eigen::Vector2d nearest_displacement_m(const WarpField& field, const Eigen::Vector2d& point_m) {
  if (field.known(point_m.x(), point_m.y())) return field.displacement_m(point_m.x(), point_m.y());
  double nearest = std::numeric_limits<double>::infinity();
  Eigen::Vector2d place_m = point_m;
  for (int row = 0; row < field.cell_rows; ++row) {
    for (int column = 0; column < field.cell_columns; ++column) {
      if (field.cell_known[static_cast<std::size_t>(row * field.cell_columns + column)] == 0) continue;
      // The point of the cell that is nearest, kept clear of its edge.
      const auto inside = [&](double value, double origin, int index) {
        const double begin = origin + index * field.cell_m;
        return std::clamp(value, begin + 0.01 * field.cell_m, begin + 0.99 * field.cell_m);
      };
      const Eigen::Vector2d in_cell_m(inside(point_m.x(), field.min_x_m, column), inside(point_m.y(), field.min_y_m, row));
      const double distance_m = (in_cell_m - point_m).norm();
      if (distance_m >= nearest) continue;
      nearest = distance_m;
      place_m = in_cell_m;
    }
  }
  if (nearest == std::numeric_limits<double>::infinity()) return Eigen::Vector2d::Zero();
  return field.displacement_m(place_m.x(), place_m.y());
}

}  // namespace

PlaceOnReference registered_place(const WarpField& field) {
  return [field](const Eigen::Vector2d& point_m) {
    Eigen::Vector2d place_m = point_m;
    for (int i = 0; i < kIterations; ++i) place_m = point_m - nearest_displacement_m(field, place_m);
    return place_m;
  };
}

}  // namespace pilotage
