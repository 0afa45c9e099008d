#include "pilotage/camera/camera_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <set>
#include <sstream>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/camera/photogrammetry_cameras.h"

namespace pilotage {
namespace {

constexpr std::uintmax_t kMaxFileBytes = 1 << 20;

/// A YAML map with the name to use in messages: "camera.yaml" or "camera.yaml: cam0".
struct YamlMap {
  std::string name;
  YAML::Node node;

  [[noreturn]] void fail(const std::string& what) const { throw DataError(name + ": " + what); }

  /// The value of the one key among `keys` (spellings of the same thing) that is there; nothing when none is.
  std::optional<std::pair<std::string, YAML::Node>> find(std::initializer_list<const char*> keys) const {
    std::optional<std::pair<std::string, YAML::Node>> found;
    for (const char* key : keys) {
      for (const auto& entry : node) {
        if (!entry.first.IsScalar() || entry.first.Scalar() != key) continue;
        if (found) fail("\"" + found->first + "\" and \"" + key + "\" both stand there");
        found.emplace(key, entry.second);
      }
    }
    return found;
  }

  std::pair<std::string, YAML::Node> require(std::initializer_list<const char*> keys) const {
    auto found = find(keys);
    if (!found) fail("\"" + std::string(*keys.begin()) + "\" is missing");
    return *found;
  }

  double number(const std::string& key, const YAML::Node& value) const {
    if (!value.IsScalar()) fail(key + " is not a number");
    const std::optional<double> parsed = parse_number(value.Scalar());
    if (!parsed || !std::isfinite(*parsed)) fail(key + " = \"" + value.Scalar() + "\" is not a finite number");
    return *parsed;
  }

  int size(const std::string& key, const YAML::Node& value) const {
    const double parsed = number(key, value);
    if (!(parsed >= 1 && parsed <= 100000) || parsed != std::floor(parsed)) {
      fail(key + " = " + value.Scalar() + " is not a whole number in [1, 100000]");
    }
    return static_cast<int>(parsed);
  }

  std::string text(const std::string& key, const YAML::Node& value) const {
    if (!value.IsScalar()) fail(key + " is not a text");
    return value.Scalar();
  }

  std::vector<double> numbers(const std::string& key, const YAML::Node& value) const {
    if (!value.IsSequence()) fail(key + " is not a list of numbers");
    if (value.size() > 64) fail(key + " has " + std::to_string(value.size()) + " numbers, at most 64 are allowed");
    std::vector<double> result;
    for (const auto& element : value) result.push_back(number(key, element));
    return result;
  }

  /// The numbers of a matrix written as {rows, cols, data}, whose count must be rows × cols, as a list, or as a list of
  /// rows.
  std::vector<double> matrix(const std::string& key, const YAML::Node& value) const {
    if (value.IsSequence()) return listed(key, value);
    if (!value.IsMap()) fail(key + " is not a matrix with rows, cols and data");
    const YamlMap map{name + ": " + key, value};
    const auto dimension = [&](const char* what) {
      const double count = map.number(what, map.require({what}).second);
      if (!(count >= 0 && count <= 64))
        map.fail(std::string(what) + " = " + format_number(count) + " is not in [0, 64]");
      return count;
    };
    const double count = dimension("rows") * dimension("cols");
    // A matrix without elements may leave its data out.
    const auto data = map.find({"data"});
    const std::vector<double> result = data ? map.numbers("data", data->second) : std::vector<double>{};
    if (static_cast<double>(result.size()) != count) {
      map.fail("data has " + std::to_string(result.size()) + " numbers, rows x cols is " + format_number(count));
    }
    return result;
  }

