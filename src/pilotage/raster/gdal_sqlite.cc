#include "pilotage/raster/gdal_sqlite.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <system_error>
#include <utility>
#include <vector>

#include <cpl_vsi.h>
#include <sqlite3.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

constexpr std::string_view kMagic("SQLite format 3\0", 16);
constexpr std::int64_t kMinSteps = 2'000'000;
constexpr std::int64_t kStepsPerByte = 2;
constexpr int kStepsBetweenLooks = 1000;
constexpr std::uintmax_t kMinValueBytes = std::uintmax_t{1} << 20;
constexpr std::int64_t kMinReadBytes = std::int64_t{16} << 20;
constexpr std::int64_t kReadBytesPerByte = 4;

/// Names of tables whose rows describe others (OGC 12-128r18; MBTiles 1.3). GDAL reads them whole.
constexpr const char* kDescribes =
    "(name LIKE 'gpkg\\_%' ESCAPE '\\' OR lower(name) IN ('metadata', 'layer_styles', 'sqlite_sequence'))";

using Connection = std::unique_ptr<sqlite3, decltype(&sqlite3_close)>;

/// A connection that is not trusted: its statements may take only so many steps, and give only so many bytes.
class WatchedFile {
 public:
  WatchedFile(std::string name, Connection connection, std::uintmax_t file_bytes)
      : name_(std::move(name)),
        connection_(std::move(connection)),
        steps_left_(kMinSteps + kStepsPerByte * static_cast<std::int64_t>(file_bytes)),
        bytes_left_(kMinReadBytes + kReadBytesPerByte * static_cast<std::int64_t>(file_bytes)) {
    constexpr std::uintmax_t kMost = std::numeric_limits<int>::max();
    sqlite3_limit(connection_.get(), SQLITE_LIMIT_LENGTH,
                  static_cast<int>(std::clamp(file_bytes, kMinValueBytes, kMost)));
    sqlite3_progress_handler(connection_.get(), kStepsBetweenLooks, spend, this);
  }
  WatchedFile(const WatchedFile&) = delete;  // SQLite keeps its address
  WatchedFile& operator=(const WatchedFile&) = delete;

  /// The first column of the rows. Throws where SQLite cannot read all.
  std::vector<std::string> texts(const std::string& sql) {
    std::vector<std::string> found;
    require(read(sql, [&](sqlite3_stmt* row) {
      const auto* text = static_cast<const char*>(sqlite3_column_blob(row, 0));
      found.emplace_back(text != nullptr ? text : "", static_cast<std::size_t>(sqlite3_column_bytes(row, 0)));
    }));
    return found;
  }

  /// Whether there is a row, as far as SQLite can read.
  bool finds(const std::string& sql) {
    bool found = false;
    read(
        sql, [&](sqlite3_stmt*) { found = true; }, [&] { return !found; });
    return found;
  }

  /// Reads up to `most` rows. SQLite's code, SQLITE_OK where it could read them.
  int read_rows(const std::string& sql, std::int64_t most = std::numeric_limits<std::int64_t>::max()) {
    std::int64_t rows = 0;
    return read(
        sql, [&](sqlite3_stmt*) { ++rows; }, [&] { return rows < most; });
  }

  void forbid_functions() { sqlite3_set_authorizer(connection_.get(), forbid, nullptr); }

  void require(int code) const {
    if (code != SQLITE_OK) refuse(std::string("SQLite cannot read it: ") + sqlite3_errmsg(connection_.get()));
  }
  [[noreturn]] void refuse(const std::string& why) const { throw DataError(name_ + ": " + why); }

 private:
  static int spend(void* file) {
    auto* const self = static_cast<WatchedFile*>(file);
    self->steps_left_ -= kStepsBetweenLooks;
    return self->steps_left_ >= 0 ? 0 : 1;
  }

  static int forbid(void* /*unused*/, int action, const char* /*a*/, const char* /*b*/, const char* /*c*/,
                    const char* /*d*/) {
    return action == SQLITE_FUNCTION || action == SQLITE_RECURSIVE ? SQLITE_DENY : SQLITE_OK;
  }

