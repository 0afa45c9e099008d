#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "pilotage/vision/feature_set.h"

namespace pilotage {

namespace hamming_detail {
struct Nearest;
/// Offers to `nearest` every slot of [begin, end) that may be among those sought of `query`. `blocks` holds `words` × 8
/// numbers for each eight slots, aligned to 64 bytes. `words` is one of kDescriptorWords.
using Scan = void (*)(const std::uint64_t* blocks, int words, const std::uint64_t* query, std::size_t begin,
                      std::size_t end, Nearest& nearest);
}  // namespace hamming_detail

/// Implementations of the search; all give the same result.
enum class HammingPath {
  kPortable,  ///< Any machine.
  kAvx2,      ///< x86-64 with AVX2: byte-wise table look-up.
  kAvx512,    ///< x86-64 with AVX-512 VPOPCNTDQ.
  kNeon,      ///< 64-bit ARM: every one of them has it.
};

std::string_view hamming_path_name(HammingPath path);

/// The paths this machine can run, slowest first; the last is what the search uses unless told otherwise.
std::vector<HammingPath> hamming_paths();
HammingPath best_hamming_path();

inline constexpr int kMaxHammingNeighbours = 8;

/// A neighbour of a query descriptor.
struct HammingMatch {
  std::uint32_t index = std::numeric_limits<std::uint32_t>::max();     ///< In the feature set the index was made from.
  std::uint32_t distance = std::numeric_limits<std::uint32_t>::max();  ///< Number of differing bits.

  bool found() const { return index != std::numeric_limits<std::uint32_t>::max(); }
  bool operator==(const HammingMatch&) const = default;
};

/// The k nearest of each query, nearest first, equal distances in the order of the index. Where there are fewer than k
/// candidates the rest is not found().
struct HammingMatches {
  int k = 0;
  std::vector<HammingMatch> matches;  ///< Query after query, k each.

  std::span<const HammingMatch> of_query(std::size_t query) const {
    return {matches.data() + query * static_cast<std::size_t>(k), static_cast<std::size_t>(k)};
  }
};

/// All neighbours of each query, query after query, nearest first, equal distances in the order of the index.
struct HammingLists {
  std::vector<std::size_t> begin;  ///< Of each query's neighbours in `matches`, and the end.
  std::vector<HammingMatch> matches;

  std::span<const HammingMatch> of_query(std::size_t query) const {
    return {matches.data() + begin[query], begin[query + 1] - begin[query]};
  }
};

/// A rectangle of positions; its edges belong to it.
struct HammingWindow {
  double min_x_px;
  double min_y_px;
  double max_x_px;
  double max_y_px;
};

/// Descriptors laid out for the search: blocks of eight descriptors, word after word, sorted by position (cells of
/// a grid, row by row) so that the candidates of a window are one contiguous range for each row of cells. Positions and
/// descriptors are copied: the feature set need not outlive it.
class HammingIndex {
 public:
  /// Descriptors of one of kDescriptorWords. Any positions are allowed; one that is NaN lies in no window.
  /// Throws UsageError for other lengths, when the descriptors' size does not fit the number of features, or for 2³² −
  /// 1 features or more.
  explicit HammingIndex(const FeatureSet& features);

  std::size_t size() const { return order_.size(); }
  int descriptor_bytes() const { return words_ * 8; }

  /// The k (1 … 8) nearest of each query among all features. Exact. Throws UsageError when the queries' descriptors
  /// have another length, k is out of range, or the machine cannot run `path`. Thread-safe.
  HammingMatches find_nearest(const FeatureSet& queries, int k, HammingPath path = best_hamming_path()) const;

  /// The same among the features inside the query's own window that are at most `max_distance` bits away; `windows` has
  /// one for each query.
  HammingMatches find_nearest(const FeatureSet& queries, std::span<const HammingWindow> windows, int k,
                              HammingPath path = best_hamming_path(),
                              std::uint32_t max_distance = std::numeric_limits<std::uint32_t>::max()) const;

  /// All features inside each query's window that are at most `max_distance` bits away. Exact; throws as find_nearest.
  HammingLists find_within(const FeatureSet& queries, std::span<const HammingWindow> windows,
                           std::uint32_t max_distance, HammingPath path = best_hamming_path()) const;

 private:
  struct Block {
    alignas(64) std::uint64_t lanes[8];
  };

  /// A row or column of the grid of cells that the slots are sorted by; what lies outside belongs to the nearest one.
  struct Axis {
    double min_px = 0;
    double cell_px = 1;
    std::size_t count = 1;

    std::size_t cell(double position_px) const;
  };

  /// Offers the slots that can lie in `window` to `nearest`, which knows the window.
  void scan_window(const FeatureSet& queries, std::size_t query, const HammingWindow& window, hamming_detail::Scan scan,
                   hamming_detail::Nearest& nearest) const;

  int words_ = 4;
  std::vector<Block> blocks_;         ///< words_ for each eight slots: word w of all eight, then word w + 1.
  std::vector<std::uint32_t> order_;  ///< Index of a slot's feature.
  std::vector<float> x_px_;           ///< By slot.
  std::vector<float> y_px_;
  Axis rows_;
  Axis cols_;
  std::vector<std::size_t> cell_begin_;  ///< First slot of each cell, row by row, and the end.
};

}  // namespace pilotage
