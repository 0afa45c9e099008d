#include "pilotage/raster/shared_blocks.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <future>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "pilotage/geo/tile_groups.h"

namespace pilotage {
namespace {

constexpr std::int64_t kLeastSide_px = 256;  // smaller blocks are joined
constexpr std::int64_t kKeptPixels = 16 << 20;
constexpr std::int64_t kMostRowsBytes = std::int64_t{256} << 20;

std::int64_t unit_side(std::int64_t block_px, std::int64_t extent_px) {
  return std::min(extent_px, (kLeastSide_px + block_px - 1) / block_px * block_px);
}

int type_of(const GraySource& source) {
  return CV_MAKETYPE(source.depth, 1);
}

int type_of(const ColorSource& source) {
  return CV_MAKETYPE(source.depth, source.channels);
}

template <class Source>
std::int64_t bytes_per_px(const Source& source) {
  return static_cast<std::int64_t>(CV_ELEM_SIZE(type_of(source)) + 1);  // and its mask
}

template <class Source>
class Blocks {
 public:
  Blocks(const Source& source, std::int64_t kept_pixels)
      : source_(source),
        kept_pixels_(kept_pixels),
        width_px_(unit_side(source.block_width_px, source.width_px)),
        height_px_(unit_side(source.block_height_px, source.height_px)) {
    const std::int64_t across = (source.width_px + width_px_ - 1) / width_px_;
    const std::int64_t down = (source.height_px + height_px_ - 1) / height_px_;
    const std::int64_t block_px = width_px_ * height_px_;
    const std::int64_t most_of_rows =
        std::max(kMostRowsBytes / bytes_per_px(source) / block_px, 3 * (kSlabWidth_px / width_px_ + 2));
    const std::int64_t three_rows = std::min(3 * across, most_of_rows);
    const std::int64_t most = std::max(three_rows, kept_pixels / block_px);
    most_ = static_cast<std::size_t>(most);
    keeps_all_ = across * down <= most;
  }

  bool too_large() const { return width_px_ * height_px_ > kept_pixels_; }

  Raster read(const PixelWindow& window) {
    if (!keeps_all_ && whole(window.col, window.width, width_px_, source_.width_px) &&
        whole(window.row, window.height, height_px_, source_.height_px)) {
      return source_.read(window);
    }
    if (window.width < 1 || window.height < 1 || window.col < 0 || window.row < 0 ||
        window.col + window.width > source_.width_px || window.row + window.height > source_.height_px) {
      return source_.read(window);  // refuses it
    }
    Raster result{cv::Mat(window.height, window.width, type_of(source_)), cv::Mat(window.height, window.width, CV_8U),
                  source_.map_from_pixel.shifted(static_cast<double>(window.col), static_cast<double>(window.row))};
    std::vector<BlockIndex> in_work;
    for (const BlockIndex& index : blocks_of(window)) {
      if (const auto block = get(index, false)) {
        copy_part(*block, index, window, result);
      } else {
        in_work.push_back(index);
      }
    }
    for (const BlockIndex& index : in_work) copy_part(*get(index, true), index, window, result);
    return result;
  }

 private:
  using BlockIndex = std::pair<std::int64_t, std::int64_t>;  // row and column among the blocks
  struct Hash {
    std::size_t operator()(const BlockIndex& index) const {
      return std::hash<std::int64_t>{}(index.first * 0x9E3779B97F4A7C15 + index.second);
    }
  };
  struct CachedBlock {
    std::shared_future<Raster> raster;
    std::list<BlockIndex>::iterator age;
  };

  /// Begins and ends at the borders of blocks.
  static bool whole(std::int64_t begin, std::int64_t length, std::int64_t side, std::int64_t extent) {
    return begin % side == 0 && ((begin + length) % side == 0 || begin + length == extent);
  }

