#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

// The only file pair of the onboard half that includes SQLite: objects that close themselves, errors as DataError.

namespace pilotage {

/// A prepared statement. Values are read by column index from 0 after step() returned true and live until the next
/// step() or reset(). Every failure throws DataError beginning with the database's name.
class Statement {
 public:
  /// Parameters are numbered from 1.
  Statement& bind(int index, std::int64_t value);
  Statement& bind(int index, double value);
  Statement& bind(int index, std::string_view value);
  Statement& bind(int index, std::span<const std::uint8_t> value);
  Statement& bind_null(int index);

  bool step();   ///< True when there is a row.
  void reset();  ///< Makes it ready to run again; forgets the bound values.
  void run();    ///< step() to the end, reset().

  int column_count() const;
  std::string column_name(int column) const;
  int type(int column) const;  ///< SQLITE_INTEGER 1, SQLITE_FLOAT 2, SQLITE_TEXT 3, SQLITE_BLOB 4, SQLITE_NULL 5.
  bool is_null(int column) const;
  std::int64_t integer(int column) const;
  double real(int column) const;
  std::string_view text(int column) const;
  std::span<const std::uint8_t> blob(int column) const;

 private:
  friend class Database;
  Statement(sqlite3* database, std::string name, std::string_view sql);
  void check(int code) const;

  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  std::string name_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

/// A connection; used by one thread at a time.
class Database {
 public:
  /// Creates a new database at `path`, called `name` in messages, for bulk writing: no journal, so that a failure
  /// leaves it useless and it must be thrown away.
  static Database create(const std::filesystem::path& path, std::string name);

  /// Opens an existing file that may hold anything: read-only and immutable (nothing is locked, no journal is looked
  /// for), schema not trusted, cell sizes checked, defensive, lengths limited.
  static Database open_untrusted(const std::filesystem::path& path, std::string name);

  const std::string& name() const { return name_; }
  Statement prepare(std::string_view sql) const;
  void execute(const std::string& sql) const;  ///< One or several statements without result.
  std::int64_t query_integer(
      std::string_view sql) const;  ///< The first value of the first row; throws when there is none.

 private:
  Database(const std::filesystem::path& path, std::string name, int flags);

  struct Close {
    void operator()(sqlite3* database) const;
  };
  std::string name_;
  std::unique_ptr<sqlite3, Close> database_;
};

}  // namespace pilotage
