#include "pilotage/capture/match_folder.h"

#include <cstring>
#include <utility>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/file_digest.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/read_file.h"

namespace pilotage {
namespace {

constexpr const char* kPictureMagic = "pilotage-picture 1\n";
constexpr const char* kMatchesMagic = "pilotage-matches 1\n";
constexpr std::size_t kDigestChars = 64;
constexpr std::size_t kNameChars = 24;  // of a digest: names stay short, and no two pictures share one
constexpr int kDescriptorBytes = 128;
constexpr int kMostFeatures = 1'000'000;
constexpr int kMostSide_px = 1 << 20;

std::filesystem::path file_of(const std::filesystem::path& folder, const std::string& digest, const char* ending) {
  return folder / (digest.substr(0, kNameChars) + ending);
}

void append_bytes(std::string& bytes, const void* from, std::size_t count) {
  bytes.append(static_cast<const char*>(from), count);
}

/// A header of one line of JSON, and the bytes behind it.
struct KeptFile {
  nlohmann::ordered_json header;
  std::string_view body;
};

KeptFile split(const std::string& name, const std::string& bytes) {
  const std::size_t end = bytes.find('\n');
  if (end == std::string::npos) throw DataError(name + ": has no header");
  return {parse_json(name, std::string_view(bytes).substr(0, end)), std::string_view(bytes).substr(end + 1)};
}

/// Takes values off the front of a body. Throws DataError when it is too short.
class BodyReader {
 public:
  BodyReader(const std::string& name, std::string_view body) : name_(name), rest_(body) {}
  void take(void* to, std::size_t count) {
    if (rest_.size() < count) throw DataError(name_ + ": is too short");
    if (count > 0) std::memcpy(to, rest_.data(), count);
    rest_.remove_prefix(count);
  }
  void finish() const {
    if (!rest_.empty()) throw DataError(name_ + ": is too long");
  }

 private:
  const std::string& name_;
  std::string_view rest_;
};

FramePicture picture_from(const std::string& name, const std::string& bytes) {
  const KeptFile file = split(name, bytes);
  JsonObject header(file.header, name);
  FramePicture picture;
  picture.digest = header.text("picture");
  picture.width_px = header.small_integer("width_px", 1, kMostSide_px);
  picture.height_px = header.small_integer("height_px", 1, kMostSide_px);
  picture.features.pixel_sigma_px = header.positive_number("pixel_sigma_px");
  const int features = header.small_integer("features", 0, kMostFeatures);
  picture.small.create(header.small_integer("small_height_px", 1, 4096),
                       header.small_integer("small_width_px", 1, 4096), CV_8UC3);
  header.finish();
  BodyReader body(name, file.body);
  picture.features.pixels.resize(static_cast<std::size_t>(features));
  for (Eigen::Vector2d& pixel : picture.features.pixels) body.take(pixel.data(), 2 * sizeof(double));
  if (features > 0) picture.features.descriptors.create(features, kDescriptorBytes, CV_8U);
  body.take(picture.features.descriptors.data, static_cast<std::size_t>(features) * kDescriptorBytes);
  body.take(picture.small.data, picture.small.total() * picture.small.elemSize());
  body.finish();
  return picture;
}

MatchesWith matches_from(const std::string& name, const std::string& digest, const std::string& bytes) {
  const KeptFile file = split(name, bytes);
  JsonObject header(file.header, name);
  if (header.text("picture") != digest) throw DataError(name + ": is of another picture");
  BodyReader body(name, file.body);
  MatchesWith matches;
  for (JsonObject& with : header.objects("with")) {
    FeatureMatches& one = matches[with.text("picture")];
    one.resize(static_cast<std::size_t>(with.small_integer("matches", 0, kMostFeatures)));
    with.finish();
    for (auto& match : one) {
      std::array<std::int32_t, 2> numbers{};
      body.take(numbers.data(), sizeof(numbers));
      match = {numbers[0], numbers[1]};
    }
  }
  header.finish();
  body.finish();
  return matches;
}

}  // namespace

MatchFolder::MatchFolder(std::filesystem::path folder, std::string software_version)
    : folder_(std::move(folder)), software_version_(std::move(software_version)) {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) throw DataError(folder_.string() + ": cannot be made: " + error.message());
}

