#include "pilotage/landmark/landmark_files.h"

#include <cmath>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/mapdb/geopackage_rows.h"
#include "pilotage/raster/gdal_vector.h"

namespace pilotage {
namespace {

VectorValue number_or_null(double number) {
  if (std::isfinite(number)) return number;
  return std::monostate{};
}

}  // namespace

std::string measured_share_text(const Share& share) {
  if (share.of == 0) return "of none";
  const Interval interval = share.interval();
  return format_fixed(100 * share.value(), 1) + " % (" + std::to_string(share.count) + " of " +
         std::to_string(share.of) + "; 95 % interval " + format_fixed(100 * interval.low, 1) + " to " +
         format_fixed(100 * interval.high, 1) + " %)";
}

void check_scored_landmarks_name(const std::filesystem::path& path) {
  if (path.extension() == ".gpkg" || path.extension() == ".geojson") return;
  throw UsageError("output = \"" + path.string() + "\" is neither .geojson nor .gpkg");
}

void write_scored_landmarks(const std::filesystem::path& path, const LandmarkScores& scores, bool overwrite) {
  VectorLayer layer;
  layer.name = "landmarks";
  layer.title = "Landmarks on another date";
  layer.shape = VectorShape::kPoint;
  layer.crs = Crs::wgs84();
  layer.columns = {{"class", VectorType::kText, ""},
                   {"fate", VectorType::kText, "Found, missed or a false alarm"},
                   {"score", VectorType::kReal, ""},
                   {"east_m", VectorType::kReal, "Hit less label, east, m"},
                   {"north_m", VectorType::kReal, "Hit less label, north, m"},
                   {"length_m", VectorType::kReal, "Length, m"},
                   {"learnt", VectorType::kBoolean, "The detector learnt it"},
                   {"ambiguity", VectorType::kReal, "Expected others of its class within the search radius"}};
  for (const ScoredLandmark& landmark : scores.landmarks) {
    VectorFeature feature;
    feature.points = {{landmark.place.lon_deg, landmark.place.lat_deg}};
    feature.values = {landmark.class_name,
                      options_detail::enum_to_name(landmark.fate),
                      number_or_null(landmark.score),
                      number_or_null(landmark.east_m),
                      number_or_null(landmark.north_m),
                      landmark.length_m,
                      landmark.learnt,
                      number_or_null(landmark.ambiguity)};
    layer.features.push_back(std::move(feature));
  }
  check_scored_landmarks_name(path);
  if (path.extension() == ".gpkg") {
    write_geopackage(path, {layer}, geopackage_timestamp(), overwrite);
  } else {
    write_geojson(path, layer, overwrite);
  }
}

}  // namespace pilotage
