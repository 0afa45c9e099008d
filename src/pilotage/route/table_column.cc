#include "pilotage/route/table_column.h"

#include <cctype>
#include <cmath>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

std::string column_key(std::string_view column) {
  std::string key;
  for (const char c : column) {
    const auto letter = static_cast<unsigned char>(c);
    if (std::isspace(letter) == 0) key += static_cast<char>(std::tolower(letter));
  }
  return key;
}

std::string_view without_blanks(std::string_view cell) {
  while (!cell.empty() && cell.front() == ' ') cell.remove_prefix(1);
  while (!cell.empty() && cell.back() == ' ') cell.remove_suffix(1);
  return cell;
}

}  // namespace

std::optional<TableColumn> find_column(const std::vector<std::string>& columns, std::string_view key, double factor) {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (column_key(columns[i]) == key) return TableColumn{i, factor};
  }
  return std::nullopt;
}

double cell_number(const std::vector<std::string>& cells, const TableColumn& column,
                   const std::vector<std::string>& columns, const std::string& where) {
  const std::string_view cell = without_blanks(cells[column.at]);
  const auto number = parse_number(cell);
  if (number && std::isfinite(*number)) return *number * column.factor;
  throw DataError(where + columns[column.at].substr(0, 30) + " is \"" + std::string(cell.substr(0, 40)) +
                  "\", expected a finite number");
}

std::optional<double> cell_number_if_any(const std::vector<std::string>& cells, const TableColumn& column,
                                         const std::vector<std::string>& columns, const std::string& where) {
  if (without_blanks(cells[column.at]).empty()) return std::nullopt;
  return cell_number(cells, column, columns, where);
}

}  // namespace pilotage
