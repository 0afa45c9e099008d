#include "pilotage/route/ogr_file.h"

#include <cpl_error.h>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/raster/gdal_sqlite.h"

namespace pilotage {
namespace {

std::string_view checked(const std::string& name, std::string_view bytes, OgrFormat format) {
  if (format == OgrFormat::kGeoPackage) check_sqlite_vectors(name, bytes);
  return bytes;
}

/// What gpkg_contents does not name is no layer.
const char* const* open_options(OgrFormat format) {
  static constexpr const char* kContentsAlone[] = {"LIST_ALL_TABLES=NO", nullptr};
  return format == OgrFormat::kGeoPackage ? kContentsAlone : nullptr;
}

struct FormatInfo {
  const char* title;
  const char* extension;
  std::vector<const char*> drivers;
};

FormatInfo format_info(OgrFormat format) {
  switch (format) {
    case OgrFormat::kKml:
      return {"KML", "kml", {"LIBKML", "KML", nullptr}};
    case OgrFormat::kKmz:
      return {"KMZ", "kml", {"LIBKML", "KML", nullptr}};
    case OgrFormat::kGpx:
      return {"GPX", "gpx", {"GPX", nullptr}};
    case OgrFormat::kGeoJson:
      return {"GeoJSON", "geojson", {"GeoJSON", nullptr}};
    case OgrFormat::kGeoPackage:
      return {"GeoPackage", "gpkg", {"GPKG", nullptr}};
    case OgrFormat::kOsmXml:
      return {"OpenStreetMap XML", "osm", {"OSM", nullptr}};
    case OgrFormat::kOsmPbf:
      return {"OpenStreetMap PBF", "osm.pbf", {"OSM", nullptr}};
  }
  return {};
}

bool is_kml_format(OgrFormat format) {
  return format == OgrFormat::kKml || format == OgrFormat::kKmz;
}

}  // namespace

OgrFile::OgrFile(const std::string& name, std::string_view bytes, OgrFormat format)
    : name_(name),
      title_(format_info(format).title),
      tracks_(is_kml_format(format) ? kml_tracks(name, bytes) : std::vector<KmlTrack>{}),
      file_(checked(name, bytes, format), format_info(format).extension),
      dataset_(GDALDataset::Open(file_.path().c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY,
                                 format_info(format).drivers.data(), open_options(format))) {
  if (!dataset_) errors_.throw_data_error(name + ": cannot be read as " + title_);
  CPLErrorReset();
}

void OgrFile::check_whole() const {
  if (CPLGetLastErrorType() >= CE_Failure) throw DataError(name_ + ": is damaged: " + CPLGetLastErrorMsg());
}

ToWgs84::ToWgs84(OGRLayer& layer, const std::string& where) : where_(where) {
  const OGRSpatialReference* crs = layer.GetSpatialRef();
  if (crs == nullptr) return;
  OGRSpatialReference wgs84;
  wgs84.SetWellKnownGeogCS("WGS84");
  wgs84.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  std::unique_ptr<OGRSpatialReference> source(crs->Clone());
  source->StripVertical();
  source->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  if (source->IsSame(&wgs84) != 0) return;
  transform_.reset(OGRCreateCoordinateTransformation(source.get(), &wgs84));
  if (!transform_) throw DataError(where_ + ": its coordinate reference system cannot be brought to WGS 84");
}

void ToWgs84::apply(std::vector<LinePoint>& points) const {
  if (!transform_) return;
  for (LinePoint& point : points) {
    const double x = point.x;
    const double y = point.y;
    if (transform_->Transform(1, &point.x, &point.y) == FALSE) {
      throw DataError(where_ + ": the point " + format_number(x) + ", " + format_number(y) +
                      " cannot be brought to WGS 84");
    }
  }
}

}  // namespace pilotage
