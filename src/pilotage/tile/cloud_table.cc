#include "pilotage/tile/cloud_table.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pilotage/base/csv.h"
#include "pilotage/base/error.h"
#include "pilotage/base/read_file.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

std::optional<std::size_t> column_of(const CsvTable& table, const std::string& name) {
  const auto found = std::find(table.columns().begin(), table.columns().end(), name);
  if (found == table.columns().end()) return std::nullopt;
  return static_cast<std::size_t>(found - table.columns().begin());
}

double number_in(const CsvTable& table, const std::string& cell, const std::string& column, double least, double most) {
  const std::optional<double> number = parse_number(cell);
  if (number && *number >= least && *number <= most) return *number;
  throw DataError(table.where() + column + " = \"" + cell + "\" is not a number from " + format_number(least) + " to " +
                  format_number(most));
}

int whole_in(const CsvTable& table, const std::string& cell, const std::string& column, int least, int most) {
  const double number = number_in(table, cell, column, least, most);
  const int whole = static_cast<int>(number);
  if (whole == number) return whole;
  throw DataError(table.where() + column + " = \"" + cell + "\" is not a whole number");
}

}  // namespace

double hidden_fraction(const std::filesystem::path& file, const UtcDate& flight) {
  const std::string name = file.string();
  const std::string text = read_file(file);
  CsvTable table(name, text, "a table of clouds by month");
  const auto month_column = column_of(table, "month");
  const auto hour_column = column_of(table, "hour_utc");
  const auto hidden_column = column_of(table, "hidden_fraction");
  if (!month_column || !hidden_column) {
    throw DataError(name + ": lacks the column " + (month_column ? "hidden_fraction" : "month") +
                    "; a table of clouds has month, hidden_fraction and, by hour, hour_utc");
  }
  std::map<std::pair<int, int>, double> hidden;  // by month and hour; hour 0 where the table has none
  while (const std::vector<std::string>* row = table.next()) {
    const int month = whole_in(table, (*row)[*month_column], "month", 1, 12);
    const int hour = hour_column ? whole_in(table, (*row)[*hour_column], "hour_utc", 0, 23) : 0;
    const double fraction = number_in(table, (*row)[*hidden_column], "hidden_fraction", 0, 1);
    if (!hidden.emplace(std::pair(month, hour), fraction).second) {
      throw DataError(table.where() + "month " + std::to_string(month) +
                      (hour_column ? ", hour " + std::to_string(hour) : "") + " is there already");
    }
  }

  const auto midnight = std::chrono::floor<std::chrono::days>(flight.time);
  const int month = static_cast<int>(static_cast<unsigned>(std::chrono::year_month_day(midnight).month()));
  const int hour = static_cast<int>(std::chrono::floor<std::chrono::hours>(flight.time - midnight).count());
  std::vector<double> asked;
  for (const auto& [when, fraction] : hidden) {
    if (when.first == month && (!hour_column || !flight.has_clock || when.second == hour)) asked.push_back(fraction);
  }
  if (asked.empty()) {
    throw DataError(name + ": says nothing of month " + std::to_string(month) +
                    (hour_column && flight.has_clock ? " at hour " + std::to_string(hour) + " UTC" : "") +
                    ", in which the flight begins");
  }
  return std::accumulate(asked.begin(), asked.end(), 0.0) / static_cast<double>(asked.size());
}

}  // namespace pilotage
