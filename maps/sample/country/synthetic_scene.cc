#include "country/synthetic_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <GeographicLib/UTMUPS.hpp>
#include <opencv2/core.hpp>

#include "country/noise.h"
#include "country/world.h"
#include "pilotage/base/error.h"
#include "pilotage/base/parallel.h"

namespace pilotage {
namespace {

using Eigen::Vector2d;
using scene_detail::EpochLook;
using scene_detail::Rgb;
using scene_detail::World;

void check_view(const GeoTransform& t, int width_px, int height_px) {
  if (width_px <= 0 || height_px <= 0) {
    throw UsageError("a scene cannot be rendered at " + std::to_string(width_px) + " × " + std::to_string(height_px) +
                     " pixels: both must be positive");
  }
  const double determinant = t.determinant();
  if (!std::isfinite(determinant) || determinant == 0 || !std::isfinite(t.origin_x) || !std::isfinite(t.origin_y)) {
    throw UsageError("a scene cannot be rendered through a geotransform that is not finite or cannot be inverted");
  }
}

/// Pixels to metres from the scene's south-west corner.
GeoTransform local_from(const Scene& scene, GeoTransform map_from_pixel) {
  map_from_pixel.origin_x -= scene.origin_m.x();
  map_from_pixel.origin_y -= scene.origin_m.y();
  return map_from_pixel;
}

bool inside(const World& world, const Vector2d& p) {
  return p.x() >= 0 && p.y() >= 0 && p.x() <= world.width_m && p.y() <= world.height_m;
}

/// Parts of a pixel in each direction: a power of two, each part at most 0.75 m.
int parts_per_pixel(double gsd_m) {
  int parts = 1;
  while (gsd_m / parts > 0.75 && parts < 64) parts *= 2;
  return parts;
}

/// The camera: exposure, haze, tone curve, and noise of the sensor that belongs to the place.
cv::Vec3b develop(const EpochLook& look, std::uint64_t seed, const Vector2d& p, const Rgb& seen, float falloff) {
  const auto tone = [&](float value, float gain) {
    const float exposed = std::clamp(value * gain * falloff / 255.0F, 0.0F, 1.2F);
    const float curved = look.contrast == 1 ? exposed : std::pow(exposed, look.contrast);
    // A soft shoulder instead of clipping.
    const float limited = curved < 0.8F ? curved : 0.8F + 0.2F * std::tanh((curved - 0.8F) / 0.2F);
    return look.haze + limited * (255.0F - look.haze);
  };
  const std::uint64_t noise =
      scene_detail::lattice_hash(seed, scene_detail::floor_to_int(p.x() * 64), scene_detail::floor_to_int(p.y() * 64));
  const float gray = 1.7F * (scene_detail::hash_signed(noise, 0) + scene_detail::hash_signed(noise, 1));
  const float luma = 0.3F * seen.r + 0.59F * seen.g + 0.11F * seen.b;
  const Rgb muted = scene_detail::blend({luma, luma, luma}, seen, look.saturation);
  const auto level = [](float value) {
    return static_cast<unsigned char>(std::lround(std::clamp(value, 0.0F, 255.0F)));
  };
  return {level(tone(muted.r, look.gain.r) + gray + 0.8F * scene_detail::hash_signed(noise, 2)),
          level(tone(muted.g, look.gain.g) + gray),
          level(tone(muted.b, look.gain.b) + gray + 1.2F * scene_detail::hash_signed(noise, 3))};
}

/// One row of samples at sub-pixel row `row` (in parts of pixels), `count` of them from `first`, `offset` added to
/// both.
void sample_row(const World& world, SceneEpoch epoch, const GeoTransform& local_from_part, double row, double offset,
                double footprint_m, std::vector<Rgb>& samples) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vector2d p = local_from_part.map_from_pixel({static_cast<double>(i) + offset, row});
    samples[i] = scene_detail::look_at(world, epoch, p, footprint_m).colour;
  }
}

