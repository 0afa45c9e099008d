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

/// The text as a cell: in quotes, and those inside doubled, where it holds a comma, a quote, a line break, or a blank
/// at either end.
std::string csv_cell(std::string_view text);

/// A number as a cell: the shortest text that reads back as the same double, nothing for NaN.
std::string csv_cell(double number);

}  // namespace pilotage
