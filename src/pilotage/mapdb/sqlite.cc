#include "pilotage/mapdb/sqlite.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <new>
#include <string_view>
#include <system_error>
#include <utility>

#include <sqlite3.h>

#include "pilotage/base/error.h"
#include "pilotage/mapdb/chunk_vfs.h"

namespace pilotage {

/// What reading an untrusted file has cost: SQLite counts, and asks every few steps whether to go on.
struct ReadingCost {
  std::string name;  // of the database, as messages begin
  sqlite3* database = nullptr;
  std::int64_t file_bytes = 0;
  std::int64_t limit = 0;  // steps and pages
  std::int64_t steps = 0;
  std::int64_t first_page = 0;   // how many had been read when the counting began
  std::int64_t page_weight = 1;  // a page of 64 KiB takes as long as sixteen of the usual size
  std::function<void()> checkpoint;
  std::exception_ptr failure;  // what the checkpoint threw

  /// Pages that SQLite asked for so far, from its cache or from the file: a step may read one, or a value of 64 MiB.
  std::int64_t pages_read() const {
    std::int64_t pages = 0;
    for (const int counter : {SQLITE_DBSTATUS_CACHE_HIT, SQLITE_DBSTATUS_CACHE_MISS}) {
      int count = 0;
      int unused = 0;
      sqlite3_db_status(database, counter, &count, &unused, 0);
      pages += static_cast<unsigned>(count);
    }
    return pages;
  }

  bool spent() const {
    constexpr std::int64_t kCounterEnd = std::int64_t{1} << 31;  // SQLite's counters go from there to 0
    std::int64_t pages = pages_read() - first_page;
    while (pages < 0) pages += kCounterEnd;
    return steps + page_weight * pages > limit;
  }
  bool stopped() const { return failure != nullptr || spent(); }

  void renew() {
    steps = 0;
    first_page = pages_read();
    failure = nullptr;
  }

  void throw_if_stopped() const {
    if (failure) std::rethrow_exception(failure);
    if (!spent()) return;
    throw DataError(name + ": to read it takes more steps than a sound map of its size can need (" +
                    std::to_string(limit) + " for " + std::to_string(file_bytes) +
                    " bytes): its pages or indices lead in circles");
  }
};

namespace {

// Every value stands in the file once; columns may be read twice.
constexpr std::int64_t kReadsPerByte = 4;
constexpr int kStepsBetweenCalls = 1000;

/// As sqlite3_set_authorizer wants it. When SQLite loads a schema it reads the statistics of ANALYZE by itself, before
/// anybody can look at how their table is declared; no map has any.
int refuse_statistics(void* /*unused*/, int action, const char* table, const char* /*column*/, const char* /*database*/,
                      const char* /*trigger*/) {
  const bool statistics =
      action == SQLITE_READ && table != nullptr && std::string_view(table).starts_with("sqlite_stat");
  return statistics ? SQLITE_DENY : SQLITE_OK;
}

/// As sqlite3_progress_handler wants it: not 0 ends the statement.
int count_steps(void* reading_cost) {
  auto& cost = *static_cast<ReadingCost*>(reading_cost);
  cost.steps += kStepsBetweenCalls;
  if (cost.checkpoint && !cost.failure) {
    try {
      cost.checkpoint();
    } catch (...) {  // it must not pass through SQLite; whoever runs the statement throws it on
      cost.failure = std::current_exception();
    }
  }
  return cost.stopped() ? 1 : 0;
}

/// The path as SQLite's URI file name; everything but letters, digits and a few marks is escaped.
std::string uri_of(const std::filesystem::path& path, const char* query) {
  static constexpr char kHex[] = "0123456789ABCDEF";
  std::string uri = "file://";
  for (const char c : std::filesystem::absolute(path).string()) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '/' ||
                       c == '-' || c == '_' || c == '.' || c == '~';
    if (plain) {
      uri += c;
    } else {
      uri += {'%', kHex[byte >> 4], kHex[byte & 15]};
    }
  }
  return uri + query;
}

/// What failed, as an exception: a chunk that is not what was signed, a cost that is spent, or what SQLite says.
[[noreturn]] void throw_failure(const std::string& name, int code, sqlite3* database, const ReadingCost* cost) {
  if (code == SQLITE_NOMEM) throw std::bad_alloc();
  const std::string message = name + ": " + sqlite3_errmsg(database);
  rethrow_chunk_failure(database);
  if (cost != nullptr) cost->throw_if_stopped();
  throw DataError(message);
}

}  // namespace

