// Any bytes as a camera, as YAML and as the pairs of text that a map keeps: DataError, or a sound camera that its own
// text gives again.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>
#include <utility>

#include "pilotage/base/error.h"
#include "pilotage/camera/camera.h"
#include "pilotage/camera/camera_file.h"
#include "pilotage/camera/camera_text.h"

namespace {

void check(const pilotage::Camera& camera) {
  if (!pilotage::camera_problem(camera).empty()) std::abort();
  const pilotage::CameraText text = pilotage::camera_to_text(camera);
  if (pilotage::camera_to_text(pilotage::camera_from_text("again", text)) != text) std::abort();
}

/// Lines "key value".
pilotage::CameraText pairs_of(const std::string& text) {
  pilotage::CameraText pairs;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const auto blank = line.find(' ');
    pairs.emplace_back(line.substr(0, blank), blank == std::string::npos ? "" : line.substr(blank + 1));
  }
  return pairs;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    check(pilotage::parse_camera_yaml("fuzz", text));
  } catch (const pilotage::DataError&) {
  }
  try {
    check(pilotage::camera_from_text("fuzz", pairs_of(text)));
  } catch (const pilotage::DataError&) {
  }
  return 0;
}
