#include "pilotage/vision/hamming.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>
#include <string>

#include "pilotage/base/error.h"
#include "pilotage/vision/hamming_kernel.h"

namespace pilotage {
namespace {

using hamming_detail::kSlotsPerBlock;
using hamming_detail::Nearest;
using hamming_detail::Scan;
using QueryWords = std::array<std::uint64_t, hamming_detail::kMostWords>;

/// Slots that all queries look at before the next ones: 16 KiB of 256-bit descriptors stay in the first cache.
constexpr std::size_t kSlotsPerChunk = 512;

/// Descriptors as words; the bits' order within a word is of no consequence, only that it is the same everywhere.
std::uint64_t word_of(const std::uint8_t* descriptor, int word) {
  std::uint64_t value = 0;
  std::memcpy(&value, descriptor + 8 * word, 8);
  return value;
}

Scan scan_of(HammingPath path) {
  const auto paths = hamming_paths();
  if (std::find(paths.begin(), paths.end(), path) == paths.end()) {
    throw UsageError("this machine cannot run the Hamming search " + std::string(hamming_path_name(path)));
  }
  switch (path) {
    case HammingPath::kAvx512:
      return hamming_detail::scan_avx512;
    case HammingPath::kAvx2:
      return hamming_detail::scan_avx2;
    case HammingPath::kNeon:
      return hamming_detail::scan_neon;
    case HammingPath::kPortable:
      break;
  }
  return hamming_detail::scan_portable;
}

void check_features(const FeatureSet& features, const char* what) {
  const int bytes = features.descriptor_bytes;
  if (!is_descriptor_length(8 * bytes)) {
    throw UsageError(std::string(what) + " have descriptors of " + std::to_string(bytes) +
                     " bytes, only these lengths can be searched: " + descriptor_byte_lengths());
  }
  if (features.descriptors.size() != features.size() * static_cast<std::size_t>(bytes)) {
    throw UsageError(std::string(what) + ": " + std::to_string(features.descriptors.size()) +
                     " bytes of descriptors do not fit " + std::to_string(features.size()) + " features of " +
                     std::to_string(bytes) + " bytes");
  }
}

void check_query(const FeatureSet& queries, int descriptor_bytes, int k) {
  check_features(queries, "the queries");
  if (queries.descriptor_bytes != descriptor_bytes) {
    throw UsageError("the queries have descriptors of " + std::to_string(queries.descriptor_bytes) +
                     " bytes, the index of " + std::to_string(descriptor_bytes));
  }
  if (k < 1 || k > kMaxHammingNeighbours) {
    throw UsageError("k = " + std::to_string(k) + " is outside [1, " + std::to_string(kMaxHammingNeighbours) + "]");
  }
}

/// Smallest and largest finite value of a coordinate; 0, 0 when there is none.
std::pair<double, double> extent(const std::vector<Feature>& features, float Feature::*coordinate) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const Feature& feature : features) {
    const auto value = static_cast<double>(feature.*coordinate);
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  return low <= high ? std::pair(low, high) : std::pair(0.0, 0.0);
}

QueryWords query_words(const FeatureSet& queries, std::size_t query) {
  QueryWords words{};
  for (int word = 0; word < queries.descriptor_bytes / 8; ++word) {
    words[static_cast<std::size_t>(word)] = word_of(queries.descriptor(query), word);
  }
  return words;
}

void store(const Nearest& nearest, HammingMatch* matches) {
  for (int i = 0; i < nearest.k; ++i) {
    const std::uint64_t key = nearest.keys[static_cast<std::size_t>(i)];
    const HammingMatch match{static_cast<std::uint32_t>(key), static_cast<std::uint32_t>(key >> 32)};
    matches[i] = match.found() ? match : HammingMatch{};
  }
}

void check_windows(const FeatureSet& queries, std::span<const HammingWindow> windows) {
  if (windows.size() == queries.size()) return;
  throw UsageError(std::to_string(windows.size()) + " windows were given for " + std::to_string(queries.size()) +
                   " queries");
}

HammingMatches empty_matches(std::size_t queries, int k) {
  return {k, std::vector<HammingMatch>(queries * static_cast<std::size_t>(k))};
}

}  // namespace

