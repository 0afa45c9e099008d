#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace pilotage {
class ChunkedFile;  // their symbols are not for users of the library
class ChunkVfs;
struct ReadingCost;
}  // namespace pilotage

#pragma GCC visibility push(default)

struct sqlite3;
struct sqlite3_stmt;

// SQLite as objects that close themselves, with errors as DataError. Only sqlite.cc, chunk_vfs.cc and
// raster/gdal_sqlite.cc include SQLite.

namespace pilotage {

/// A prepared statement. Values are read by column index from 0 after step() returned true and live until the next
/// step() or reset(). Reading is strict: a value of another type than asked for throws. Every failure throws DataError
/// that begins with the database's name and what the statement reads. So does a statement of an untrusted file that
/// gives more rows, or more bytes of text and blobs, than the file has room for: its pages are read in circles.
class Statement {
 public:
  /// Parameters are numbered from 1. A NaN is bound as NULL.
  Statement& bind(int index, std::int64_t value);
  Statement& bind(int index, double value);
  Statement& bind(int index, std::string_view value);
  Statement& bind(int index, std::span<const std::uint8_t> value);
  Statement& bind_null(int index);

  bool step();   ///< True when there is a row.
  void reset();  ///< Makes it ready to run again; forgets the bound values.
  void run();    ///< step() to the end, reset().

  enum class Type { kInteger, kReal, kText, kBlob, kNull };
  int column_count() const;
  std::string column_name(int column) const;
  Type type(int column) const;
  bool is_null(int column) const { return type(column) == Type::kNull; }
  std::int64_t integer(int column) const;
  /// The value as int; throws when it is outside [min, max].
  int integer(int column, int min, int max) const;
  double real(int column) const;  ///< Integers are numbers too.
  std::string_view text(int column) const;
  std::span<const std::uint8_t> blob(int column) const;

 private:
  friend class Database;
  Statement(sqlite3* database, std::string name, std::string_view sql, ReadingCost* cost, int min_row_bytes);
  void check(int code) const;
  void count_bytes(std::size_t bytes) const;
  [[noreturn]] void throw_wrong_type(int column, const char* expected) const;

  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  std::string name_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
  ReadingCost* cost_ = nullptr;  // of the connection, when its file is not trusted
  int min_row_bytes_ = 1;
  std::int64_t rows_ = 0;           // since reset()
  mutable std::int64_t bytes_ = 0;  // of text and blobs that were read since reset()
};

/// Resets a statement when the scope ends, however it ends, so that a thrown error leaves it usable.
class StatementScope {
 public:
  explicit StatementScope(Statement& statement) : statement_(statement) {}
  ~StatementScope() { statement_.reset(); }
  StatementScope(const StatementScope&) = delete;
  StatementScope& operator=(const StatementScope&) = delete;

 private:
  Statement& statement_;
};

/// A connection; used by one thread at a time.
class Database {
 public:
  /// Creates a new database at `path`, called `name` in messages, for bulk writing: no journal, so that a failure
  /// leaves it useless and it must be thrown away.
  static Database create(const std::filesystem::path& path, std::string name);

  /// Opens an existing file that may hold anything: read-only and immutable (nothing is locked, no journal is looked
  /// for), schema not trusted, cell sizes checked, defensive, no views and triggers, lengths limited to
  /// `max_value_bytes` and to the file's own size. What all statements together may cost is limited (renew_cost).
  static Database open_untrusted(const std::filesystem::path& path, int max_value_bytes);

  /// The same of a database that is in memory, called `name` in messages; the bytes are neither copied nor written.
  static Database open_untrusted(std::string name, std::shared_ptr<const std::string> bytes, int max_value_bytes);

  /// The same of a file that is checked chunk by chunk; a statement that needs a chunk which is not what was signed
  /// throws IntegrityError.
  static Database open_untrusted(std::string name, std::shared_ptr<const ChunkedFile> file, int max_value_bytes);

  Database(Database&&) noexcept;
  Database& operator=(Database&& other) noexcept;  ///< Exchanges both: `other` closes the connection when it ends.
  ~Database();

  /// Calls `checkpoint` every few hundred microseconds of the statements that run; what it throws ends the statement
  /// and comes out of it. It must not use this connection. Of an untrusted file only; an empty one asks no more.
  void watch(std::function<void()> checkpoint);

  /// What the statements of an untrusted file may cost, in steps of SQLite's virtual machine and pages of the file, is
  /// kMinReadingCost and kReadingCostPerByte for each of its bytes; to check a sound map whole takes 0.02 to 0.3 a
  /// byte. Then they throw DataError. This counts anew from here on; before, in opening, it is kMaxOpeningCost at most.
  void renew_cost();
  static constexpr std::int64_t kMinReadingCost = 200'000;
  static constexpr std::int64_t kReadingCostPerByte = 2;
  static constexpr std::int64_t kMaxOpeningCost = 2'000'000;

  /// Throws what ended a statement where SQLite did not hand that on: the checkpoint's exception, or that the cost is
  /// spent. `stopped`: whether it would.
  void throw_if_stopped() const;
  bool stopped() const;

  /// Ends the connection; every statement must be gone. Throws DataError.
  void close();

  const std::string& name() const { return name_; }
  /// `subject` (a table) is named in messages. `min_row_bytes`: what a row of the result takes in the file at least.
  Statement prepare(std::string_view sql, std::string_view subject = "", int min_row_bytes = kMinRowBytes) const;
  /// A row of the smallest kind: pointer, length, number and header of its cell, and two small values.
  static constexpr int kMinRowBytes = 6;
  void execute(const std::string& sql) const;  ///< One or several statements without result.
  /// The first value of the first row; throws DataError when there is none.
  std::int64_t query_integer(std::string_view sql, std::string_view subject = "") const;

 private:
  Database(const std::filesystem::path& path, std::string name, const std::string& file, int flags,
           std::unique_ptr<ChunkVfs> vfs = nullptr);

  void distrust(std::uintmax_t file_bytes, int max_value_bytes);

  struct Close {
    void operator()(sqlite3* database) const;
  };
  std::string name_;
  std::shared_ptr<const std::string> bytes_;  // of a database in memory
  std::unique_ptr<ChunkVfs> vfs_;             // of a file that is checked chunk by chunk
  std::unique_ptr<ReadingCost> cost_;         // of an untrusted file; SQLite and statements keep pointers to it
  std::unique_ptr<sqlite3, Close> database_;
};

}  // namespace pilotage

#pragma GCC visibility pop