 private:
  std::vector<double> listed(const std::string& key, const YAML::Node& value) const {
    if (value.size() == 0 || !value[0].IsSequence()) return numbers(key, value);
    std::vector<double> result;
    for (const auto& row : value) {
      const std::vector<double> of_row = numbers(key, row);
      result.insert(result.end(), of_row.begin(), of_row.end());
      if (result.size() > 64) fail(key + " has more than 64 numbers");
    }
    return result;
  }
};

/// Sets focal lengths and principal point from a row-major 3 × 3 matrix whose first pixel centre is (0, 0).
void set_camera_matrix(const YamlMap& map, const std::string& key, const std::vector<double>& k, Camera& camera) {
  if (k.size() != 9) map.fail(key + " has " + std::to_string(k.size()) + " numbers, expected 3 x 3");
  const bool plain = k[3] == 0 && k[6] == 0 && k[7] == 0 && k[8] == 1;
  if (!plain) map.fail(key + " is not of the form [fx, 0, cx; 0, fy, cy; 0, 0, 1]");
  if (k[1] != 0) map.fail(key + " has skew " + format_number(k[1]) + ", only 0 can be used");
  camera.fx_px = k[0];
  camera.cx_px = k[2] + 0.5;
  camera.fy_px = k[4];
  camera.cy_px = k[5] + 0.5;
}

void set_distortion(const YamlMap& map, const std::string& key, bool fisheye, const std::vector<double>& coefficients,
                    Camera& camera) {
  const std::size_t used = fisheye ? 4 : 5;
  for (std::size_t i = used; i < coefficients.size(); ++i) {
    if (coefficients[i] != 0) {
      map.fail(key + " has a coefficient " + format_number(coefficients[i]) + " beyond the first " +
               std::to_string(used) + ", of a distortion model that cannot be used");
    }
  }
  if (!coefficients.empty() && coefficients.size() < 4) {
    map.fail(key + " has " + std::to_string(coefficients.size()) + " coefficients, expected none or at least 4");
  }
  if (fisheye && coefficients.empty()) map.fail(key + " is empty, a fisheye needs 4 coefficients");
  bool all_zero = true;
  for (std::size_t i = 0; i < std::min(used, coefficients.size()); ++i) {
    camera.distortion[i] = coefficients[i];
    all_zero = all_zero && coefficients[i] == 0;
  }
  if (fisheye) {
    camera.distortion_model = DistortionModel::kFisheye;  // with zeros too: r = f θ is not a pinhole
  } else if (!all_zero) {
    camera.distortion_model = DistortionModel::kBrownConrady;
  }
}

/// A whole number of a ROS message; `unsaid` where it is not there.
int count_of(const YamlMap& map, const char* key, int unsaid) {
  const auto found = map.find({key});
  if (!found) return unsaid;
  const double count = map.number(found->first, found->second);
  if (count >= 0 && count <= 100000 && count == std::floor(count)) return static_cast<int>(count);
  map.fail(found->first + " = " + found->second.Scalar() + " is not a whole number in [0, 100000]");
}

/// A ROS driver sends a part of the sensor (roi, in full pixels; all 0: the whole) in larger pixels (binning; 0: as 1).
/// Size and matrix of the file are those of the whole sensor in full pixels; the camera becomes that of the pictures.
void cut_and_bin(const YamlMap& map, Camera& camera) {
  int left_px = 0;
  int top_px = 0;
  if (const auto roi = map.find({"roi"}); roi && roi->second.IsMap()) {
    const YamlMap part{map.name + ": roi", roi->second};
    left_px = count_of(part, "x_offset", 0);
    top_px = count_of(part, "y_offset", 0);
    const int width_px = count_of(part, "width", 0);
    const int height_px = count_of(part, "height", 0);
    if ((width_px == 0) != (height_px == 0)) part.fail("width and height are 0 together, or neither");
    if (left_px + width_px > camera.width_px || top_px + height_px > camera.height_px) {
      part.fail("leaves the image of " + std::to_string(camera.width_px) + " x " + std::to_string(camera.height_px) +
                " px");
    }
    if (width_px == 0 && (left_px != 0 || top_px != 0)) part.fail("x_offset and y_offset are of a part without a size");
    if (width_px > 0) {
      camera.width_px = width_px;
      camera.height_px = height_px;
    }
  }
  const int across = std::max(1, count_of(map, "binning_x", 1));
  const int down = std::max(1, count_of(map, "binning_y", 1));
  if (across > camera.width_px || down > camera.height_px) map.fail("binning leaves no pixel");
  camera.width_px /= across;
  camera.height_px /= down;
  camera.fx_px /= across;
  camera.fy_px /= down;
  camera.cx_px = (camera.cx_px - left_px) / across;
  camera.cy_px = (camera.cy_px - top_px) / down;
}

/// Of four coefficients both readings are possible, and they put a ray at 45° elsewhere by a fifth of its radius.
void refuse_four_without_a_model(const YamlMap& map, const std::string& key, const std::vector<double>& coefficients) {
  const bool all_zero = std::all_of(coefficients.begin(), coefficients.end(), [](double k) { return k == 0; });
  if (coefficients.size() != 4 || all_zero) return;
  map.fail(key +
           " has four numbers and no model: OpenCV's fisheye writes four (k1 … k4), and so does Brown-Conrady "
           "without k3 (k1, k2, p1, p2); add \"distortion_model: equidistant\" or \"distortion_model: plumb_bob\"");
}

/// ROS and OpenCV name nearly the same things.
Camera camera_from_matrices(const YamlMap& map) {
  Camera camera;
  const auto width = map.require({"image_width", "image_Width", "imageWidth", "width"});
  const auto height = map.require({"image_height", "image_Height", "imageHeight", "height"});
  camera.width_px = map.size(width.first, width.second);
  camera.height_px = map.size(height.first, height.second);
  const auto matrix = map.require({"camera_matrix", "Camera_Matrix", "cameraMatrix", "K", "k"});
  set_camera_matrix(map, matrix.first, map.matrix(matrix.first, matrix.second), camera);

  bool fisheye = false;
  bool says_model = false;
  if (const auto flag = map.find({"fisheye_model"})) {
    const double value = map.number(flag->first, flag->second);
    if (value != 0 && value != 1) map.fail(flag->first + " = " + format_number(value) + " is not 0 or 1");
    fisheye = value == 1;
    says_model = true;
  }
  if (const auto model = map.find({"distortion_model"})) {
    const std::string name = map.text(model->first, model->second);
    const std::set<std::string> brown{"plumb_bob", "radtan", "rational_polynomial", ""};
    says_model = says_model || !name.empty();
    if (name == "equidistant" || name == "fisheye") {
      fisheye = true;
    } else if (!brown.contains(name)) {
      map.fail("distortion_model = \"" + name +
               "\" is not one of: plumb_bob, radtan, rational_polynomial, equidistant, fisheye");
    }
  }
  const auto distortion = map.find(
      {"distortion_coefficients", "Distortion_Coefficients", "distortionCoefficients", "distCoeffs", "D", "d"});
  if (distortion) {
    const std::vector<double> coefficients = map.matrix(distortion->first, distortion->second);
    if (!says_model) refuse_four_without_a_model(map, distortion->first, coefficients);
    set_distortion(map, distortion->first, fisheye, coefficients, camera);
  } else {
    set_distortion(map, "distortion_coefficients", fisheye, {}, camera);
  }
  cut_and_bin(map, camera);
  return camera;
}

/// OpenCV's storage as XML, as the YAML that it could have been.
YAML::Node yaml_of(const XmlElement& element, bool is_data) {
  if (is_data) {
    YAML::Node list(YAML::NodeType::Sequence);
    std::istringstream words(element.text);
    for (std::string word; words >> word;) list.push_back(word);
    return list;
  }
  if (element.children.empty()) return YAML::Node(element.text);
  YAML::Node map(YAML::NodeType::Map);
  for (const XmlElement& child : element.children) map.force_insert(child.name, yaml_of(child, child.name == "data"));
  return map;
}

Camera camera_from_kalibr(const YamlMap& map) {
  const std::string model = map.text("camera_model", map.require({"camera_model"}).second);
  if (model != "pinhole") map.fail("camera_model = \"" + model + "\" cannot be used, only pinhole");
  const auto intrinsics = map.numbers("intrinsics", map.require({"intrinsics"}).second);
  if (intrinsics.size() != 4) {
    map.fail("intrinsics has " + std::to_string(intrinsics.size()) + " numbers, expected fu, fv, pu, pv");
  }
  const auto resolution = map.require({"resolution"}).second;
  if (!resolution.IsSequence() || resolution.size() != 2) map.fail("resolution is not [width, height]");
  Camera camera;
  camera.width_px = map.size("resolution", resolution[0]);
  camera.height_px = map.size("resolution", resolution[1]);
  camera.fx_px = intrinsics[0];
  camera.fy_px = intrinsics[1];
  camera.cx_px = intrinsics[2] + 0.5;
  camera.cy_px = intrinsics[3] + 0.5;

  const std::string distortion = map.text("distortion_model", map.require({"distortion_model"}).second);
  if (distortion == "none") return camera;
  if (distortion != "radtan" && distortion != "equidistant") {
    map.fail("distortion_model = \"" + distortion + "\" is not one of: radtan, equidistant, none");
  }
  const auto coefficients = map.numbers("distortion_coeffs", map.require({"distortion_coeffs"}).second);
  if (coefficients.size() != 4) {
    map.fail("distortion_coeffs has " + std::to_string(coefficients.size()) + " numbers, expected 4");
  }
  set_distortion(map, "distortion_coeffs", distortion == "equidistant", coefficients, camera);
  return camera;
}

/// The cameras of a Kalibr camchain: cam0, cam1, …
std::vector<std::string> kalibr_cameras(const YAML::Node& root) {
  std::vector<std::string> names;
  for (const auto& entry : root) {
    if (entry.first.IsScalar() && entry.first.Scalar().starts_with("cam") && entry.second.IsMap() &&
        YamlMap{"", entry.second}.find({"camera_model"})) {
      names.push_back(entry.first.Scalar());
    }
  }
  return names;
}

Camera camera_from_yaml(const std::string& name, std::string_view text) {
  YAML::Node root;
  try {
    root = YAML::Load(std::string(text));
  } catch (const YAML::Exception& error) {
    throw DataError(name + ": not valid YAML: " + error.what());
  }
  if (!root.IsMap()) throw DataError(name + ": not a camera calibration: the YAML is not a map of keys");
  const YamlMap map{name, root};
  Camera camera;
  if (map.find({"camera_model"})) {
    camera = camera_from_kalibr(map);
  } else if (const auto cameras = kalibr_cameras(root); cameras.size() > 1) {
    map.fail("holds " + std::to_string(cameras.size()) + " cameras (" + join(cameras, ", ") + "); keep one of them");
  } else if (cameras.size() == 1) {
    const std::string& key = cameras.front();
    camera = camera_from_kalibr({name + ": " + key, map.require({key.c_str()}).second});
  } else if (map.find({"camera_matrix", "Camera_Matrix", "cameraMatrix", "K", "k"})) {
    camera = camera_from_matrices(map);
  } else {
    map.fail("not a camera calibration of ROS or OpenCV (no camera_matrix, K or k) or Kalibr (no camera_model)");
  }
  return camera;
}

}  // namespace

Camera parse_camera_file(const std::string& name, std::string_view text) {
  Camera camera;
  if (looks_like_colmap_cameras(text)) {
    camera = parse_colmap_cameras(name, text);
  } else if (text.substr(std::min(text.find_first_not_of(" \t\r\n"), text.size())).starts_with('<')) {
    const XmlElement root = parse_xml(name, text);
    if (root.name == "calibration") {
      camera = agisoft_camera(name, root);
    } else if (root.name == "opencv_storage") {
      camera = camera_from_matrices({name, yaml_of(root, false)});
    } else {
      throw DataError(name + ": not a camera calibration: XML with the root <" + root.name.substr(0, 40) +
                      ">; OpenCV's is <opencv_storage>, Agisoft's <calibration>");
    }
  } else {
    camera = camera_from_yaml(name, text);
  }
  check_camera(name, camera);
  return camera;
}

Camera read_camera_file(const std::filesystem::path& path) {
  return parse_camera_file(path.string(), read_file(path, kMaxFileBytes));
}

}  // namespace pilotage
