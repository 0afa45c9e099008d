#include "pilotage/matchability/self_votes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <string>

#include "pilotage/base/error.h"
#include "pilotage/base/parallel.h"
#include "pilotage/geo/tile_groups.h"
#include "pilotage/vision/hamming.h"

namespace pilotage {
namespace {

constexpr int kTruePeak_px = 5;
constexpr int kVoteGridSide_px = 2 * kVoteReach_px + 1;
constexpr std::size_t kQueriesPerTask = 1024;

struct Displacement {
  std::int8_t dx_px;
  std::int8_t dy_px;
};

/// Votes over all displacements, for one tile at a time.
class VoteSurface {
 public:
  void add(Displacement vote) {
    ++votes_[static_cast<std::size_t>((vote.dy_px + kVoteReach_px) * kVoteGridSide_px + vote.dx_px + kVoteReach_px)];
  }

  /// Standard deviation of the sums of 3 × 3 bins, but for the true peak; empties the surface.
  double take_noise() {
    // Sums along rows of three, then of three rows: integers, so that the order of the votes does not matter.
    std::int64_t sum = 0;
    std::int64_t squares = 0;
    std::int64_t count = 0;
    for (int y = 0; y < kVoteGridSide_px; ++y) {
      std::array<int, kVoteGridSide_px> column{};
      for (int row = std::max(y - 1, 0); row <= std::min(y + 1, kVoteGridSide_px - 1); ++row) {
        const std::uint16_t* votes = &votes_[static_cast<std::size_t>(row * kVoteGridSide_px)];
        for (int x = 0; x < kVoteGridSide_px; ++x) column[static_cast<std::size_t>(x)] += votes[x];
      }
      for (int x = 0; x < kVoteGridSide_px; ++x) {
        if (std::max(std::abs(x - kVoteReach_px), std::abs(y - kVoteReach_px)) <= kTruePeak_px) continue;
        int box = column[static_cast<std::size_t>(x)];
        if (x > 0) box += column[static_cast<std::size_t>(x - 1)];
        if (x + 1 < kVoteGridSide_px) box += column[static_cast<std::size_t>(x + 1)];
        sum += box;
        squares += std::int64_t{box} * box;
        ++count;
      }
    }
    votes_.fill(0);
    const double mean = static_cast<double>(sum) / static_cast<double>(count);
    return std::sqrt(std::max(0.0, static_cast<double>(squares) / static_cast<double>(count) - mean * mean));
  }

 private:
  std::array<std::uint16_t, static_cast<std::size_t>(kVoteGridSide_px) * kVoteGridSide_px> votes_{};
};

std::int8_t rounded(float value_px) {
  const long whole = std::lround(value_px);
  return static_cast<std::int8_t>(std::clamp(whole, -long{kVoteReach_px}, long{kVoteReach_px}));
}

FeatureSet some_features(const FeatureSet& all, std::size_t begin, std::size_t end) {
  const auto bytes = static_cast<std::size_t>(all.descriptor_bytes);
  FeatureSet some;
  some.pattern = all.pattern;
  some.descriptor_bytes = all.descriptor_bytes;
  some.features.assign(all.features.data() + begin, all.features.data() + end);
  some.descriptors.assign(all.descriptors.data() + begin * bytes, all.descriptors.data() + end * bytes);
  return some;
}

/// Features of one band of rows, in the order of their rows, and the displacements that each votes for.
struct FeatureBand {
  FeatureSet features;
  std::vector<std::uint32_t> by_x;               ///< Their indices, from left to right.
  std::vector<std::vector<Displacement>> votes;  ///< Empty until they are asked for.
};

/// The features of the map band by band, each read once and kept while it is needed.
class FeatureBands {
 public:
  FeatureBands(const GraySource& source, const TileMatrix& matrix, std::span<const std::int64_t> indices,
               const FeatureOptions& options, int threads)
      : source_(source), options_(options), threads_(threads) {
    for (const std::int64_t index : indices) {
      const PixelWindow window = matrix.search_window(matrix.cell_of(index), kVoteReach_px);
      const std::int64_t end = window.row + window.height;
      for (std::int64_t band = window.row / kFeatureBlockPx; band * kFeatureBlockPx < end; ++band) {
        const std::int64_t top = std::max(window.row, band * kFeatureBlockPx);
        const std::int64_t bottom = std::min(end, (band + 1) * kFeatureBlockPx);
        windows_[band].push_back({window.col, top, window.width, static_cast<int>(bottom - top)});
      }
    }
  }

  void forget_before(std::int64_t band) { bands_.erase(bands_.begin(), bands_.lower_bound(band)); }

  /// A band with its votes; nullptr where there is nothing.
  const FeatureBand* with_votes(std::int64_t band) {
    FeatureBand* found = load(band);
    if (found == nullptr || found->votes.size() == found->features.size()) return found;
    FeatureSet around;
    around.pattern = found->features.pattern;
    around.descriptor_bytes = found->features.descriptor_bytes;
    for (const std::int64_t near : {band - 1, band, band + 1}) {
      const FeatureBand* part = load(near);
      if (part == nullptr) continue;
      const FeatureSet& more = part->features;
      around.features.insert(around.features.end(), more.features.begin(), more.features.end());
      around.descriptors.insert(around.descriptors.end(), more.descriptors.begin(), more.descriptors.end());
    }
    found->votes.resize(found->features.size());
    const HammingIndex index(around);
    const std::size_t tasks = (found->features.size() + kQueriesPerTask - 1) / kQueriesPerTask;
    parallel_for(tasks, threads_, [&](std::size_t task, int) {
      const std::size_t begin = task * kQueriesPerTask;
      const std::size_t end = std::min(begin + kQueriesPerTask, found->features.size());
      vote(index, around, some_features(found->features, begin, end), &found->votes[begin]);
    });
    return found;
  }