  template <class Take, class GoOn>
  int read(const std::string& sql, const Take& take, const GoOn& go_on) {
    sqlite3_stmt* made = nullptr;
    int code = sqlite3_prepare_v2(connection_.get(), sql.c_str(), -1, &made, nullptr);
    const std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)> statement(made, sqlite3_finalize);
    while (code == SQLITE_OK && go_on()) {
      code = sqlite3_step(made);
      if (code != SQLITE_ROW) break;
      for (int column = 0; column < sqlite3_column_count(made); ++column) {
        bytes_left_ -= sqlite3_column_bytes(made, column);
      }
      take(made);
      code = bytes_left_ >= 0 ? SQLITE_OK : SQLITE_INTERRUPT;
    }
    // Whatever SQLite calls it: while it reads the schema it says otherwise.
    if (steps_left_ < 0 || bytes_left_ < 0) {
      refuse("is damaged: to read what describes its tables takes SQLite more than a file of its size can need");
    }
    if (code == SQLITE_TOOBIG) refuse("is damaged: it holds a value that is longer than the file");
    return code == SQLITE_DONE ? SQLITE_OK : code;
  }
  template <class Take>
  int read(const std::string& sql, const Take& take) {
    return read(sql, take, [] { return true; });
  }

  std::string name_;
  Connection connection_;
  std::int64_t steps_left_;
  std::int64_t bytes_left_;
};

std::string quoted(const std::string& name, char quote) {
  std::string text(1, quote);
  for (const char letter : name) text += letter == quote ? std::string(2, quote) : std::string(1, letter);
  return text + quote;
}

void refuse_generated_columns(WatchedFile& file) {
  for (const std::string& table : file.texts("SELECT name FROM sqlite_master WHERE type = 'table'")) {
    // Of a virtual table whose module is not known SQLite tells no columns, here and to GDAL.
    if (!file.finds("SELECT 1 FROM pragma_table_xinfo(" + quoted(table, '\'') + ") WHERE hidden IN (2, 3)")) continue;
    file.refuse("the table \"" + table +
                "\" has generated columns, whose formulas are not run for a stranger; write it anew without them "
                "(ogr2ogr, gdal_translate)");
  }
}

void refuse_views(WatchedFile& file, const std::string& condition) {
  const std::vector<std::string> views =
      file.texts("SELECT name FROM sqlite_master m WHERE type = 'view' AND " + condition);
  if (views.empty()) return;
  file.refuse("has the view \"" + views.front() +
              "\", which is not run for a stranger; write its rows as a table (ogr2ogr)");
}

/// False where it is no database after all.
bool check_descriptions(WatchedFile& file) {
  const int code = file.read_rows("SELECT * FROM sqlite_master");
  if (code == SQLITE_NOTADB) return false;
  file.require(code);
  refuse_generated_columns(file);
  refuse_views(file, kDescribes);
  // An R-tree takes one step for as many nodes as it leads to.
  if (!file.texts(std::string("SELECT name FROM pragma_table_list WHERE type = 'virtual' AND ") + kDescribes).empty()) {
    file.refuse("is damaged: a virtual table describes the others");
  }
  for (const std::string& table :
       file.texts(std::string("SELECT name FROM sqlite_master WHERE type = 'table' AND ") + kDescribes)) {
    file.read_rows("SELECT * FROM " + quoted(table, '"') + " NOT INDEXED");
  }
  return true;
}

bool has_contents(WatchedFile& file) {
  return !file.texts("SELECT name FROM sqlite_master WHERE lower(name) = 'gpkg_contents'").empty();
}

/// MBTiles may have their tiles in a view, which joins tables and no more.
void try_tile_views(WatchedFile& file) {
  const std::vector<std::string> views = file.texts(
      "SELECT name FROM sqlite_master m WHERE type = 'view' AND (lower(name) IN ('tiles', 'map', 'images')" +
      std::string(has_contents(file) ? " OR EXISTS (SELECT 1 FROM gpkg_contents c WHERE lower(c.table_name) = "
                                       "lower(m.name) AND c.data_type NOT IN ('features', 'attributes')))"
                                     : ")"));
  file.forbid_functions();
  for (const std::string& view : views) {
    if (file.read_rows("SELECT * FROM " + quoted(view, '"'), 1) == SQLITE_OK) continue;
    refuse_views(file, "name = " + quoted(view, '\''));
  }
}

