#include "pilotage/raster/gdal_gray.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/geo/geodesic.h"
#include "pilotage/raster/gdal_view.h"
#include "pilotage/raster/gray_stretch.h"
#include "pilotage/raster/shared_blocks.h"

namespace pilotage {
namespace {

constexpr std::int64_t kMaxPicturePixels = std::int64_t{1} << 29;
constexpr double kAverageAbove = 1.5;  // grid pixels per imagery pixel; docs/methods/imagery.md

void drop_not_finite(const cv::Mat& gray, cv::Mat& valid) {
  if (gray.depth() != CV_64F) return;
  for (int row = 0; row < gray.rows; ++row) {
    const auto* value = gray.ptr<double>(row);
    auto* mask = valid.ptr<std::uint8_t>(row);
    for (int col = 0; col < gray.cols; ++col) {
      if (!std::isfinite(value[col])) mask[col] = 0;
    }
  }
}

Raster read_gray(const RasterView& view, const PixelWindow& window) {
  Raster raster{gray_from_colors(view.read_pixels(window)), view.read_valid(window), {}};
  drop_not_finite(raster.pixels, raster.valid);
  return raster;
}

/// Pixels in `channels` channels: a part of one band shows three equal ones among colours.
Raster read_colors(const RasterView& view, const PixelWindow& window, int channels) {
  Raster raster{view.read_pixels(window), view.read_valid(window), {}};
  drop_not_finite(gray_from_colors(raster.pixels), raster.valid);
  if (raster.pixels.channels() == 1 && channels == 3) {
    cv::Mat colors;
    cv::merge(std::vector<cv::Mat>(3, raster.pixels), colors);
    raster.pixels = colors;
  }
  return raster;
}

int channels_of(const ImageryInfo& info) {
  return info.palette ? 3 : static_cast<int>(info.gray_bands.size());
}

void check_window(const PixelWindow& window, std::int64_t width_px, std::int64_t height_px) {
  const bool inside = window.col >= 0 && window.row >= 0 && window.width > 0 && window.height > 0 &&
                      window.col + window.width <= width_px && window.row + window.height <= height_px;
  if (inside) return;
  throw UsageError("window " + std::to_string(window.col) + ", " + std::to_string(window.row) + ", " +
                   std::to_string(window.width) + " x " + std::to_string(window.height) +
                   " is not inside the grid of " + std::to_string(width_px) + " x " + std::to_string(height_px) +
                   " pixels");
}

/// Side of a grid's pixel on the ground at its centre, metres.
double ground_gsd_m(const TargetGrid& grid) {
  const GeoTransform& place = grid.map_from_pixel;
  const double metres = grid.crs.metres_per_unit();
  if (!std::isnan(metres)) return std::sqrt(std::abs(place.determinant())) * metres;
  const CrsTransform transform(grid.crs);
  const Eigen::Vector2d middle(static_cast<double>(grid.width_px) / 2, static_cast<double>(grid.height_px) / 2);
  const auto at = [&](double col, double row) {
    return transform.geodetic_from_map(place.map_from_pixel(middle + Eigen::Vector2d(col, row)));
  };
  const auto left = at(-0.5, 0);
  const auto right = at(0.5, 0);
  const auto up = at(0, -0.5);
  const auto down = at(0, 0.5);
  if (!left || !right || !up || !down) throw UsageError("the grid's centre has no longitude and latitude");
  return std::sqrt(geodesic_between(*left, *right).length_m * geodesic_between(*up, *down).length_m);
}

void check_grid(const TargetGrid& grid) {
  const GeoTransform& place = grid.map_from_pixel;
  constexpr std::int64_t kMaxSide = std::numeric_limits<int>::max();
  if (grid.width_px < 1 || grid.height_px < 1 || grid.width_px > kMaxSide || grid.height_px > kMaxSide) {
    throw UsageError("a grid of " + std::to_string(grid.width_px) + " x " + std::to_string(grid.height_px) +
                     " pixels is outside [1, " + std::to_string(kMaxSide) + "]");
  }
  const bool finite = std::isfinite(place.origin_x) && std::isfinite(place.origin_y) &&
                      std::isfinite(place.x_per_col) && std::isfinite(place.y_per_row);
  if (!finite || !(place.x_per_col > 0) || !(place.y_per_row < 0) || place.x_per_row != 0 || place.y_per_col != 0) {
    throw UsageError("the mission grid is not north-up");
  }
}

/// One raster of a mosaic.
struct MosaicPart {
  ImageryInfo info;
  std::shared_ptr<ViewPool> pool;
  PixelWindow extent;  // of the grid that it can cover
};

/// The pixels of the grid that the raster can reach, a few more rather than one less.
PixelWindow extent_on_grid(const ImageryInfo& info, const TargetGrid& grid) {
  constexpr double kMargin = 16;
  const Bounds bounds = imagery_bounds(info, grid.crs);
  if (bounds.empty()) return {};
  const Eigen::Vector2d low = grid.map_from_pixel.pixel_from_map({bounds.min_x_m, bounds.max_y_m});
  const Eigen::Vector2d high = grid.map_from_pixel.pixel_from_map({bounds.max_x_m, bounds.min_y_m});
  // The bulge of a curved edge between the points that imagery_bounds looks at.
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(kMargin) + (high - low) / 1024;
  const auto width = static_cast<double>(grid.width_px);
  const auto height = static_cast<double>(grid.height_px);
  const double left = std::clamp(std::floor(low.x() - margin.x()), 0.0, width);
  const double right = std::clamp(std::ceil(high.x() + margin.x()), 0.0, width);
  const double top = std::clamp(std::floor(low.y() - margin.y()), 0.0, height);
  const double bottom = std::clamp(std::ceil(high.y() + margin.y()), 0.0, height);
  return {static_cast<std::int64_t>(left), static_cast<std::int64_t>(top), static_cast<int>(right - left),
          static_cast<int>(bottom - top)};
}

bool overlap(const PixelWindow& a, const PixelWindow& b) {
  return a.col < b.col + b.width && b.col < a.col + a.width && a.row < b.row + b.height && b.row < a.row + a.height;
}

struct Mosaic {
  std::vector<MosaicPart> parts;  // the last one lies on top
  TargetGrid grid;
  int depth = CV_8U;
};

Resampling kernel_of(const ImageryInfo& info, double grid_gsd_m, const ImageryOptions& options) {
  if (options.resampling != Resampling::kAuto) return options.resampling;
  const double ratio = grid_gsd_m / std::sqrt(info.gsd_x_m * info.gsd_y_m);
  return ratio > kAverageAbove ? Resampling::kAverage : Resampling::kCubic;
}

/// The cheapest kernel that finds the same pixels valid: every one but averaging asks the imagery's pixel under the
/// centre. Doubles keep theirs, because a value that is not finite reaches as far as the kernel.
Resampling mask_kernel_of(const ImageryInfo& info, double grid_gsd_m, const ImageryOptions& options) {
  const Resampling kernel = kernel_of(info, grid_gsd_m, options);
  return kernel == Resampling::kAverage || info.depth == CV_64F ? kernel : Resampling::kNearest;
}

/// `choose` is one of the two functions above.
Mosaic open_mosaic(const std::vector<std::string>& datasets, const TargetGrid& grid, const ImageryOptions& options,
                   decltype(kernel_of)* choose = kernel_of) {
  if (datasets.empty()) throw UsageError("no imagery is given");
  check_grid(grid);
  Mosaic mosaic;
  mosaic.grid = grid;
  const double grid_gsd_m = ground_gsd_m(grid);
  for (const std::string& dataset : datasets) {
    MosaicPart part;
    part.info = inspect_imagery(dataset, options);
    part.extent = extent_on_grid(part.info, grid);
    const Resampling resampling = choose(part.info, grid_gsd_m, options);
    part.pool = std::make_shared<ViewPool>([info = part.info, options, grid, resampling] {
      return std::make_unique<RasterView>(info, options, grid, resampling);
    });
    mosaic.depth = mosaic.parts.empty() || mosaic.depth == part.info.depth ? part.info.depth : CV_64F;
    mosaic.parts.push_back(std::move(part));
  }
  return mosaic;
}

/// The window of the mosaic: `read(view)` gives the pixels (of depth `type`) and mask of one part.
template <class Read>
Raster compose(const Mosaic& mosaic, const PixelWindow& window, int type, const Read& read) {
  Raster result{cv::Mat(window.height, window.width, type, cv::Scalar::all(0)),
                cv::Mat(window.height, window.width, CV_8U, cv::Scalar(0)),
                mosaic.grid.map_from_pixel.shifted(static_cast<double>(window.col), static_cast<double>(window.row))};
  for (auto part = mosaic.parts.rbegin(); part != mosaic.parts.rend(); ++part) {
    if (!overlap(window, part->extent)) continue;
    Raster raster = part->pool->with_view(read);
    const cv::Mat news = raster.valid & ~result.valid;
    if (raster.pixels.type() != type) raster.pixels.convertTo(raster.pixels, type);
    raster.pixels.copyTo(result.pixels, news);
    result.valid |= news;
    if (cv::countNonZero(result.valid) == window.width * window.height) break;
  }
  return result;
}

GrayStretch channel_stretch(const cv::Mat& channel, const cv::Mat& valid) {
  return find_stretch(gray_source_from({channel, valid, {}}), 2, 98);
}

/// Colours of any depth → 8 bits, channel by channel.
cv::Mat to_8bit(const Raster& raster) {
  if (raster.pixels.depth() == CV_8U) return raster.pixels;
  std::vector<cv::Mat> channels;
  cv::split(raster.pixels, channels);
  for (cv::Mat& channel : channels) channel = apply_stretch(channel, channel_stretch(channel, raster.valid));
  cv::Mat merged;
  cv::merge(channels, merged);
  return merged;
}

/// Windows of a raster on its own grid, each read by `read(view, window)`.
template <class Read>
std::function<Raster(const PixelWindow&)> windows_on_own_pixels(const ImageryInfo& info, const ImageryOptions& options,
                                                                const Read& read) {
  auto pool = std::make_shared<ViewPool>([info, options] { return std::make_unique<RasterView>(info, options); });
  pool->with_view([](const RasterView&) { return 0; });  // opening fails here rather than in the first read
  return [info, pool, read](const PixelWindow& window) {
    check_window(window, info.width_px, info.height_px);
    Raster raster = pool->with_view([&](const RasterView& view) { return read(view, window); });
    raster.map_from_pixel =
        info.map_from_pixel.shifted(static_cast<double>(window.col), static_cast<double>(window.row));
    return raster;
  };
}

GraySource source_on_own_pixels(const ImageryInfo& info, const ImageryOptions& options) {
  return {info.width_px,       info.height_px,
          info.map_from_pixel, info.crs,
          info.depth,          windows_on_own_pixels(info, options, read_gray),
          info.block_width_px, info.block_height_px};
}

using SharedMosaic = std::shared_ptr<const Mosaic>;

GraySource gray_on_grid(const SharedMosaic& mosaic) {
  GraySource source;
  source.width_px = mosaic->grid.width_px;
  source.height_px = mosaic->grid.height_px;
  source.map_from_pixel = mosaic->grid.map_from_pixel;
  source.crs = mosaic->grid.crs;
  source.depth = mosaic->depth;
  source.block_width_px = RasterView::kWarpedBlockWidth_px;
  source.block_height_px = RasterView::kWarpedBlockHeight_px;
  source.read = [mosaic](const PixelWindow& window) {
    check_window(window, mosaic->grid.width_px, mosaic->grid.height_px);
    return compose(*mosaic, window, CV_MAKETYPE(mosaic->depth, 1),
                   [&](const RasterView& view) { return read_gray(view, window); });
  };
  return source;
}

ColorSource colors_on_grid(const SharedMosaic& mosaic) {
  const bool colored = std::any_of(mosaic->parts.begin(), mosaic->parts.end(),
                                   [](const MosaicPart& part) { return channels_of(part.info) == 3; });
  const int channels = colored ? 3 : 1;
  return {mosaic->grid.width_px,
          mosaic->grid.height_px,
          mosaic->grid.map_from_pixel,
          mosaic->grid.crs,
          channels,
          mosaic->depth,
          [mosaic, channels](const PixelWindow& window) {
            check_window(window, mosaic->grid.width_px, mosaic->grid.height_px);
            return compose(*mosaic, window, CV_MAKETYPE(mosaic->depth, channels),
                           [&](const RasterView& view) { return read_colors(view, window, channels); });
          },
          RasterView::kWarpedBlockWidth_px,
          RasterView::kWarpedBlockHeight_px};
}

SharedMosaic share(Mosaic mosaic) {
  return std::make_shared<const Mosaic>(std::move(mosaic));
}

/// What a picture is, when it may be read whole.
ImageryInfo accepted_picture(const std::string& dataset, const std::function<void(int width, int height)>& accept) {
  ImageryInfo info = inspect_picture(dataset);
  if (std::int64_t{info.width_px} * info.height_px > kMaxPicturePixels) {
    throw DataError(dataset + ": has " + std::to_string(info.width_px) + " x " + std::to_string(info.height_px) +
                    " pixels, a frame at most " + std::to_string(kMaxPicturePixels));
  }
  if (accept) accept(info.width_px, info.height_px);
  return info;
}

}  // namespace

GraySource open_gray(const std::string& dataset, const ImageryOptions& options) {
  return share_blocks(source_on_own_pixels(inspect_imagery(dataset, options), options));
}

cv::Mat read_gray8_picture(const std::string& dataset, const std::function<void(int width, int height)>& accept) {
  const ImageryInfo info = accepted_picture(dataset, accept);
  const GraySource source = stretch_to_8bit(source_on_own_pixels(info, {}));
  Raster raster = source.read({0, 0, info.width_px, info.height_px});
  if (info.mask != MaskKind::kNone) raster.pixels.setTo(0, raster.valid == 0);
  return raster.pixels;
}

cv::Mat read_rgb8_picture(const std::string& dataset, const std::function<void(int width, int height)>& accept) {
  const ImageryInfo info = accepted_picture(dataset, accept);
  if (info.depth != CV_8U) {
    throw DataError(dataset + ": has values of type " + info.band_type + "; a frame in colour has 8 bits (Byte)");
  }
  const RasterView view(info, {});
  Raster raster = read_colors(view, {0, 0, info.width_px, info.height_px}, 3);
  if (info.mask != MaskKind::kNone) raster.pixels.setTo(0, raster.valid == 0);
  return raster.pixels;
}

GraySource open_gray_on_grid(const std::vector<std::string>& datasets, const Crs& crs,
                             const GeoTransform& map_from_pixel, std::int64_t width_px, std::int64_t height_px,
                             const ImageryOptions& options) {
  return share_blocks(gray_on_grid(share(open_mosaic(datasets, {crs, map_from_pixel, width_px, height_px}, options))));
}

GraySource open_valid_on_grid(const std::vector<std::string>& datasets, const Crs& crs,
                              const GeoTransform& map_from_pixel, std::int64_t width_px, std::int64_t height_px,
                              const ImageryOptions& options) {
  GraySource source =
      gray_on_grid(share(open_mosaic(datasets, {crs, map_from_pixel, width_px, height_px}, options, mask_kernel_of)));
  source.depth = CV_8U;
  source.read = [read = source.read](const PixelWindow& window) {
    Raster raster = read(window);
    raster.pixels = raster.valid;
    return raster;
  };
  return share_blocks(source);
}

ColorSource open_colors(const std::string& dataset, const ImageryOptions& options) {
  const ImageryInfo info = inspect_imagery(dataset, options);
  const int channels = channels_of(info);
  return {info.width_px,
          info.height_px,
          info.map_from_pixel,
          info.crs,
          channels,
          info.depth,
          windows_on_own_pixels(info, options,
                                [channels](const RasterView& view, const PixelWindow& window) {
                                  return read_colors(view, window, channels);
                                }),
          info.block_width_px,
          info.block_height_px};
}

ColorSource open_colors_on_grid(const std::vector<std::string>& datasets, const Crs& crs,
                                const GeoTransform& map_from_pixel, std::int64_t width_px, std::int64_t height_px,
                                const ImageryOptions& options) {
  return colors_on_grid(share(open_mosaic(datasets, {crs, map_from_pixel, width_px, height_px}, options)));
}

GrayAndColors open_gray_and_colors_on_grid(const std::vector<std::string>& datasets, const Crs& crs,
                                           const GeoTransform& map_from_pixel, std::int64_t width_px,
                                           std::int64_t height_px, const ImageryOptions& options,
                                           std::int64_t kept_bytes) {
  const SharedMosaic mosaic = share(open_mosaic(datasets, {crs, map_from_pixel, width_px, height_px}, options));
  const ColorSource colors = colors_on_grid(mosaic);
  // Gray of parts that are not alike is rounded part by part, before they become one: it is not the colours' gray.
  const bool alike = std::all_of(mosaic->parts.begin(), mosaic->parts.end(), [&](const MosaicPart& part) {
    return part.info.depth == colors.depth && channels_of(part.info) == colors.channels;
  });
  if (!alike) return {share_blocks(gray_on_grid(mosaic)), colors, 0};
  const ColorSource shared = share_blocks(colors, kept_bytes);
  return {gray_source_of(shared), shared, kept_pixels(colors, kept_bytes)};
}

Raster read_rgb8_on_grid(const std::vector<std::string>& datasets, const Crs& crs, const GeoTransform& map_from_pixel,
                         int width_px, int height_px, const ImageryOptions& options) {
  const Mosaic mosaic = open_mosaic(datasets, {crs, map_from_pixel, width_px, height_px}, options);
  const PixelWindow window{0, 0, width_px, height_px};
  Raster raster = compose(mosaic, window, CV_MAKETYPE(mosaic.depth, 3),
                          [&](const RasterView& view) { return read_colors(view, window, 3); });
  raster.pixels = to_8bit(raster);
  return raster;
}

}  // namespace pilotage
