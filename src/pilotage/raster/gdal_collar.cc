#include "pilotage/raster/gdal_collar.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include <gdal_priv.h>

#include "pilotage/base/text.h"
#include "pilotage/raster/gdal_view.h"

namespace pilotage {
namespace {

constexpr int kMostProbes = 256;                // along each side of a raster
constexpr std::int64_t kStripPixels = 1 << 22;  // read at a time

template <class Value>
void colors_of_row(const Value* pixel, int channels, std::optional<Value> white, std::span<CollarColor> row) {
  for (CollarColor& color : row) {
    const Value first = *pixel;
    color = first == 0 ? CollarColor::kBlack : white && first == *white ? CollarColor::kWhite : CollarColor::kNone;
    for (int channel = 1; channel < channels; ++channel) {
      if (pixel[channel] != first) color = CollarColor::kNone;
    }
    pixel += channels;
  }
}

/// The colours of row `row` of `pixels`. Floating-point and signed values have no largest one that an image would show.
void colors_of_row(const cv::Mat& pixels, int row, std::span<CollarColor> colors) {
  const int channels = pixels.channels();
  switch (pixels.depth()) {
    case CV_8U:
      return colors_of_row<std::uint8_t>(pixels.ptr<std::uint8_t>(row), channels, std::uint8_t{255}, colors);
    case CV_16U:
      return colors_of_row<std::uint16_t>(pixels.ptr<std::uint16_t>(row), channels, std::uint16_t{65535}, colors);
    default:
      return colors_of_row<double>(pixels.ptr<double>(row), channels, std::nullopt, colors);
  }
}

/// All pixels of the window are black, or all are white.
bool shows_collar(const RasterView& view, const PixelWindow& window) {
  const cv::Mat pixels = view.read_pixels(window);
  std::vector<CollarColor> colors(static_cast<std::size_t>(window.width));
  std::optional<CollarColor> color;
  for (int row = 0; row < window.height; ++row) {
    colors_of_row(pixels, row, colors);
    for (const CollarColor one : colors) {
      if (one == CollarColor::kNone || one != color.value_or(one)) return false;
      color = one;
    }
  }
  return true;
}

/// Pixels of a side to look at, evenly spread, the first and the last among them.
std::vector<int> probes(int side_px) {
  const int count = std::min(side_px, kMostProbes);
  std::vector<int> places;
  for (int i = 0; i < count; ++i) {
    places.push_back(count == 1 ? 0 : static_cast<int>(std::int64_t{side_px - 1} * i / (count - 1)));
  }
  return places;
}

/// Whether a line of kLeastCollarDepth_px pixels, straight inwards from the edge, is of one colour anywhere. From the
/// top downwards, so that formats that are decoded from their beginning are decoded once.
bool edge_shows_collar(const RasterView& view, int width_px, int height_px) {
  const auto depth = static_cast<int>(kLeastCollarDepth_px);
  const int down = std::min(depth, height_px);
  const int across = std::min(depth, width_px);
  for (const int col : probes(width_px)) {
    if (shows_collar(view, {col, 0, 1, down})) return true;
  }
  for (const int row : probes(height_px)) {
    if (shows_collar(view, {0, row, across, 1}) || shows_collar(view, {width_px - across, row, across, 1})) return true;
  }
  for (const int col : probes(width_px)) {
    if (shows_collar(view, {col, height_px - down, 1, down})) return true;
  }
  return false;
}

std::string say_collar(const std::string& dataset, const Collar& collar) {
  const bool black = collar.black_px > 0;
  const bool white = collar.white_px > 0;
  return dataset + ": " + format_fixed(100 * collar.share(), 1) + " % of its pixels are a " +
         (black && white ? "black and white"
          : black        ? "black"
                         : "white") +
         " collar (" + (black ? "0" : "") + (black && white ? " or " : "") + (white ? "the largest value" : "") +
         " in every band, reaching in from its edge) and are taken for no data; " +
         (black && white ? "" : "--nodata, or a mask in the file, says so of all such pixels, ") +
         "--collar keep takes them for ground";
}

CollarFinding look_for_collar(const ImageryInfo& info, const ImageryOptions& options, const Progress& progress) {
  const RasterView view(info, options);
  if (!edge_shows_collar(view, info.width_px, info.height_px)) return {};
  if (const auto pixels = std::int64_t{info.width_px} * info.height_px; pixels > kMostCollarSearch_px) {
    return {nullptr,
            info.dataset + ": has black or white at its edge, but " + std::to_string(pixels) +
                " pixels, of which at most " + std::to_string(kMostCollarSearch_px) +
                " are searched for a collar; all of it is taken for ground; --nodata says which value is none"};
  }
  CollarSearch regions(info.width_px, info.height_px);
  std::vector<CollarColor> colors(static_cast<std::size_t>(info.width_px));
  const auto rows_at_once = static_cast<int>(std::clamp<std::int64_t>(kStripPixels / info.width_px, 1, info.height_px));
  for (int first = 0; first < info.height_px; first += rows_at_once) {
    report_progress(progress, "looking for a collar", first, info.height_px);
    const cv::Mat strip = view.read_pixels({0, first, info.width_px, std::min(rows_at_once, info.height_px - first)});
    for (int row = 0; row < strip.rows; ++row) {
      colors_of_row(strip, row, colors);
      if (regions.add_row(colors)) continue;
      return {nullptr, info.dataset +
                           ": has black or white at its edge, but too much of both all over it to say what is a "
                           "collar; all of it is taken for ground; --nodata says which value is none, --collar keep "
                           "that none is"};
    }
  }
  std::optional<Collar> collar = regions.finish();
  if (!collar) return {};
  const std::string warning = say_collar(info.dataset, *collar);
  return {std::make_shared<const Collar>(std::move(*collar)), warning};
}

class CollarBand final : public GDALRasterBand {
 public:
  CollarBand(GDALDataset* dataset, std::shared_ptr<const Collar> collar) : collar_(std::move(collar)) {
    poDS = dataset;
    nBand = 1;
    eDataType = GDT_Byte;
    nRasterXSize = nBlockXSize = collar_->width_px;
    nRasterYSize = collar_->height_px();
    nBlockYSize = 1;
  }

