// Makes the imagery, the elevation and the camera frames of the sample mission; run by the build (target
// sample_mission).

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>
#include <string>
#include <vector>

#include "cut_flight_frames.h"
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "country/synthetic_scene.h"
#include "pilotage/base/error.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/random.h"
#include "pilotage/raster/gdal_geotiff.h"

namespace {

namespace fs = std::filesystem;

/// Raise when this program writes other files from the same pictures.
constexpr int kGeneratorVersion = 3;

/// The flight over the second date: as many pixels across as the matcher needs, by a navigator that is some 15 m off.
pilotage::FlightFrameOptions frames_of_the_second_date() {
  pilotage::FlightFrameOptions frames;
  frames.frames = 60;
  frames.footprint_m = 180;
  frames.width_px = 800;
  frames.height_px = 450;
  frames.prior_offset_m = 30;
  frames.prior_sigma_m = 15;
  frames.format = pilotage::FrameFormat::kPgm;  // read by docs/examples/onboard, which decodes nothing else
  return frames;
}

struct SampleOptions {
  pilotage::SceneOptions scene;
  double gsd_m = 0.5;
  double elevation_gsd_m = 5;
  int jpeg_quality = 88;
  pilotage::FlightFrameOptions frames = frames_of_the_second_date();

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.group("scene", self.scene, "The world.");
    fields.field("gsd_m", self.gsd_m, "Pixel of the imagery.", pilotage::Range{0.1, 10});
    fields.field("elevation_gsd_m", self.elevation_gsd_m, "Pixel of the elevation.", pilotage::Range{1, 100});
    fields.field("jpeg_quality", self.jpeg_quality, "Of the imagery.", pilotage::Range{1, 100});
    fields.group("frames", self.frames, "The camera frames of the second date.");
  }
};

struct Picture {
  const char* file;
  pilotage::SceneEpoch epoch;
  const char* taken;
};

constexpr std::array<Picture, 2> kPictures = {{
    {"ortho.tif", pilotage::SceneEpoch::kFirst, "2023:06:14 09:40:00"},
    {"ortho_second_epoch.tif", pilotage::SceneEpoch::kSecond, "2024:09:26 14:10:00"},
}};
constexpr const char* kElevationFile = "elevation.tif";
constexpr const char* kFramesFolder = "frames";
constexpr std::uint64_t kFramesSeed = 1;
constexpr const char* kStampFile = ".sample_mission_stamp.json";

/// Hash of all files of a folder, by name.
std::string sources_hash(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::string content;
  for (const fs::path& file : files) content += file.filename().string() + '\n' + pilotage::read_file(file) + '\n';
  return std::to_string(pilotage::seed_from_name(content));
}

/// What the files are made from: when it equals the stamp beside them they are current.
std::string stamp_of(const SampleOptions& options, const fs::path& sources) {
  SampleOptions copy = options;
  nlohmann::ordered_json stamp;
  stamp["generator_version"] = kGeneratorVersion;
  stamp["country_sources"] = sources_hash(sources);
  stamp["options"] = pilotage::options_to_json(pilotage::list_options(copy));
  return stamp.dump(2) + "\n";
}

bool is_current(const fs::path& folder, const std::string& stamp) {
  std::error_code ignored;
  for (const Picture& picture : kPictures) {
    if (!fs::is_regular_file(folder / picture.file, ignored)) return false;
  }
  for (const fs::path& file : {folder / kElevationFile, folder / kFramesFolder / "frames.csv", folder / kStampFile}) {
    if (!fs::is_regular_file(file, ignored)) return false;
  }
  return pilotage::read_file(folder / kStampFile) == stamp;
}

void write_picture(const fs::path& folder, const pilotage::Scene& scene, const SampleOptions& options,
                   const Picture& picture) {
  const int width_px = static_cast<int>(std::floor(scene.options.width_m / options.gsd_m));
  const int height_px = static_cast<int>(std::floor(scene.options.height_m / options.gsd_m));
  const pilotage::Raster raster = pilotage::render_rgb8(
      scene, picture.epoch, pilotage::whole_scene_grid(scene, options.gsd_m), width_px, height_px);
  pilotage::GeotiffOptions geotiff;
  geotiff.compression = pilotage::GeotiffCompression::kJpeg;
  geotiff.jpeg_quality = options.jpeg_quality;
  geotiff.metadata = {{"TIFFTAG_DATETIME", picture.taken},
                      {"TIFFTAG_IMAGEDESCRIPTION", "Computed picture of a place that does not exist"}};
  pilotage::write_rgb8_geotiff(folder / picture.file, raster, scene.crs(), geotiff, true);
}

void write_elevation(const fs::path& folder, const pilotage::Scene& scene, const SampleOptions& options) {
  const int width_px = static_cast<int>(std::floor(scene.options.width_m / options.elevation_gsd_m));
  const int height_px = static_cast<int>(std::floor(scene.options.height_m / options.elevation_gsd_m));
  pilotage::Raster raster;
  raster.map_from_pixel = pilotage::whole_scene_grid(scene, options.elevation_gsd_m);
  raster.pixels = pilotage::elevation(scene, raster.map_from_pixel, width_px, height_px);
  raster.valid = cv::Mat(height_px, width_px, CV_8U, cv::Scalar(255));
  pilotage::GeotiffOptions geotiff;
  geotiff.metadata = {{"TIFFTAG_IMAGEDESCRIPTION", "Computed ground heights in metres of a place that does not exist"}};
  pilotage::write_float32_geotiff(folder / kElevationFile, raster, scene.crs(), geotiff, true);
}

/// Frames of the second date along the route, with the camera of the mission.
void write_frames(const fs::path& folder, const SampleOptions& options) {
  fs::remove_all(folder / kFramesFolder);
  pilotage::FlightFrameOptions frames = options.frames;
  frames.camera = folder / "camera.yaml";
  frames.route = folder / "route.plan";
  frames.also = folder / kPictures[0].file;
  frames.elevation = folder / kElevationFile;
  pilotage::cut_flight_frames(folder / kPictures[1].file, folder / kFramesFolder, frames, kFramesSeed, 0, false);
}

void make_sample_mission(const fs::path& folder, const fs::path& sources) {
  const SampleOptions options;
  const std::string stamp = stamp_of(options, sources);
  if (is_current(folder, stamp)) return;
  const auto start = std::chrono::steady_clock::now();
  const pilotage::Scene scene = pilotage::make_scene(options.scene);
  std::error_code ignored;
  fs::remove(folder / kStampFile, ignored);
  for (const Picture& picture : kPictures) write_picture(folder, scene, options, picture);
  write_elevation(folder, scene, options);
  write_frames(folder, options);
  pilotage::write_file(folder / kStampFile, stamp, true);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  std::cerr << "sample mission written to " << folder.string() << " in " << std::llround(seconds.count()) << " s\n";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: make_sample_mission FOLDER COUNTRY_SOURCES\n"
                 "Writes ortho.tif, ortho_second_epoch.tif, elevation.tif and frames/ there unless they are current:\n"
                 "made with the same options by the same sources of the country.\n";
    return 2;
  }
  try {
    make_sample_mission(argv[1], argv[2]);
    return 0;
  } catch (const pilotage::UsageError& error) {
    std::cerr << "make_sample_mission: " << error.what() << '\n';
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "make_sample_mission: " << error.what() << '\n';
    return 1;
  }
}
