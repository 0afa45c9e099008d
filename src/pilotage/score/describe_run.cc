#include "pilotage/score/describe_run.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/file_digest.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/utf8.h"
#include "pilotage/ground/ground_imagery.h"
#include "pilotage/raster/gdal_io.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uintmax_t kPieces = 16;
constexpr std::uintmax_t kPieceBytes = 16384;

std::string shown(const Json& json) {
  std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  return text.size() > 80 ? text.substr(0, 80) + "…" : text;
}

/// Of a file of this machine; null for what is none.
Json fingerprint(const std::string& name) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(name, error)) return nullptr;
  const std::uintmax_t size = std::filesystem::file_size(name, error);
  if (error) throw DataError(name + ": cannot be read: " + error.message());
  const bool whole = size <= kPieces * kPieceBytes;
  std::string bytes;
  std::string piece(kPieceBytes, '\0');
  std::ifstream stream(name, std::ios::binary);
  for (std::uintmax_t i = 0; i < kPieces; ++i) {
    stream.seekg(static_cast<std::streamoff>(whole ? i * kPieceBytes : (size - kPieceBytes) / (kPieces - 1) * i));
    const std::uintmax_t length = whole ? std::min(kPieceBytes, size - std::min(size, i * kPieceBytes)) : kPieceBytes;
    stream.read(piece.data(), static_cast<std::streamsize>(length));
    if (!stream) throw DataError(name + ": cannot be read: " + std::strerror(errno));
    bytes.append(piece, 0, length);
  }
  return {{"bytes", size}, {"fingerprint", bytes_digest(bytes)}};
}

/// Gray values and masks of 8 x 8 windows spread evenly over a source.
std::string sample_digest(const GraySource& source, const Progress& progress) {
  constexpr int kSamples = 8;
  constexpr std::int64_t kSide = 32;
  std::string bytes;
  const auto append = [&](const cv::Mat& image) {
    for (int row = 0; row < image.rows; ++row) {
      bytes.append(reinterpret_cast<const char*>(image.ptr(row)),
                   static_cast<std::size_t>(image.cols) * image.elemSize());
    }
  };
  const auto width = static_cast<int>(std::min(kSide, source.width_px));
  const auto height = static_cast<int>(std::min(kSide, source.height_px));
  for (int i = 0; i < kSamples; ++i) {
    for (int j = 0; j < kSamples; ++j) {
      report_progress(progress, "looking at the imagery", 0, 0);
      const Raster raster = source.read({(source.width_px - width) * j / (kSamples - 1),
                                         (source.height_px - height) * i / (kSamples - 1), width, height});
      append(raster.valid);
      cv::Mat pixels = raster.pixels.clone();
      pixels.setTo(0, raster.valid == 0);  // what is not ground may be anything
      append(pixels);
    }
  }
  return bytes_digest(bytes);
}

/// Every file or dataset string that the result depends on, each once.
std::set<std::string> sources_of(const ScoreRun& run) {
  std::set<std::string> names(run.inputs.begin(), run.inputs.end());
  names.insert(run.options.score.second_epoch.begin(), run.options.score.second_epoch.end());
  if (!run.options.score.model.empty()) names.insert(run.options.score.model);
  for (const std::string& dataset : dataset_names(run.ground.imagery)) names.insert(dataset);
  if (!run.ground.elevation.empty()) names.insert(run.ground.elevation);
  return names;
}

Json samples_of(const ScoreRun& run, const Progress& progress) {
  Json samples = Json::array();
  for (const GridLevel& level : run.ground.levels)
    samples.push_back(sample_digest(open_gray(run.ground, level), progress));
  for (const std::string& dataset : run.options.score.second_epoch)
    samples.push_back(sample_digest(open_gray(dataset, second_date_options(run.ground.imagery.options)), progress));
  return samples;
}

/// "files.a/b.tif.bytes" of the JSON pointer "/files/a~1b.tif/bytes" (RFC 6901).
std::string dotted(const std::string& pointer) {
  std::string text;
  for (std::size_t i = 1; i < pointer.size(); ++i) {
    if (pointer[i] == '~' && i + 1 < pointer.size()) {
      text += pointer[++i] == '1' ? '/' : '~';
    } else {
      text += pointer[i] == '/' ? '.' : pointer[i];
    }
  }
  return text;
}

}  // namespace

Json describe_run(const ScoreRun& run, const std::string& software_version, const Progress& progress) {
  Json inputs = Json::array();
  for (const std::string& name : run.inputs) inputs.push_back(name_as_utf8(name));
  Json files = Json::object();
  for (const std::string& name : sources_of(run)) files[name_as_utf8(name)] = fingerprint(name);
  ScoreRunOptions options = run.options;
  return {{"program", software_version},
          {"inputs", inputs},
          {"seed", run.seed},
          {"options", options_to_json(list_options(options))},
          {"files", files},
          {"samples", samples_of(run, progress)}};
}

ScoreRun open_described_run(const std::string& name, const Json& description) {
  JsonObject run(description, name + ": run");
  std::vector<std::string> inputs = run.texts("inputs");
  for (std::string& input : inputs) input = bytes_of_name(input);
  const std::int64_t seed = run.integer("seed", 0);
  ScoreRunOptions options;
  try {
    set_options_from_json(list_options(options), run.value("options"), name);
  } catch (const UsageError& error) {
    throw DataError(error.what());
  }
  return open_score_run(inputs, options, static_cast<std::uint64_t>(seed));
}

std::string run_difference(const Json& run, const Json& other) {
  if (run == other) return "";
  const Json flat = run.flatten();
  const Json flat_other = other.flatten();
  for (const auto& [key, value] : flat.items()) {
    const auto found = flat_other.find(key);
    if (found == flat_other.end()) return dotted(key) + ": " + shown(value) + ", not there in the other";
    if (*found != value) return dotted(key) + ": " + shown(value) + ", not " + shown(*found);
  }
  for (const auto& [key, value] : flat_other.items()) {
    if (!flat.contains(key)) return dotted(key) + ": not there, " + shown(value) + " in the other";
  }
  return "order of the keys";
}

}  // namespace pilotage
