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
    case HammingPath::kPortable:
      break;
  }
  return hamming_detail::scan_portable;
}

void check_features(const FeatureSet& features, const char* what) {
  const int bytes = features.descriptor_bytes;
  if (bytes != 16 && bytes != 32 && bytes != 64) {
    throw UsageError(std::string(what) + " have descriptors of " + std::to_string(bytes) +
                     " bytes, only 16, 32 and 64 can be searched");
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

/// Sorting needs an order: NaN goes where no window reaches it.
float sortable(float position) {
  return std::isnan(position) ? std::numeric_limits<float>::infinity() : position;
}

std::array<std::uint64_t, 8> query_words(const FeatureSet& queries, std::size_t query) {
  std::array<std::uint64_t, 8> words{};
  for (int word = 0; word < queries.descriptor_bytes / 8; ++word) {
    words[static_cast<std::size_t>(word)] = word_of(queries.descriptor(query), word);
  }
  return words;
}

void store(const Nearest& nearest, HammingMatch* matches) {
  for (int i = 0; i < nearest.k; ++i) {
    const std::uint64_t key = nearest.keys[static_cast<std::size_t>(i)];
    matches[i] = {static_cast<std::uint32_t>(key), static_cast<std::uint32_t>(key >> 32)};
  }
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

  // Bands of rows, about as many features high as 1/5 of a row is long: a window then wastes little at its edges, and
  // its ranges stay long enough for the search to run at full speed.
  double max_y_px = -std::numeric_limits<double>::infinity();
  double min_y_px = std::numeric_limits<double>::infinity();
  for (const Feature& feature : features.features) {
    if (!std::isfinite(feature.y_px)) continue;
    min_y_px = std::min(min_y_px, static_cast<double>(feature.y_px));
    max_y_px = std::max(max_y_px, static_cast<double>(feature.y_px));
  }
  const auto bands = std::max<std::size_t>(1, static_cast<std::size_t>(std::sqrt(static_cast<double>(count)) / 5));
  if (min_y_px < max_y_px) {
    band_min_y_px_ = min_y_px;
    band_height_px_ = (max_y_px - min_y_px) / static_cast<double>(bands);
  }
  std::vector<std::uint32_t> band_of(count);
  for (std::size_t i = 0; i < count; ++i) band_of[i] = band_of_y(features.features[i].y_px, bands);

  order_.resize(count);
  std::iota(order_.begin(), order_.end(), 0U);
  std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (band_of[a] != band_of[b]) return band_of[a] < band_of[b];
    const float x_a = sortable(features.features[a].x_px);
    const float x_b = sortable(features.features[b].x_px);
    return x_a != x_b ? x_a < x_b : a < b;
  });

  band_begin_.assign(bands + 1, 0);
  for (const std::uint32_t band : band_of) ++band_begin_[band + 1];
  std::partial_sum(band_begin_.begin(), band_begin_.end(), band_begin_.begin());

  const auto words = static_cast<std::size_t>(words_);
  blocks_.resize((count + kSlotsPerBlock - 1) / kSlotsPerBlock * words);
  for (std::size_t slot = 0; slot < count; ++slot) {
    const Feature& feature = features.features[order_[slot]];
    x_px_.push_back(sortable(feature.x_px));
    y_px_.push_back(feature.y_px);
    for (std::size_t word = 0; word < words; ++word) {
      blocks_[slot / kSlotsPerBlock * words + word].lanes[slot % kSlotsPerBlock] =
          word_of(features.descriptor(order_[slot]), static_cast<int>(word));
    }
  }
}

std::uint32_t HammingIndex::band_of_y(double y_px, std::size_t bands) const {
  const double band = (y_px - band_min_y_px_) / band_height_px_;
  if (!(band > 0)) return 0;  // NaN too
  return static_cast<std::uint32_t>(std::min(band, static_cast<double>(bands - 1)));
}

HammingMatches HammingIndex::find_nearest(const FeatureSet& queries, int k, HammingPath path) const {
  check_query(queries, descriptor_bytes(), k);
  const Scan scan = scan_of(path);
  HammingMatches result = empty_matches(queries.size(), k);
  if (size() == 0) return result;
  std::vector<Nearest> nearest(queries.size());
  std::vector<std::array<std::uint64_t, 8>> words(queries.size());
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

HammingMatches HammingIndex::find_nearest(const FeatureSet& queries, std::span<const HammingWindow> windows, int k,
                                          HammingPath path) const {
  check_query(queries, descriptor_bytes(), k);
  if (windows.size() != queries.size()) {
    throw UsageError(std::to_string(windows.size()) + " windows were given for " + std::to_string(queries.size()) +
                     " queries");
  }
  const Scan scan = scan_of(path);
  HammingMatches result = empty_matches(queries.size(), k);
  if (size() == 0) return result;
  const std::size_t bands = band_begin_.size() - 1;
  Nearest nearest;
  nearest.k = k;
  nearest.order = order_.data();
  nearest.x_px = x_px_.data();
  nearest.y_px = y_px_.data();
  for (std::size_t query = 0; query < queries.size(); ++query) {
    const HammingWindow& window = windows[query];
    const auto words = query_words(queries, query);
    nearest.clear();
    nearest.window = &window;
    // A window with a NaN edge holds nothing.
    if (window.min_x_px <= window.max_x_px && window.min_y_px <= window.max_y_px) {
      const std::size_t last_band = band_of_y(window.max_y_px, bands);
      for (std::size_t band = band_of_y(window.min_y_px, bands); band <= last_band; ++band) {
        const auto first = x_px_.begin() + static_cast<std::ptrdiff_t>(band_begin_[band]);
        const auto last = x_px_.begin() + static_cast<std::ptrdiff_t>(band_begin_[band + 1]);
        const auto from = std::partition_point(first, last, [&](float x) { return x < window.min_x_px; });
        const auto to = std::partition_point(from, last, [&](float x) { return x <= window.max_x_px; });
        scan(blocks_[0].lanes, words_, words.data(), static_cast<std::size_t>(from - x_px_.begin()),
             static_cast<std::size_t>(to - x_px_.begin()), nearest);
      }
    }
    store(nearest, result.matches.data() + query * static_cast<std::size_t>(k));
  }
  return result;
}

}  // namespace pilotage
