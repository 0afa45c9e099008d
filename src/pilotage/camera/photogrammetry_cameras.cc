#include "pilotage/camera/photogrammetry_cameras.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <sstream>
#include <vector>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

constexpr double kLargestSide_px = 100'000;

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

struct ColmapLine {
  int number = 0;  ///< In the file, from 1.
  std::vector<std::string> words;
};

/// Those that are no comment.
std::vector<ColmapLine> colmap_lines(std::string_view text) {
  std::istringstream stream{std::string(text)};
  std::vector<ColmapLine> lines;
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    std::vector<std::string> words = words_of(line);
    if (!words.empty() && !words.front().starts_with('#')) lines.push_back({number, std::move(words)});
  }
  return lines;
}

bool is_model_name(const std::string& word) {
  return word.size() > 2 &&
         std::all_of(word.begin(), word.end(), [](char c) { return (c >= 'A' && c <= 'Z') || c == '_'; });
}

double number_of(const std::string& where, const std::string& what, const std::string& text) {
  const std::optional<double> parsed = parse_number(text);
  if (parsed && std::isfinite(*parsed)) return *parsed;
  throw DataError(where + ": " + what + " = \"" + text.substr(0, 40) + "\" is not a finite number");
}

int side_of(const std::string& where, const std::string& what, const std::string& text) {
  const double side_px = number_of(where, what, text);
  if (side_px >= 1 && side_px <= kLargestSide_px && side_px == std::floor(side_px)) return static_cast<int>(side_px);
  throw DataError(where + ": " + what + " = " + text.substr(0, 40) + " is not a whole number in [1, 100000]");
}

/// What the parameters of a model are, in their order: f (both axes), fx, fy, cx, cy, or a place of
/// Camera::distortion; "0": must be 0.
struct ColmapModel {
  const char* name;
  DistortionModel distortion;
  std::vector<std::string> parameters;
};