/// The bytes between what says that it can be used, and the digest.
std::optional<std::string> MatchFolder::find(const std::filesystem::path& file, const std::string& magic) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return std::nullopt;
  std::string bytes = read_file(file);
  const std::string begin = magic + software_version_ + "\n";
  if (!bytes.starts_with(begin) || bytes.size() < begin.size() + kDigestChars ||
      bytes_digest(std::string_view(bytes).substr(0, bytes.size() - kDigestChars)) !=
          std::string_view(bytes).substr(bytes.size() - kDigestChars)) {
    ++unusable_;
    return std::nullopt;
  }
  return bytes.substr(begin.size(), bytes.size() - begin.size() - kDigestChars);
}

std::optional<FramePicture> MatchFolder::find_picture(const std::string& digest) {
  const std::filesystem::path file = file_of(folder_, digest, ".picture");
  const std::optional<std::string> bytes = find(file, kPictureMagic);
  if (!bytes) return std::nullopt;
  FramePicture picture = picture_from(file.string(), *bytes);
  if (picture.digest != digest) throw DataError(file.string() + ": is of another picture");
  return picture;
}

void MatchFolder::keep_picture(const FramePicture& picture) const {
  const FrameFeatures& features = picture.features;
  const nlohmann::ordered_json header{{"picture", picture.digest},
                                      {"width_px", picture.width_px},
                                      {"height_px", picture.height_px},
                                      {"pixel_sigma_px", features.pixel_sigma_px},
                                      {"features", features.pixels.size()},
                                      {"small_width_px", picture.small.cols},
                                      {"small_height_px", picture.small.rows}};
  std::string bytes = kPictureMagic + software_version_ + "\n" + header.dump() + "\n";
  for (const Eigen::Vector2d& pixel : features.pixels) append_bytes(bytes, pixel.data(), 2 * sizeof(double));
  for (int row = 0; row < features.descriptors.rows; ++row) {
    append_bytes(bytes, features.descriptors.ptr(row), kDescriptorBytes);
  }
  for (int row = 0; row < picture.small.rows; ++row) {
    append_bytes(bytes, picture.small.ptr(row),
                 static_cast<std::size_t>(picture.small.cols) * picture.small.elemSize());
  }
  write_file(file_of(folder_, picture.digest, ".picture"), bytes + bytes_digest(bytes), true);
}

MatchesWith MatchFolder::find_matches(const std::string& digest_of_first) {
  const std::filesystem::path file = file_of(folder_, digest_of_first, ".matches");
  const std::optional<std::string> bytes = find(file, kMatchesMagic);
  return bytes ? matches_from(file.string(), digest_of_first, *bytes) : MatchesWith{};
}

void MatchFolder::keep_matches(const std::string& digest_of_first, const MatchesWith& matches) const {
  nlohmann::ordered_json with = nlohmann::ordered_json::array();
  std::string body;
  for (const auto& [digest, one] : matches) {
    with.push_back({{"picture", digest}, {"matches", one.size()}});
    for (const auto& [first, second] : one) {
      const std::array<std::int32_t, 2> numbers{first, second};
      append_bytes(body, numbers.data(), sizeof(numbers));
    }
  }
  const nlohmann::ordered_json header{{"picture", digest_of_first}, {"with", std::move(with)}};
  const std::string bytes = kMatchesMagic + software_version_ + "\n" + header.dump() + "\n" + body;
  write_file(file_of(folder_, digest_of_first, ".matches"), bytes + bytes_digest(bytes), true);
}

std::string MatchFolder::warning() const {
  if (unusable_ == 0) return "";
  return folder_.string() + ": files that were damaged or of another version of the program, and were made anew: " +
         std::to_string(unusable_);
}

}  // namespace pilotage