/// What a dataset's name may hold a file in: "GPKG:file:table" is the file without what stands before the first colon
/// and behind the last.
std::vector<std::string> files_in_name(const std::string& dataset) {
  std::vector<std::string> names{dataset};
  const std::size_t first = dataset.find(':');
  if (first == std::string::npos) return names;
  names.push_back(dataset.substr(first + 1));
  for (std::size_t last = names.back().rfind(':'); last != std::string::npos; last = names.back().rfind(':')) {
    names.push_back(names.back().substr(0, last));
  }
  return names;
}

/// Of GDAL's file systems those that unpack a file of this machine.
bool is_packed(const std::string& name) {
  constexpr std::string_view kUnpacking[] = {"/vsizip/", "/vsitar/", "/vsigzip/",    "/vsi7z/",
                                             "/vsirar/", "/vsizip{", "/vsisubfile/", "/vsisparse/"};
  return std::any_of(std::begin(kUnpacking), std::end(kUnpacking),
                     [&](std::string_view prefix) { return name.starts_with(prefix); });
}

bool is_sqlite(const std::string& name) {
  const std::unique_ptr<VSILFILE, decltype(&VSIFCloseL)> file(VSIFOpenL(name.c_str(), "rb"), VSIFCloseL);
  std::string magic(kMagic.size(), '\0');
  return file != nullptr && VSIFReadL(magic.data(), 1, magic.size(), file.get()) == magic.size() && magic == kMagic;
}

Connection open_connection(const std::string& path, int flags) {
  sqlite3* made = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &made, flags, nullptr);
  Connection connection(made, sqlite3_close);
  if (code != SQLITE_OK) throw DataError(path + ": SQLite cannot open it: " + sqlite3_errstr(code));
  return connection;
}

/// Without a write-ahead log nothing is written beside the file, and no lock is needed.
Connection open_file(const std::string& path) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::error_code ignored;
  if (std::filesystem::exists(path + "-wal", ignored)) return open_connection(path, SQLITE_OPEN_READONLY);
  std::string uri = "file:";
  for (const char letter : std::filesystem::absolute(path).string()) {
    const auto byte = static_cast<unsigned char>(letter);
    const bool plain = byte > ' ' && byte < 0x7F && letter != '%' && letter != '?' && letter != '#';
    uri += plain ? std::string(1, letter) : std::string{'%', kDigits[byte >> 4], kDigits[byte & 15]};
  }
  return open_connection(uri + "?immutable=1", SQLITE_OPEN_READONLY | SQLITE_OPEN_URI);
}

}  // namespace

void check_sqlite_raster(const std::string& dataset) {
  for (const std::string& name : files_in_name(dataset)) {
    std::error_code error;
    const bool packed = is_packed(name);
    if (!packed && !std::filesystem::is_regular_file(name, error)) continue;
    if (!is_sqlite(name)) continue;
    if (packed) throw DataError(dataset + ": is a database inside another file; unpack it first");
    const std::uintmax_t bytes = std::filesystem::file_size(name, error);
    if (error) throw DataError(dataset + ": cannot be read: " + error.message());
    WatchedFile file(dataset, open_file(name), bytes);
    if (check_descriptions(file)) try_tile_views(file);
    return;
  }
}

void check_sqlite_vectors(const std::string& name, std::string_view bytes) {
  constexpr std::size_t kVersions = 18;  // of the file format, to write and to read
  if (!bytes.starts_with(kMagic) || bytes.size() <= kVersions + 1) return;
  // SQLite takes no file in memory that says it has a write-ahead log, which GDAL does.
  std::string copy(bytes);
  copy[kVersions] = copy[kVersions + 1] = '\1';
  Connection connection = open_connection(":memory:", SQLITE_OPEN_READWRITE);
  const auto size = static_cast<sqlite3_int64>(copy.size());
  const int code = sqlite3_deserialize(connection.get(), "main", reinterpret_cast<unsigned char*>(copy.data()), size,
                                       size, SQLITE_DESERIALIZE_READONLY);
  if (code != SQLITE_OK) throw DataError(name + ": SQLite cannot read it: " + sqlite3_errstr(code));
  WatchedFile file(name, std::move(connection), bytes.size());
  if (!check_descriptions(file) || !has_contents(file)) return;
  refuse_views(file, "EXISTS (SELECT 1 FROM gpkg_contents c WHERE lower(c.table_name) = lower(m.name))");
}

}  // namespace pilotage
