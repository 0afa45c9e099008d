#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pilotage {

/// Reads comma-separated text row by row (Y. Shafranovich, RFC 4180, 2005): cells may be quoted and then hold commas,
/// line breaks and doubled quotes; lines end with "\n" or "\r\n", the last one may lack it; a byte order mark is
/// skipped; lines without a character are skipped. Blanks belong to their cell.
class CsvReader {
 public:
  /// `name` stands for the source in messages; `text` must outlive the reader.
  CsvReader(std::string name, std::string_view text);

  /// The cells of the next row into `cells`; false at the end. Throws DataError, naming source and line, for a quote
  /// that is not closed or stands inside a cell without quotes, and for text behind a closing quote.
  bool next(std::vector<std::string>& cells);

  /// The line on which the last row began, counted from 1.
  std::int64_t line() const { return row_line_; }

  /// "NAME: line LINE: " for messages about the last row.
  std::string where() const;

 private:
  std::string take_quoted();
  std::string take_bare();

  std::string name_;
  std::string_view rest_;
  std::int64_t line_ = 1;
  std::int64_t row_line_ = 0;
};

/// A table whose first row names its columns.
class CsvTable {
 public:
  /// `expected` says in messages what the text should be ("a table of frames"). Throws DataError when it is empty, and
  /// for a column that is a duplicate.
  CsvTable(const std::string& name, std::string_view text, const std::string& expected);

  const std::vector<std::string>& columns() const { return columns_; }

  /// The next row, one cell for each column; nullptr at the end. Throws as CsvReader::next, and DataError for a row
  /// with more or fewer cells.
  const std::vector<std::string>* next();

  /// "NAME: line LINE: " for messages about the last row.
  std::string where() const { return reader_.where(); }

 private:
  CsvReader reader_;
  std::vector<std::string> columns_;
  std::vector<std::string> cells_;
};

/// The text as a cell: in quotes, and those inside doubled, where it holds a comma, a quote, a line break, or a blank
/// at either end.
std::string csv_cell(std::string_view text);

/// A number as a cell: the shortest text that reads back as the same double, nothing for NaN.
std::string csv_cell(double number);

}  // namespace pilotage