 private:
  FeatureBand* load(std::int64_t band) {
    const auto wanted = windows_.find(band);
    if (wanted == windows_.end()) return nullptr;
    const auto [entry, is_new] = bands_.try_emplace(band);
    FeatureBand& loaded = entry->second;
    if (is_new) {
      loaded.features = extract_features_of_map(source_, wanted->second, options_, threads_);
      const std::vector<Feature>& features = loaded.features.features;
      loaded.by_x.resize(features.size());
      std::iota(loaded.by_x.begin(), loaded.by_x.end(), 0U);
      std::sort(loaded.by_x.begin(), loaded.by_x.end(),
                [&](std::uint32_t a, std::uint32_t b) { return features[a].x_px < features[b].x_px; });
    }
    return &loaded;
  }

  static void vote(const HammingIndex& index, const FeatureSet& around, const FeatureSet& voters,
                   std::vector<Displacement>* votes) {
    std::vector<HammingWindow> windows;
    for (const Feature& feature : voters.features) {
      const auto x = static_cast<double>(feature.x_px);
      const auto y = static_cast<double>(feature.y_px);
      windows.push_back({x - kVoteReach_px, y - kVoteReach_px, x + kVoteReach_px, y + kVoteReach_px});
    }
    const auto found =
        index.find_within(voters, windows, static_cast<std::uint32_t>(descriptor_of(voters).lookalike_bits()));
    for (std::size_t i = 0; i < voters.size(); ++i) {
      for (const HammingMatch& match : found.of_query(i)) {
        const Feature& other = around.features[match.index];
        votes[i].push_back(
            {rounded(other.x_px - voters.features[i].x_px), rounded(other.y_px - voters.features[i].y_px)});
      }
    }
  }

  const GraySource& source_;
  const FeatureOptions& options_;
  int threads_;
  std::map<std::int64_t, std::vector<PixelWindow>> windows_;  // what each band must hold
  std::map<std::int64_t, FeatureBand> bands_;
};

SelfVotes votes_of_tile(const PixelWindow& tile, std::span<const FeatureBand* const> bands, VoteSurface& surface) {
  SelfVotes result;
  for (const FeatureBand* band : bands) {
    const std::vector<Feature>& features = band->features.features;
    const auto first = std::lower_bound(band->by_x.begin(), band->by_x.end(), static_cast<float>(tile.col),
                                        [&](std::uint32_t index, float x_px) { return features[index].x_px < x_px; });
    const auto end_px = static_cast<float>(tile.col + tile.width);
    for (auto index = first; index != band->by_x.end() && features[*index].x_px < end_px; ++index) {
      const auto y = static_cast<double>(features[*index].y_px) - static_cast<double>(tile.row);
      if (y < 0 || y >= tile.height) continue;
      ++result.features;
      for (const Displacement vote : band->votes[*index]) surface.add(vote);
    }
  }
  if (result.features > 0) result.noise = surface.take_noise();
  return result;
}

}  // namespace

std::vector<SelfVotes> count_self_votes(const GraySource& source, const TileMatrix& matrix,
                                        std::span<const std::int64_t> tile_indices, const FeatureOptions& options,
                                        int threads, const Progress& progress) {
  for (const std::int64_t index : tile_indices) {
    if (index >= 0 && index < matrix.tile_count()) continue;
    throw UsageError("tile index " + std::to_string(index) + " is outside [0, " +
                     std::to_string(matrix.tile_count() - 1) + "]");
  }
  std::vector<SelfVotes> result(tile_indices.size());
  std::vector<VoteSurface> surfaces(static_cast<std::size_t>(thread_count(threads)));
  std::int64_t done = 0;
  for (const std::vector<std::size_t>& slab : tiles_by_slab(matrix, tile_indices, source.block_width_px)) {
    std::map<std::int64_t, std::vector<std::size_t>> rows;  // of tiles: indices in the result
    std::vector<std::int64_t> indices;
    for (const std::size_t i : slab) {
      indices.push_back(tile_indices[i]);
      rows[matrix.cell_of(tile_indices[i]).row].push_back(i);
    }
    FeatureBands bands(source, matrix, indices, options, threads);
    for (const auto& entry : rows) {
      const std::int64_t row = entry.first;
      const std::vector<std::size_t>& result_indices = entry.second;
      report_progress(progress, "counting votes", done, std::ssize(tile_indices));
      const std::int64_t first_band = row * matrix.stride_px / kFeatureBlockPx;
      const std::int64_t last_band = (row * matrix.stride_px + matrix.tile_size_px - 1) / kFeatureBlockPx;
      bands.forget_before(first_band - 1);
      std::vector<const FeatureBand*> touched;
      for (std::int64_t band = first_band; band <= last_band; ++band) {
        if (const FeatureBand* found = bands.with_votes(band)) touched.push_back(found);
      }
      parallel_for(result_indices.size(), threads, [&](std::size_t i, int worker) {
        const PixelWindow tile = matrix.tile_window(matrix.cell_of(tile_indices[result_indices[i]]));
        result[result_indices[i]] = votes_of_tile(tile, touched, surfaces[static_cast<std::size_t>(worker)]);
      });
      done += std::ssize(result_indices);
    }
  }
  report_progress(progress, "counting votes", done, done);
  return result;
}

}  // namespace pilotage
