#include "pilotage/raster/gdal_imagery.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <cpl_string.h>
#include <gdal_priv.h>
#include <opencv2/core/mat.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utc_time.h"
#include "pilotage/geo/geodesic.h"
#include "pilotage/raster/block_limits.h"
#include "pilotage/raster/gdal_collar.h"
#include "pilotage/raster/gdal_control_points.h"
#include "pilotage/raster/gdal_datum.h"
#include "pilotage/raster/gdal_handle.h"
#include "pilotage/raster/gdal_licence.h"
#include "pilotage/raster/gdal_tile_folder.h"
#include "pilotage/raster/map_sigma.h"

namespace pilotage {
namespace {

constexpr std::int64_t kManyPixels = 64'000'000;  // above this, coarse grids without overviews are slow
constexpr double kScaleTolerance = 0.01;

struct Georeference {
  GeoTransform map_from_pixel;
  const OGRSpatialReference* reference = nullptr;  // owned by the dataset
  bool from_points = false;
};

GeoTransform from_gdal(const std::array<double, 6>& numbers) {
  return {numbers[0], numbers[1], numbers[2], numbers[3], numbers[4], numbers[5]};
}

bool usable(const GeoTransform& transform) {
  const double determinant = transform.determinant();
  return std::isfinite(determinant) && determinant != 0 && std::isfinite(transform.origin_x) &&
         std::isfinite(transform.origin_y);
}

Georeference find_georeference(GDALDataset& dataset, const std::string& name) {
  Georeference result;
  std::array<double, 6> numbers{};
  if (dataset.GetGeoTransform(numbers.data()) == CE_None) {
    result.map_from_pixel = from_gdal(numbers);
    result.reference = dataset.GetSpatialRef();
  } else if (dataset.GetGCPCount() > 0) {
    // Others were warped by their points before this.
    if (GDALGCPsToGeoTransform(dataset.GetGCPCount(), dataset.GetGCPs(), numbers.data(), FALSE) == 0) {
      throw DataError(name + ": its ground control points are no affine transform");
    }
    result = {from_gdal(numbers), dataset.GetGCPSpatialRef(), true};
  } else if (dataset.GetMetadata("RPC") != nullptr) {
    throw DataError(name + ": is georeferenced by RPC only; ortho-rectify it first, for instance with gdalwarp -rpc");
  } else {
    throw DataError(name + ": has no georeference (no geotransform, world file or ground control points)");
  }
  if (!usable(result.map_from_pixel)) throw DataError(name + ": its geotransform cannot be inverted");
  return result;
}

/// Metres (or degrees, as the CRS has) by which two transforms place the corners of a raster apart, at most.
double moved_by(const GeoTransform& a, const GeoTransform& b, int width_px, int height_px) {
  double moved = 0;
  for (const double col : {0.0, static_cast<double>(width_px)}) {
    for (const double row : {0.0, static_cast<double>(height_px)}) {
      moved = std::max(moved, (a.map_from_pixel({col, row}) - b.map_from_pixel({col, row})).norm());
    }
  }
  return moved;
}

/// The files beside a raster that may say where it lies, as GDAL lists them.
std::string georeference_sidecars(GDALDataset& dataset) {
  const CPLStringList files(dataset.GetFileList());
  std::vector<std::string> names;
  for (int i = 1; i < files.size(); ++i) {
    const std::string name = files[i];
    if (!name.ends_with(".msk") && !name.ends_with(".ovr")) names.push_back(name);
  }
  return names.empty() ? "a file beside it" : join(names, ", ");
}

/// Says when a file beside the raster (.aux.xml, world file) puts it elsewhere, or on another CRS, than the raster
/// itself. Formats whose driver can be told to look at nothing else (GeoTIFF, JPEG 2000) are looked at.
void warn_of_moved_place(GDALDataset& dataset, const Georeference& used, ImageryInfo& info) {
  const char* known =
      dataset.GetDriver() != nullptr ? dataset.GetDriver()->GetMetadataItem(GDAL_DMD_OPENOPTIONLIST) : nullptr;
  if (known == nullptr || std::string_view(known).find("GEOREF_SOURCES") == std::string_view::npos) return;
  const char* const open_options[] = {"GEOREF_SOURCES=INTERNAL", nullptr};
  const GdalErrors errors;
  const DatasetPtr alone(
      GDALDataset::Open(info.dataset.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, nullptr, open_options));
  std::array<double, 6> numbers{};
  if (alone == nullptr || alone->GetGeoTransform(numbers.data()) != CE_None) return;
  const double moved = moved_by(used.map_from_pixel, from_gdal(numbers), info.width_px, info.height_px);
  if (moved > 0) {
    info.warnings.push_back(info.dataset + ": " + georeference_sidecars(dataset) + " puts it up to " +
                            format_number(moved) + " units of its CRS from where the file itself lies");
  }
  const OGRSpatialReference* const own = alone->GetSpatialRef();
  if (own != nullptr && used.reference != nullptr && own->IsSame(used.reference) == 0) {
    info.warnings.push_back(info.dataset + ": " + georeference_sidecars(dataset) +
                            " gives it another CRS than the file's own \"" +
                            std::string(own->GetName() != nullptr ? own->GetName() : "") + "\"");
  }
}

Crs crs_of(const OGRSpatialReference& reference) {
  char* text = nullptr;
  const char* const options[] = {"FORMAT=WKT2_2019", nullptr};
  reference.exportToWkt(&text, options);
  const std::string wkt = text != nullptr ? text : "";
  CPLFree(text);
  return Crs::from_user_input(wkt);
}

Crs find_crs(const OGRSpatialReference* reference, const std::string& name, const std::string& stand_in,
             std::vector<std::string>& warnings) {
  if (reference == nullptr || reference->IsEmpty()) {
    if (stand_in.empty()) throw DataError(name + ": states no CRS; give --imagery-crs, for instance EPSG:32633");
    return Crs::from_user_input(stand_in);
  }
  Crs crs;
  try {
    crs = crs_of(*reference);
  } catch (const UsageError& error) {
    throw DataError(name + ": its CRS cannot be used: " + error.what());
  }
  if (!crs.is_projected() && !crs.is_geographic()) {
    throw DataError(name + ": its CRS \"" + crs.name() + "\" is neither projected nor geographic");
  }
  if (stand_in.empty()) return crs;
  const Crs given = Crs::from_user_input(stand_in);
  if (const std::string ellipsoid = ellipsoid_without_datum(crs); !ellipsoid.empty()) {
    warnings.push_back(name + ": its CRS names no datum, only the ellipsoid \"" + ellipsoid +
                       "\"; taken is the one given, " + stand_in + ", \"" + given.name() + "\"");
    return given;
  }
  if (!crs.same_as(given)) {
    warnings.push_back(name + ": states its own CRS \"" + crs.name() + "\"; the one given, " + stand_in +
                       ", is not used");
  }
  return crs;
}

std::vector<int> bands_by_color(GDALDataset& dataset) {
  std::array<int, 3> rgb{};
  std::vector<int> others;
  for (int band = 1; band <= dataset.GetRasterCount(); ++band) {
    const GDALColorInterp color = dataset.GetRasterBand(band)->GetColorInterpretation();
    if (color == GCI_AlphaBand) continue;
    others.push_back(band);
    const int place = color - GCI_RedBand;  // red, green, blue follow each other
    if (place >= 0 && place < 3 && rgb[static_cast<std::size_t>(place)] == 0)
      rgb[static_cast<std::size_t>(place)] = band;
  }
  if (rgb[0] > 0 && rgb[1] > 0 && rgb[2] > 0) return {rgb[0], rgb[1], rgb[2]};
  others.resize(others.size() >= 3 ? 3 : std::min<std::size_t>(others.size(), 1));
  return others;
}

std::vector<int> choose_bands(GDALDataset& dataset, const std::string& name, const std::vector<double>& asked) {
  const int count = dataset.GetRasterCount();
  if (asked.empty()) {
    const std::vector<int> bands = bands_by_color(dataset);
    if (bands.empty()) throw DataError(name + ": has no band of pixels");
    return bands;
  }
  if (asked.size() != 1 && asked.size() != 3) {
    throw UsageError("bands has " + std::to_string(asked.size()) + " values; give one band, or red, green and blue");
  }
  std::vector<int> bands;
  for (const double number : asked) {
    if (number != std::floor(number) || number < 1 || number > count) {
      throw UsageError("bands = " + format_number(number) + ": " + name + " has bands 1 to " + std::to_string(count));
    }
    bands.push_back(static_cast<int>(number));
  }
  return bands;
}

bool is_palette(GDALDataset& dataset, const std::vector<int>& bands) {
  GDALRasterBand* band = dataset.GetRasterBand(bands.front());
  return bands.size() == 1 && band->GetColorInterpretation() == GCI_PaletteIndex && band->GetColorTable() != nullptr;
}

bool all_of_type(GDALDataset& dataset, const std::vector<int>& bands, GDALDataType type) {
  return std::all_of(bands.begin(), bands.end(),
                     [&](int band) { return dataset.GetRasterBand(band)->GetRasterDataType() == type; });
}

MaskKind find_mask(GDALDataset& dataset, const std::vector<int>& bands, bool nodata_given) {
  for (int band = 1; band <= dataset.GetRasterCount(); ++band) {
    if (dataset.GetRasterBand(band)->GetColorInterpretation() == GCI_AlphaBand) return MaskKind::kAlpha;
  }
  if (nodata_given) return MaskKind::kNoData;
  const int flags = dataset.GetRasterBand(bands.front())->GetMaskFlags();
  if ((flags & GMF_ALL_VALID) != 0) return MaskKind::kNone;
  return (flags & GMF_NODATA) != 0 ? MaskKind::kNoData : MaskKind::kMaskBand;
}

/// "YYYY-MM-DD" from a text that starts with year, month and day, with or without separators; "" otherwise.
std::string date_of(std::string_view text) {
  std::string digits;
  for (const char c : text) {
    if (digits.size() == 8) break;
    if (c >= '0' && c <= '9') {
      digits += c;
    } else if ((c != ':' && c != '-' && c != '/') || (digits.size() != 4 && digits.size() != 6)) {
      break;
    }
  }
  if (digits.size() != 8) return "";
  const int year = std::stoi(digits.substr(0, 4));
  const int month = std::stoi(digits.substr(4, 2));
  const int day = std::stoi(digits.substr(6, 2));
  if (year < 1826 || month < 1 || month > 12 || day < 1 || day > 31) return "";
  return digits.substr(0, 4) + "-" + digits.substr(4, 2) + "-" + digits.substr(6, 2);
}

/// `date` with the time of day behind it in `text`, which counts in UTC; `date` alone where there is none, and for
/// midnight, which is written where nobody knows the hour.
std::string with_time_of_day(const std::string& date, std::string_view text) {
  std::string digits;
  for (const char c : text) {
    if (c == '.' || digits.size() == 14) break;  // fractions of a second are of no use here
    if (c >= '0' && c <= '9') digits += c;
  }
  if (digits.size() != 14) return date;
  const std::string time =
      date + "T" + digits.substr(8, 2) + ":" + digits.substr(10, 2) + ":" + digits.substr(12, 2) + "Z";
  return parse_utc_time(time) && !time.ends_with("T00:00:00Z") ? time : date;
}

/// From what tells the time of the exposure to what may tell the time of processing.
std::string find_acquisition_date(GDALDataset& dataset) {
  struct Item {
    const char* domain;
    const char* name;
    bool in_utc;  ///< By its definition; the clocks of cameras and of software keep the time of somewhere.
  };
  static constexpr std::array<Item, 10> kItems{{{"IMAGERY", "ACQUISITIONDATETIME", true},
                                                {"", "ACQUISITION_DATE", false},
                                                {"", "acquisition_start", false},
                                                {"", "DATE_ACQUIRED", false},
                                                {"", "PRODUCT_START_TIME", true},
                                                {"", "NITF_IDATIM", true},
                                                {"", "EXIF_DateTimeOriginal", false},
                                                {"EXIF", "EXIF_DateTimeOriginal", false},
                                                {"", "EXIF_DateTime", false},
                                                {"", "TIFFTAG_DATETIME", false}}};
  for (const Item& item : kItems) {
    const char* text = dataset.GetMetadataItem(item.name, item.domain);
    if (text == nullptr) continue;
    const std::string date = date_of(text);
    const bool in_utc = item.in_utc || std::string_view(text).ends_with('Z');
    if (!date.empty()) return in_utc ? with_time_of_day(date, text) : date;
  }
  return "";
}

void measure_gsd(ImageryInfo& info) {
  CrsTransform transform(info.crs);
  const Eigen::Vector2d middle(info.width_px / 2.0, info.height_px / 2.0);
  const auto at = [&](double col, double row) {
    const auto point =
        transform.geodetic_from_map(info.map_from_pixel.map_from_pixel(middle + Eigen::Vector2d(col, row)));
    if (!point) throw DataError(info.dataset + ": its centre has no longitude and latitude; is its CRS right?");
    return *point;
  };
  const double half_x = std::min(8.0, middle.x());
  const double half_y = std::min(8.0, middle.y());
  info.center = at(0, 0);
  info.gsd_x_m = geodesic_between(at(-half_x, 0), at(half_x, 0)).length_m / (2 * half_x);
  info.gsd_y_m = geodesic_between(at(0, -half_y), at(0, half_y)).length_m / (2 * half_y);
}

/// Refuses coordinates in degrees under a CRS of metres.
void refuse_degrees_as_metres(const ImageryInfo& info) {
  constexpr double kSmallestPixel_m = 1e-3;
  if (!info.crs.is_projected() || std::min(info.gsd_x_m, info.gsd_y_m) >= kSmallestPixel_m) return;
  for (const double x_share : {0.0, 1.0}) {
    for (const double y_share : {0.0, 1.0}) {
      const Eigen::Vector2d corner =
          info.map_from_pixel.map_from_pixel({info.width_px * x_share, info.height_px * y_share});
      if (std::abs(corner.x()) > 360 || std::abs(corner.y()) > 90) return;
    }
  }
  const Eigen::Vector2d center = info.map_from_pixel.map_from_pixel({info.width_px / 2.0, info.height_px / 2.0});
  ImageryInfo in_degrees = info;
  in_degrees.crs = Crs::wgs84();
  measure_gsd(in_degrees);
  throw DataError(info.dataset + ": its CRS \"" + info.crs.name() + "\" is in metres, but its coordinates (" +
                  format_fixed(center.x(), 6) + ", " + format_fixed(center.y(), 6) + " at its centre, pixels of " +
                  format_number(std::max(info.gsd_x_m, info.gsd_y_m)) +
                  " m) look like degrees; as EPSG:4326 its centre is at lon " +
                  format_fixed(in_degrees.center.lon_deg, 7) + ", lat " + format_fixed(in_degrees.center.lat_deg, 7) +
                  ", its pixels " + format_fixed(std::max(in_degrees.gsd_x_m, in_degrees.gsd_y_m), 2) +
                  " m. If that is right, say it with gdal_edit.py -a_srs EPSG:4326, or with --imagery-crs where the "
                  "file states no CRS");
}

std::string grid_text(const DatumShift& shift) {
  if (shift.missing_grid.empty()) return "";
  return "; PROJ's grid " + shift.missing_grid + ", which is not installed (projsync --file " + shift.missing_grid +
         "), " +
         (shift.accuracy_with_grid_m ? "is good to " + format_number(*shift.accuracy_with_grid_m) + " m" : "is better");
}

/// Says how well the datum is changed; refuses coordinates whose datum is not known or cannot be changed.
void judge_datum(ImageryInfo& info) {
  const std::string ellipsoid = ellipsoid_without_datum(info.crs);
  if (!ellipsoid.empty()) {
    std::vector<std::string> texts;
    for (const PossibleDatum& datum : possible_datums(ellipsoid, info.center)) {
      texts.push_back("on " + datum.name + " it lies " + format_fixed(datum.shift_m, 0) +
                      " m from where WGS 84 would have it");
    }
    throw DataError(info.dataset + ": its CRS names no datum, only the ellipsoid \"" + ellipsoid + "\"" +
                    (texts.empty() ? "" : ": " + join(texts, ", ")) +
                    "; say the CRS with --imagery-crs, or in the file with gdal_edit.py -a_srs");
  }
  const DatumShift shift = datum_shift(info.crs, info.center);
  const NearWgs84 near = shift.ballpark ? near_wgs84(info.crs) : NearWgs84::kSame;
  if (near == NearWgs84::kFar) {
    throw DataError(info.dataset + ": PROJ cannot bring \"" + info.crs.name() + "\" to WGS 84 here (" +
                    shift.operation + " changes no datum, which may be a hundred metres)" + grid_text(shift) +
                    "; install it, or re-project the raster where it is known");
  }
  constexpr double kNearDatums_m = 3;  // NAD83, ETRS89, GDA … against each other and WGS 84
  const double accuracy_m = near == NearWgs84::kNear ? kNearDatums_m : shift.accuracy_m.value_or(0);
  if (accuracy_m < kDatumAccuracySaid_m) return;
  info.datum_accuracy_m = accuracy_m;
  info.warnings.push_back(info.dataset + ": \"" + info.crs.name() + "\" is brought to WGS 84 within " +
                          format_number(accuracy_m) + " m (" + shift.operation + ")" + grid_text(shift));
}

void read_bands(GDALDataset& dataset, const ImageryOptions& options, ImageryInfo& info) {
  info.gray_bands = choose_bands(dataset, info.dataset, options.bands);
  for (int band = 1; band <= dataset.GetRasterCount(); ++band) {
    info.band_colors.emplace_back(
        GDALGetColorInterpretationName(dataset.GetRasterBand(band)->GetColorInterpretation()));
  }
  GDALRasterBand* first = dataset.GetRasterBand(info.gray_bands.front());
  info.band_type = GDALGetDataTypeName(first->GetRasterDataType());
  const char* pixel_type = first->GetMetadataItem("PIXELTYPE", "IMAGE_STRUCTURE");
  if (pixel_type != nullptr && std::string_view(pixel_type) == "SIGNEDBYTE") {
    throw DataError(info.dataset +
                    ": holds signed 8-bit values, which are not supported; convert it, for instance with "
                    "gdal_translate -ot Int16");
  }
  info.palette = is_palette(dataset, info.gray_bands);
  if (info.palette || all_of_type(dataset, info.gray_bands, GDT_Byte)) {
    info.depth = CV_8U;
  } else {
    info.depth = all_of_type(dataset, info.gray_bands, GDT_UInt16) ? CV_16U : CV_64F;
  }
  const char* white = dataset.GetMetadataItem("MINISWHITE", "IMAGE_STRUCTURE");
  info.min_is_white = white != nullptr && std::string_view(white) == "YES" && info.gray_bands.size() == 1 &&
                      !info.palette && info.depth != CV_64F;
  info.mask = find_mask(dataset, info.gray_bands, options.nodata.has_value());
  info.overviews = first->GetOverviewCount();
  first->GetBlockSize(&info.block_width_px, &info.block_height_px);
  check_blocks(info, GDALGetDataTypeSizeBytes(first->GetRasterDataType()));
  info.scale = first->GetScale();
  info.offset = first->GetOffset();
  info.unit = first->GetUnitType();
}

void add_warnings(GDALDataset& dataset, bool from_points, ImageryInfo& info) {
  const auto warn = [&](const std::string& text) { info.warnings.push_back(info.dataset + ": " + text); };
  if (from_points) warn("its place comes from ground control points, which one affine transform fits");
  if (info.control_points) {
    const ControlPointFit& fit = *info.control_points;
    warn("its place comes from " + std::to_string(fit.points) + " ground control points, by a polynomial of order " +
         std::to_string(fit.order) + ": left out of the fit, they miss their places by " + format_fixed(fit.rms_m, 2) +
         " m (rms), at most " + format_fixed(fit.largest_m, 2) + " m");
  }
  if (GDALDataTypeIsComplex(dataset.GetRasterBand(info.gray_bands.front())->GetRasterDataType()) != 0) {
    warn("holds complex values; gray is their magnitude");
  }
  if (std::abs(info.gsd_x_m / info.gsd_y_m - 1) > kScaleTolerance) {
    warn("its pixels are not square on the ground: " + format_fixed(info.gsd_x_m, 4) + " m × " +
         format_fixed(info.gsd_y_m, 4) + " m");
  }
  if (info.overviews == 0 && std::int64_t{info.width_px} * info.height_px > kManyPixels) {
    warn("has no overviews; reading it on a coarser grid is slow (gdaladdo makes them)");
  }
}

/// The raster that a tag names lies beside the dataset's own file, whatever it was opened by.
std::string map_sigma_beside(GDALDataset& opened, const std::string& dataset, const std::string& name) {
  const CPLStringList files(opened.GetFileList());
  const std::string file = files.Count() > 0 ? files[0] : dataset;
  return (std::filesystem::path(file).parent_path() / std::filesystem::path(name).filename()).string();
}

ImageryInfo start_info(GDALDataset& opened, const std::string& dataset) {
  ImageryInfo info;
  info.dataset = dataset;
  info.driver = opened.GetDriverName();
  info.width_px = opened.GetRasterXSize();
  info.height_px = opened.GetRasterYSize();
  if (opened.GetRasterCount() == 0) {
    const char* first = opened.GetMetadataItem("SUBDATASET_1_NAME", "SUBDATASETS");
    throw DataError(dataset + ": has no band of pixels" +
                    (first != nullptr ? "; it holds several rasters, the first is " + std::string(first) : ""));
  }
  return info;
}

}  // namespace

ImageryOptions second_date_options(const ImageryOptions& reference) {
  ImageryOptions options;
  options.collar = reference.collar;
  return options;
}

ImageryInfo inspect_picture(const std::string& dataset) {
  const DatasetPtr opened = open_raster(dataset);
  const GdalErrors errors;
  ImageryInfo info = start_info(*opened, dataset);
  read_bands(*opened, {}, info);
  info.acquired = find_acquisition_date(*opened);
  errors.require_whole(dataset);
  return info;
}

ImageryInfo inspect_imagery(const std::string& dataset, const ImageryOptions& options, const Progress& progress) {
  check_options(options);
  const DatasetPtr file = open_raster(dataset);
  const GdalErrors errors;
  ImageryInfo info = start_info(*file, dataset);
  if (is_tile_folder(dataset)) info.warnings = tile_folder_warnings(dataset);
  info.control_points = fit_control_points(*file, dataset, options.imagery_crs);
  const DatasetPtr placed =
      info.control_points ? place_by_control_points(*file, dataset, *info.control_points) : nullptr;
  GDALDataset* const opened = placed != nullptr ? placed.get() : file.get();
  info.width_px = opened->GetRasterXSize();
  info.height_px = opened->GetRasterYSize();
  const Georeference georeference = find_georeference(*opened, dataset);
  info.map_from_pixel = georeference.map_from_pixel;
  if (!georeference.from_points) warn_of_moved_place(*opened, georeference, info);
  info.crs = find_crs(georeference.reference, dataset, options.imagery_crs, info.warnings);
  read_bands(*opened, options, info);
  info.acquired = find_acquisition_date(*file);
  info.licence = find_licence(*file);
  const char* map_sigma = file->GetMetadataItem(kMapSigmaTag);
  if (map_sigma != nullptr) info.map_sigma = map_sigma_beside(*file, dataset, map_sigma);
  errors.require_whole(dataset);
  try {
    measure_gsd(info);
  } catch (const DataError& error) {
    const std::string message = error.what();
    throw DataError(message.starts_with(dataset) ? message : dataset + ": " + message);
  }
  refuse_degrees_as_metres(info);
  judge_datum(info);
  add_warnings(*opened, georeference.from_points, info);
  if (info.mask == MaskKind::kNone && options.collar == CollarRule::kMask) {
    const CollarFinding found = find_collar(info, options, progress);
    info.collar = found.collar;
    if (!found.warning.empty()) info.warnings.push_back(found.warning);
  }
  return info;
}

bool looks_like_heights(const ImageryInfo& info) {
  return info.gray_bands.size() == 1 && (info.band_type == "Float32" || info.band_type == "Float64" ||
                                         info.band_type == "Int16" || info.band_type == "Int32");
}

double placement_rms_m(const ImageryInfo& info) {
  return std::hypot(info.control_points ? info.control_points->rms_m : 0, info.datum_accuracy_m);
}

Bounds imagery_bounds(const ImageryInfo& info, const Crs& crs) {
  constexpr int kSteps = 64;  // per edge; the bulge between two steps of a curved edge is below 1/16,000 of its own
  const CrsTransform from(info.crs);
  const CrsTransform to(crs);
  const bool same = info.crs.same_as(crs);
  Bounds bounds;
  const auto add = [&](double x_share, double y_share) {
    const Eigen::Vector2d pixel(info.width_px * x_share, info.height_px * y_share);
    const Eigen::Vector2d map = info.map_from_pixel.map_from_pixel(pixel);
    if (same) return bounds.extend(map);
    const auto geodetic = from.geodetic_from_map(map);
    const auto point = geodetic ? to.map_from_geodetic(*geodetic) : std::nullopt;
    if (point) bounds.extend(*point);
  };
  for (int i = 0; i <= kSteps; ++i) {
    const double share = static_cast<double>(i) / kSteps;
    add(share, 0);
    add(share, 1);
    add(0, share);
    add(1, share);
  }
  return bounds;
}

Bounds imagery_bounds(const std::vector<ImageryInfo>& infos, const Crs& crs) {
  Bounds bounds;
  for (const ImageryInfo& info : infos) {
    const Bounds one = imagery_bounds(info, crs);
    if (one.empty()) continue;
    bounds.extend({one.min_x_m, one.min_y_m});
    bounds.extend({one.max_x_m, one.max_y_m});
  }
  return bounds;
}

std::vector<std::string> imagery_warnings(const std::vector<ImageryInfo>& infos, double camera_gsd_m) {
  std::vector<std::string> warnings;
  for (const ImageryInfo& info : infos) {
    warnings.insert(warnings.end(), info.warnings.begin(), info.warnings.end());
    const double gsd_m = std::max(info.gsd_x_m, info.gsd_y_m);
    if (camera_gsd_m > 0 && gsd_m > camera_gsd_m * (1 + kScaleTolerance)) {
      warnings.push_back(info.dataset + ": its pixels (" + format_fixed(gsd_m, 3) +
                         " m) are coarser than the camera could use (" + format_fixed(camera_gsd_m, 3) +
                         " m); the map is limited by the imagery");
    }
    const ImageryInfo& first = infos.front();
    const double ratio = std::sqrt(info.gsd_x_m * info.gsd_y_m / (first.gsd_x_m * first.gsd_y_m));
    if (std::max(ratio, 1 / ratio) > 1 + kScaleTolerance) {
      warnings.push_back(info.dataset + ": its ground sample distance is " + format_fixed(ratio, 4) +
                         " times that of " + first.dataset + " (more than 1 % apart)");
    }
    if (info.depth != first.depth) {
      warnings.push_back(info.dataset + ": holds " + info.band_type + " values, " + first.dataset + " " +
                         first.band_type + "; their gray values may not be comparable");
    }
  }
  return warnings;
}

}  // namespace pilotage
