#include "ring_field.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "country/synthetic_scene.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/random.h"
#include "pilotage/camera/render_frame.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/prepare/prepare.h"
#include "pilotage/raster/gdal_geotiff.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

constexpr Paint kPostColor = {90, 92, 95};
constexpr double kPostRadius_m = 0.06;
constexpr double kMapGsd_m = 0.06;  // what the lowest frames are compared at too: the default is for higher flights

/// Grain of the ground, of three sizes: stones, tufts, patches.
cv::Mat grain(int size_px, double gsd_m) {
  Random random(seed_from_name("grain of the ring field"));
  cv::Mat sum(size_px, size_px, CV_32F, cv::Scalar(0));
  for (const auto& [length_m, strength] : {std::pair{0.06, 6.0}, {0.2, 9.0}, {0.8, 8.0}}) {
    const double scale = std::max(1.0, length_m / gsd_m);
    const int coarse_px = static_cast<int>(std::ceil(size_px / scale)) + 2;
    cv::Mat coarse(coarse_px, coarse_px, CV_32F);
    for (auto value = coarse.begin<float>(); value != coarse.end<float>(); ++value) {
      *value = static_cast<float>(strength * random.normal());
    }
    cv::Mat fine;
    cv::resize(coarse, fine, {}, scale, scale, cv::INTER_CUBIC);
    sum += fine(cv::Rect(0, 0, size_px, size_px));
  }
  return sum;
}

/// A camera straight down for prepare().
CameraOptions options_of(const Camera& camera) {
  CameraOptions options;
  options.width_px = camera.width_px;
  options.height_px = camera.height_px;
  options.hfov_deg = 2 * std::atan2(camera.width_px / 2.0, camera.fx_px) * 180 / 3.141592653589793;
  return options;
}

/// Lines 8 m apart over the field, by turns low and high: what lies beside them within the corridor is the whole field.
std::string route_over(const RingField& field, double side_m, double low_m, double high_m) {
  const LocalFrame frame(field.middle);
  const double half_m = 0.5 * side_m - 12;
  Json line = Json::array();
  const int lines = std::max(2, static_cast<int>(std::ceil(2 * half_m / 8)));
  for (int i = 0; i <= lines; ++i) {
    const double north_m = -half_m + 2 * half_m * i / lines;
    for (const double east_m : {i % 2 == 0 ? -half_m : half_m, i % 2 == 0 ? half_m : -half_m}) {
      const GeodeticPoint point = frame.geodetic_from_enu({east_m, north_m, 0});
      line.push_back({point.lon_deg, point.lat_deg, i % 2 == 0 ? low_m : high_m});
    }
  }
  const Json feature = {{"type", "Feature"},
                        {"properties", Json::object()},
                        {"geometry", {{"type", "LineString"}, {"coordinates", line}}}};
  return json_text({{"type", "FeatureCollection"}, {"features", {feature}}});
}

void add_decoy(Mesh& mesh, const Decoy& decoy) {
  const RingClass& kind = kRingClasses[static_cast<std::size_t>(decoy.ring_class)];
  const Eigen::Vector3d normal = direction(decoy.azimuth_deg, 0);
  switch (decoy.kind) {
    case DecoyKind::kDisc:
      add_disc(mesh, decoy.center_m, normal, 0, decoy.radius_m, 48, kind.color);
      break;
    case DecoyKind::kSquare:
      add_disc(mesh, decoy.center_m, normal, 1.2 * decoy.radius_m, 1.6 * decoy.radius_m, 4, kind.color);
      break;
    case DecoyKind::kPainted:
      add_disc(mesh, decoy.center_m + 0.01 * Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitZ(), decoy.radius_m,
               decoy.radius_m + 2 * kind.tube_radius_m, 48, kind.color);
      return;
  }
  const double half_m = decoy.kind == DecoyKind::kSquare ? 1.6 * decoy.radius_m * std::sqrt(0.5) : decoy.radius_m;
  add_post(mesh, decoy.center_m - half_m * Eigen::Vector3d::UnitZ(), kPostRadius_m, kPostColor);
}

}  // namespace

RingField make_ring_field(const RingFieldOptions& options, int threads) {
  const Scene scene = make_scene({});
  const int size_px = static_cast<int>(std::lround(options.side_m / options.gsd_m));
  const Eigen::Vector2d middle_m = scene.map_from_local(scene.sites.orchard).array().round().matrix();
  const GeoTransform grid =
      GeoTransform::north_up(middle_m.x() - 0.5 * options.side_m, middle_m.y() + 0.5 * options.side_m, options.gsd_m);
  RingField field;
  field.rgb = render_rgb8(scene, SceneEpoch::kFirst, grid, size_px, size_px, threads);
  cv::Mat grains;
  cv::Mat(grain(size_px, options.gsd_m)).convertTo(grains, CV_16S);
  cv::Mat three;
  cv::merge(std::vector<cv::Mat>{grains, grains, grains}, three);
  cv::add(field.rgb.pixels, three, field.rgb.pixels, cv::noArray(), CV_8U);
  field.crs = scene.crs();
  const Crs crs = Crs::from_user_input(field.crs);
  const Eigen::Vector2d origin_px = Eigen::Vector2d::Constant(0.5 * size_px);
  field.middle = geodetic_from_pixel(CrsTransform(crs), grid, origin_px);
  field.picture = make_ground_picture(field.rgb.pixels, origin_px, ground_place(crs, grid, origin_px).pixel_from_enu_m);
  return field;
}

std::filesystem::path prepare_ring_field(const RingField& field, const Camera& camera, double low_m, double high_m,
                                         const std::filesystem::path& folder, int threads) {
  std::filesystem::create_directories(folder);
  write_rgb8_geotiff(folder / "ground.tif", field.rgb, field.crs, {}, true);
  const double side_m = field.rgb.pixels.cols * std::sqrt(std::abs(field.rgb.map_from_pixel.determinant()));
  write_file(folder / "route.geojson", route_over(field, side_m, low_m, high_m), true);
  PrepareOptions options;
  options.tile.imagery = {(folder / "ground.tif").string()};
  options.tile.route = (folder / "route.geojson").string();
  options.tile.route_options.height_reference = HeightReference::kAgl;
  options.tile.camera = options_of(camera);
  options.tile.route_options.speed_mps = 4;
  options.tile.max_error_m = 5;
  options.tile.ins.grade = InsGrade::kIndustrial;
  options.tile.min_agl_m = 1;
  options.tile.gsd_m = kMapGsd_m;
  PrepareRun run;
  run.output_folder = folder;
  run.overwrite = true;
  run.threads = threads;
  prepare(options, run);
  return folder / "map.gpkg";
}

Mesh mesh_of(const RingScene& scene) {
  Mesh mesh;
  for (const Ring& ring : scene.rings) {
    const RingClass& kind = ring.kind();
    add_torus(mesh, ring.center_m, ring.normal(), kind.inner_radius_m + kind.tube_radius_m, kind.tube_radius_m,
              kind.color);
    const Eigen::Vector3d bottom =
        ring.center_m - (kind.inner_radius_m + 2 * kind.tube_radius_m) * Eigen::Vector3d::UnitZ();
    add_post(mesh, bottom, kPostRadius_m, kPostColor);
  }
  for (const Decoy& decoy : scene.decoys) add_decoy(mesh, decoy);
  return mesh;
}

}  // namespace pilotage
