#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pilotage {

/// Where a column of a table of waypoints stands, and what a number in it is to be multiplied with.
struct TableColumn {
  std::size_t at = 0;
  double factor = 1;
};

/// The column of that name, whose letters are small; blanks and capitals in the table do not matter.
std::optional<TableColumn> find_column(const std::vector<std::string>& columns, std::string_view key, double factor);

/// The number in a cell, blanks around it left out, times the factor. `where` begins messages. Throws DataError naming
/// the column for anything but a finite number.
double cell_number(const std::vector<std::string>& cells, const TableColumn& column,
                   const std::vector<std::string>& columns, const std::string& where);

/// The same, or nothing where the cell is blank.
std::optional<double> cell_number_if_any(const std::vector<std::string>& cells, const TableColumn& column,
                                         const std::vector<std::string>& columns, const std::string& where);

}  // namespace pilotage
