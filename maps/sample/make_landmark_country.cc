// Writes a country with round landmarks at two dates, and their outlines: a ground on which detectors are trained and
// judged. Run by tests and by the examples of docs/commands/landmark-train.md.

#include <cmath>
#include <exception>
#include <filesystem>
#include <iostream>
#include <string>

#include "country/synthetic_scene.h"
#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/raster/gdal_geotiff.h"
#include "pilotage/raster/gdal_vector.h"

namespace {

namespace fs = std::filesystem;
using namespace pilotage;

void write_picture(const fs::path& file, const Scene& scene, SceneEpoch epoch, double gsd_m, const char* taken) {
  const int width_px = static_cast<int>(std::floor(scene.options.width_m / gsd_m));
  const int height_px = static_cast<int>(std::floor(scene.options.height_m / gsd_m));
  GeotiffOptions geotiff;
  geotiff.compression = GeotiffCompression::kJpeg;
  geotiff.metadata = {{"TIFFTAG_DATETIME", taken}};
  write_rgb8_geotiff(file, render_rgb8(scene, epoch, whole_scene_grid(scene, gsd_m), width_px, height_px), scene.crs(),
                     geotiff, true);
}

void write_labels(const fs::path& file, const Scene& scene) {
  VectorLayer layer;
  layer.name = "landmarks";
  layer.shape = VectorShape::kPoint;
  layer.crs = Crs::from_user_input(scene.crs());
  layer.columns = {{"class", VectorType::kText, ""}, {"diameter", VectorType::kReal, "Diameter, m"}};
  for (const SceneLandmark& landmark : landmarks(scene)) {
    VectorFeature feature;
    feature.points = {landmark.center_m};
    feature.values = {landmark.class_name, landmark.diameter_m};
    layer.features.push_back(feature);
  }
  write_geojson(file, layer, true);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 3 && argc != 4) {
    std::cerr << "usage: make_landmark_country FOLDER LANDMARKS_OF_EACH_CLASS [SEED]\n";
    return 2;
  }
  SceneOptions options;
  options.landmarks = std::stoi(argv[2]);
  options.seed = argc == 4 ? std::stoll(argv[3]) : 7;
  const Scene scene = make_scene(options);
  constexpr double kGsd_m = 0.5;
  const fs::path folder = argv[1];
  fs::create_directories(folder);
  write_picture(folder / "ortho.tif", scene, SceneEpoch::kFirst, kGsd_m, "2023:06:14 09:40:00");
  write_picture(folder / "ortho_second_epoch.tif", scene, SceneEpoch::kSecond, kGsd_m, "2024:09:26 14:10:00");
  write_labels(folder / "landmarks.geojson", scene);
  std::cout << landmarks(scene).size() << " landmarks\n";
  return 0;
} catch (const std::exception& error) {
  std::cerr << "make_landmark_country: " << error.what() << "\n";
  return 1;
}