std::string_view hamming_path_name(HammingPath path) {
  switch (path) {
    case HammingPath::kPortable:
      return "portable";
    case HammingPath::kAvx2:
      return "avx2";
    case HammingPath::kAvx512:
      return "avx512";
    case HammingPath::kNeon:
      return "neon";
  }
  return "unknown";
}

std::vector<HammingPath> hamming_paths() {
  std::vector<HammingPath> paths{HammingPath::kPortable};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) paths.push_back(HammingPath::kAvx2);
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vpopcntdq")) {
    paths.push_back(HammingPath::kAvx512);
  }
#elif defined(__aarch64__)
  paths.push_back(HammingPath::kNeon);
#endif
  return paths;
}

HammingPath best_hamming_path() {
  static const HammingPath kBest = hamming_paths().back();
  return kBest;
}

HammingIndex::HammingIndex(const FeatureSet& features) {
  check_features(features, "the features");
  const std::size_t count = features.size();
  if (count >= std::numeric_limits<std::uint32_t>::max()) {
    throw UsageError(std::to_string(count) + " features are too many for one index");
  }
  words_ = features.descriptor_bytes / 8;

  // Rows of cells hold some 10 √n features, cells about 16: a window's ranges are then long enough for the search to
  // run at full speed, and little of them lies outside it.
  const auto make_axis = [&](float Feature::*coordinate, double cells) {
    const auto [low, high] = extent(features.features, coordinate);
    Axis axis{low, 1, std::max<std::size_t>(1, static_cast<std::size_t>(cells))};
    if (high > low) axis.cell_px = (high - low) / static_cast<double>(axis.count);
    return axis;
  };
  rows_ = make_axis(&Feature::y_px, std::sqrt(static_cast<double>(count)) / 10);
  cols_ = make_axis(&Feature::x_px, static_cast<double>(count) / static_cast<double>(rows_.count) / 16);

  std::vector<std::size_t> cell_of(count);
  cell_begin_.assign(rows_.count * cols_.count + 1, 0);
  for (std::size_t i = 0; i < count; ++i) {
    const Feature& feature = features.features[i];
    const std::size_t row = rows_.cell(static_cast<double>(feature.y_px));
    cell_of[i] = row * cols_.count + cols_.cell(static_cast<double>(feature.x_px));
    ++cell_begin_[cell_of[i] + 1];
  }
  std::partial_sum(cell_begin_.begin(), cell_begin_.end(), cell_begin_.begin());
  order_.resize(count);
  std::vector<std::size_t> next(cell_begin_.begin(), cell_begin_.end() - 1);
  for (std::size_t i = 0; i < count; ++i) order_[next[cell_of[i]]++] = static_cast<std::uint32_t>(i);

  const auto words = static_cast<std::size_t>(words_);
  blocks_.resize((count + kSlotsPerBlock - 1) / kSlotsPerBlock * words);
  for (std::size_t slot = 0; slot < count; ++slot) {
    const Feature& feature = features.features[order_[slot]];
    x_px_.push_back(feature.x_px);
    y_px_.push_back(feature.y_px);
    for (std::size_t word = 0; word < words; ++word) {
      blocks_[slot / kSlotsPerBlock * words + word].lanes[slot % kSlotsPerBlock] =
          word_of(features.descriptor(order_[slot]), static_cast<int>(word));
    }
  }
}

std::size_t HammingIndex::Axis::cell(double position_px) const {
  const double cell = (position_px - min_px) / cell_px;
  if (!(cell > 0)) return 0;  // NaN too
  return static_cast<std::size_t>(std::min(cell, static_cast<double>(count - 1)));
}

