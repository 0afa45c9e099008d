#include "landmark/landmark_ground.h"

#include <cmath>
#include <numbers>

#include "raster/raster_maker.h"
#include <opencv2/imgproc.hpp>

#include "pilotage/base/output_file.h"
#include "pilotage/base/random.h"
#include "pilotage/base/text.h"
#include "pilotage/raster/gdal_crs.h"

namespace pilotage::testing {
namespace {

using Eigen::Vector2d;

std::vector<Vector2d> corners_of_bar(const GroundThing& thing) {
  const double heading = thing.heading_deg * std::numbers::pi / 180;
  const Vector2d along(std::sin(heading), -std::cos(heading));  // south is positive
  const Vector2d across(-along.y(), along.x());
  std::vector<Vector2d> corners;
  for (const auto& [a, b] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    corners.push_back(thing.center_m + along * (a * thing.length_m / 2) + across * (b * thing.width_m / 2));
  }
  return corners;
}

}  // namespace

std::vector<GroundThing> scattered(int columns, int rows, bool discs, std::uint64_t seed) {
  constexpr double kSpacing_m = 60;
  Random random(seed);
  std::vector<GroundThing> things;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      GroundThing thing;
      thing.center_m =
          Vector2d(kSpacing_m * (column + 1) + random.uniform(-8, 8), kSpacing_m * (row + 1) + random.uniform(-8, 8));
      thing.length_m = random.uniform(16, 26);
      thing.width_m = discs ? thing.length_m : thing.length_m / 3;
      thing.heading_deg = discs ? 0 : random.uniform(0, 180);
      thing.disc = discs;
      things.push_back(thing);
    }
  }
  return things;
}

cv::Mat draw_ground(const std::vector<GroundThing>& things, int side_px, double brightness, std::uint64_t seed) {
  Random random(seed);
  cv::Mat ground(side_px, side_px, CV_8U, cv::Scalar(100));
  for (int i = 0; i < side_px / 4; ++i) {  // what is no landmark
    const cv::Rect square(static_cast<int>(random.below(static_cast<std::uint64_t>(side_px))),
                          static_cast<int>(random.below(static_cast<std::uint64_t>(side_px))), 12, 12);
    const cv::Scalar gray(random.uniform(60, 140));
    ground(square & cv::Rect(0, 0, side_px, side_px)).setTo(gray);
  }
  constexpr int kShift = 4;
  constexpr double kFixed = 1 << kShift;
  const auto fixed = [&](const Vector2d& place_m) {
    const Vector2d px = place_m / kGroundGsd_m - Vector2d(0.5, 0.5);
    return cv::Point(static_cast<int>(std::lround(px.x() * kFixed)), static_cast<int>(std::lround(px.y() * kFixed)));
  };
  for (const GroundThing& thing : things) {
    const cv::Scalar gray(100 + brightness * random.uniform(0.6, 1));
    if (thing.disc) {
      cv::circle(ground, fixed(thing.center_m),
                 static_cast<int>(std::lround(thing.length_m / 2 / kGroundGsd_m * kFixed)), gray, cv::FILLED,
                 cv::LINE_AA, kShift);
    } else {
      std::vector<cv::Point> corners;
      for (const Vector2d& corner : corners_of_bar(thing)) corners.push_back(fixed(corner));
      cv::fillConvexPoly(ground, corners, gray, cv::LINE_AA, kShift);
    }
  }
  for (int row = 0; row < side_px; ++row) {
    for (int col = 0; col < side_px; ++col) {
      auto& pixel = ground.at<std::uint8_t>(row, col);
      pixel = cv::saturate_cast<std::uint8_t>(pixel + 8 * random.normal());
    }
  }
  return ground;
}

std::string write_ground(const std::filesystem::path& path, const cv::Mat& gray) {
  RasterSpec spec;
  spec.width = gray.cols;
  spec.height = gray.rows;
  spec.place = GeoTransform::north_up(500'000, 5'000'000, kGroundGsd_m);
  spec.value = [&](int, int col, int row) { return gray.at<std::uint8_t>(row, col); };
  return make_raster(path, spec);
}

std::string ground_place(const Vector2d& place_m) {
  static const CrsTransform transform(utm33());
  const GeodeticPoint point = *transform.geodetic_from_map(Vector2d(500'000 + place_m.x(), 5'000'000 - place_m.y()));
  return "[" + format_fixed(point.lon_deg, 10) + ", " + format_fixed(point.lat_deg, 10) + "]";
}

std::string write_things(const std::filesystem::path& path, const std::vector<GroundThing>& things,
                         const std::string& class_name) {
  std::vector<std::string> features;
  for (const GroundThing& thing : things) {
    std::string geometry = R"({"type": "Point", "coordinates": )" + ground_place(thing.center_m) + "}";
    if (!thing.disc) {
      std::vector<std::string> corners;
      for (const Vector2d& corner : corners_of_bar(thing)) corners.push_back(ground_place(corner));
      corners.push_back(corners.front());
      geometry = R"({"type": "Polygon", "coordinates": [[)" + join(corners, ", ") + "]]}";
    }
    features.push_back(R"({"type": "Feature", "properties": {"class": ")" + class_name + R"(", "diameter": )" +
                       format_number(thing.length_m) + R"(}, "geometry": )" + geometry + "}");
  }
  write_file(path, R"({"type": "FeatureCollection", "features": [)" + join(features, ",\n") + "]}", true);
  return path.string();
}

}  // namespace pilotage::testing
