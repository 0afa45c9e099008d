#include "pilotage/base/csv.h"

#include <algorithm>
#include <cmath>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"

namespace pilotage {
namespace {

bool at_line_end(std::string_view text) {
  return text.empty() || text.front() == '\n' || text.starts_with("\r\n");
}

}  // namespace

CsvReader::CsvReader(std::string name, std::string_view text)
    : name_(std::move(name)), rest_(without_byte_order_mark(text)) {}

std::string CsvReader::where() const {
  return name_ + ": line " + std::to_string(row_line_) + ": ";
}

bool CsvReader::next(std::vector<std::string>& cells) {
  cells.clear();
  const auto end_line = [&] {
    rest_.remove_prefix(rest_.empty() ? 0 : rest_.find('\n') + 1);
    ++line_;
  };
  while (!rest_.empty() && at_line_end(rest_)) end_line();
  if (rest_.empty()) return false;
  row_line_ = line_;
  while (true) {
    cells.push_back(rest_.starts_with('"') ? take_quoted() : take_bare());
    if (at_line_end(rest_)) break;
    if (rest_.front() != ',') {
      throw DataError(where() + "text after the closing quote of \"" + cells.back().substr(0, 40) + "\"");
    }
    rest_.remove_prefix(1);
  }
  end_line();
  return true;
}

std::string CsvReader::take_quoted() {
  std::string cell;
  rest_.remove_prefix(1);
  while (true) {
    const std::size_t quote = rest_.find('"');
    if (quote == std::string_view::npos) throw DataError(where() + "a quote is not closed");
    const std::string_view part = rest_.substr(0, quote);
    line_ += std::count(part.begin(), part.end(), '\n');
    cell += part;
    rest_.remove_prefix(quote + 1);
    if (!rest_.starts_with('"')) return cell;
    cell += '"';
    rest_.remove_prefix(1);
  }
}

std::string CsvReader::take_bare() {
  std::size_t end = 0;
  while (end < rest_.size() && rest_[end] != ',' && !at_line_end(rest_.substr(end))) {
    if (rest_[end] == '"') {
      throw DataError(where() + "a quote inside the unquoted cell \"" + std::string(rest_.substr(0, end)) + "…\"");
    }
    ++end;
  }
  std::string cell(rest_.substr(0, end));
  rest_.remove_prefix(end);
  return cell;
}

CsvTable::CsvTable(const std::string& name, std::string_view text, const std::string& expected) : reader_(name, text) {
  if (!reader_.next(columns_)) throw DataError(name + ": empty, expected " + expected);
  for (auto column = columns_.begin(); column != columns_.end(); ++column) {
    if (std::find(columns_.begin(), column, *column) == column) continue;
    throw DataError(where() + "column \"" + *column + "\" is a duplicate");
  }
}

const std::vector<std::string>* CsvTable::next() {
  if (!reader_.next(cells_)) return nullptr;
  if (cells_.size() == columns_.size()) return &cells_;
  throw DataError(where() + std::to_string(cells_.size()) + " cells, expected " + std::to_string(columns_.size()));
}

std::string csv_cell(std::string_view text) {
  const bool plain =
      text.find_first_of(",\"\r\n") == std::string_view::npos && !text.starts_with(' ') && !text.ends_with(' ');
  if (plain) return std::string(text);
  std::string cell = "\"";
  for (const char c : text) {
    if (c == '"') cell += '"';
    cell += c;
  }
  return cell + "\"";
}

std::string csv_cell(double number) {
  return std::isnan(number) ? std::string() : format_number(number);
}

}  // namespace pilotage
