// Reading the onboard map: synthetic maps of side × side tiles, 400 descriptors each, one a hundred times larger than
// the other. $PILOTAGE_BENCH_MAP_SIDE is the side of the larger one: 200 (default) makes 0.8 GB, 720 makes 10 GB.
// TMPDIR says where they are made; they are removed afterwards.

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <string>

#include "testing/key_pair.h"
#include "testing/temporary_folder.h"
#include <GeographicLib/TransverseMercator.hpp>
#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include "pilotage/base/random.h"
#include "pilotage/geo/enu_from_grid.h"
#include "pilotage/mapdb/map_reader.h"
#include "pilotage/mapdb/map_signing.h"
#include "pilotage/mapdb/map_verify.h"
#include "pilotage/mapdb/map_writer.h"

namespace pilotage {
namespace {

constexpr int kTilePx = 128;
constexpr int kFeatures = 400;

std::optional<GeodeticPoint> from_utm(const Eigen::Vector2d& p) {
  double lat = 0, lon = 0;
  GeographicLib::TransverseMercator::UTM().Reverse(117, p.x() - 500000, p.y() - 10000000, lat, lon);
  return GeodeticPoint{lon, lat};
}

TileDescriptors random_descriptors(const MapTile& tile, const PixelWindow& window, Random& random) {
  TileDescriptors result;
  result.tile_id = tile.tile_id;
  result.window = window;
  for (int i = 0; i < kFeatures; ++i) {
    result.features.features.push_back(
        {static_cast<float>(random.uniform(0, kTilePx)), static_cast<float>(random.uniform(0, kTilePx)), 0, 1});
    result.ground_height_m.push_back(static_cast<float>(random.uniform(0, 50)));
  }
  for (int i = 0; i < kFeatures * result.features.descriptor_bytes / 8; ++i) {
    for (std::uint64_t bits = random.next(), b = 0; b < 8; ++b, bits >>= 8) {
      result.features.descriptors.push_back(static_cast<std::uint8_t>(bits));
    }
  }
  return result;
}

int large_side() {
  const char* named = std::getenv("PILOTAGE_BENCH_MAP_SIDE");
  return named == nullptr ? 200 : std::stoi(named);
}

std::filesystem::path write_map(const std::filesystem::path& path, int side) {
  Random random(seed_from_name("mapdb_bench"));
  MapHeader header;
  header.crs = {"WGS 84 / UTM zone 50S", "PROJCS[\"WGS 84 / UTM zone 50S\"]", ""};
  MapLevel level;
  level.gsd_m = 0.6;
  level.matrix = {0, GeoTransform::north_up(380000, 6450000, 0.6), side * kTilePx, side * kTilePx, kTilePx, kTilePx};
  header.levels = {level};
  MapWriter writer(path, header, false);
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const PixelWindow window = level.matrix.tile_window(column, row);
      MapTile tile;
      tile.tile_id = static_cast<std::int64_t>(row) * side + column;
      tile.column = column;
      tile.row = row;
      const auto corner = [&](int x, int y) {
        return level.matrix.map_from_pixel.map_from_pixel(
            {static_cast<double>(window.col + x), static_cast<double>(window.row + y)});
      };
      tile.bounds.extend(corner(0, 0));
      tile.bounds.extend(corner(kTilePx, kTilePx));
      tile.center = *from_utm(tile.bounds.center_m());
      tile.enu_from_grid = enu_from_grid(tile.bounds.center_m(), 100, from_utm);
      writer.add_tile(tile, {});
      writer.add_descriptors(random_descriptors(tile, window, random));
    }
  }
  writer.finish();
  return path;
}

const std::filesystem::path& map_of_side(int side) {
  static const testing::TemporaryFolder folder;
  static std::map<int, std::filesystem::path> paths;
  if (!paths.contains(side)) paths[side] = write_map(folder / (std::to_string(side) + ".gpkg"), side);
  return paths[side];
}

/// A map that is signed with a list of its chunks, and the key.
struct SignedFile {
  std::filesystem::path path;
  std::string key;
};

SignedFile sign(const std::filesystem::path& path) {
  const std::filesystem::path secret = path.string() + ".key";
  SignedFile result{path, testing::generate_key_pair(secret, path.string() + ".pub")};
  SignOptions options;
  options.chunk_list_above_bytes = 0;
  sign_file(path, secret, options);
  return result;
}

const SignedFile& signed_map_of_side(int side) {
  static std::map<int, SignedFile> signed_maps;
  if (!signed_maps.contains(side)) signed_maps[side] = sign(map_of_side(side));
  return signed_maps[side];
}

/// A map of many gigabytes: a small one, and behind it pages that no table uses, a hole of the file system.
const SignedFile& enlarged_map(std::uintmax_t gigabytes) {
  static const testing::TemporaryFolder folder;
  static std::map<std::uintmax_t, SignedFile> signed_maps;
  if (signed_maps.contains(gigabytes)) return signed_maps[gigabytes];
  const std::filesystem::path path = folder / (std::to_string(gigabytes) + "_gb.gpkg");
  std::filesystem::copy_file(map_of_side(20), path);
  constexpr std::uintmax_t kPageBytes = 4096;
  const std::uintmax_t pages = gigabytes * 1000 * 1000 * 1000 / kPageBytes;
  std::filesystem::resize_file(path, pages * kPageBytes);
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(28);  // where an SQLite file says how many pages it has, big-endian
  for (int shift = 24; shift >= 0; shift -= 8) file.put(static_cast<char>(pages >> shift));
  file.close();
  return signed_maps[gigabytes] = sign(path);
}