void Statement::Finalize::operator()(sqlite3_stmt* statement) const {
  sqlite3_finalize(statement);
}

Statement::Statement(sqlite3* database, std::string name, std::string_view sql, ReadingCost* cost, int min_row_bytes)
    : name_(std::move(name)), cost_(cost), min_row_bytes_(min_row_bytes) {
  sqlite3_stmt* statement = nullptr;
  const int code = sqlite3_prepare_v3(database, sql.data(), static_cast<int>(sql.size()), SQLITE_PREPARE_PERSISTENT,
                                      &statement, nullptr);
  statement_.reset(statement);
  if (code != SQLITE_OK || statement == nullptr) throw_failure(name_, code, database, cost_);
}

void Statement::check(int code) const {
  if (code != SQLITE_OK) throw_failure(name_, code, sqlite3_db_handle(statement_.get()), cost_);
}

void Statement::count_bytes(std::size_t bytes) const {
  if (cost_ == nullptr) return;
  bytes_ += static_cast<std::int64_t>(bytes);
  if (bytes_ <= kReadsPerByte * cost_->file_bytes) return;
  throw DataError(name_ + ": gives more text and blobs than a file of " + std::to_string(cost_->file_bytes) +
                  " bytes can hold: its pages are read in circles");
}

void Statement::throw_wrong_type(int column, const char* expected) const {
  static constexpr const char* kNames[] = {"an integer", "a number", "text", "a blob", "NULL"};
  throw DataError(name_ + ": column " + column_name(column) + " holds " + kNames[static_cast<int>(type(column))] +
                  ", expected " + expected);
}

Statement& Statement::bind(int index, std::int64_t value) {
  check(sqlite3_bind_int64(statement_.get(), index, value));
  return *this;
}

Statement& Statement::bind(int index, double value) {
  if (std::isnan(value)) return bind_null(index);
  check(sqlite3_bind_double(statement_.get(), index, value));
  return *this;
}

// Values are copied: a bound value may be a temporary, and binding is never the slow part.
Statement& Statement::bind(int index, std::string_view value) {
  const char* data = value.empty() ? "" : value.data();
  check(sqlite3_bind_text64(statement_.get(), index, data, value.size(), SQLITE_TRANSIENT, SQLITE_UTF8));
  return *this;
}

Statement& Statement::bind(int index, std::span<const std::uint8_t> value) {
  if (value.empty()) {
    check(sqlite3_bind_zeroblob(statement_.get(), index, 0));
  } else {
    check(sqlite3_bind_blob64(statement_.get(), index, value.data(), value.size(), SQLITE_TRANSIENT));
  }
  return *this;
}

Statement& Statement::bind_null(int index) {
  check(sqlite3_bind_null(statement_.get(), index));
  return *this;
}

bool Statement::step() {
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_DONE) return false;
  if (code != SQLITE_ROW) throw_failure(name_, code, sqlite3_db_handle(statement_.get()), cost_);
  if (cost_ == nullptr || ++rows_ <= cost_->file_bytes / min_row_bytes_) return true;
  throw DataError(name_ + ": gives more rows than a file of " + std::to_string(cost_->file_bytes) +
                  " bytes can hold: its pages are read in circles");
}

void Statement::reset() {
  sqlite3_reset(statement_.get());  // its result repeats that of step(), which was checked
  sqlite3_clear_bindings(statement_.get());
  rows_ = 0;
  bytes_ = 0;
}

void Statement::run() {
  const StatementScope scope(*this);
  while (step()) {
  }
}

int Statement::column_count() const {
  return sqlite3_column_count(statement_.get());
}

std::string Statement::column_name(int column) const {
  const char* name = sqlite3_column_name(statement_.get(), column);
  return name == nullptr ? std::string() : std::string(name);
}

Statement::Type Statement::type(int column) const {
  switch (sqlite3_column_type(statement_.get(), column)) {
    case SQLITE_INTEGER:
      return Type::kInteger;
    case SQLITE_FLOAT:
      return Type::kReal;
    case SQLITE_TEXT:
      return Type::kText;
    case SQLITE_BLOB:
      return Type::kBlob;
    default:
      return Type::kNull;
  }
}

std::int64_t Statement::integer(int column) const {
  if (type(column) != Type::kInteger) throw_wrong_type(column, "an integer");
  return sqlite3_column_int64(statement_.get(), column);
}

