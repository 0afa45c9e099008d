#include "pilotage/route/ogr_file.h"

#include <atomic>
#include <cstdint>

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_vsi.h>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/route/read_route.h"
#include "pilotage/route/route_size.h"

namespace pilotage {
namespace {

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
      return {"KMZ", "kmz", {"LIBKML", nullptr}};
    case OgrFormat::kGpx:
      return {"GPX", "gpx", {"GPX", nullptr}};
    case OgrFormat::kGeoJson:
      return {"GeoJSON", "geojson", {"GeoJSON", nullptr}};
    case OgrFormat::kGeoPackage:
      return {"GeoPackage", "gpkg", {"GPKG", nullptr}};
  }
  return {};
}

/// The document of a KMZ archive (doc.kml, else its first .kml) as a path that GDAL opens. A small archive may unpack
/// to any size, so that is checked first.
std::string kmz_document(const std::string& name, const std::string& archive) {
  const std::string folder = "/vsizip/" + archive;
  const std::unique_ptr<char*, decltype(&CSLDestroy)> entries(VSIReadDirRecursive(folder.c_str()), CSLDestroy);
  std::string document;
  std::uint64_t total = 0;
  for (char** entry = entries.get(); entry != nullptr && *entry != nullptr; ++entry) {
    const std::string path = folder + "/" + *entry;
    VSIStatBufL status{};
    if (VSIStatL(path.c_str(), &status) == 0) total += static_cast<std::uint64_t>(status.st_size);
    if (!path.ends_with(".kml") && !path.ends_with(".KML")) continue;
    if (document.empty() || std::string_view(*entry) == "doc.kml") document = path;
  }
  if (document.empty()) throw DataError(name + ": cannot be read as KMZ: the archive holds no .kml file");
  if (total > kMaxRouteBytes) {
    throw DataError(name + ": unpacks to " + std::to_string(total) + " bytes, at most " +
                    std::to_string(kMaxRouteBytes) + " are allowed");
  }
  GByte* bytes = nullptr;
  vsi_l_offset size = 0;
  if (VSIIngestFile(nullptr, document.c_str(), &bytes, &size, static_cast<GIntBig>(kMaxRouteBytes)) != 0) {
    const std::unique_ptr<GByte, decltype(&VSIFree)> freed(bytes, VSIFree);
    check_kml_size(name, {reinterpret_cast<const char*>(bytes), static_cast<std::size_t>(size)});
  }
  return document;
}

}  // namespace

MemoryFile::MemoryFile(std::string_view bytes, const std::string& extension) {
  static std::atomic<unsigned> counter{0};
  path_ = "/vsimem/pilotage-route-" + std::to_string(counter++) + "." + extension;
  copy_.assign(bytes.begin(), bytes.end());
  VSIFCloseL(VSIFileFromMemBuffer(path_.c_str(), copy_.data(), copy_.size(), FALSE));
}

MemoryFile::~MemoryFile() {
  VSIUnlink(path_.c_str());
}

OgrFile::OgrFile(const std::string& name, std::string_view bytes, OgrFormat format)
    : name_(name), title_(format_info(format).title), file_(bytes, format_info(format).extension) {
  const std::string path = format == OgrFormat::kKmz ? kmz_document(name, file_.path()) : file_.path();
  dataset_.reset(
      GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY, format_info(format).drivers.data()));
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
