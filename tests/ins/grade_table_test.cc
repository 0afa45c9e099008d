#include <filesystem>
#include <sstream>

#include "testing/drift_after.h"
#include "testing/source_folder.h"
#include <gtest/gtest.h>

#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/ins/drift.h"

namespace pilotage {
namespace {

/// The cells of a row "| a | b | … |", without the blanks around them.
std::vector<std::string> cells_of(const std::string& row) {
  std::vector<std::string> cells;
  std::istringstream stream(row);
  std::string cell;
  std::getline(stream, cell, '|');
  while (std::getline(stream, cell, '|')) {
    const auto first = cell.find_first_not_of(' ');
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, cell.find_last_not_of(' ') - first + 1));
  }
  return cells;
}

// docs/methods/ins.md shows what the grades mean; its numbers are those of the code.
TEST(GradeTable, OfTheDocsIsUpToDate) {
  std::istringstream docs(read_file(testing::source_folder() / "docs" / "methods" / "ins.md"));
  bool inside = false;
  int rows = 0;
  for (std::string line; std::getline(docs, line);) {
    if (line.starts_with("| σ of position (m) after")) inside = true;
    if (!inside || !line.starts_with("| ") || line.starts_with("| σ")) continue;
    const auto cells = cells_of(line);
    ASSERT_GE(cells.size(), 9U) << line;
    InsOptions options;
    const std::string name = cells[0].substr(0, cells[0].find(','));
    set_from_text(*list_options(options).find("grade"), {name});
    if (name != cells[0]) options.velocity_aid_sigma_mps = 1;
    const InsErrorModel model = make_ins_error_model(options);
    const double times_s[] = {10, 30, 60, 120, 300};
    for (std::size_t i = 0; i < 5; ++i) {
      EXPECT_EQ(cells[1 + i], format_fixed(position_error_m(testing::drift_after(model, times_s[i], 20, 2), 1), 1))
          << line;
    }
    const double limits_m[] = {25, 50, 100};
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(cells[6 + i], format_fixed(longest_bridgeable_gap_s(model, 20, limits_m[i], 3, 2), 0)) << line;
    }
    ++rows;
  }
  EXPECT_EQ(rows, 8);
}

}  // namespace
}  // namespace pilotage