int Statement::integer(int column, int min, int max) const {
  const std::int64_t value = integer(column);
  if (value < min || value > max) {
    throw DataError(name_ + ": column " + column_name(column) + " holds " + std::to_string(value) + ", outside [" +
                    std::to_string(min) + ", " + std::to_string(max) + "]");
  }
  return static_cast<int>(value);
}

double Statement::real(int column) const {
  const Type found = type(column);
  if (found != Type::kReal && found != Type::kInteger) throw_wrong_type(column, "a number");
  return sqlite3_column_double(statement_.get(), column);
}

std::string_view Statement::text(int column) const {
  if (type(column) != Type::kText) throw_wrong_type(column, "text");
  const void* data = sqlite3_column_text(statement_.get(), column);
  if (data == nullptr) throw std::bad_alloc();
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column));
  count_bytes(size);
  return {static_cast<const char*>(data), size};
}

std::span<const std::uint8_t> Statement::blob(int column) const {
  if (type(column) != Type::kBlob) throw_wrong_type(column, "a blob");
  const void* data = sqlite3_column_blob(statement_.get(), column);
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column));
  if (data == nullptr && size > 0) throw std::bad_alloc();
  count_bytes(size);
  return {static_cast<const std::uint8_t*>(data), size};
}

void Database::Close::operator()(sqlite3* database) const {
  sqlite3_close_v2(database);
}

Database::Database(const std::filesystem::path& path, std::string name, const std::string& file, int flags,
                   std::unique_ptr<ChunkVfs> vfs)
    : name_(std::move(name)), vfs_(std::move(vfs)) {
  sqlite3* database = nullptr;
  const int code =
      sqlite3_open_v2(file.c_str(), &database, flags | SQLITE_OPEN_NOMUTEX, vfs_ ? vfs_->name().c_str() : nullptr);
  database_.reset(database);
  if (code == SQLITE_OK) return;
  std::error_code ignored;
  const bool missing = (flags & SQLITE_OPEN_READONLY) != 0 && !std::filesystem::exists(path, ignored);
  throw DataError(
      name_ + (missing ? std::string(": does not exist") : std::string(": cannot be opened: ") + sqlite3_errstr(code)));
}

Database::Database(Database&&) noexcept = default;

// Member by member would free the bytes of a connection that is still open.
Database& Database::operator=(Database&& other) noexcept {
  std::swap(name_, other.name_);
  std::swap(bytes_, other.bytes_);
  std::swap(vfs_, other.vfs_);
  std::swap(cost_, other.cost_);
  std::swap(database_, other.database_);
  return *this;
}

Database::~Database() = default;

Database Database::create(const std::filesystem::path& path, std::string name) {
  Database database(path, std::move(name), uri_of(path, "?mode=rwc"),
                    SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_URI);
  database.execute(
      "PRAGMA page_size=4096; PRAGMA encoding='UTF-8'; PRAGMA auto_vacuum=NONE; PRAGMA journal_mode=OFF;"
      "PRAGMA synchronous=OFF; PRAGMA locking_mode=EXCLUSIVE; PRAGMA temp_store=MEMORY; PRAGMA foreign_keys=OFF;");
  return database;
}

Database Database::open_untrusted(const std::filesystem::path& path, int max_value_bytes) {
  std::error_code error;
  const std::uintmax_t file_bytes =
      std::filesystem::file_size(path, error);  // also tells pipes, which would be waited for
  if (error) throw DataError(path.string() + ": cannot be read: " + error.message());
  Database result(path, path.string(), uri_of(path, "?mode=ro&immutable=1"), SQLITE_OPEN_READONLY | SQLITE_OPEN_URI);
  result.distrust(file_bytes, max_value_bytes);
  return result;
}

Database Database::open_untrusted(std::string name, std::shared_ptr<const std::string> bytes, int max_value_bytes) {
  Database result({}, std::move(name), ":memory:", SQLITE_OPEN_READWRITE);
  result.bytes_ = std::move(bytes);
  const auto size = static_cast<sqlite3_int64>(result.bytes_->size());
  // SQLite takes a pointer to what it may write to; told that it is read-only, it does not.
  auto* data = reinterpret_cast<unsigned char*>(const_cast<char*>(result.bytes_->data()));
  const int code = sqlite3_deserialize(result.database_.get(), "main", data, size, size, SQLITE_DESERIALIZE_READONLY);
  if (code != SQLITE_OK) throw DataError(result.name_ + ": cannot be opened: " + sqlite3_errstr(code));
  result.distrust(result.bytes_->size(), max_value_bytes);
  return result;
}

