#include "pilotage/raster/gdal_control_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gdal_alg.h>
#include <gdal_priv.h>
#include <gdal_utils.h>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/geo/geodesic.h"

namespace pilotage {
namespace {

constexpr int kFewestPoints = 4;  // three place a plane, the fourth says how well
constexpr int kMostFits = 20;
constexpr double kMostMissed_px = 5;

struct Polynomial {
  void operator()(void* transformer) const { GDALDestroyGCPTransformer(transformer); }
};
using PolynomialPtr = std::unique_ptr<void, Polynomial>;

/// How far the places of points, in the CRS, lie from where the polynomial of the other points puts them: metres.
std::vector<double> missed_m(const std::vector<GDAL_GCP>& points, int order, const CrsTransform& crs) {
  const int fits = std::min(kMostFits, static_cast<int>(points.size()));
  std::vector<double> missed;
  for (int fit = 0; fit < fits; ++fit) {
    std::vector<GDAL_GCP> others;
    std::vector<GDAL_GCP> left_out;
    for (std::size_t i = 0; i < points.size(); ++i) {
      (static_cast<int>(i % static_cast<std::size_t>(fits)) == fit ? left_out : others).push_back(points[i]);
    }
    const GdalErrors errors;
    const PolynomialPtr polynomial(
        GDALCreateGCPTransformer(static_cast<int>(others.size()), others.data(), order, FALSE));
    if (polynomial == nullptr) return {};  // too few points of it, or points in a line
    for (const GDAL_GCP& point : left_out) {
      double x = point.dfGCPPixel;
      double y = point.dfGCPLine;
      double z = 0;
      int success = 0;
      GDALGCPTransform(polynomial.get(), FALSE, 1, &x, &y, &z, &success);
      const auto put = crs.geodetic_from_map({x, y});
      const auto stated = crs.geodetic_from_map({point.dfGCPX, point.dfGCPY});
      if (success == 0 || !put || !stated) return {};
      missed.push_back(geodesic_between(*put, *stated).length_m);
    }
  }
  return missed;
}

double rms(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

/// Metres between neighbouring pixels, by the two points that lie farthest apart in the picture.
double pixel_m(const std::vector<GDAL_GCP>& points, const CrsTransform& crs) {
  double farthest_px = 0;
  double length_m = 0;
  for (const GDAL_GCP& point : points) {
    const double apart_px =
        std::hypot(point.dfGCPPixel - points.front().dfGCPPixel, point.dfGCPLine - points.front().dfGCPLine);
    const auto a = crs.geodetic_from_map({points.front().dfGCPX, points.front().dfGCPY});
    const auto b = crs.geodetic_from_map({point.dfGCPX, point.dfGCPY});
    if (apart_px <= farthest_px || !a || !b) continue;
    farthest_px = apart_px;
    length_m = geodesic_between(*a, *b).length_m;
  }
  return farthest_px > 0 ? length_m / farthest_px : 0;
}

Crs crs_of_points(GDALDataset& dataset, const std::string& name, const std::string& stand_in) {
  const OGRSpatialReference* const reference = dataset.GetGCPSpatialRef();
  if (reference == nullptr || reference->IsEmpty()) {
    if (stand_in.empty()) {
      throw DataError(name + ": its ground control points state no CRS; give --imagery-crs, for instance EPSG:32633");
    }
    return Crs::from_user_input(stand_in);
  }
  char* text = nullptr;
  const char* const options[] = {"FORMAT=WKT2_2019", nullptr};
  reference->exportToWkt(&text, options);
  const std::string wkt = text != nullptr ? text : "";
  CPLFree(text);
  try {
    return Crs::from_user_input(wkt);
  } catch (const UsageError& error) {
    throw DataError(name + ": the CRS of its ground control points cannot be used: " + error.what());
  }
}

}  // namespace

std::optional<ControlPointFit> fit_control_points(GDALDataset& dataset, const std::string& name,
                                                  const std::string& stand_in) {
  std::array<double, 6> numbers{};
  const int count = dataset.GetGCPCount();
  if (count == 0 || dataset.GetGeoTransform(numbers.data()) == CE_None) return std::nullopt;
  if (GDALGCPsToGeoTransform(count, dataset.GetGCPs(), numbers.data(), FALSE) != 0) return std::nullopt;
  const std::string points_text = name + ": has " + std::to_string(count) + " ground control points";
  if (count < kFewestPoints) {
    throw DataError(points_text + ", which no affine transform fits; at least " + std::to_string(kFewestPoints) +
                    " are needed to place it and to know how well");
  }
  const std::vector<GDAL_GCP> points(dataset.GetGCPs(), dataset.GetGCPs() + count);
  ControlPointFit fit;
  fit.points = count;
  fit.crs = crs_of_points(dataset, name, stand_in);
  const CrsTransform transform(fit.crs);
  for (const int order : {1, 2}) {
    const std::vector<double> missed = missed_m(points, order, transform);
    if (missed.empty() || (fit.order > 0 && rms(missed) >= fit.rms_m)) continue;
    fit.order = order;
    fit.rms_m = rms(missed);
    fit.largest_m = *std::max_element(missed.begin(), missed.end());
  }
  if (fit.order == 0) {
    throw DataError(points_text + " that do not place it: they lie in a line, or too few stand in different places");
  }
  const double most_m = kMostMissed_px * pixel_m(points, transform);
  if (fit.rms_m > most_m) {
    throw DataError(points_text + "; left out of the fit, they miss their places by " + format_fixed(fit.rms_m, 1) +
                    " m (rms) and at most " + format_fixed(fit.largest_m, 1) + " m, more than " +
                    format_fixed(kMostMissed_px, 0) + " of its pixels (" + format_fixed(most_m, 1) +
                    " m). Look for points that are wrong; or, where the ground is hilly, ortho-rectify it first");
  }
  return fit;
}

DatasetPtr place_by_control_points(GDALDataset& dataset, const std::string& name, const ControlPointFit& fit) {
  const GdalErrors errors;
  const bool picture = dataset.GetRasterBand(1)->GetColorTable() == nullptr &&
                       GDALDataTypeIsComplex(dataset.GetRasterBand(1)->GetRasterDataType()) == 0;
  std::vector<std::string> texts{"-of", "VRT", "-dstalpha", "-order", std::to_string(fit.order), "-et", "0.05", "-ovr",
                                 "NONE", "-s_srs", fit.crs.wkt(), "-t_srs", fit.crs.wkt(), "-r",
                                 // Neither numbers of colours nor phases can be averaged.
                                 picture ? "cubic" : "near"};
  std::vector<char*> arguments;
  for (std::string& text : texts) arguments.push_back(text.data());
  arguments.push_back(nullptr);
  const std::unique_ptr<GDALWarpAppOptions, decltype(&GDALWarpAppOptionsFree)> options(
      GDALWarpAppOptionsNew(arguments.data(), nullptr), GDALWarpAppOptionsFree);
  GDALDatasetH source = GDALDataset::ToHandle(&dataset);
  DatasetPtr placed(options == nullptr
                        ? nullptr
                        : GDALDataset::FromHandle(GDALWarp("", nullptr, 1, &source, options.get(), nullptr)));
  if (placed == nullptr) errors.throw_data_error(name + ": cannot be placed by its ground control points");
  return placed;
}

}  // namespace pilotage