  std::vector<BlockIndex> blocks_of(const PixelWindow& window) const {
    std::vector<BlockIndex> blocks;
    for (std::int64_t row = window.row / height_px_; row * height_px_ < window.row + window.height; ++row) {
      for (std::int64_t col = window.col / width_px_; col * width_px_ < window.col + window.width; ++col) {
        blocks.emplace_back(row, col);
      }
    }
    return blocks;
  }

  /// What the window has of a block.
  void copy_part(const Raster& block, const BlockIndex& index, const PixelWindow& window, Raster& result) const {
    const std::int64_t first_col = index.second * width_px_;
    const std::int64_t first_row = index.first * height_px_;
    const std::int64_t left = std::max(window.col, first_col);
    const std::int64_t top = std::max(window.row, first_row);
    const cv::Rect from(static_cast<int>(left - first_col), static_cast<int>(top - first_row),
                        static_cast<int>(std::min(window.col + window.width, first_col + width_px_) - left),
                        static_cast<int>(std::min(window.row + window.height, first_row + height_px_) - top));
    const cv::Rect to(static_cast<int>(left - window.col), static_cast<int>(top - window.row), from.width, from.height);
    block.pixels(from).copyTo(result.pixels(to));
    block.valid(from).copyTo(result.valid(to));
  }

  /// The block; of one that another thread is making nothing, or with `waits` when it is there. So threads that want
  /// the same blocks make different ones at a time.
  std::optional<Raster> get(const BlockIndex& index, bool waits) {
    std::promise<Raster> promise;
    {
      std::unique_lock lock(mutex_);
      if (const auto found = kept_.find(index); found != kept_.end()) {
        used_.splice(used_.begin(), used_, found->second.age);
        const std::shared_future<Raster> raster = found->second.raster;
        lock.unlock();
        if (!waits && raster.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
        return raster.get();
      }
      used_.push_front(index);
      kept_[index] = {promise.get_future().share(), used_.begin()};
      if (kept_.size() > most_) {
        kept_.erase(used_.back());
        used_.pop_back();
      }
    }
    try {
      const std::int64_t col = index.second * width_px_;
      const std::int64_t row = index.first * height_px_;
      Raster raster = source_.read({col, row, static_cast<int>(std::min(width_px_, source_.width_px - col)),
                                    static_cast<int>(std::min(height_px_, source_.height_px - row))});
      promise.set_value(raster);
      return raster;
    } catch (...) {
      promise.set_exception(std::current_exception());
      const std::lock_guard lock(mutex_);
      if (const auto found = kept_.find(index); found != kept_.end()) {  // who asks again tries again
        used_.erase(found->second.age);
        kept_.erase(found);
      }
      throw;
    }
  }

  Source source_;
  std::int64_t kept_pixels_;
  std::int64_t width_px_;
  std::int64_t height_px_;
  std::size_t most_ = 0;
  bool keeps_all_ = false;
  std::mutex mutex_;
  std::unordered_map<BlockIndex, CachedBlock, Hash> kept_;
  std::list<BlockIndex> used_;  // the last one used first
};

template <class Source>
Source shared_source(const Source& source, std::int64_t kept_pixels) {
  if (source.block_width_px <= 1 && source.block_height_px <= 1) return source;
  auto blocks = std::make_shared<Blocks<Source>>(source, kept_pixels);
  if (blocks->too_large()) return source;
  Source shared = source;
  shared.read = [blocks](const PixelWindow& window) { return blocks->read(window); };
  return shared;
}

}  // namespace

GraySource share_blocks(const GraySource& source) {
  return shared_source(source, kKeptPixels);
}

std::int64_t kept_pixels(const ColorSource& source, std::int64_t kept_bytes) {
  return kept_bytes / bytes_per_px(source);
}

ColorSource share_blocks(const ColorSource& source, std::int64_t kept_bytes) {
  return shared_source(source, kept_pixels(source, kept_bytes));
}

}  // namespace pilotage