Database Database::open_untrusted(std::string name, std::shared_ptr<const ChunkedFile> file, int max_value_bytes) {
  const std::uintmax_t file_bytes = file->size();
  // The file system holds one file, whatever its name.
  Database result({}, std::move(name), "map", SQLITE_OPEN_READONLY, std::make_unique<ChunkVfs>(std::move(file)));
  result.distrust(file_bytes, max_value_bytes);
  return result;
}

void Database::watch(std::function<void()> checkpoint) {
  cost_->checkpoint = std::move(checkpoint);
  cost_->failure = nullptr;
}

void Database::renew_cost() {
  cost_->limit = kMinReadingCost + kReadingCostPerByte * cost_->file_bytes;
  cost_->renew();
}

void Database::throw_if_stopped() const {
  if (cost_) cost_->throw_if_stopped();
}

bool Database::stopped() const {
  return cost_ && cost_->stopped();
}

void Database::distrust(std::uintmax_t file_bytes, int max_value_bytes) {
  // First of all: the first statement reads the schema, which may lead in circles like any table.
  const auto bytes = static_cast<std::int64_t>(std::min<std::uintmax_t>(file_bytes, std::int64_t{1} << 50));
  cost_ = std::make_unique<ReadingCost>(
      ReadingCost{.name = name_,
                  .database = database_.get(),
                  .file_bytes = bytes,
                  .limit = std::min(kMaxOpeningCost, kMinReadingCost + kReadingCostPerByte * bytes),
                  .checkpoint = {},
                  .failure = {}});
  cost_->renew();
  sqlite3_progress_handler(database_.get(), kStepsBetweenCalls, count_steps, cost_.get());
  sqlite3_set_authorizer(database_.get(), refuse_statistics, nullptr);
  sqlite3* database = database_.get();
  for (const auto& [option, value] : {std::pair{SQLITE_DBCONFIG_DEFENSIVE, 1},
                                      {SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0},
                                      {SQLITE_DBCONFIG_ENABLE_TRIGGER, 0},
                                      {SQLITE_DBCONFIG_ENABLE_VIEW, 0},
                                      {SQLITE_DBCONFIG_ENABLE_LOAD_EXTENSION, 0},
                                      // a quoted name that is no column is an error, not a string
                                      {SQLITE_DBCONFIG_DQS_DML, 0},
                                      {SQLITE_DBCONFIG_DQS_DDL, 0}}) {
    if (sqlite3_db_config(database, option, value, nullptr) != SQLITE_OK) {
      throw DataError(name_ + ": this SQLite library lacks the protection " + std::to_string(option));
    }
  }
  constexpr std::int64_t kMinValueBytes = 65536;  // what SQLite makes itself, of files that are smaller
  const std::int64_t longest = std::min<std::int64_t>(max_value_bytes, std::max(kMinValueBytes, bytes));
  sqlite3_limit(database, SQLITE_LIMIT_LENGTH, static_cast<int>(longest));
  sqlite3_limit(database, SQLITE_LIMIT_SQL_LENGTH, 100000);
  sqlite3_limit(database, SQLITE_LIMIT_EXPR_DEPTH, 50);
  sqlite3_limit(database, SQLITE_LIMIT_ATTACHED, 0);
  sqlite3_limit(database, SQLITE_LIMIT_WORKER_THREADS, 0);
  execute("PRAGMA cell_size_check=ON; PRAGMA temp_store=MEMORY; PRAGMA mmap_size=0;");
  constexpr std::int64_t kUsualPageBytes = 4096;
  cost_->page_weight = std::max<std::int64_t>(1, query_integer("PRAGMA page_size") / kUsualPageBytes);
}

void Database::close() {
  if (sqlite3_close(database_.get()) != SQLITE_OK) throw DataError(name_ + ": " + sqlite3_errmsg(database_.get()));
  static_cast<void>(database_.release());
}

Statement Database::prepare(std::string_view sql, std::string_view subject, int min_row_bytes) const {
  std::string name = name_;
  if (!subject.empty()) name.append(": ").append(subject);
  return Statement(database_.get(), std::move(name), sql, cost_.get(), min_row_bytes);
}

void Database::execute(const std::string& sql) const {
  const int code = sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) throw_failure(name_, code, database_.get(), cost_.get());
}

std::int64_t Database::query_integer(std::string_view sql, std::string_view subject) const {
  Statement statement = prepare(sql, subject);
  if (!statement.step()) throw DataError(statement.name_ + ": has no row");
  return statement.integer(0);
}

}  // namespace pilotage
