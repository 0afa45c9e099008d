#include "pilotage/mapdb/map_digest.h"

#include <limits>
#include <string_view>
#include <vector>

#include <sodium.h>

#include "pilotage/base/error.h"
#include "pilotage/mapdb/byte_order.h"

namespace pilotage {
namespace {

class Blake2b {
 public:
  Blake2b() {
    if (sodium_init() < 0) throw DataError("libsodium cannot be started");
    crypto_generichash_init(&state_, nullptr, 0, kDigestBytes);
  }
  void add(std::span<const std::uint8_t> bytes) { crypto_generichash_update(&state_, bytes.data(), bytes.size()); }
  Digest finish() {
    Digest digest{};
    crypto_generichash_final(&state_, digest.data(), digest.size());
    return digest;
  }

 private:
  crypto_generichash_state state_{};
};

/// Length (64 bits), then the bytes: no two sequences of fields give the same string.
void append_counted(std::vector<std::uint8_t>& bytes, std::span<const std::uint8_t> field) {
  append_le(bytes, static_cast<std::uint64_t>(field.size()));
  bytes.insert(bytes.end(), field.begin(), field.end());
}

void append_counted(std::vector<std::uint8_t>& bytes, std::string_view field) {
  append_le(bytes, static_cast<std::uint64_t>(field.size()));
  append_text(bytes, field);
}

void append_place(std::vector<std::uint8_t>& bytes, std::int64_t tile_id, int level, const PixelWindow& window) {
  append_le(bytes, tile_id);
  append_le(bytes, std::int64_t{level});
  append_le(bytes, window.col);
  append_le(bytes, window.row);
  append_le(bytes, std::int64_t{window.width});
  append_le(bytes, std::int64_t{window.height});
}

void append_value(std::vector<std::uint8_t>& bytes, const Statement& statement, int column) {
  switch (statement.type(column)) {
    case Statement::Type::kNull:
      bytes.push_back('N');
      return;
    case Statement::Type::kInteger:
      bytes.push_back('I');
      append_le(bytes, statement.integer(column));
      return;
    case Statement::Type::kReal:
      bytes.push_back('F');
      append_le(bytes, statement.real(column));
      return;
    case Statement::Type::kText:
      bytes.push_back('T');
      append_counted(bytes, statement.text(column));
      return;
    case Statement::Type::kBlob:
      bytes.push_back('B');
      append_counted(bytes, statement.blob(column));
      return;
  }
}

/// The table's name, its columns' names, and every row of `select`.
void add_table(Blake2b& hash, std::string_view table, Statement& select) {
  std::vector<std::uint8_t> bytes = {'T'};
  append_counted(bytes, table);
  append_le(bytes, static_cast<std::uint64_t>(select.column_count()));
  for (int column = 0; column < select.column_count(); ++column) append_counted(bytes, select.column_name(column));
  hash.add(bytes);
  while (select.step()) {
    bytes.assign(1, 'R');
    for (int column = 0; column < select.column_count(); ++column) append_value(bytes, select, column);
    hash.add(bytes);
  }
}

std::string quoted_name(std::string_view name) {
  std::string result = "\"";
  for (const char c : name) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + '"';
}

}  // namespace

Digest descriptor_digest(const DescriptorRow& row) {
  std::vector<std::uint8_t> bytes;
  append_text(bytes, "pilotage descriptors 1\n");
  append_place(bytes, row.tile_id, row.level, row.window);
  append_le(bytes, row.count);
  append_le(bytes, std::int64_t{row.descriptor_bytes});
  bytes.push_back(row.ground_base_m ? 1 : 0);
  append_le(bytes, row.ground_base_m.value_or(0));
  append_counted(bytes, row.keypoints);
  append_counted(bytes, row.descriptors);
  Blake2b hash;
  hash.add(bytes);
  return hash.finish();
}

Digest chip_digest(const MapChip& chip) {
  std::vector<std::uint8_t> bytes;
  append_text(bytes, "pilotage chips 1\n");
  append_place(bytes, chip.tile_id, chip.level, chip.window);
  append_counted(bytes, chip.encoding);
  append_counted(bytes, std::span<const std::uint8_t>(chip.data));
  Blake2b hash;
  hash.add(bytes);
  return hash.finish();
}

Digest content_digest(const Database& database) {
  Blake2b hash;
  std::vector<std::uint8_t> bytes;
  append_text(bytes, "pilotage map 1\n");
  hash.add(bytes);
  Statement schema =
      database.prepare("SELECT type, name, tbl_name, sql FROM sqlite_master ORDER BY name, type", "schema");
  add_table(hash, "sqlite_master", schema);
  // Virtual tables have no root page: what they hold stands in their shadow tables, which are listed like all others.
  Statement tables =
      database.prepare("SELECT name FROM sqlite_master WHERE type = 'table' AND rootpage <> 0 ORDER BY name", "schema");
  while (tables.step()) {
    const std::string name(tables.text(0));
    const char* filter = name == "map_info" ? " WHERE key <> 'content_digest'" : "";
    Statement rows = database.prepare("SELECT * FROM " + quoted_name(name) + filter + " ORDER BY rowid", name);
    add_table(hash, name, rows);
  }
  return hash.finish();
}

std::string to_hex(std::span<const std::uint8_t> bytes) {
  static constexpr char kHex[] = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : bytes) text += {kHex[byte >> 4], kHex[byte & 15]};
  return text;
}

}  // namespace pilotage
