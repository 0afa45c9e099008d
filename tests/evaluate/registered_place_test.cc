#include "pilotage/evaluate/registered_place.h"

#include <gtest/gtest.h>

namespace pilotage {
namespace {

/// Control points every 100 m whose displacement grows from west to east; known in the western half only.
WarpField growing_field() {
  WarpField field;
  field.min_x_m = -200;
  field.min_y_m = -200;
  field.spacing_m = 100;
  field.columns = 16;
  field.rows = 8;
  for (int row = 0; row < field.rows; ++row) {
    for (int column = 0; column < field.columns; ++column) field.control_m.emplace_back(0.5 * column, -2);
  }
  field.node_sigma_m.assign(field.control_m.size(), 0.1);
  field.cell_m = 50;
  field.cell_columns = 30;
  field.cell_rows = 14;
  for (int row = 0; row < field.cell_rows; ++row) {
    for (int column = 0; column < field.cell_columns; ++column) field.cell_known.push_back(column < 15 ? 1 : 0);
  }
  return field;
}

TEST(RegisteredPlace, UndoesTheDisplacement) {
  const WarpField field = growing_field();
  const PlaceOnReference place = registered_place(field);
  const Eigen::Vector2d on_reference(150, 100);
  const Eigen::Vector2d on_other = on_reference + field.displacement_m(150, 100);
  EXPECT_LT((place(on_other) - on_reference).norm(), 0.01);
  EXPECT_GT((on_other - on_reference).norm(), 2);
}

TEST(RegisteredPlace, TakesTheNearestDisplacementWhereNoneIsKnown) {
  const WarpField field = growing_field();
  const PlaceOnReference place = registered_place(field);
  // Cells are known up to x = 550.
  const Eigen::Vector2d far(900, 100);
  ASSERT_FALSE(field.known(far.x(), far.y()));
  EXPECT_LT((place(far) - (far - field.displacement_m(549.5, 100))).norm(), 0.01);
}

TEST(RegisteredPlace, IsThePointItselfWithoutAnyTie) {
  WarpField field = growing_field();
  field.cell_known.assign(field.cell_known.size(), 0);
  const Eigen::Vector2d point(150, 100);
  EXPECT_EQ(registered_place(field)(point), point);
}

}  // namespace
}  // namespace pilotage
