#include "pilotage/raster/collar.h"

#include <algorithm>
#include <cstddef>

namespace pilotage {

double Collar::share() const {
  return static_cast<double>(black_px + white_px) / (static_cast<double>(width_px) * height_px());
}

void Collar::clear(const PixelWindow& window, cv::Mat& valid) const {
  const auto left = static_cast<int>(window.col);
  const int right = left + window.width;
  for (int row = 0; row < window.height; ++row) {
    const auto first = static_cast<std::size_t>(window.row) + static_cast<std::size_t>(row);
    const auto end = runs.begin() + static_cast<std::ptrdiff_t>(row_starts[first + 1]);
    auto run = std::partition_point(runs.begin() + static_cast<std::ptrdiff_t>(row_starts[first]), end,
                                    [&](const Run& one) { return one.end <= left; });
    auto* const mask = valid.ptr<std::uint8_t>(row);
    for (; run != end && run->begin < right; ++run) {
      std::fill(mask + std::max(run->begin, left) - left, mask + std::min(run->end, right) - left, std::uint8_t{0});
    }
  }
}

CollarSearch::CollarSearch(int width_px, int height_px, std::size_t most_runs)
    : width_px_(width_px), height_px_(height_px), most_runs_(most_runs) {}

std::int32_t CollarSearch::root_of(std::int32_t region) {
  auto parent = [&](std::int32_t of) -> std::int32_t& { return regions_[static_cast<std::size_t>(of)].parent; };
  while (parent(region) != region) {
    parent(region) = parent(parent(region));
    region = parent(region);
  }
  return region;
}

std::int32_t CollarSearch::join(std::int32_t a, std::int32_t b) {
  a = root_of(a);
  b = root_of(b);
  if (a == b) return a;
  if (b < a) std::swap(a, b);
  Region& kept = regions_[static_cast<std::size_t>(a)];
  Region& joined = regions_[static_cast<std::size_t>(b)];
  kept.pixels += joined.pixels;
  kept.edge_pixels += joined.edge_pixels;
  joined.parent = a;
  return a;
}

/// `above`: the first run of the row above that may touch this one; moves on with the runs of a row.
void CollarSearch::add_run(const Collar::Run& run, CollarColor color, std::size_t& above, std::size_t above_end) {
  std::int32_t region = -1;
  while (above < above_end && runs_[above].run.end <= run.begin) ++above;
  for (std::size_t i = above; i < above_end && runs_[i].run.begin < run.end; ++i) {
    if (regions_[static_cast<std::size_t>(runs_[i].region)].color != color) continue;
    region = region < 0 ? root_of(runs_[i].region) : join(region, runs_[i].region);
  }
  if (region < 0) {
    region = static_cast<std::int32_t>(regions_.size());
    regions_.push_back({region, color, 0, 0});
  }
  const int row = static_cast<int>(row_starts_.size()) - 1;
  const std::int64_t length = run.end - run.begin;
  Region& of = regions_[static_cast<std::size_t>(region)];
  of.pixels += length;
  of.edge_pixels += row == 0 || row + 1 == height_px_ ? length : (run.begin == 0) + (run.end == width_px_);
  runs_.push_back({run, region});
}

bool CollarSearch::add_row(std::span<const CollarColor> row) {
  const std::size_t above_end = runs_.size();
  std::size_t above = row_starts_.size() > 1 ? row_starts_[row_starts_.size() - 2] : above_end;
  for (int col = 0; col < width_px_;) {
    const CollarColor color = row[static_cast<std::size_t>(col)];
    const int begin = col;
    while (col < width_px_ && row[static_cast<std::size_t>(col)] == color) ++col;
    if (color != CollarColor::kNone) add_run({begin, col}, color, above, above_end);
  }
  row_starts_.push_back(runs_.size());
  return runs_.size() <= most_runs_;
}

std::optional<Collar> CollarSearch::finish() {
  const auto is_collar = [](const Region& region) {
    return region.edge_pixels > 0 && region.pixels >= kLeastCollarPixels &&
           region.pixels >= kLeastCollarDepth_px * region.edge_pixels;
  };
  Collar collar;
  collar.width_px = width_px_;
  collar.row_starts.push_back(0);
  for (std::size_t row = 0; row + 1 < row_starts_.size(); ++row) {
    for (std::size_t i = row_starts_[row]; i < row_starts_[row + 1]; ++i) {
      const Region& region = regions_[static_cast<std::size_t>(root_of(runs_[i].region))];
      if (!is_collar(region)) continue;
      const Collar::Run& run = runs_[i].run;
      collar.runs.push_back(run);
      (region.color == CollarColor::kBlack ? collar.black_px : collar.white_px) += run.end - run.begin;
    }
    collar.row_starts.push_back(collar.runs.size());
  }
  if (collar.runs.empty()) return std::nullopt;
  return collar;
}

}  // namespace pilotage
