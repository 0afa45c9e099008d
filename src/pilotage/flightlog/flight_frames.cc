#include "pilotage/flightlog/flight_frames.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

std::optional<Camera> camera_without_exif(const FrameSources& sources) {
  return sources.given ? sources.given : sources.of_map;
}

Camera require_camera(const std::optional<Camera>& camera, const std::string& path) {
  if (camera) return *camera;
  throw UsageError(path + ": there is no camera: the map has none; give --camera");
}

bool is_picture(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr std::array<std::string_view, 6> kPictures{".jpg", ".jpeg", ".png", ".tif", ".tiff", ".pgm"};
  return std::find(kPictures.begin(), kPictures.end(), extension) != kPictures.end();
}

/// How texts are ordered in which numbers count as numbers: IMG_9 before IMG_10.
bool less_with_numbers(std::string_view a, std::string_view b) {
  const auto digits = [](std::string_view text) {
    const std::size_t end = text.find_first_not_of("0123456789");
    return text.substr(0, end);
  };
  const auto value = [](std::string_view number) {
    return number.substr(std::min(number.find_first_not_of('0'), number.size()));
  };
  const std::string_view whole_a = a;
  const std::string_view whole_b = b;
  while (!a.empty() && !b.empty()) {
    const std::string_view number_a = digits(a);
    const std::string_view number_b = digits(b);
    if (!number_a.empty() && !number_b.empty()) {
      const std::string_view value_a = value(number_a);
      const std::string_view value_b = value(number_b);
      if (value_a.size() != value_b.size()) return value_a.size() < value_b.size();
      if (value_a != value_b) return value_a < value_b;
      a.remove_prefix(number_a.size());
      b.remove_prefix(number_b.size());
    } else {
      if (a.front() != b.front()) return a.front() < b.front();
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  if (a.size() != b.size()) return a.size() < b.size();
  return whole_a < whole_b;
}

}  // namespace

std::vector<std::string> pictures_of_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (is_picture(entry.path())) files.push_back(entry.path().filename().string());
  }
  if (error) throw DataError(folder.string() + ": cannot be read as a folder: " + error.message());
  if (files.empty()) throw DataError(folder.string() + ": holds no picture (jpg, jpeg, png, tif, tiff, pgm)");
  std::sort(files.begin(), files.end(), less_with_numbers);
  return files;
}

FlightFrames complete_frame(const std::string& path, const FrameRecord& frame, const FrameSources& sources) {
  FlightFrames done;
  FlightFrame complete{path, frame, {}};
  std::optional<Camera> camera = camera_without_exif(sources);
  std::optional<FrameExif> exif;
  if (sources.from_exif) exif = frame_exif(read_image_metadata(path));
  if (exif) {
    for (const std::string& warning : exif->warnings) done.warnings.push_back(path + ": " + warning);
  }
  if (auto own = exif && !sources.given ? exif_camera(*exif) : std::nullopt) {
    own->value.mount = sources.exif_mount;
    camera = own->value;
    done.taken.push_back({frame.file, "camera.fx_px", own->value.fx_px, own->tag});
  }
  complete.camera = require_camera(camera, path);
  if (exif) {
    const std::vector<TakenField> filled = fill_from_exif(complete.frame, *exif, complete.camera.mount);
    done.taken.insert(done.taken.end(), filled.begin(), filled.end());
  }
  if (const std::vector<std::string> missing = missing_fields(complete.frame); !missing.empty()) {
    done.warnings.push_back(path + ": " + join(missing, ", ") + (missing.size() > 1 ? " are" : " is") + " not known");
  }
  done.frames.push_back(std::move(complete));
  return done;
}

FlightFrames complete_frames(const std::string& table_path, const FrameTable& table, const FrameSources& sources) {
  FlightFrames all;
  all.warnings = table.warnings;
  for (const FrameRecord& frame : table.frames) {
    const std::string path = frame_path(table_path, frame.file);
    FlightFrames one;
    try {
      one = complete_frame(path, frame, sources);
    } catch (const DataError&) {  // not a picture: its row in the result will say so
      one.frames.push_back({path, frame, require_camera(camera_without_exif(sources), path)});
    }
    all.frames.insert(all.frames.end(), one.frames.begin(), one.frames.end());
    all.taken.insert(all.taken.end(), one.taken.begin(), one.taken.end());
    all.warnings.insert(all.warnings.end(), one.warnings.begin(), one.warnings.end());
  }
  return all;
}

}  // namespace pilotage