/// Renders pixel rows [first, last) of the picture.
void render_rows(const World& world, SceneEpoch epoch, const GeoTransform& local_from_pixel, int first, int last,
                 Raster& picture) {
  const int width = picture.pixels.cols;
  const double gsd_m = std::sqrt(std::abs(local_from_pixel.determinant()));
  const int parts = parts_per_pixel(gsd_m);
  GeoTransform local_from_part = local_from_pixel;
  local_from_part.x_per_col /= parts;
  local_from_part.x_per_row /= parts;
  local_from_part.y_per_col /= parts;
  local_from_part.y_per_row /= parts;
  const double footprint_m = gsd_m / parts;
  const EpochLook& look = scene_detail::epoch_look(epoch);
  const std::uint64_t sensor_seed = world.seed + 77 + static_cast<std::uint64_t>(scene_detail::epoch_index(epoch));
  const auto part_count = static_cast<std::size_t>(width) * static_cast<std::size_t>(parts);
  std::vector<Rgb> above(part_count + 1);
  std::vector<Rgb> below(part_count + 1);
  std::vector<Rgb> middle(part_count);
  std::vector<Rgb> sums(static_cast<std::size_t>(width));
  sample_row(world, epoch, local_from_part, static_cast<double>(first) * parts, 0, footprint_m, above);
  for (int row = first; row < last; ++row) {
    std::fill(sums.begin(), sums.end(), Rgb{});
    for (int part = 0; part < parts; ++part) {
      const double part_row = static_cast<double>(row) * parts + part;
      sample_row(world, epoch, local_from_part, part_row + 0.5, 0.5, footprint_m, middle);
      sample_row(world, epoch, local_from_part, part_row + 1, 0, footprint_m, below);
      for (std::size_t i = 0; i < part_count; ++i) {
        const Rgb corners = above[i] + above[i + 1] + below[i] + below[i + 1];
        Rgb& sum = sums[i / static_cast<std::size_t>(parts)];
        sum = sum + middle[i] * 0.5F + corners * 0.125F;
      }
      std::swap(above, below);
    }
    for (int col = 0; col < width; ++col) {
      const Vector2d p = local_from_pixel.map_from_pixel({col + 0.5, row + 0.5});
      const bool valid = inside(world, p);
      picture.valid.at<unsigned char>(row, col) = valid ? 255 : 0;
      if (!valid) continue;
      // Light falls off between strips of the survey flight, differently at each date.
      const float falloff = 1 + 0.025F * scene_detail::gradient_noise(sensor_seed + 9, p.x() / 900, p.y() / 900);
      const Rgb seen = sums[static_cast<std::size_t>(col)] * (1.0F / static_cast<float>(parts * parts));
      picture.pixels.at<cv::Vec3b>(row, col) = develop(look, sensor_seed, p, seen, falloff);
    }
  }
}

/// Calls `body(first, last)` for blocks of rows.
void for_row_blocks(int height_px, int threads, const std::function<void(int, int)>& body) {
  constexpr int kBlock = 32;
  const int blocks = (height_px + kBlock - 1) / kBlock;
  parallel_for(static_cast<std::size_t>(blocks), threads, [&](std::size_t block, int) {
    const int first = static_cast<int>(block) * kBlock;
    body(first, std::min(height_px, first + kBlock));
  });
}

}  // namespace

std::string Scene::crs() const {
  return "EPSG:" + std::to_string(epsg);
}

Scene make_scene(const SceneOptions& options) {
  check_options(options);
  int zone = 0;
  bool north = true;
  double easting_m = 0;
  double northing_m = 0;
  GeographicLib::UTMUPS::Forward(options.center_lat_deg, options.center_lon_deg, zone, north, easting_m, northing_m);
  Scene scene;
  scene.options = options;
  scene.epsg = (north ? 32600 : 32700) + zone;
  scene.origin_m = {10 * std::round((easting_m - options.width_m / 2) / 10),
                    10 * std::round((northing_m - options.height_m / 2) / 10)};
  const auto world = std::make_shared<const World>(scene_detail::make_world(options));
  scene.sites = world->sites;
  scene.world = world;
  return scene;
}

