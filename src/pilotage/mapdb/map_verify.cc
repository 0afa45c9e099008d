#include "pilotage/mapdb/map_verify.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <functional>
#include <new>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include <pthread.h>

#include "pilotage/base/error.h"
#include "pilotage/mapdb/chip_codec.h"
#include "pilotage/mapdb/chunked_file.h"
#include "pilotage/mapdb/descriptor_row.h"
#include "pilotage/mapdb/geometry_blob.h"
#include "pilotage/mapdb/map_digest.h"
#include "pilotage/mapdb/map_landmarks.h"
#include "pilotage/mapdb/map_reader.h"
#include "pilotage/mapdb/map_tables.h"

namespace pilotage {
namespace {

constexpr std::size_t kMaxProblems = 100;

/// A file under examination; each check adds what it finds to the report.
struct Examination {
  std::string file;
  MapReader reader;
  Database database;
  VerifyReport& report;
  const Progress& progress;
  std::set<std::int64_t> tile_ids = {};

  void add(MapProblem::Kind kind, std::string_view table, std::optional<std::int64_t> tile_id, std::string message) {
    if (report.problems.size() >= kMaxProblems) return;
    if (!message.starts_with(file)) {
      std::string prefix = file + ": " + std::string(table);
      if (tile_id) prefix += ": tile " + std::to_string(*tile_id);
      message = prefix + ": " + message;
    }
    report.problems.push_back({kind, std::string(table), tile_id, std::move(message)});
  }
  void damaged(std::string_view table, std::optional<std::int64_t> tile_id, std::string message) {
    add(MapProblem::Kind::kDamaged, table, tile_id, std::move(message));
  }
  void wrong_digest(std::string_view table, std::optional<std::int64_t> tile_id, std::string message) {
    add(MapProblem::Kind::kDigest, table, tile_id, std::move(message));
  }
  /// Runs a check; what it throws becomes damage of `table`, so that the other checks still run, unless all that the
  /// checks may cost is spent.
  void guard(std::string_view table, std::optional<std::int64_t> tile_id, const std::function<void()>& check) {
    try {
      check();
    } catch (const DataError& error) {
      if (database.stopped()) throw;
      damaged(table, tile_id, error.what());
    }
  }
};

/// Runs `work` on a thread of its own with so large a stack, and throws what it throws.
void run_with_stack(std::size_t stack_bytes, const std::function<void()>& work) {
  struct Job {
    const std::function<void()>& work;
    std::exception_ptr thrown;
  } job{work, nullptr};
  const auto run = [](void* given) -> void* {
    auto& own = *static_cast<Job*>(given);
    try {
      own.work();
    } catch (...) {
      own.thrown = std::current_exception();
    }
    return nullptr;
  };
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, stack_bytes);
  pthread_t thread{};
  const int failed = pthread_create(&thread, &attributes, run, &job);
  pthread_attr_destroy(&attributes);
  if (failed != 0) throw std::bad_alloc();
  pthread_join(thread, nullptr);
  if (job.thrown) std::rethrow_exception(job.thrown);
}

void check_structure(Examination& e) {
  Statement integrity = e.database.prepare("PRAGMA integrity_check(20)");
  while (integrity.step()) {
    if (integrity.text(0) != "ok") e.damaged("", std::nullopt, std::string(integrity.text(0)));
  }
  Statement foreign_keys = e.database.prepare("PRAGMA foreign_key_check");
  while (foreign_keys.step()) {
    const std::string table(foreign_keys.text(0));
    e.damaged(table, std::nullopt, "a row refers to one that does not exist in " + std::string(foreign_keys.text(2)));
  }
}

/// R-trees keep single precision, rounded outwards: the stored box holds `low` … `high` and is hardly larger.
bool box_fits(double stored_low, double stored_high, double low, double high) {
  const double slack = 1e-30 + std::max(std::abs(low), std::abs(high)) * 0x1p-21;
  return stored_low <= low && stored_low >= low - slack && stored_high >= high && stored_high <= high + slack;
}

void check_index(Examination& e, std::string_view index, const std::string& select, const std::vector<MapTile>& tiles,
                 const std::function<std::array<double, 4>(const MapTile&)>& box_of) {
  Statement check = e.database.prepare("SELECT rtreecheck('main', ?)", index);
  check.bind(1, index);
  const std::string found = check.step() ? std::string(check.text(0)) : "cannot be checked";
  e.database.throw_if_stopped();  // rtreecheck hands the interruption on as its finding
  if (found != "ok") {
    e.damaged(index, std::nullopt, found);
    return;  // to walk through a tree that is none may take for ever
  }
  const std::int64_t count = e.database.query_integer("SELECT count(*) FROM " + std::string(index), index);
  if (count != static_cast<std::int64_t>(tiles.size())) {
    e.damaged(index, std::nullopt,
              "has " + std::to_string(count) + " entries for " + std::to_string(tiles.size()) + " tiles");
  }
  Statement entry = e.database.prepare(select, index);
  for (const MapTile& tile : tiles) {
    const StatementScope scope(entry);
    entry.bind(1, tile.tile_id);
    if (!entry.step()) {
      e.damaged(index, tile.tile_id, "has no entry");
      continue;
    }
    const auto box = box_of(tile);
    if (!box_fits(entry.real(0), entry.real(1), box[0], box[1]) ||
        !box_fits(entry.real(2), entry.real(3), box[2], box[3])) {
      e.damaged(index, tile.tile_id, "its entry is not where the tile is");
    }
  }
}

void check_indices(Examination& e, const std::vector<MapTile>& tiles) {
  e.guard(kGridIndex, std::nullopt, [&] {
    check_index(e, kGridIndex, "SELECT minx, maxx, miny, maxy FROM rtree_tiles_geom WHERE id = ?", tiles,
                [](const MapTile& t) -> std::array<double, 4> {
                  return {t.bounds.min_x_m, t.bounds.max_x_m, t.bounds.min_y_m, t.bounds.max_y_m};
                });
  });
  e.guard(kCenterIndex, std::nullopt, [&] {
    check_index(e, kCenterIndex,
                "SELECT min_lon, max_lon, min_lat, max_lat FROM pilotage_tile_centers WHERE tile_id = ?", tiles,
                [](const MapTile& t) -> std::array<double, 4> {
                  return {t.center.lon_deg, t.center.lon_deg, t.center.lat_deg, t.center.lat_deg};
                });
  });
}

void check_tiles(Examination& e, const std::vector<MapTile>& tiles) {
  const std::int64_t srs_id = e.database.query_integer(
      "SELECT srs_id FROM gpkg_geometry_columns WHERE table_name = 'tiles'", "gpkg_geometry_columns");
  Statement geometry = e.database.prepare("SELECT geom FROM tiles WHERE tile_id = ?", "tiles");
  std::int64_t checked = 0;
  for (const MapTile& tile : tiles) {
    report_progress(e.progress, "checking the tiles' outlines", checked++, e.report.tiles);
    e.guard("tiles", tile.tile_id, [&] {
      const MapLevel* level = e.reader.find_level(tile.level);
      if (level == nullptr) {
        e.damaged("tiles", tile.tile_id, "level " + std::to_string(tile.level) + " is not in pilotage_levels");
      } else if (tile_radius_m(tile) > level->max_tile_radius_m) {
        e.damaged("tiles", tile.tile_id, "is larger than max_tile_radius_m of its level");
      }
      const StatementScope scope(geometry);
      geometry.bind(1, tile.tile_id);
      if (!geometry.step()) throw DataError(e.file + ": tiles: tile " + std::to_string(tile.tile_id) + " is lost");
      const auto expected = polygon_blob(tile.bounds, static_cast<std::int32_t>(srs_id));
      const auto found = geometry.blob(0);
      if (!std::equal(found.begin(), found.end(), expected.begin(), expected.end())) {
        e.damaged("tiles", tile.tile_id, "its geometry is not the outline of its bounds");
      }
      static_cast<void>(e.reader.tile_values(tile.tile_id));
    });
  }
}

void check_lines(Examination& e, const std::string& table) {
  Statement statement = e.database.prepare("SELECT fid, geom FROM " + table, table);
  while (statement.step()) {
    const std::string where = e.file + ": " + table + ": line " + std::to_string(statement.integer(0));
    e.guard(table, std::nullopt, [&] { static_cast<void>(parse_line_blob(statement.blob(1), where)); });
  }
}

void check_owner(Examination& e, std::string_view table, std::int64_t tile_id, int level) {
  if (!e.tile_ids.contains(tile_id)) e.damaged(table, tile_id, "there is no such tile");
  if (e.reader.find_level(level) == nullptr) {
    e.damaged(table, tile_id, "level " + std::to_string(level) + " is not in pilotage_levels");
  }
}

void check_descriptors(Examination& e) {
  constexpr std::string_view kTable = "pilotage_descriptors";
  Statement statement = e.database.prepare(
      "SELECT " + std::string(kDescriptorColumns) + " FROM pilotage_descriptors ORDER BY id", kTable);
  while (statement.step()) {
    report_progress(e.progress, "checking tiles", ++e.report.descriptor_rows, e.report.tiles);
    e.guard(kTable, std::nullopt, [&] {
      const std::int64_t tile_id = statement.integer(0);
      e.guard(kTable, tile_id, [&] {
        const DescriptorRow row = read_descriptor_row(statement, e.file);
        e.report.descriptors += row.count;
        check_owner(e, kTable, row.tile_id, row.level);
        e.guard(kTable, tile_id, [&] { check_descriptor_length(row, e.reader.info(), e.file); });
        const Digest digest = descriptor_digest(row);
        if (!std::equal(digest.begin(), digest.end(), row.digest.begin(), row.digest.end())) {
          e.wrong_digest(kTable, tile_id, "level " + std::to_string(row.level) + ": the digest does not match");
        }
        static_cast<void>(decode_descriptors(row, e.reader.features().pattern, e.file));
      });
    });
  }
}

void check_chips(Examination& e) {
  constexpr std::string_view kTable = "pilotage_chips";
  Statement statement =
      e.database.prepare("SELECT " + std::string(kChipColumns) + " FROM pilotage_chips ORDER BY id", kTable);
  while (statement.step()) {
    report_progress(e.progress, "checking chips", ++e.report.chips, e.report.tiles);
    e.guard(kTable, std::nullopt, [&] {
      const std::int64_t tile_id = statement.integer(0);
      e.guard(kTable, tile_id, [&] {
        const MapChip chip = read_chip_row(statement, e.file);
        check_owner(e, kTable, chip.tile_id, chip.level);
        const Digest digest = chip_digest(chip);
        const auto stored = statement.blob(8);
        if (!std::equal(digest.begin(), digest.end(), stored.begin(), stored.end())) {
          e.wrong_digest(kTable, tile_id, "level " + std::to_string(chip.level) + ": the digest does not match");
        }
        if (chip.encoding == kGrayEncoding || chip.encoding == kChipEncoding) {
          static_cast<void>(decode_chip(chip, e.file));
        }
      });
    });
  }
}

void check_landmarks(Examination& e) {
  const std::shared_ptr<const MapLandmarks> landmarks = e.reader.landmarks();
  e.report.landmarks = std::ssize(landmarks->landmarks);
  Statement geometry = e.database.prepare("SELECT geom FROM landmarks ORDER BY fid", "landmarks");
  for (const MapLandmark& landmark : landmarks->landmarks) {
    if (!geometry.step()) break;
    const std::vector<std::uint8_t> expected = point_blob(landmark.place);
    const auto found = geometry.blob(0);
    if (std::equal(found.begin(), found.end(), expected.begin(), expected.end())) continue;
    e.damaged("landmarks", std::nullopt,
              "landmark " + std::to_string(landmark.id) + ": its geometry is not the point of its lon_deg and lat_deg");
  }
}

void check_content(Examination& e) {
  e.report.content_digest = to_hex(content_digest(e.database));
  const std::string stored = e.reader.info().find("content_digest").value_or("");
  if (stored.empty()) {
    e.damaged("map_info", std::nullopt, "has no content_digest");
  } else if (stored != e.report.content_digest) {
    e.wrong_digest("map_info", std::nullopt,
                   "content_digest is " + stored + ", but the rows of the file give " + e.report.content_digest);
  }
}

/// SQLite's check of its structure calls itself once for each page of a chain, which a forged index may be as long as
/// the file: so much stack for each. Pages that are not touched take no memory.
constexpr std::size_t kStackBytesPerPage = 1024;
constexpr std::size_t kMinStackBytes = std::size_t{8} << 20;

/// From what trusts the file least to what walks its structure. Where not even all rows can be read within what a file
/// of its size may cost, nothing else is tried.
void examine(Examination& e) {
  report_progress(e.progress, "digest of all rows", 0, 0);
  check_content(e);
  report_progress(e.progress, "checking the file", 0, 0);
  const auto pages = static_cast<std::size_t>(e.database.query_integer("PRAGMA page_count"));
  e.guard("", std::nullopt,
          [&] { run_with_stack(kMinStackBytes + kStackBytesPerPage * pages, [&] { check_structure(e); }); });
  std::vector<MapTile> tiles;
  e.guard("tiles", std::nullopt, [&] { tiles = e.reader.tiles(); });
  e.report.tiles = static_cast<std::int64_t>(tiles.size());
  for (const MapTile& tile : tiles) e.tile_ids.insert(tile.tile_id);
  e.guard("tiles", std::nullopt, [&] { check_tiles(e, tiles); });
  check_indices(e, tiles);
  for (const char* table : {"route", "legs"}) {
    e.guard(table, std::nullopt, [&] { check_lines(e, table); });
  }
  e.guard("pilotage_descriptors", std::nullopt, [&] { check_descriptors(e); });
  if (e.reader.has_landmarks()) e.guard("landmarks", std::nullopt, [&] { check_landmarks(e); });
  if (e.reader.has_chips()) e.guard("pilotage_chips", std::nullopt, [&] { check_chips(e); });
}

/// What SQLite would roll into the file when another program opens it: the file is then no longer what was checked.
void check_journals(const std::string& file, VerifyReport& report) {
  for (const char* suffix : {"-journal", "-wal"}) {
    std::error_code error;
    const std::uintmax_t bytes = std::filesystem::file_size(file + suffix, error);
    if (error || bytes == 0) continue;
    report.problems.push_back({MapProblem::Kind::kDamaged, "", std::nullopt,
                               file + suffix +
                                   ": lies beside the map: a program did not finish a change, and the next "
                                   "that opens the map for writing changes it"});
  }
}

/// Every byte of the file against the list of its chunks, also those that no table uses.
void check_chunks(const ChunkedFile& file, VerifyReport& report, const Progress& progress) {
  const std::uint64_t count = chunk_count(file.size());
  for (std::uint64_t index = 0; index < count && report.problems.size() < kMaxProblems; ++index) {
    report_progress(progress, "checking chunks of the file", static_cast<std::int64_t>(index),
                    static_cast<std::int64_t>(count));
    try {
      static_cast<void>(file.read_chunk(index));
    } catch (const IntegrityError& wrong) {
      report.problems.push_back({MapProblem::Kind::kDigest, "", std::nullopt, wrong.what()});
    }
  }
}

/// `open_reader` and `open_database` give two connections to the same bytes.
VerifyReport verify(const std::string& file, std::uintmax_t bytes, const std::function<MapReader()>& open_reader,
                    const std::function<Database()>& open_database, const Progress& progress) {
  VerifyReport report;
  report.bytes = static_cast<std::int64_t>(bytes);
  check_journals(file, report);
  try {
    Examination examination{file, open_reader(), open_database(), report, progress};
    examination.database.watch([&progress] { report_progress(progress, "checking the file", 0, 0); });
    examination.database.renew_cost();
    examine(examination);
  } catch (const DataError& damage) {  // all that checks may cost is spent, or the file cannot even be opened as a map
    report.problems.push_back({MapProblem::Kind::kDamaged, "", std::nullopt, damage.what()});
  }
  return report;
}

}  // namespace

VerifyReport verify_map(const std::filesystem::path& path, const Progress& progress) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  if (error) throw DataError(path.string() + ": cannot be read: " + error.message());
  return verify(
      path.string(), bytes, [&] { return MapReader::open_unverified(path); },
      [&] { return Database::open_untrusted(path, kMaxMapBlobBytes); }, progress);
}

VerifyReport verify_map(const SignedMap& map, const Progress& progress) {
  VerifyReport report;
  report.bytes = static_cast<std::int64_t>(map.size());
  if (map.chunks()) check_chunks(*map.chunks(), report, progress);
  if (!report.ok()) return report;
  return verify(
      map.name(), map.size(), [&] { return MapReader::open(map); }, [&] { return map.open_database(); }, progress);
}

bool VerifyReport::any_wrong_digest() const {
  return std::any_of(problems.begin(), problems.end(),
                     [](const MapProblem& problem) { return problem.kind == MapProblem::Kind::kDigest; });
}

void require_intact(const VerifyReport& report) {
  for (const MapProblem& problem : report.problems) {
    if (problem.kind == MapProblem::Kind::kDigest) throw IntegrityError(problem.message);
  }
  if (!report.ok()) throw DataError(report.problems.front().message);
}

}  // namespace pilotage
