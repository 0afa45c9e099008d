#include "pilotage/raster/gdal_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gdal_priv.h>
#include <gdal_utils.h>
#include <gdal_vrt.h>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"
#include "pilotage/raster/gdal_collar.h"
#include "pilotage/raster/gdal_control_points.h"

namespace pilotage {
namespace {

GDALDataType gdal_type(int depth) {
  return depth == CV_8U ? GDT_Byte : depth == CV_16U ? GDT_UInt16 : GDT_Float64;
}

/// The arguments of a GDAL utility as it wants them.
class Arguments {
 public:
  explicit Arguments(std::vector<std::string> texts) : texts_(std::move(texts)) {
    for (std::string& text : texts_) pointers_.push_back(text.data());
    pointers_.push_back(nullptr);
  }
  char** get() { return pointers_.data(); }

 private:
  std::vector<std::string> texts_;
  std::vector<char*> pointers_;
};

const char* utility_name(Resampling resampling) {
  switch (resampling) {
    case Resampling::kNearest:
      return "near";
    case Resampling::kBilinear:
      return "bilinear";
    case Resampling::kAverage:
      return "average";
    default:
      return "cubic";
  }
}

/// Where the raster is warped to.
std::vector<std::string> grid_arguments(const TargetGrid& grid) {
  const Eigen::Vector2d top_left = grid.map_from_pixel.map_from_pixel({0, 0});
  const Eigen::Vector2d bottom_right =
      grid.map_from_pixel.map_from_pixel({static_cast<double>(grid.width_px), static_cast<double>(grid.height_px)});
  return {"-of",
          "VRT",
          "-t_srs",
          grid.crs.wkt(),
          "-te",
          format_number(top_left.x()),
          format_number(bottom_right.y()),
          format_number(bottom_right.x()),
          format_number(top_left.y()),
          "-ts",
          std::to_string(grid.width_px),
          std::to_string(grid.height_px),
          "-et",
          "0.05"};
}

/// Interpolating kernels keep their own width up to this many of the imagery's pixels in a grid pixel. GDAL measures
/// the ratio block by block and widens them where it finds more than 1/0.95, which costs two and a half times the time
/// and makes blocks on either side of that ratio differ; docs/methods/imagery.md.
constexpr double kNotWidenedUpTo = 1.1;

/// How many of the imagery's pixels the middle pixel of the grid is wide or high, whichever is more; NaN where it has
/// no place in the imagery's CRS.
double imagery_pixels_per_grid_pixel(const ImageryInfo& info, const TargetGrid& grid) {
  const CrsTransform from_grid(grid.crs);
  const CrsTransform to_imagery(info.crs);
  const Eigen::Vector2d middle(static_cast<double>(grid.width_px) / 2, static_cast<double>(grid.height_px) / 2);
  const auto at = [&](double col, double row) -> Eigen::Vector2d {
    const auto point =
        from_grid.geodetic_from_map(grid.map_from_pixel.map_from_pixel(middle + Eigen::Vector2d(col, row)));
    const auto map = point ? to_imagery.map_from_geodetic(*point) : std::nullopt;
    return map ? info.map_from_pixel.pixel_from_map(*map) : Eigen::Vector2d::Constant(kNaN);
  };
  const double width = (at(0.5, 0) - at(-0.5, 0)).norm();
  const double height = (at(0, 0.5) - at(0, -0.5)).norm();
  return std::isnan(width) ? width : std::max(height, width);
}

std::vector<std::string> warp_arguments(const ImageryInfo& info, const TargetGrid& grid, Resampling resampling) {
  std::vector<std::string> arguments = grid_arguments(grid);
  // Overviews have mixed what is a collar into the ground beside it.
  const char* const overviews = info.collar == nullptr ? "AUTO" : "NONE";
  // The same rule as RasterView::read_valid: YES = all bands hold the no-data value, PARTIAL = any does.
  const char* const no_data = info.depth == CV_8U ? "UNIFIED_SRC_NODATA=YES" : "UNIFIED_SRC_NODATA=PARTIAL";
  arguments.insert(arguments.end(), {"-dstalpha", "-ovr", overviews, "-r", utility_name(resampling), "-wo", no_data});
  const bool interpolates = resampling == Resampling::kCubic || resampling == Resampling::kBilinear;
  if (interpolates && imagery_pixels_per_grid_pixel(info, grid) <= kNotWidenedUpTo) {
    arguments.insert(arguments.end(), {"-wo", "XSCALE=1", "-wo", "YSCALE=1"});
  }
  return arguments;
}

}  // namespace

RasterView::RasterView(const ImageryInfo& info, const ImageryOptions& options)
    : RasterView(info, options, For::kReading) {}

RasterView::RasterView(const ImageryInfo& info, const ImageryOptions& options, For purpose)
    : info_(info), channels_(info.palette ? 3 : static_cast<int>(info.gray_bands.size())) {
  stack_.push_back(open_raster(info.dataset));
  const GdalErrors errors;
  if (info.control_points) stack_.push_back(place_by_control_points(top(), info.dataset, *info.control_points));
  if (top().GetRasterXSize() != info.width_px || top().GetRasterYSize() != info.height_px) {
    throw DataError(info.dataset + ": has changed while it was read");
  }
  if (info.palette) {
    expand_palette(options);
  } else if (GDALDataTypeIsComplex(top().GetRasterBand(info.gray_bands.front())->GetRasterDataType()) != 0) {
    take_magnitude();
  } else if (purpose == For::kReading && !options.nodata) {
    take_file_bands();
  } else {
    select_bands(options);
  }
  if (purpose == For::kReading) return;
  if (info.collar != nullptr) add_collar_alpha();
  const GeoTransform& place = info.map_from_pixel;
  std::array<double, 6> numbers{place.origin_x, place.x_per_col, place.x_per_row,
                                place.origin_y, place.y_per_col, place.y_per_row};
  top().SetGeoTransform(numbers.data());
  top().SetProjection(info.crs.wkt().c_str());
}

RasterView::RasterView(const ImageryInfo& info, const ImageryOptions& options, const TargetGrid& grid,
                       Resampling resampling)
    : RasterView(info, options, For::kWarping) {
  if (info.mask == MaskKind::kMaskBand && info.overviews > 0) warp_whole_mask(grid, resampling);
  stack_.push_back(warp(top(), warp_arguments(info, grid, resampling)));
  alpha_band_ = channels_ + 1;
  warped_ = true;
}

DatasetPtr RasterView::warp(GDALDataset& from, const std::vector<std::string>& arguments) const {
  const GdalErrors errors;
  Arguments list(arguments);
  const std::unique_ptr<GDALWarpAppOptions, decltype(&GDALWarpAppOptionsFree)> options(
      GDALWarpAppOptionsNew(list.get(), nullptr), GDALWarpAppOptionsFree);
  GDALDatasetH source = GDALDataset::ToHandle(&from);
  DatasetPtr warped(options == nullptr
                        ? nullptr
                        : GDALDataset::FromHandle(GDALWarp("", nullptr, 1, &source, options.get(), nullptr)));
  if (warped == nullptr) fail(errors, "cannot be warped onto the mission grid");
  return warped;
}

/// Overviews hold masks that were made coarser as pictures are, and so end elsewhere: what is valid, the mask at full
/// resolution says as well. One band of it costs little beside the pixels.
void RasterView::warp_whole_mask(const TargetGrid& grid, Resampling resampling) {
  mask_stack_.push_back(translated(top(), {"-of", "VRT", "-b", "mask"}));
  std::vector<std::string> arguments = grid_arguments(grid);
  // Averaging takes a pixel for valid when anything under it is.
  const char* const kernel = resampling == Resampling::kAverage ? "max" : "near";
  arguments.insert(arguments.end(), {"-ovr", "NONE", "-r", kernel});
  mask_stack_.push_back(warp(*mask_stack_.back(), arguments));
}

RasterView::~RasterView() {
  while (!mask_stack_.empty()) mask_stack_.pop_back();
  while (!stack_.empty()) stack_.pop_back();  // what was made last refers to what was made first
}

void RasterView::fail(const GdalErrors& errors, const char* what) const {
  errors.throw_data_error(info_.dataset + ": " + what);
}

void RasterView::translate(const std::vector<std::string>& arguments) {
  stack_.push_back(translated(top(), arguments));
}

DatasetPtr RasterView::translated(GDALDataset& from, const std::vector<std::string>& arguments) const {
  const GdalErrors errors;
  Arguments list(arguments);
  const std::unique_ptr<GDALTranslateOptions, decltype(&GDALTranslateOptionsFree)> options(
      GDALTranslateOptionsNew(list.get(), nullptr), GDALTranslateOptionsFree);
  DatasetPtr made(options == nullptr ? nullptr
                                     : GDALDataset::FromHandle(
                                           GDALTranslate("", GDALDataset::ToHandle(&from), options.get(), nullptr)));
  if (made == nullptr) fail(errors, "its bands cannot be selected");
  return made;
}

/// The bands as the file has them: a view of them would copy every pixel once more.
void RasterView::take_file_bands() {
  std::copy(info_.gray_bands.begin(), info_.gray_bands.end(), bands_.begin());
  for (int band = top().GetRasterCount(); band > 0; --band) {
    if (top().GetRasterBand(band)->GetColorInterpretation() == GCI_AlphaBand) alpha_band_ = band;  // the first one
  }
}

void RasterView::select_bands(const ImageryOptions& options) {
  std::vector<std::string> arguments{"-of", "VRT"};
  for (const int band : info_.gray_bands) arguments.insert(arguments.end(), {"-b", std::to_string(band)});
  for (int band = 1; band <= top().GetRasterCount() && alpha_band_ == 0; ++band) {
    if (top().GetRasterBand(band)->GetColorInterpretation() != GCI_AlphaBand) continue;
    arguments.insert(arguments.end(), {"-b", std::to_string(band)});
    alpha_band_ = channels_ + 1;
  }
  const GDALDataType type = top().GetRasterBand(info_.gray_bands.front())->GetRasterDataType();
  if (options.nodata) {
    arguments.insert(arguments.end(), {"-a_nodata", format_number(*options.nodata)});
  } else if (info_.mask == MaskKind::kNone && (type == GDT_Float32 || type == GDT_Float64)) {
    arguments.insert(arguments.end(), {"-a_nodata", "nan"});  // so that warping keeps NaN out of its neighbours
  }
  translate(arguments);
}

/// Colours instead of indices; the index that means no data becomes a transparent colour.
void RasterView::expand_palette(const ImageryOptions& options) {
  translate({"-of", "VRT", "-b", std::to_string(info_.gray_bands.front())});
  GDALRasterBand* band = top().GetRasterBand(1);
  const std::unique_ptr<GDALColorTable> colors(band->GetColorTable()->Clone());
  int has_nodata = 0;
  const double nodata = options.nodata ? *options.nodata : band->GetNoDataValue(&has_nodata);
  if ((options.nodata || has_nodata != 0) && nodata >= 0 && nodata < colors->GetColorEntryCount()) {
    GDALColorEntry entry = *colors->GetColorEntry(static_cast<int>(nodata));
    entry.c4 = 0;
    colors->SetColorEntry(static_cast<int>(nodata), &entry);
    band->SetColorTable(colors.get());
  }
  for (int i = 0; i < colors->GetColorEntryCount(); ++i) {
    if (colors->GetColorEntry(i)->c4 < 255) alpha_band_ = channels_ + 1;
  }
  translate({"-of", "VRT", "-expand", alpha_band_ > 0 ? "rgba" : "rgb"});
}

/// Complex values → their magnitude, before anything is resampled: their phases would cancel each other.
void RasterView::take_magnitude() {
  const GdalErrors errors;
  DatasetPtr made(GDALDataset::FromHandle(VRTCreate(info_.width_px, info_.height_px)));
  for (const int band : info_.gray_bands) {
    const char* const options[] = {"subclass=VRTDerivedRasterBand", "PixelFunctionType=mod",
                                   "SourceTransferType=CFloat64", nullptr};
    const bool added = made != nullptr && GDALAddBand(GDALDataset::ToHandle(made.get()), GDT_Float64,
                                                      const_cast<char**>(options)) == CE_None;
    if (!added ||
        VRTAddSimpleSource(static_cast<VRTSourcedRasterBandH>(made->GetRasterBand(made->GetRasterCount())),
                           GDALRasterBand::ToHandle(top().GetRasterBand(band)), 0, 0, info_.width_px, info_.height_px,
                           0, 0, info_.width_px, info_.height_px, "near", VRT_NODATA_UNSET) != CE_None) {
      fail(errors, "its complex values cannot be read");
    }
  }
  stack_.push_back(std::move(made));
}

/// The collar as an alpha band behind the others, so that warping keeps it out of its neighbours.
void RasterView::add_collar_alpha() {
  const GdalErrors errors;
  DatasetPtr alpha = make_collar_alpha(info_.collar);
  const bool added = top().AddBand(GDT_Byte) == CE_None;
  GDALRasterBand* const band = added ? top().GetRasterBand(top().GetRasterCount()) : nullptr;
  if (band == nullptr || band->SetColorInterpretation(GCI_AlphaBand) != CE_None ||
      VRTAddSimpleSource(static_cast<VRTSourcedRasterBandH>(band), GDALRasterBand::ToHandle(alpha->GetRasterBand(1)), 0,
                         0, info_.width_px, info_.height_px, 0, 0, info_.width_px, info_.height_px, "near",
                         VRT_NODATA_UNSET) != CE_None) {
    fail(errors, "its collar cannot be masked");
  }
  stack_.insert(stack_.begin(), std::move(alpha));
}

cv::Mat RasterView::read_pixels(const PixelWindow& window) const {
  const GdalErrors errors;
  cv::Mat pixels(window.height, window.width, CV_MAKETYPE(info_.depth, channels_));
  std::array<int, 3> bands = bands_;
  const auto element = static_cast<GSpacing>(pixels.elemSize1());
  const CPLErr result =
      top().RasterIO(GF_Read, static_cast<int>(window.col), static_cast<int>(window.row), window.width, window.height,
                     pixels.data, window.width, window.height, gdal_type(info_.depth), channels_, bands.data(),
                     element * channels_, static_cast<GSpacing>(pixels.step[0]), element, nullptr);
  if (result != CE_None || errors.read_in_part()) fail(errors, "cannot be read");
  if (info_.min_is_white) cv::bitwise_not(pixels, pixels);  // 255 − v, 65535 − v
  return pixels;
}

cv::Mat RasterView::read_valid(const PixelWindow& window) const {
  const GdalErrors errors;
  const auto read = [&](GDALRasterBand& band) {
    cv::Mat mask(window.height, window.width, CV_8U);
    if (band.RasterIO(GF_Read, static_cast<int>(window.col), static_cast<int>(window.row), window.width, window.height,
                      mask.data, window.width, window.height, GDT_Byte, 1, static_cast<GSpacing>(mask.step[0]),
                      nullptr) != CE_None) {
      fail(errors, "its mask cannot be read");
    }
    return cv::Mat(mask != 0);
  };
  cv::Mat valid(window.height, window.width, CV_8U, cv::Scalar(255));
  if (alpha_band_ > 0) valid = read(*top().GetRasterBand(alpha_band_));
  if (!mask_stack_.empty()) valid &= read(*mask_stack_.back()->GetRasterBand(1));
  if (warped_) return valid;
  if (info_.collar != nullptr) info_.collar->clear(window, valid);

  const auto band_of = [&](int channel) { return top().GetRasterBand(bands_.at(static_cast<std::size_t>(channel))); };
  const int flags = band_of(0)->GetMaskFlags();
  if ((flags & (GMF_ALL_VALID | GMF_ALPHA)) != 0) return valid;
  cv::Mat masks = read(*band_of(0)->GetMaskBand());
  for (int channel = 1; channel < channels_ && (flags & GMF_PER_DATASET) == 0; ++channel) {
    const cv::Mat mask = read(*band_of(channel)->GetMaskBand());
    masks = info_.depth == CV_8U ? cv::Mat(masks | mask) : cv::Mat(masks & mask);
  }
  return valid & masks;
}

std::unique_ptr<RasterView> ViewPool::take() {
  {
    const std::lock_guard lock(mutex_);
    if (!idle_.empty()) {
      std::unique_ptr<RasterView> view = std::move(idle_.back());
      idle_.pop_back();
      return view;
    }
  }
  return open_();
}

void ViewPool::give_back(std::unique_ptr<RasterView> view) {
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(view));
}

}  // namespace pilotage