GeoTransform whole_scene_grid(const Scene& scene, double gsd_m) {
  return GeoTransform::north_up(scene.origin_m.x(), scene.origin_m.y() + scene.options.height_m, gsd_m);
}

Raster render_rgb8(const Scene& scene, SceneEpoch epoch, const GeoTransform& map_from_pixel, int width_px,
                   int height_px, int threads) {
  check_view(map_from_pixel, width_px, height_px);
  const GeoTransform local_from_pixel = local_from(scene, map_from_pixel);
  Raster picture;
  picture.pixels = cv::Mat::zeros(height_px, width_px, CV_8UC3);
  picture.valid = cv::Mat::zeros(height_px, width_px, CV_8U);
  picture.map_from_pixel = map_from_pixel;
  for_row_blocks(height_px, threads, [&](int first, int last) {
    render_rows(*scene.world, epoch, local_from_pixel, first, last, picture);
  });
  return picture;
}

cv::Mat land_cover(const Scene& scene, SceneEpoch epoch, const GeoTransform& map_from_pixel, int width_px,
                   int height_px, int threads) {
  check_view(map_from_pixel, width_px, height_px);
  const GeoTransform local_from_pixel = local_from(scene, map_from_pixel);
  const double gsd_m = std::sqrt(std::abs(map_from_pixel.determinant()));
  const double footprint_m = gsd_m / parts_per_pixel(gsd_m);
  cv::Mat labels(height_px, width_px, CV_8U, cv::Scalar(255));
  for_row_blocks(height_px, threads, [&](int first, int last) {
    for (int row = first; row < last; ++row) {
      for (int col = 0; col < width_px; ++col) {
        const Vector2d p = local_from_pixel.map_from_pixel({col + 0.5, row + 0.5});
        if (!inside(*scene.world, p)) continue;
        labels.at<unsigned char>(row, col) =
            static_cast<unsigned char>(scene_detail::look_at(*scene.world, epoch, p, footprint_m).cover);
      }
    }
  });
  return labels;
}

cv::Mat elevation(const Scene& scene, const GeoTransform& map_from_pixel, int width_px, int height_px) {
  check_view(map_from_pixel, width_px, height_px);
  const GeoTransform local_from_pixel = local_from(scene, map_from_pixel);
  cv::Mat heights(height_px, width_px, CV_32F, cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
  for (int row = 0; row < height_px; ++row) {
    for (int col = 0; col < width_px; ++col) {
      const Vector2d p = local_from_pixel.map_from_pixel({col + 0.5, row + 0.5});
      if (inside(*scene.world, p)) heights.at<float>(row, col) = scene.world->ground.at(p).elevation_m;
    }
  }
  return heights;
}

std::vector<SceneLandmark> landmarks(const Scene& scene) {
  std::vector<SceneLandmark> found;
  for (const scene_detail::Box& box : scene.world->objects.boxes) {
    if (!scene_detail::is_round(box.kind)) continue;
    const char* name = box.kind == scene_detail::BoxKind::kTank         ? "tank"
                       : box.kind == scene_detail::BoxKind::kRoundabout ? "roundabout"
                                                                        : "ring";
    found.push_back({name, scene.map_from_local(box.center_m), 2 * box.half_length_m});
  }
  return found;
}

Vector2d orchard_rows(const Scene& scene, const Vector2d& local_m) {
  const World& world = *scene.world;
  const Vector2d q = scene_detail::bent_from_ground(world.ground, local_m);
  const scene_detail::Parcel& parcel = world.parcels.parcels[static_cast<std::size_t>(world.parcels.locate(q))];
  if (parcel.use != scene_detail::LandUse::kOrchard) throw UsageError("no orchard stands at the point asked for");
  return parcel.rows;
}

}  // namespace pilotage