 protected:
  CPLErr IReadBlock(int /*block_x*/, int row, void* data) override {
    cv::Mat valid(1, nBlockXSize, CV_8U, data);
    valid.setTo(255);
    collar_->clear({0, row, nBlockXSize, 1}, valid);
    return CE_None;
  }

 private:
  std::shared_ptr<const Collar> collar_;
};

class CollarDataset final : public GDALDataset {
 public:
  explicit CollarDataset(const std::shared_ptr<const Collar>& collar) {
    nRasterXSize = collar->width_px;
    nRasterYSize = collar->height_px();
    SetBand(1, new CollarBand(this, collar));  // GDALDataset deletes it
  }
};

/// What makes two looks at a raster see the same pixels.
using LookedAt = std::tuple<std::string, std::vector<int>, std::uintmax_t, std::int64_t>;

LookedAt looked_at(const ImageryInfo& info) {
  std::error_code no_size;
  std::error_code no_time;
  const std::uintmax_t size = std::filesystem::file_size(info.dataset, no_size);
  const auto changed = std::filesystem::last_write_time(info.dataset, no_time);
  return {info.dataset, info.gray_bands, no_size ? 0 : size, no_time ? 0 : changed.time_since_epoch().count()};
}

}  // namespace

CollarFinding find_collar(const ImageryInfo& info, const ImageryOptions& options, const Progress& progress) {
  constexpr std::size_t kMostKept = 4096;  // rasters; a mosaic of more is looked at again
  static std::mutex mutex;
  static auto& found = *new std::map<LookedAt, CollarFinding>;
  const LookedAt key = looked_at(info);
  const std::lock_guard lock(mutex);
  if (const auto known = found.find(key); known != found.end()) return known->second;
  if (found.size() >= kMostKept) found.clear();
  return found[key] = look_for_collar(info, options, progress);
}

DatasetPtr make_collar_alpha(const std::shared_ptr<const Collar>& collar) {
  return DatasetPtr(new CollarDataset(collar));
}

}  // namespace pilotage