HammingMatches HammingIndex::find_nearest(const FeatureSet& queries, int k, HammingPath path) const {
  check_query(queries, descriptor_bytes(), k);
  const Scan scan = scan_of(path);
  HammingMatches result = empty_matches(queries.size(), k);
  if (size() == 0) return result;
  std::vector<Nearest> nearest(queries.size());
  std::vector<QueryWords> words(queries.size());
  for (std::size_t query = 0; query < queries.size(); ++query) {
    nearest[query].clear();
    nearest[query].k = k;
    nearest[query].order = order_.data();
    words[query] = query_words(queries, query);
  }
  for (std::size_t begin = 0; begin < size(); begin += kSlotsPerChunk) {
    const std::size_t end = std::min(begin + kSlotsPerChunk, size());
    for (std::size_t query = 0; query < queries.size(); ++query) {
      scan(blocks_[0].lanes, words_, words[query].data(), begin, end, nearest[query]);
    }
  }
  for (std::size_t query = 0; query < queries.size(); ++query) {
    store(nearest[query], result.matches.data() + query * static_cast<std::size_t>(k));
  }
  return result;
}

void HammingIndex::scan_window(const FeatureSet& queries, std::size_t query, const HammingWindow& window, Scan scan,
                               Nearest& nearest) const {
  // A window with a NaN edge holds nothing.
  if (!(window.min_x_px <= window.max_x_px && window.min_y_px <= window.max_y_px)) return;
  const auto words = query_words(queries, query);
  nearest.window = &window;
  const std::size_t first_col = cols_.cell(window.min_x_px);
  const std::size_t last_col = cols_.cell(window.max_x_px);
  const std::size_t last_row = rows_.cell(window.max_y_px);
  for (std::size_t row = rows_.cell(window.min_y_px); row <= last_row; ++row) {
    scan(blocks_[0].lanes, words_, words.data(), cell_begin_[row * cols_.count + first_col],
         cell_begin_[row * cols_.count + last_col + 1], nearest);
  }
}

HammingMatches HammingIndex::find_nearest(const FeatureSet& queries, std::span<const HammingWindow> windows, int k,
                                          HammingPath path, std::uint32_t max_distance) const {
  check_query(queries, descriptor_bytes(), k);
  check_windows(queries, windows);
  const Scan scan = scan_of(path);
  HammingMatches result = empty_matches(queries.size(), k);
  if (size() == 0) return result;
  Nearest nearest{{}, k, order_.data(), x_px_.data(), y_px_.data()};
  for (std::size_t query = 0; query < queries.size(); ++query) {
    nearest.clear(max_distance);
    scan_window(queries, query, windows[query], scan, nearest);
    store(nearest, result.matches.data() + query * static_cast<std::size_t>(k));
  }
  return result;
}

HammingLists HammingIndex::find_within(const FeatureSet& queries, std::span<const HammingWindow> windows,
                                       std::uint32_t max_distance, HammingPath path) const {
  check_query(queries, descriptor_bytes(), 1);
  check_windows(queries, windows);
  const Scan scan = scan_of(path);
  HammingLists result{{0}, {}};
  std::vector<std::uint64_t> keys;
  Nearest nearest{{}, 1, order_.data(), x_px_.data(), y_px_.data()};
  nearest.all = &keys;
  nearest.clear(max_distance);
  for (std::size_t query = 0; query < queries.size(); ++query) {
    keys.clear();
    if (size() > 0) scan_window(queries, query, windows[query], scan, nearest);
    std::sort(keys.begin(), keys.end());
    for (const std::uint64_t key : keys) {
      result.matches.push_back({static_cast<std::uint32_t>(key), static_cast<std::uint32_t>(key >> 32)});
    }
    result.begin.push_back(result.matches.size());
  }
  return result;
}

}  // namespace pilotage
