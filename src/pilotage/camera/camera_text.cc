#include "pilotage/camera/camera_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

using ModelName = std::pair<DistortionModel, std::string_view>;
constexpr std::array<ModelName, 3> kModelNames{{{DistortionModel::kNone, "none"},
                                                {DistortionModel::kBrownConrady, "brown_conrady"},
                                                {DistortionModel::kFisheye, "fisheye"}}};

/// Takes values out of the pairs; whatever is left at the end is unknown.
class TextFields {
 public:
  TextFields(std::string name, const CameraText& text) : name_(std::move(name)) {
    for (const auto& [key, value] : text) {
      if (!values_.emplace(key, value).second) throw DataError(name_ + ": duplicate key \"" + key + "\"");
    }
  }

  std::string take(const std::string& key) {
    const auto found = values_.find(key);
    if (found == values_.end()) throw DataError(name_ + ": \"" + key + "\" is missing");
    std::string value = std::move(found->second);
    values_.erase(found);
    return value;
  }

  double take_number(const std::string& key) { return number(key, take(key)); }

  int take_size(const std::string& key) {
    const double size = take_number(key);
    if (!(size >= 1 && size <= 100000) || size != std::floor(size)) {
      throw DataError(name_ + ": " + key + " = " + format_number(size) + " is not a whole number in [1, 100000]");
    }
    return static_cast<int>(size);
  }

  DistortionModel take_model(const std::string& key) {
    const std::string text = take(key);
    if (const auto model = distortion_model_named(text)) return *model;
    throw DataError(name_ + ": " + key + " = \"" + text + "\" is not one of: none, brown_conrady, fisheye");
  }

  std::array<double, 5> take_five(const std::string& key) {
    const std::string text = take(key);
    std::array<double, 5> numbers{};
    std::string_view rest = text;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const std::size_t end = rest.find(' ');
      const bool last = i + 1 == numbers.size();
      if ((end == std::string_view::npos) != last) {
        throw DataError(name_ + ": " + key + " = \"" + text + "\" is not five numbers separated by one blank");
      }
      numbers[i] = number(key, rest.substr(0, end));
      if (!last) rest.remove_prefix(end + 1);
    }
    return numbers;
  }

  void expect_empty() const {
    if (!values_.empty()) throw DataError(name_ + ": unknown key \"" + values_.begin()->first + "\"");
  }

 private:
  double number(const std::string& key, std::string_view text) const {
    const std::optional<double> value = parse_number(text);
    if (!value || !std::isfinite(*value)) {
      throw DataError(name_ + ": " + key + " = \"" + std::string(text) + "\" is not a number");
    }
    return *value;
  }

  std::string name_;
  std::map<std::string, std::string> values_;
};

}  // namespace

std::string distortion_model_name(DistortionModel model) {
  const auto found = std::ranges::find(kModelNames, model, &ModelName::first);
  return std::string(found->second);
}

std::optional<DistortionModel> distortion_model_named(std::string_view name) {
  const auto found = std::ranges::find(kModelNames, name, &ModelName::second);
  return found == kModelNames.end() ? std::nullopt : std::optional(found->first);
}

CameraText camera_to_text(const Camera& camera) {
  std::vector<std::string> distortion;
  for (const double coefficient : camera.distortion) distortion.push_back(format_number(coefficient));
  return {{"width_px", std::to_string(camera.width_px)},
          {"height_px", std::to_string(camera.height_px)},
          {"fx_px", format_number(camera.fx_px)},
          {"fy_px", format_number(camera.fy_px)},
          {"cx_px", format_number(camera.cx_px)},
          {"cy_px", format_number(camera.cy_px)},
          {"distortion_model", distortion_model_name(camera.distortion_model)},
          {"distortion", join(distortion, " ")},
          {"mount_yaw_deg", format_number(camera.mount.yaw_deg)},
          {"mount_pitch_deg", format_number(camera.mount.pitch_deg)},
          {"mount_roll_deg", format_number(camera.mount.roll_deg)}};
}

Camera camera_from_text(const std::string& name, const CameraText& text) {
  TextFields fields(name, text);
  Camera camera;
  camera.width_px = fields.take_size("width_px");
  camera.height_px = fields.take_size("height_px");
  camera.fx_px = fields.take_number("fx_px");
  camera.fy_px = fields.take_number("fy_px");
  camera.cx_px = fields.take_number("cx_px");
  camera.cy_px = fields.take_number("cy_px");
  camera.distortion_model = fields.take_model("distortion_model");
  camera.distortion = fields.take_five("distortion");
  camera.mount.yaw_deg = fields.take_number("mount_yaw_deg");
  camera.mount.pitch_deg = fields.take_number("mount_pitch_deg");
  camera.mount.roll_deg = fields.take_number("mount_roll_deg");
  fields.expect_empty();
  check_camera(name, camera);
  return camera;
}

}  // namespace pilotage
