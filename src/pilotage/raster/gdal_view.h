#pragma once

#include <array>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pilotage/geo/tile_matrix.h"
#include "pilotage/raster/gdal_handle.h"
#include "pilotage/raster/gdal_imagery.h"

// Private to raster/gdal_*.cc: a raster reduced to the bands that gray is made of, on its own grid or warped onto
// another.

namespace pilotage {

/// What a raster is warped onto: a north-up grid.
struct TargetGrid {
  Crs crs;
  GeoTransform map_from_pixel;
  std::int64_t width_px = 0;
  std::int64_t height_px = 0;
};

/// A stack of GDAL datasets, each made from the one before; `bands` of the last one are gray or red, green, blue.
/// Belongs to one thread at a time.
class RasterView {
 public:
  /// What GDAL warps at a time, counted from the first pixel of the grid.
  static constexpr int kWarpedBlockWidth_px = 512;
  static constexpr int kWarpedBlockHeight_px = 128;

  /// The raster on its own grid.
  RasterView(const ImageryInfo& info, const ImageryOptions& options);
  /// The raster on another grid.
  RasterView(const ImageryInfo& info, const ImageryOptions& options, const TargetGrid& grid, Resampling resampling);
  ~RasterView();
  RasterView(const RasterView&) = delete;
  RasterView& operator=(const RasterView&) = delete;

  /// One or three channels of depth `info.depth`; three are red, green, blue.
  cv::Mat read_pixels(const PixelWindow& window) const;
  /// 255 where GDAL's masks say there is ground, by the rule of gdal_gray.h; values that are not finite are not looked
  /// at.
  cv::Mat read_valid(const PixelWindow& window) const;

 private:
  enum class For { kReading, kWarping };
  RasterView(const ImageryInfo& info, const ImageryOptions& options, For purpose);
  void take_file_bands();
  void select_bands(const ImageryOptions& options);
  void expand_palette(const ImageryOptions& options);
  void take_magnitude();
  void add_collar_alpha();
  void translate(const std::vector<std::string>& arguments);
  DatasetPtr translated(GDALDataset& from, const std::vector<std::string>& arguments) const;
  DatasetPtr warp(GDALDataset& from, const std::vector<std::string>& arguments) const;
  void warp_whole_mask(const TargetGrid& grid, Resampling resampling);
  GDALDataset& top() const { return *stack_.back(); }
  [[noreturn]] void fail(const GdalErrors& errors, const char* what) const;

  ImageryInfo info_;
  std::vector<DatasetPtr> stack_;
  std::vector<DatasetPtr> mask_stack_;  // of the mask at full resolution, where overviews have one of their own
  int channels_ = 1;
  std::array<int, 3> bands_{1, 2, 3};
  int alpha_band_ = 0;  // 0 = there is none
  bool warped_ = false;
};

/// As many views of one raster as there are threads reading it at the same time.
class ViewPool {
 public:
  explicit ViewPool(std::function<std::unique_ptr<RasterView>()> open) : open_(std::move(open)) {}

  /// Calls `use(view)` with a view that no other thread uses meanwhile.
  template <class Use>
  auto with_view(const Use& use) {
    std::unique_ptr<RasterView> view = take();
    auto result = use(*view);
    give_back(std::move(view));
    return result;
  }

 private:
  std::unique_ptr<RasterView> take();
  void give_back(std::unique_ptr<RasterView> view);

  std::function<std::unique_ptr<RasterView>()> open_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<RasterView>> idle_;
};

}  // namespace pilotage
