// A mission prepared by a program: imagery, a route and a camera in; map, scores and report in a folder out, the map
// verified, and on standard output how likely a frame of each stored tile is matched. README.md beside this file says
// how to run it.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include <opencv2/core/utility.hpp>
#include <pilotage/onboard.h>
#include <pilotage/prep.h>

namespace {

// The mission as a planner states it. What is not set keeps the default that `pilotage prepare --help` shows.
pilotage::PrepareOptions mission(const std::vector<std::string>& arguments) {
  pilotage::PrepareOptions options;
  options.tile.imagery = {arguments[0]};
  options.tile.route = arguments[1];
  options.tile.camera.file = arguments[2];
  options.tile.route_options.agl_m = std::stod(arguments[3]);
  options.tile.route_options.speed_mps = std::stod(arguments[4]);
  options.tile.ins.grade = pilotage::InsGrade::kTactical;
  options.tile.max_error_m = 60;
  return options;
}

// Called while the work is done; to return false would stop it, and nothing would be left behind.
bool show_progress(std::string_view what, std::int64_t done, std::int64_t total) {
  std::fprintf(stderr, "\r\033[K%.*s %lld of %lld", static_cast<int>(what.size()), what.data(),
               static_cast<long long>(done), static_cast<long long>(total));
  return true;
}

// What flies reads the map; here it tells what the ground program wrote about each tile.
void print_tiles(const std::filesystem::path& map_path) {
  pilotage::MapReader map = pilotage::MapReader::open_unverified(map_path);
  std::size_t column = 0;
  while (map.tile_columns().at(column).name != "p_correct_fix") ++column;
  std::puts("tile_id,lon_deg,lat_deg,p_correct_fix");
  for (const pilotage::MapTile& tile : map.tiles()) {
    const auto values = map.tile_values(tile.tile_id);
    const double* p = std::get_if<double>(&values->at(column));  // no number where it was not scored
    std::printf("%lld,%.6f,%.6f,%s\n", static_cast<long long>(tile.tile_id), tile.center.lon_deg, tile.center.lat_deg,
                p == nullptr ? "" : std::to_string(*p).c_str());
  }
}

void run(const std::vector<std::string>& arguments) {
  const pilotage::PrepareOptions options = mission(arguments);
  pilotage::PrepareRun into;
  into.output_folder = arguments[5];
  into.software_version = std::string("pilotage ") + PILOTAGE_VERSION;

  const pilotage::PrepareResult result = pilotage::prepare(options, into, show_progress);
  std::fprintf(stderr, "\r\033[K");
  for (const std::string& warning : result.warnings) std::fprintf(stderr, "warning: %s\n", warning.c_str());

  // Before a map is handed on. A signature (pilotage::sign_file) would follow here.
  const std::filesystem::path map_path = into.output_folder / "map.gpkg";
  pilotage::require_intact(pilotage::verify_map(map_path));
  print_tiles(map_path);
  std::fprintf(stderr, "%s\n", result.verdict.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.size() != 6) {
    std::fprintf(stderr, "usage: %s IMAGERY ROUTE CAMERA_FILE AGL_M SPEED_MPS OUTPUT_FOLDER\n", argv[0]);
    return 2;
  }
  cv::setNumThreads(1);  // for the whole process, so the program's to say: the library shares its work out itself
  try {
    run(arguments);
    return 0;
  } catch (const pilotage::UsageError& error) {  // what was asked for is not allowed
    std::fprintf(stderr, "prep_example: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {  // a file that cannot be read or written, a number that is none
    std::fprintf(stderr, "prep_example: %s\n", error.what());
    return 1;
  }
}