/// At least 600 m from the edge of a map.
GeodeticPoint random_place(Random& random, int side) {
  const double extent_m = side * kTilePx * 0.6;
  return *from_utm({380000 + random.uniform(600, extent_m - 600), 6450000 - random.uniform(600, extent_m - 600)});
}

std::size_t read_near(MapReader& reader, GeodeticPoint place, double radius_m) {
  std::size_t features = 0;
  for (const NearTile& near : reader.tiles_near(place, radius_m, 0)) {
    features += reader.descriptors(near.tile.tile_id, near.tile.level)->features.size();
  }
  return features;
}

void BM_TilesNear(benchmark::State& state) {
  const int side = static_cast<int>(state.range(0));
  MapReader reader = MapReader::open_unverified(map_of_side(side), 0);  // decodes each time
  Random random(1);
  for (auto _ : state) benchmark::DoNotOptimize(reader.tiles_near(random_place(random, side), 60, 0));
}

void BM_TilesNearAndDescriptors(benchmark::State& state) {
  const int side = static_cast<int>(state.range(0));
  MapReader reader = MapReader::open_unverified(map_of_side(side), 0);  // decodes each time
  Random random(2);
  std::size_t features = 0;
  for (auto _ : state) features += read_near(reader, random_place(random, side), 60);
  state.counters["features"] = benchmark::Counter(static_cast<double>(features), benchmark::Counter::kAvgIterations);
}

void BM_ChunkedTilesNearAndDescriptors(benchmark::State& state) {
  const int side = static_cast<int>(state.range(0));
  const SignedFile& map = signed_map_of_side(side);
  MapReader reader = MapReader::open(map.path, {map.key}, 0);  // decodes each time
  Random random(2);
  for (auto _ : state) benchmark::DoNotOptimize(read_near(reader, random_place(random, side), 60));
}

/// Blocks of 512 bytes that the system read from the disk for this process.
std::int64_t blocks_read() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_inblock;
}

/// The pages of a file are dropped from the system's cache (as far as the system obeys).
void drop_pages(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return;  // no list of chunks
  ::fsync(descriptor);
  ::posix_fadvise(descriptor, 0, 0, POSIX_FADV_DONTNEED);
  ::close(descriptor);
}

/// Opens a map whose pages are not in the system's cache, and reads it at a place.
void cold_open(benchmark::State& state, const std::function<MapReader(const std::filesystem::path&)>& open_map) {
  const int side = static_cast<int>(state.range(0));
  const std::filesystem::path& path = map_of_side(side);
  Random random(3);
  const std::int64_t before = blocks_read();
  for (auto _ : state) {
    state.PauseTiming();
    drop_pages(path);
    drop_pages(chunk_list_path_of(path));
    const GeodeticPoint place = random_place(random, side);
    state.ResumeTiming();
    MapReader reader = open_map(path);
    benchmark::DoNotOptimize(read_near(reader, place, 60));
  }
  state.counters["read_KiB"] =
      benchmark::Counter(0.5 * static_cast<double>(blocks_read() - before), benchmark::Counter::kAvgIterations);
  state.counters["GB"] = 1e-9 * static_cast<double>(std::filesystem::file_size(path));
}

void BM_ColdOpenNearDescriptors(benchmark::State& state) {
  cold_open(state, [](const auto& path) { return MapReader::open_unverified(path); });
}

void BM_ColdChunkedOpenNearDescriptors(benchmark::State& state) {
  const SignedFile& map = signed_map_of_side(static_cast<int>(state.range(0)));
  cold_open(state, [&](const auto& path) { return MapReader::open(path, {map.key}); });
}

/// Only opens: from the system's cache, or cold.
void BM_OpenEnlarged(benchmark::State& state) {
  const SignedFile& map = enlarged_map(static_cast<std::uintmax_t>(state.range(0)));
  for (auto _ : state) {
    if (state.range(1) != 0) {
      state.PauseTiming();
      drop_pages(map.path);
      drop_pages(chunk_list_path_of(map.path));
      state.ResumeTiming();
    }
    benchmark::DoNotOptimize(MapReader::open(map.path, {map.key}));
  }
}

void BM_OpenNearDescriptors(benchmark::State& state) {
  const int side = static_cast<int>(state.range(0));
  Random random(4);
  for (auto _ : state) {
    MapReader reader = MapReader::open_unverified(map_of_side(side), 0);  // decodes each time
    benchmark::DoNotOptimize(read_near(reader, random_place(random, side), 60));
  }
}

void BM_Verify(benchmark::State& state) {
  for (auto _ : state) {
    if (!verify_map(map_of_side(20)).ok()) state.SkipWithError("the map is damaged");
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) *
                          static_cast<std::int64_t>(std::filesystem::file_size(map_of_side(20))));
}

void both_maps(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgName("side")->Arg(large_side() / 10)->Arg(large_side())->Unit(benchmark::kMicrosecond);
}

BENCHMARK(BM_TilesNear)->Apply(both_maps);
BENCHMARK(BM_TilesNearAndDescriptors)->Apply(both_maps);
BENCHMARK(BM_OpenNearDescriptors)->Apply(both_maps);
BENCHMARK(BM_ColdOpenNearDescriptors)->Apply(both_maps)->Iterations(200);
BENCHMARK(BM_OpenEnlarged)->ArgNames({"GB", "cold"})->ArgsProduct({{1, 10}, {0, 1}})->Unit(benchmark::kMillisecond);
BENCHMARK(BM_ChunkedTilesNearAndDescriptors)->Apply(both_maps);
BENCHMARK(BM_ColdChunkedOpenNearDescriptors)->Apply(both_maps)->Iterations(200);
BENCHMARK(BM_Verify)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
}  // namespace pilotage
