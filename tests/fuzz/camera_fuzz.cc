// Any bytes as a camera, as YAML and as the pairs of text that a map keeps: DataError, or a sound camera that its own
// text gives again.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>
#include <utility>

#include "fuzz/fuzz_targets.h"

#include "pilotage/base/error.h"
#include "pilotage/camera/camera.h"
#include "pilotage/camera/camera_file.h"
#include "pilotage/camera/camera_text.h"

namespace pilotage {
namespace {

void check_camera(const Camera& camera) {
  if (!camera_problem(camera).empty()) std::abort();
  const CameraText text = camera_to_text(camera);
  if (camera_to_text(camera_from_text("again", text)) != text) std::abort();
}

/// Lines "key value".
CameraText pairs_of(const std::string& text) {
  CameraText pairs;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const auto blank = line.find(' ');
    pairs.emplace_back(line.substr(0, blank), blank == std::string::npos ? "" : line.substr(blank + 1));
  }
  return pairs;
}

}  // namespace

void fuzz_camera(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    check_camera(parse_camera_file("fuzz", text));
  } catch (const DataError&) {
  }
  try {
    check_camera(camera_from_text("fuzz", pairs_of(text)));
  } catch (const DataError&) {
  }
}

}  // namespace pilotage
