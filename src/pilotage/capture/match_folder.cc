#include "pilotage/capture/match_folder.h"

#include <algorithm>
#include <cstring>
#include <string_view>
#include <utility>

#include <opencv2/core/utility.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/file_digest.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/read_file.h"

namespace pilotage {
namespace {

constexpr std::size_t kDigestChars = 64;
constexpr std::size_t kNameChars = 24;  // of a digest: 96 bits
constexpr std::int64_t kDescriptorBytes = 128;
constexpr std::int64_t kMostFeatures = 1'000'000;

/// What every file begins with.
std::string made_by() {
  return "pilotage-capture-matches " + std::to_string(kMatchRevision) + "\nOpenCV " + cv::getVersionString() + "\n";
}

template <class T>
void append(std::string& bytes, const T* values, std::size_t count) {
  bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

/// Takes values off the front of bytes; false when there are too few.
class BytesReader {
 public:
  explicit BytesReader(std::string_view bytes) : rest_(bytes) {}

  template <class T>
  bool take(T* to, std::size_t count) {
    if (rest_.size() / sizeof(T) < count) return false;
    if (count > 0) std::memcpy(to, rest_.data(), count * sizeof(T));
    rest_.remove_prefix(count * sizeof(T));
    return true;
  }
  bool is_at_end() const { return rest_.empty(); }

 private:
  std::string_view rest_;
};

std::string features_bytes(const FrameFeatures& features) {
  std::string bytes;
  const std::int64_t count = std::ssize(features.pixels);
  append(bytes, &count, 1);
  append(bytes, &features.pixel_sigma_px, 1);
  for (const Eigen::Vector2d& pixel : features.pixels) append(bytes, pixel.data(), 2);
  for (int row = 0; row < features.descriptors.rows; ++row) {
    append(bytes, features.descriptors.ptr(row), static_cast<std::size_t>(kDescriptorBytes));
  }
  return bytes;
}

std::optional<FrameFeatures> features_from(std::string_view bytes) {
  BytesReader reader(bytes);
  FrameFeatures features;
  std::int64_t count = 0;
  if (!reader.take(&count, 1) || count < 0 || count > kMostFeatures || !reader.take(&features.pixel_sigma_px, 1)) {
    return std::nullopt;
  }
  features.pixels.resize(static_cast<std::size_t>(count));
  for (Eigen::Vector2d& pixel : features.pixels) {
    if (!reader.take(pixel.data(), 2)) return std::nullopt;
  }
  if (count > 0) features.descriptors.create(static_cast<int>(count), static_cast<int>(kDescriptorBytes), CV_8U);
  if (!reader.take(features.descriptors.data, static_cast<std::size_t>(count * kDescriptorBytes)) ||
      !reader.is_at_end()) {
    return std::nullopt;
  }
  return features;
}

std::string matches_bytes(const FeatureMatches& matches) {
  std::string bytes;
  const std::int64_t count = std::ssize(matches);
  append(bytes, &count, 1);
  for (const auto& match : matches) append(bytes, match.data(), 2);
  return bytes;
}

std::optional<FeatureMatches> matches_from(std::string_view bytes, std::size_t firsts, std::size_t seconds) {
  BytesReader reader(bytes);
  std::int64_t count = 0;
  if (!reader.take(&count, 1) || count < 0 || count > kMostFeatures) return std::nullopt;
  FeatureMatches matches(static_cast<std::size_t>(count));
  for (auto& match : matches) {
    if (!reader.take(match.data(), 2)) return std::nullopt;
    if (match[0] < 0 || static_cast<std::size_t>(match[0]) >= firsts) return std::nullopt;
    if (match[1] < 0 || static_cast<std::size_t>(match[1]) >= seconds) return std::nullopt;
  }
  if (!reader.is_at_end()) return std::nullopt;
  return matches;
}

/// In one of 256 folders, so that none of them becomes long.
std::filesystem::path place_of(const std::filesystem::path& folder, const std::string& name, const char* ending) {
  return folder / name.substr(0, 2) / (name + ending);
}

std::filesystem::path features_file(const std::filesystem::path& folder, const std::string& picture_digest) {
  return place_of(folder, picture_digest.substr(0, kNameChars), ".features");
}

std::filesystem::path matches_file(const std::filesystem::path& folder, const FrameFeatures& first,
                                   const FrameFeatures& second) {
  return place_of(folder, bytes_digest(first.digest + second.digest).substr(0, kNameChars), ".matches");
}

std::string what_features(const std::string& picture_digest) {
  return "features of " + picture_digest + "\n";
}

std::string what_matches(const FrameFeatures& first, const FrameFeatures& second) {
  return "matches of " + first.digest + " and " + second.digest + "\n";
}

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw DataError(folder.string() + ": cannot be made: " + error.message());
}

void keep(const std::filesystem::path& file, const std::string& what, const std::string& content) {
  make_folder(file.parent_path());
  const std::string bytes = made_by() + what + content;
  write_file(file, bytes + bytes_digest(bytes), true);
}

}  // namespace

MatchFolder::MatchFolder(std::filesystem::path folder) : folder_(std::move(folder)) {
  make_folder(folder_);
}

/// What stands between the beginning and the digest, if the file is there and can be used.
std::optional<std::string> MatchFolder::find(const std::filesystem::path& file, const std::string& what) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return std::nullopt;
  std::string bytes;
  try {
    bytes = read_file(file);
  } catch (const DataError&) {
    ++unusable_;
    return std::nullopt;
  }
  const std::string begin = made_by() + what;
  const std::size_t end = bytes.size() - std::min(bytes.size(), kDigestChars);
  if (!bytes.starts_with(begin) || end < begin.size() ||
      bytes_digest(std::string_view(bytes).substr(0, end)) != std::string_view(bytes).substr(end)) {
    ++unusable_;
    return std::nullopt;
  }
  return bytes.substr(begin.size(), end - begin.size());
}

std::optional<FrameFeatures> MatchFolder::find_features(const std::string& picture_digest) {
  const auto bytes = find(features_file(folder_, picture_digest), what_features(picture_digest));
  if (!bytes) return std::nullopt;
  std::optional<FrameFeatures> features = features_from(*bytes);
  if (!features) {
    ++unusable_;
    return std::nullopt;
  }
  features->digest = bytes_digest(*bytes);
  return features;
}

std::optional<FeatureMatches> MatchFolder::find_matches(const FrameFeatures& first, const FrameFeatures& second) {
  const auto bytes = find(matches_file(folder_, first, second), what_matches(first, second));
  if (!bytes) return std::nullopt;
  std::optional<FeatureMatches> matches = matches_from(*bytes, first.pixels.size(), second.pixels.size());
  if (!matches) ++unusable_;
  return matches;
}

void MatchFolder::keep_features(const std::string& picture_digest, FrameFeatures& features) const {
  const std::string bytes = features_bytes(features);
  features.digest = bytes_digest(bytes);
  keep(features_file(folder_, picture_digest), what_features(picture_digest), bytes);
}

void MatchFolder::keep_matches(const FrameFeatures& first, const FrameFeatures& second,
                               const FeatureMatches& matches) const {
  keep(matches_file(folder_, first, second), what_matches(first, second), matches_bytes(matches));
}

std::string MatchFolder::warning() const {
  if (unusable_ == 0) return "";
  return folder_.string() +
         ": files that are damaged or of another revision or OpenCV, and were not used: " + std::to_string(unusable_);
}

}  // namespace pilotage
