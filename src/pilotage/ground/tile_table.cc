#include "pilotage/ground/tile_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <optional>

#include "pilotage/base/csv.h"
#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

/// A column of tiles.csv: how its cell is written, and how it is read (false = malformed).
struct Cell {
  std::string name;
  std::function<std::string(const TileRow&)> write;
  std::function<bool(TileRow&, std::string_view)> read;
};

Cell integer_cell(std::string name, std::function<std::int64_t(const TileRow&)> get,
                  std::function<bool(TileRow&, std::int64_t)> set) {
  return {std::move(name), [get = std::move(get)](const TileRow& row) { return std::to_string(get(row)); },
          [set = std::move(set)](TileRow& row, std::string_view text) {
            std::int64_t value = 0;
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
            return error == std::errc{} && end == text.data() + text.size() && set(row, value);
          }};
}

/// `required`: an empty cell (NaN) is refused.
Cell number_cell(std::string name, bool required, std::function<double(const TileRow&)> get,
                 std::function<void(TileRow&, double)> set) {
  return {std::move(name), [get = std::move(get)](const TileRow& row) { return csv_cell(get(row)); },
          [required, set = std::move(set)](TileRow& row, std::string_view text) {
            if (text.empty() && !required) {
              set(row, kNaN);
              return true;
            }
            const std::optional<double> value = parse_number(text);
            if (!value || std::isnan(*value)) return false;
            set(row, *value);
            return true;
          }};
}

Cell status_cell() {
  return {"status", [](const TileRow& row) { return std::string(tile_status_name(row.score.status)); },
          [](TileRow& row, std::string_view text) {
            for (const TileStatus status : {TileStatus::kScored, TileStatus::kTooLittleGround, TileStatus::kFlat}) {
              if (text != tile_status_name(status)) continue;
              row.score.status = status;
              return true;
            }
            return false;
          }};
}

/// Codes joined by semicolons.
Cell reasons_cell() {
  return {"reasons", [](const TileRow& row) { return reason_words(row.score); },
          [](TileRow& row, std::string_view text) {
            row.score.reasons.clear();
            while (!text.empty()) {
              const std::size_t end = std::min(text.find(';'), text.size());
              const EnumNames<ReasonCode> names = enum_names(ReasonCode{});
              const auto known = std::find_if(names.begin(), names.end(),
                                              [&](const auto& entry) { return entry.name == text.substr(0, end); });
              if (known == names.end() || end + 1 == text.size()) return false;
              row.score.reasons.push_back(known->value);
              text.remove_prefix(std::min(end + 1, text.size()));
            }
            return true;
          }};
}

std::vector<Cell> make_cells() {
  std::vector<Cell> cells;
  // A place that is not known (outside the projection, or in metres where the CRS counts degrees) is empty.
  const auto tile_number = [&](std::string name, auto member) {
    cells.push_back(number_cell(
        std::move(name), false, [member](const TileRow& row) { return *member(row); },
        [member](TileRow& row, double value) { *member(row) = value; }));
  };
  cells.push_back(integer_cell(
      "tile_id", [](const TileRow& row) { return row.tile.tile_id; },
      [](TileRow& row, std::int64_t value) {
        row.tile.tile_id = value;
        return true;
      }));
  cells.push_back(integer_cell(
      "level", [](const TileRow& row) { return row.tile.level; },
      [](TileRow& row, std::int64_t value) {
        row.tile.level = static_cast<int>(value);
        return value >= 0 && value <= 1000;
      }));
  cells.push_back(integer_cell(
      "column", [](const TileRow& row) { return row.tile.column; },
      [](TileRow& row, std::int64_t value) {
        row.tile.column = value;
        return true;
      }));
  cells.push_back(integer_cell(
      "row", [](const TileRow& row) { return row.tile.row; },
      [](TileRow& row, std::int64_t value) {
        row.tile.row = value;
        return true;
      }));
  tile_number("center_lon_deg", [](auto& row) { return &row.tile.center.lon_deg; });
  tile_number("center_lat_deg", [](auto& row) { return &row.tile.center.lat_deg; });
  tile_number("min_x_m", [](auto& row) { return &row.tile.bounds.min_x_m; });
  tile_number("min_y_m", [](auto& row) { return &row.tile.bounds.min_y_m; });
  tile_number("max_x_m", [](auto& row) { return &row.tile.bounds.max_x_m; });
  tile_number("max_y_m", [](auto& row) { return &row.tile.bounds.max_y_m; });
  cells.push_back(integer_cell(
      "min_col_px", [](const TileRow& row) { return row.min_col_px; },
      [](TileRow& row, std::int64_t value) {
        row.min_col_px = value;
        return true;
      }));
  cells.push_back(integer_cell(
      "min_row_px", [](const TileRow& row) { return row.min_row_px; },
      [](TileRow& row, std::int64_t value) {
        row.min_row_px = value;
        return true;
      }));
  cells.push_back(number_cell(
      "valid_fraction", true, [](const TileRow& row) { return row.score.valid_fraction; },
      [](TileRow& row, double value) { row.tile.valid_fraction = row.score.valid_fraction = value; }));
  cells.push_back(status_cell());
  for (const Measure& measure : measures()) {
    cells.push_back(number_cell(
        measure.name, false, [&measure](const TileRow& row) { return measure.get(row.score); },
        [&measure](TileRow& row, double value) { measure.set(row.score, value); }));
  }
  cells.push_back(reasons_cell());
  return cells;
}

