#include "pilotage/raster/gdal_degrees.h"

#include <algorithm>
#include <array>
#include <memory>
#include <string>

#include <cpl_string.h>
#include <gdal_priv.h>
#include <gdal_utils.h>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/raster/gdal_handle.h"
#include "pilotage/raster/gdal_memory.h"

namespace pilotage {
namespace {

constexpr int kChannels = 4;

void fill(GDALDataset& dataset, const cv::Mat& rgba, const GdalErrors& errors) {
  dataset.GetRasterBand(kChannels)->SetColorInterpretation(GCI_AlphaBand);
  cv::Mat pixels = rgba.isContinuous() ? rgba : rgba.clone();
  if (dataset.RasterIO(GF_Write, 0, 0, pixels.cols, pixels.rows, pixels.data, pixels.cols, pixels.rows, GDT_Byte,
                       kChannels, nullptr, kChannels, GSpacing{kChannels} * pixels.cols, 1, nullptr) != CE_None) {
    errors.throw_data_error("a picture cannot be placed");
  }
}

}  // namespace

DegreePicture picture_in_degrees(const cv::Mat& rgba, const Crs& crs, const GeoTransform& map_from_pixel, int scale,
                                 int max_side_px) {
  if (rgba.empty() || rgba.type() != CV_8UC4) throw UsageError("a picture on degrees is made of CV_8UC4");
  const auto middle =
      CrsTransform(crs).geodetic_from_map(map_from_pixel.map_from_pixel({rgba.cols / 2.0, rgba.rows / 2.0}));
  if (!middle) throw DataError("the middle of a picture has no place in WGS 84");
  const GdalErrors errors;
  const DatasetPtr source = create_in_memory(rgba.size(), kChannels, GDT_Byte, crs, map_from_pixel, "a picture");
  fill(*source, rgba, errors);

  // Longitudes counted around the middle: a picture across the antimeridian stays in one piece.
  const std::string target = "+proj=longlat +datum=WGS84 +no_defs +lon_wrap=" + format_number(middle->lon_deg);
  const double factor = std::min<double>(scale, static_cast<double>(max_side_px) / std::max(rgba.cols, rgba.rows));
  CPLStringList arguments;
  for (const std::string& argument :
       {std::string("-of"), std::string("MEM"), std::string("-t_srs"), target, std::string("-r"), std::string("near"),
        std::string("-et"), std::string("0.1"), std::string("-ts"),
        std::to_string(std::max(1, static_cast<int>(rgba.cols * factor))),
        std::to_string(std::max(1, static_cast<int>(rgba.rows * factor)))}) {
    arguments.AddString(argument.c_str());
  }
  const std::unique_ptr<GDALWarpAppOptions, decltype(&GDALWarpAppOptionsFree)> options(
      GDALWarpAppOptionsNew(arguments.List(), nullptr), GDALWarpAppOptionsFree);
  GDALDatasetH handle = GDALDataset::ToHandle(source.get());
  const DatasetPtr warped(GDALDataset::FromHandle(GDALWarp("", nullptr, 1, &handle, options.get(), nullptr)));
  if (warped == nullptr || warped->GetRasterCount() != kChannels) {
    errors.throw_data_error("a picture has no place in WGS 84");
  }
  DegreePicture picture;
  picture.rgba = cv::Mat(warped->GetRasterYSize(), warped->GetRasterXSize(), CV_8UC4, cv::Scalar::all(0));
  if (warped->RasterIO(GF_Read, 0, 0, picture.rgba.cols, picture.rgba.rows, picture.rgba.data, picture.rgba.cols,
                       picture.rgba.rows, GDT_Byte, kChannels, nullptr, kChannels,
                       GSpacing{kChannels} * picture.rgba.cols, 1, nullptr) != CE_None) {
    errors.throw_data_error("a picture on degrees cannot be read");
  }
  std::array<double, 6> numbers{};
  warped->GetGeoTransform(numbers.data());
  picture.west_deg = numbers[0];
  picture.north_deg = numbers[3];
  picture.east_deg = numbers[0] + numbers[1] * picture.rgba.cols;
  picture.south_deg = numbers[3] + numbers[5] * picture.rgba.rows;
  return picture;
}

}  // namespace pilotage
