#include "pilotage/raster/gdal_sqlite.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <system_error>
#include <vector>

#include <sqlite3.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

constexpr std::string_view kMagic("SQLite format 3\0", 16);
constexpr std::int64_t kMinSteps = 2'000'000;
constexpr std::int64_t kStepsPerByte = 2;
constexpr int kStepsBetweenLooks = 1000;
constexpr std::uintmax_t kMinValueBytes = std::uintmax_t{1} << 20;

/// Whose rows describe other tables (OGC 12-128r18; MBTiles 1.3). GDAL reads them whole.
constexpr const char* kDescribingTables =
    "SELECT name FROM sqlite_master WHERE type = 'table' AND (name LIKE 'gpkg\\_%' ESCAPE '\\' OR name IN ('metadata', "
    "'layer_styles', 'geometry_columns', 'spatial_ref_sys', 'sqlite_sequence')) AND sql NOT LIKE 'CREATE VIRTUAL%'";
constexpr const char* kGeneratedColumns =
    "SELECT m.name FROM sqlite_master m, pragma_table_xinfo(m.name) x WHERE m.type = 'table' AND x.hidden IN (2, 3)";
constexpr const char* kViews = "SELECT name FROM sqlite_master WHERE type = 'view'";

using Connection = std::unique_ptr<sqlite3, decltype(&sqlite3_close)>;

/// A connection whose statements may take only so many steps.
class WatchedFile {
 public:
  WatchedFile(std::string name, Connection connection, std::uintmax_t file_bytes)
      : name_(std::move(name)),
        connection_(std::move(connection)),
        steps_left_(kMinSteps + kStepsPerByte * static_cast<std::int64_t>(file_bytes)) {
    constexpr std::uintmax_t kMost = std::numeric_limits<int>::max();
    sqlite3_limit(connection_.get(), SQLITE_LIMIT_LENGTH,
                  static_cast<int>(std::clamp(file_bytes, kMinValueBytes, kMost)));
    sqlite3_progress_handler(connection_.get(), kStepsBetweenLooks, spend, this);
  }

  /// The first column of the rows, of which there may be `most`.
  std::vector<std::string> texts(const std::string& sql, std::size_t most = std::numeric_limits<std::size_t>::max()) {
    std::vector<std::string> found;
    sqlite3_stmt* made = nullptr;
    if (!done(sqlite3_prepare_v2(connection_.get(), sql.c_str(), -1, &made, nullptr))) return found;
    const std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)> statement(made, sqlite3_finalize);
    int code = SQLITE_OK;
    while (found.size() < most && (code = sqlite3_step(made)) == SQLITE_ROW) {
      const auto* text = static_cast<const char*>(sqlite3_column_blob(made, 0));
      found.emplace_back(text != nullptr ? text : "", static_cast<std::size_t>(sqlite3_column_bytes(made, 0)));
    }
    done(code);
    return found;
  }

  void read_to_the_end(const std::string& sql) {
    sqlite3_stmt* made = nullptr;
    if (!done(sqlite3_prepare_v2(connection_.get(), sql.c_str(), -1, &made, nullptr))) return;
    const std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)> statement(made, sqlite3_finalize);
    int code = SQLITE_OK;
    while ((code = sqlite3_step(made)) == SQLITE_ROW) {
    }
    done(code);
  }

  [[noreturn]] void refuse(const std::string& why) const { throw DataError(name_ + ": " + why); }

 private:
  static int spend(void* file) {
    auto* const self = static_cast<WatchedFile*>(file);
    self->steps_left_ -= kStepsBetweenLooks;
    return self->steps_left_ >= 0 ? 0 : 1;
  }

  /// False where SQLite cannot go on, as GDAL will not.
  bool done(int code) const {
    if (steps_left_ < 0) {  // whatever SQLite calls it: while it reads the schema it says otherwise
      refuse("is damaged: to read what describes its tables takes SQLite more steps than a file of its size can need");
    }
    if (code == SQLITE_TOOBIG) refuse("is damaged: it holds a value that is longer than the file");
    return code == SQLITE_OK || code == SQLITE_DONE || code == SQLITE_ROW;
  }

  std::string name_;
  Connection connection_;
  std::int64_t steps_left_;
};

std::string quoted(const std::string& name) {
  std::string text = "\"";
  for (const char letter : name) text += letter == '"' ? std::string("\"\"") : std::string(1, letter);
  return text + "\"";
}

void check(WatchedFile& file, bool may_have_views) {
  const std::vector<std::string> generated = file.texts(kGeneratedColumns, 1);
  if (!generated.empty()) {
    file.refuse("the table \"" + generated.front() +
                "\" has generated columns, whose formulas are not run for a stranger; write it anew without them "
                "(ogr2ogr, gdal_translate)");
  }
  const std::vector<std::string> views = file.texts(kViews);
  if (!views.empty() && !may_have_views) {
    file.refuse("has the view \"" + views.front() +
                "\", which is not run for a stranger; write its rows as a table (ogr2ogr)");
  }
  for (const std::string& view : views) file.texts("SELECT * FROM " + quoted(view) + " LIMIT 1");
  for (const std::string& table : file.texts(kDescribingTables)) {
    file.read_to_the_end("SELECT * FROM " + quoted(table) + " NOT INDEXED");
  }
}

/// The file of a dataset's name, or "": "GPKG:file:table" is the file without what stands before the first colon and
/// behind the last.
std::string file_of(const std::string& dataset) {
  std::error_code error;
  if (std::filesystem::is_regular_file(dataset, error)) return dataset;
  const std::size_t first = dataset.find(':');
  if (first == std::string::npos) return "";
  for (std::string name = dataset.substr(first + 1);;) {
    if (std::filesystem::is_regular_file(name, error)) return name;
    const std::size_t last = name.rfind(':');
    if (last == std::string::npos) return "";
    name.resize(last);
  }
}

bool is_sqlite(const std::string& path) {
  std::string magic(kMagic.size(), '\0');
  std::ifstream stream(path, std::ios::binary);
  stream.read(magic.data(), static_cast<std::streamsize>(magic.size()));
  return stream && magic == kMagic;
}

Connection opened(const std::string& path) {
  sqlite3* made = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &made, SQLITE_OPEN_READONLY, nullptr);
  Connection connection(made, sqlite3_close);
  return code == SQLITE_OK ? std::move(connection) : Connection(nullptr, sqlite3_close);
}

}  // namespace

void check_sqlite_raster(const std::string& dataset) {
  const std::string path = file_of(dataset);
  if (path.empty() || !is_sqlite(path)) return;
  Connection connection = opened(path);
  if (connection == nullptr) return;
  WatchedFile file(dataset, std::move(connection), std::filesystem::file_size(path));
  check(file, true);
}

void check_sqlite_vectors(const std::string& name, std::string_view bytes) {
  if (!bytes.starts_with(kMagic)) return;
  Connection connection = opened(":memory:");
  if (connection == nullptr) return;
  // SQLite reads them and writes nothing: they are said to be read-only.
  auto* const data = reinterpret_cast<unsigned char*>(const_cast<char*>(bytes.data()));
  const auto size = static_cast<sqlite3_int64>(bytes.size());
  if (sqlite3_deserialize(connection.get(), "main", data, size, size, SQLITE_DESERIALIZE_READONLY) != SQLITE_OK) return;
  WatchedFile file(name, std::move(connection), bytes.size());
  check(file, false);
}

}  // namespace pilotage
