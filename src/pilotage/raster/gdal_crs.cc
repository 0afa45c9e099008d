#include "pilotage/raster/gdal_crs.h"

#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include <cpl_conv.h>
#include <ogr_spatialref.h>

#include "pilotage/base/error.h"
#include "pilotage/raster/gdal_handle.h"

namespace pilotage {
namespace {

OGRSpatialReference reference_from(const std::string& text) {
  OGRSpatialReference reference;
  // Neither files nor addresses: the text may come out of a mission that someone else wrote.
  if (text.empty() || reference.SetFromUserInput(
                          text.c_str(), OGRSpatialReference::SET_FROM_USER_INPUT_LIMITATIONS_get()) != OGRERR_NONE) {
    throw UsageError("\"" + text +
                     "\" is not a CRS that PROJ knows; give a code such as EPSG:32633, WKT or a PROJ string");
  }
  reference.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return reference;
}

OGRSpatialReference reference_of(const Crs& crs) {
  if (crs.empty()) throw UsageError("no CRS is given");
  return reference_from(crs.wkt());
}

OGRSpatialReference horizontal_reference_of(const Crs& crs) {
  OGRSpatialReference reference = reference_of(crs);
  if (reference.IsCompound()) reference.StripVertical();
  reference.DemoteTo2D(nullptr);
  return reference;
}

std::string export_wkt(const OGRSpatialReference& reference, const char* format) {
  char* text = nullptr;
  const std::string option = std::string("FORMAT=") + format;
  const char* const options[] = {option.c_str(), nullptr};
  const bool ok = reference.exportToWkt(&text, options) == OGRERR_NONE;
  std::string result = ok && text != nullptr ? text : "";
  CPLFree(text);
  return result;
}

/// Whether `wkt` still says what `reference` says.
bool says_the_same(const std::string& wkt, const OGRSpatialReference& reference) {
  OGRSpatialReference again;
  if (wkt.empty() || again.SetFromUserInput(wkt.c_str()) != OGRERR_NONE) return false;
  const char* const options[] = {"IGNORE_DATA_AXIS_TO_SRS_AXIS_MAPPING=YES",
                                 "CRITERION=EQUIVALENT_EXCEPT_AXIS_ORDER_GEOGCRS", nullptr};
  return again.IsSame(&reference, options) != 0;
}

using TransformPtr = std::unique_ptr<OGRCoordinateTransformation>;

TransformPtr make_transform(const OGRSpatialReference& from, const OGRSpatialReference& to,
                            const OGRCoordinateTransformationOptions& options = {}) {
  return TransformPtr(OGRCreateCoordinateTransformation(&from, &to, options));
}

bool transform_point(OGRCoordinateTransformation& transform, double& x, double& y, double& z) {
  const GdalErrors errors;
  int success = 0;
  const bool ok = transform.Transform(1, &x, &y, &z, &success) != 0 && success != 0;
  return ok && std::isfinite(x) && std::isfinite(y) && std::isfinite(z);
}

}  // namespace

Crs Crs::from_user_input(const std::string& text) {
  const GdalErrors errors;
  const OGRSpatialReference reference = reference_from(text);
  Crs crs;
  crs.wkt_ = export_wkt(reference, "WKT1_GDAL");
  if (!says_the_same(crs.wkt_, reference)) crs.wkt_ = export_wkt(reference, "WKT2_2019");
  if (crs.wkt_.empty()) throw UsageError("\"" + text + "\" cannot be written as WKT");
  return crs;
}

Crs Crs::wgs84() {
  return from_user_input("EPSG:4326");
}

std::string Crs::name() const {
  const GdalErrors errors;
  const OGRSpatialReference reference = reference_of(*this);
  const char* name = reference.GetName();
  return name != nullptr ? name : "";
}

std::string Crs::authority() const {
  const GdalErrors errors;
  const OGRSpatialReference reference = reference_of(*this);
  const char* authority = reference.GetAuthorityName(nullptr);
  const char* code = reference.GetAuthorityCode(nullptr);
  if (authority == nullptr || code == nullptr) return "";
  return std::string(authority) + ":" + code;
}

bool Crs::is_projected() const {
  const GdalErrors errors;
  return reference_of(*this).IsProjected() != 0;
}

bool Crs::is_geographic() const {
  const GdalErrors errors;
  return reference_of(*this).IsGeographic() != 0;
}

bool Crs::has_height() const {
  const GdalErrors errors;
  const OGRSpatialReference reference = reference_of(*this);
  return reference.IsCompound() != 0 || reference.GetAxesCount() == 3;
}

double Crs::metres_per_unit() const {
  const GdalErrors errors;
  const OGRSpatialReference reference = reference_of(*this);
  return reference.IsProjected() ? reference.GetLinearUnits() : std::numeric_limits<double>::quiet_NaN();
}

bool Crs::same_as(const Crs& other) const {
  if (wkt_ == other.wkt_) return true;
  if (empty() || other.empty()) return false;
  const GdalErrors errors;
  const OGRSpatialReference a = reference_of(*this);
  const OGRSpatialReference b = reference_of(other);
  const char* const options[] = {"IGNORE_DATA_AXIS_TO_SRS_AXIS_MAPPING=YES",
                                 "CRITERION=EQUIVALENT_EXCEPT_AXIS_ORDER_GEOGCRS", nullptr};
  return a.IsSame(&b, options) != 0;
}

struct CrsTransform::Impl {
  TransformPtr map_from_geodetic;
  TransformPtr geodetic_from_map;
};

CrsTransform::CrsTransform(const Crs& crs) : impl_(std::make_unique<Impl>()) {
  // PROJ searches its database for some 20 ms; copies of what it finds cost next to nothing. Never destroyed, because
  // PROJ may be gone when statics are.
  static std::mutex mutex;
  static auto& found = *new std::map<std::string, Impl>;
  const std::lock_guard lock(mutex);
  const GdalErrors errors;
  auto known = found.find(crs.wkt());
  if (known == found.end()) {
    const OGRSpatialReference map = horizontal_reference_of(crs);
    const OGRSpatialReference geodetic = reference_from("EPSG:4326");
    Impl made{make_transform(geodetic, map), make_transform(map, geodetic)};
    if (made.map_from_geodetic == nullptr || made.geodetic_from_map == nullptr) {
      errors.throw_data_error("no transformation between WGS 84 and \"" + crs.name() + "\"");
    }
    known = found.emplace(crs.wkt(), std::move(made)).first;
  }
  *impl_ = {TransformPtr(known->second.map_from_geodetic->Clone()),
            TransformPtr(known->second.geodetic_from_map->Clone())};
}

CrsTransform::~CrsTransform() = default;
CrsTransform::CrsTransform(CrsTransform&&) noexcept = default;
CrsTransform& CrsTransform::operator=(CrsTransform&&) noexcept = default;

std::optional<Eigen::Vector2d> CrsTransform::map_from_geodetic(GeodeticPoint point) const {
  double x = point.lon_deg;
  double y = point.lat_deg;
  double z = 0;
  if (!std::isfinite(x) || !(std::abs(y) <= 90) || !transform_point(*impl_->map_from_geodetic, x, y, z)) {
    return std::nullopt;
  }
  return Eigen::Vector2d(x, y);
}

std::optional<GeodeticPoint> CrsTransform::geodetic_from_map(const Eigen::Vector2d& point) const {
  double x = point.x();
  double y = point.y();
  double z = 0;
  if (!point.allFinite() || !transform_point(*impl_->geodetic_from_map, x, y, z) || std::abs(y) > 90)
    return std::nullopt;
  return GeodeticPoint{wrap_lon_deg(x), y};
}

struct HeightTransform::Impl {
  TransformPtr amsl_from_map;
};

HeightTransform::HeightTransform(const Crs& crs) : impl_(std::make_unique<Impl>()) {
  const GdalErrors errors;
  const OGRSpatialReference map = reference_of(crs);
  const OGRSpatialReference amsl = reference_from("EPSG:4326+5773");
  OGRCoordinateTransformationOptions options;
  options.SetBallparkAllowed(false);
  impl_->amsl_from_map = make_transform(map, amsl, options);
  if (impl_->amsl_from_map == nullptr) {
    errors.throw_data_error("no transformation of the heights of \"" + crs.name() + "\" to EGM96");
  }
}

HeightTransform::~HeightTransform() = default;
HeightTransform::HeightTransform(HeightTransform&&) noexcept = default;
HeightTransform& HeightTransform::operator=(HeightTransform&&) noexcept = default;

std::optional<double> HeightTransform::amsl_m(const Eigen::Vector2d& point, double height) const {
  double x = point.x();
  double y = point.y();
  double z = height;
  if (!point.allFinite() || !std::isfinite(z) || !transform_point(*impl_->amsl_from_map, x, y, z)) return std::nullopt;
  return z;
}

}  // namespace pilotage