const std::vector<Cell>& cells() {
  static const std::vector<Cell> list = make_cells();
  return list;
}

/// For each column of the file, the cell it holds, or nullptr for one this version does not know.
std::vector<const Cell*> read_header(const CsvTable& table) {
  std::vector<const Cell*> order;
  for (const std::string& column : table.columns()) {
    const auto found =
        std::find_if(cells().begin(), cells().end(), [&](const Cell& cell) { return cell.name == column; });
    order.push_back(found == cells().end() ? nullptr : &*found);
  }
  for (const Cell& cell : cells()) {
    if (std::find(order.begin(), order.end(), &cell) != order.end()) continue;
    throw DataError(table.where() + "column \"" + cell.name + "\" is missing");
  }
  return order;
}

TileRow make_row(const Ground& ground, std::size_t i, TileScores scores) {
  const PixelWindow window = ground.window_of(ground.tiles[i]);
  return {ground.tiles[i], window.col, window.row, std::move(scores)};
}

/// The table of `count` rows that row_of gives.
template <class RowOf>
std::string table_of(std::size_t count, const RowOf& row_of) {
  std::string text;
  for (const Cell& cell : cells()) text += (text.empty() ? "" : ",") + cell.name;
  text += '\n';
  constexpr std::size_t kUsualRow = 320;
  text.reserve(text.size() + count * kUsualRow);  // growing by doubling would hold it twice
  for (std::size_t i = 0; i < count; ++i) {
    const TileRow& row = row_of(i);
    bool first = true;
    for (const Cell& cell : cells()) {
      if (!first) text += ',';
      first = false;
      text += cell.write(row);
    }
    text += '\n';
  }
  return text;
}

}  // namespace

std::string reason_words(const TileScores& score) {
  std::vector<std::string> words;
  for (const ReasonCode code : score.reasons) words.push_back(options_detail::enum_to_name(code));
  return join(words, ";");
}

std::string_view tile_status_name(TileStatus status) {
  switch (status) {
    case TileStatus::kTooLittleGround:
      return "too_little_ground";
    case TileStatus::kFlat:
      return "flat";
    case TileStatus::kScored:
      break;
  }
  return "scored";
}

std::vector<TileRow> tile_rows(const Ground& ground, std::vector<TileScores> scores) {
  std::vector<TileRow> rows;
  rows.reserve(scores.size());
  for (std::size_t i = 0; i < scores.size(); ++i) rows.push_back(make_row(ground, i, std::move(scores[i])));
  return rows;
}

std::string tile_table_to_csv(std::span<const TileRow> rows) {
  return table_of(rows.size(), [&](std::size_t i) -> const TileRow& { return rows[i]; });
}

std::string tile_table_to_csv(const Ground& ground, std::span<const TileScores> scores) {
  return table_of(scores.size(), [&](std::size_t i) { return make_row(ground, i, scores[i]); });
}

std::vector<TileRow> tile_table_from_csv(const std::string& name, std::string_view text) {
  CsvTable table(name, text, "a table of tiles");
  const std::vector<const Cell*> order = read_header(table);
  std::vector<TileRow> rows;
  while (const auto* parts = table.next()) {
    TileRow row;
    for (std::size_t i = 0; i < order.size(); ++i) {
      const std::string& part = (*parts)[i];
      if (order[i] == nullptr || order[i]->read(row, part)) continue;
      throw DataError(table.where() + order[i]->name + " = \"" + part.substr(0, 40) + "\" is not allowed");
    }
    if (!rows.empty() && rows.back().tile.tile_id >= row.tile.tile_id) {
      throw DataError(table.where() + "tile_id " + std::to_string(row.tile.tile_id) + " does not follow " +
                      std::to_string(rows.back().tile.tile_id));
    }
    rows.push_back(row);
  }
  return rows;
}

}  // namespace pilotage