const std::vector<ColmapModel>& colmap_models() {
  static const std::vector<ColmapModel> models = {
      {"SIMPLE_PINHOLE", DistortionModel::kNone, {"f", "cx", "cy"}},
      {"PINHOLE", DistortionModel::kNone, {"fx", "fy", "cx", "cy"}},
      {"SIMPLE_RADIAL", DistortionModel::kBrownConrady, {"f", "cx", "cy", "k1"}},
      {"RADIAL", DistortionModel::kBrownConrady, {"f", "cx", "cy", "k1", "k2"}},
      {"OPENCV", DistortionModel::kBrownConrady, {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2"}},
      {"FULL_OPENCV",
       DistortionModel::kBrownConrady,
       {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"}},
      {"SIMPLE_RADIAL_FISHEYE", DistortionModel::kFisheye, {"f", "cx", "cy", "k1"}},
      {"RADIAL_FISHEYE", DistortionModel::kFisheye, {"f", "cx", "cy", "k1", "k2"}},
      {"OPENCV_FISHEYE", DistortionModel::kFisheye, {"fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4"}}};
  return models;
}

/// Where a coefficient stands in Camera::distortion; nothing where the model has none of that name.
std::optional<std::size_t> place_of(const std::string& coefficient, DistortionModel model) {
  const std::array<const char*, 5> brown = {"k1", "k2", "p1", "p2", "k3"};
  const std::array<const char*, 5> fisheye = {"k1", "k2", "k3", "k4", ""};
  const auto& names = model == DistortionModel::kFisheye ? fisheye : brown;
  const auto found = std::find(names.begin(), names.end(), coefficient);
  if (found == names.end()) return std::nullopt;
  return static_cast<std::size_t>(found - names.begin());
}

void set_coefficient(const std::string& where, const std::string& coefficient, double value, Camera& camera) {
  if (const auto place = place_of(coefficient, camera.distortion_model)) {
    camera.distortion[*place] = value;
  } else if (value != 0) {
    throw DataError(where + ": " + coefficient + " = " + format_number(value) +
                    " is of a distortion model that cannot be used; only 0 can");
  }
}

/// Brown–Conrady with zeros is none; a fisheye with zeros is one.
void drop_empty_distortion(Camera& camera) {
  const bool all_zero =
      std::all_of(camera.distortion.begin(), camera.distortion.end(), [](double k) { return k == 0; });
  if (camera.distortion_model == DistortionModel::kBrownConrady && all_zero) {
    camera.distortion_model = DistortionModel::kNone;
  }
}

Camera colmap_camera(const std::string& where, const std::vector<std::string>& words) {
  const auto& models = colmap_models();
  const auto model =
      std::find_if(models.begin(), models.end(), [&](const ColmapModel& one) { return one.name == words[1]; });
  if (model == models.end()) {
    std::vector<std::string> names;
    for (const ColmapModel& one : models) names.emplace_back(one.name);
    throw DataError(where + ": the camera model " + words[1].substr(0, 40) + " cannot be used; those that can are " +
                    join(names, ", "));
  }
  Camera camera;
  camera.width_px = side_of(where, "width", words[2]);
  camera.height_px = side_of(where, "height", words[3]);
  camera.distortion_model = model->distortion;
  constexpr std::size_t kBefore = 4;
  if (words.size() != kBefore + model->parameters.size()) {
    throw DataError(where + ": " + model->name + " has " + std::to_string(words.size() - kBefore) +
                    " numbers, expected " + join(model->parameters, ", "));
  }
  for (std::size_t i = 0; i < model->parameters.size(); ++i) {
    const std::string& what = model->parameters[i];
    const double value = number_of(where, what, words[kBefore + i]);
    if (what == "f") {
      camera.fx_px = camera.fy_px = value;
    } else if (what == "fx") {
      camera.fx_px = value;
    } else if (what == "fy") {
      camera.fy_px = value;
    } else if (what == "cx") {
      camera.cx_px = value;
    } else if (what == "cy") {
      camera.cy_px = value;
    } else {
      set_coefficient(where, what, value, camera);
    }
  }
  drop_empty_distortion(camera);
  return camera;
}

}  // namespace

bool looks_like_colmap_cameras(std::string_view text) {
  const std::vector<ColmapLine> lines = colmap_lines(text);
  if (lines.empty() || lines.front().words.size() < 4) return false;
  const std::vector<std::string>& words = lines.front().words;
  return parse_number(words[0]) && is_model_name(words[1]) && parse_number(words[2]) && parse_number(words[3]);
}

Camera parse_colmap_cameras(const std::string& name, std::string_view text) {
  const std::vector<ColmapLine> lines = colmap_lines(text);
  if (lines.size() != 1) {
    throw DataError(name + ": holds " + std::to_string(lines.size()) + " cameras of COLMAP; keep one of them");
  }
  const std::string where = name + ": line " + std::to_string(lines.front().number);
  if (lines.front().words.size() < 4) throw DataError(where + ": is not CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS");
  return colmap_camera(where, lines.front().words);
}

Camera agisoft_camera(const std::string& name, const XmlElement& root) {
  const auto fail = [&](const std::string& what) -> DataError { return DataError(name + ": " + what); };
  const auto text_of = [&](const std::string& key) {
    const auto count = std::count_if(root.children.begin(), root.children.end(),
                                     [&](const XmlElement& one) { return one.name == key; });
    if (count > 1) throw fail("<" + key + "> stands there " + std::to_string(count) + " times");
    return root.child_text(key);
  };
  const auto number = [&](const std::string& key) {
    const std::string value = text_of(key);
    return value.empty() ? 0 : number_of(name, "<" + key + ">", value);
  };
  const auto needed = [&](const std::string& key) {
    if (text_of(key).empty()) throw fail("<" + key + "> is missing");
    return text_of(key);
  };
  const std::string projection = text_of("projection");
  if (projection != "frame" && projection != "fisheye" && !projection.empty()) {
    throw fail("<projection> = \"" + projection.substr(0, 40) + "\" cannot be used; only frame and fisheye can");
  }
  if (root.child("fx") != nullptr) {
    throw fail(
        "is of an old version of Agisoft (<fx>, <fy>, <skew>): open the calibration in a newer one and save it again, "
        "or as OpenCV's");
  }
  Camera camera;
  camera.width_px = side_of(name, "<width>", needed("width"));
  camera.height_px = side_of(name, "<height>", needed("height"));
  camera.fy_px = number_of(name, "<f>", needed("f"));
  camera.fx_px = camera.fy_px + number("b1");
  camera.cx_px = camera.width_px / 2.0 + number("cx");
  camera.cy_px = camera.height_px / 2.0 + number("cy");
  if (number("b2") != 0) throw fail("<b2> = " + text_of("b2") + " is skew, only 0 can be used");
  camera.distortion_model = projection == "fisheye" ? DistortionModel::kFisheye : DistortionModel::kBrownConrady;
  for (const char* k : {"k1", "k2", "k3", "k4"}) set_coefficient(name, k, number(k), camera);
  // Agisoft's p1 belongs to r² + 2x², OpenCV's p1 to r² + 2y².
  set_coefficient(name, "p2", number("p1"), camera);
  set_coefficient(name, "p1", number("p2"), camera);
  for (const char* p : {"p3", "p4"}) set_coefficient(name, p, number(p), camera);
  drop_empty_distortion(camera);
  return camera;
}

}  // namespace pilotage
