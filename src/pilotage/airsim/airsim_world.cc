#include "pilotage/airsim/airsim_world.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/angle.h"
#include "pilotage/base/error.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

constexpr double kGravityMps2 = 9.80665;
constexpr std::size_t kLongestPattern = 64;

/// The numbers that AirSim's cameras go by, too.
const std::map<std::string, std::string>& camera_numbers() {
  static const std::map<std::string, std::string> numbers = {
      {"0", "front_center"}, {"1", "front_right"}, {"2", "front_left"}, {"3", "bottom_center"}, {"4", "back_center"}};
  return numbers;
}

double fov_of(const Camera& camera) {
  return 2 * std::atan(camera.width_px / (2 * camera.fx_px)) / kRadPerDeg;
}

/// The part of regular expressions that names of objects are asked for with: characters, "." for any one, ".*" for any
/// number of them, and "\\" before a character that stands for itself. What a peer sends never costs more than the
/// lengths of pattern and name multiplied, which std::regex does not hold to.
class NamePattern {
 public:
  /// Throws DataError for everything else.
  explicit NamePattern(const std::string& pattern) {
    if (pattern.size() > kLongestPattern) {
      throw DataError("the pattern has " + std::to_string(pattern.size()) + " characters; " +
                      std::to_string(kLongestPattern) + " are taken at most");
    }
    for (std::size_t i = 0; i < pattern.size(); ++i) {
      const bool escaped = pattern[i] == '\\';
      if (escaped ? ++i == pattern.size() : std::string_view("*+?()[]{}|^$").find(pattern[i]) != std::string::npos) {
        throw DataError("\"" + pattern + "\": in a pattern characters, \".\", \".*\" and \"\\\" are understood alone");
      }
      const bool any = !escaped && pattern[i] == '.';
      const bool many = any && i + 1 < pattern.size() && pattern[i + 1] == '*';
      if (many) ++i;
      parts_.push_back({pattern[i], any, many});
    }
  }

  /// As regular expressions do: the whole of `name`.
  bool matches(std::string_view name) const {
    std::vector<bool> reached(name.size() + 1);  // by the parts so far, after so many characters of the name
    reached[0] = true;
    for (const Part& part : parts_) {
      std::vector<bool> next(name.size() + 1);
      for (std::size_t i = 0; i <= name.size(); ++i) {
        const bool before = i > 0 && (part.many ? next[i - 1] : reached[i - 1]);
        next[i] = part.many ? reached[i] || before : before && (part.any || name[i - 1] == part.character);
      }
      reached = std::move(next);
    }
    return reached.back();
  }

 private:
  struct Part {
    char character;
    bool any;
    bool many;
  };
  std::vector<Part> parts_;
};

/// Pressure of the standard atmosphere (ISO 2533) to 20 km; above that as if its layer from 11 km on went on.
double standard_pressure_pa(double altitude_m) {
  constexpr double kTropopauseM = 11000;
  const double below = 101325 * std::pow(1 - 0.0065 * std::min(altitude_m, kTropopauseM) / 288.15, 5.25588);
  constexpr double kScaleHeightM = 287.05287 * 216.65 / 9.80665;
  return below * std::exp(-std::max(0.0, altitude_m - kTropopauseM) / kScaleHeightM);
}

cv::Mat as_bgr(const cv::Mat& frame) {
  if (frame.channels() == 3) return frame.isContinuous() ? frame : frame.clone();
  cv::Mat bgr;
  cv::cvtColor(frame, bgr, cv::COLOR_GRAY2BGR);
  return bgr;
}

}  // namespace

AirsimWorld::AirsimWorld(AirsimScene scene_to_show) : scene(std::move(scene_to_show)) {
  check_camera("the simulation's camera", scene.camera);
  fit_cameras();
}

void AirsimWorld::fit_cameras() {
  Camera plain = scene.camera;
  plain.mount = {};
  const auto ahead = [&plain](double yaw_deg) { return FittedCamera{{0, 0, 0}, rotation_zyx(yaw_deg, 0, 0), plain}; };
  cameras_ = {{"front_center", ahead(0)},
              {"front_right", ahead(0)},
              {"front_left", ahead(0)},
              {"back_center", ahead(180)},
              {"bottom_center", {{0, 0, 0}, airsim_camera_rotation(scene.camera.mount), plain}}};
}

void AirsimWorld::reset() {
  cancel();
  vehicle = AirsimVehicle();
  controlled = armed = false;
  fit_cameras();
}

void AirsimWorld::advance(double seconds) {
  time_ns_ += static_cast<std::uint64_t>(seconds * 1e9);
  const std::optional<bool> done = vehicle.advance(seconds);
  if (done) finish(*done);
}

void AirsimWorld::begin(const RpcTicket& ticket, const AirsimMotion& motion) {
  cancel();
  open_ = ticket;
  vehicle.begin(motion);
}

void AirsimWorld::cancel() {
  vehicle.stop();
  finish(false);
}

void AirsimWorld::finish(bool done) {
  if (open_) finished_.push_back({*open_, {{}, done}});
  open_.reset();
}

std::vector<RpcTicketAnswer> AirsimWorld::take_finished() {
  return std::exchange(finished_, {});
}

const AirsimWorld::FittedCamera& AirsimWorld::camera(const std::string& name) const {
  const auto number = camera_numbers().find(name);
  const auto found = cameras_.find(number == camera_numbers().end() ? name : number->second);
  if (found != cameras_.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [known, camera] : cameras_) names.push_back(known);
  throw DataError("there is no camera \"" + name.substr(0, 60) + "\"; there are " + join(names, ", "));
}

AirsimPose AirsimWorld::camera_pose(const FittedCamera& camera) const {
  const Eigen::Matrix3d ned_from_body = rotation_of(vehicle.orientation);
  return {airsim_vector(vehicle.position_m + ned_from_body * camera.position_m),
          quaternion_of(ned_from_body * camera.rotation)};
}

AirsimCameraInfo AirsimWorld::camera_info(const std::string& name) const {
  const FittedCamera& fitted = camera(name);
  AirsimCameraInfo info;
  info.pose = camera_pose(fitted);
  info.fov = static_cast<float>(fov_of(fitted.camera));
  info.proj_mat.matrix.assign(4, std::vector<float>(4, 0));
  info.proj_mat.matrix[0][0] = static_cast<float>(2 * fitted.camera.fx_px / fitted.camera.width_px);
  info.proj_mat.matrix[1][1] = static_cast<float>(2 * fitted.camera.fy_px / fitted.camera.height_px);
  return info;
}

void AirsimWorld::set_camera_pose(const std::string& name, const AirsimPose& pose) {
  FittedCamera changed = camera(name);
  changed.position_m = vector_of(pose.position);
  if (!changed.position_m.allFinite() || changed.position_m.norm() > 1000) {
    throw DataError("a camera is at most 1000 m from its vehicle");
  }
  changed.rotation = rotation_of(pose.orientation);
  const auto number = camera_numbers().find(name);
  cameras_[number == camera_numbers().end() ? name : number->second] = changed;
}

void AirsimWorld::set_camera_fov(const std::string& name, double degrees) {
  if (!(degrees >= 1 && degrees <= 170)) {
    throw DataError("a field of view of " + format_number(degrees) + " degrees is outside [1, 170]");
  }
  FittedCamera changed = camera(name);
  // What camera_info says sets nothing, not even by a rounding.
  if (static_cast<float>(fov_of(changed.camera)) == static_cast<float>(degrees)) return;
  const double fx_px = changed.camera.width_px / (2 * std::tan(degrees * kRadPerDeg / 2));
  changed.camera.fy_px *= fx_px / changed.camera.fx_px;
  changed.camera.fx_px = fx_px;
  const auto number = camera_numbers().find(name);
  cameras_[number == camera_numbers().end() ? name : number->second] = changed;
}

AirsimShot AirsimWorld::shot(const AirsimImageRequest& request) const {
  if (request.image_type != kAirsimScene || request.pixels_as_float) {
    throw DataError("there are images of type Scene (0) in bytes alone");
  }
  const FittedCamera& fitted = camera(request.camera_name);
  const Eigen::Matrix3d ned_from_body = rotation_of(vehicle.orientation);
  AirsimShot shot;
  shot.view.camera = fitted.camera;
  shot.view.place = place_from_ned(scene.home, vehicle.position_m + ned_from_body * fitted.position_m);
  shot.view.attitude = attitude_of_camera(ned_from_body * fitted.rotation);
  const AirsimPose pose = camera_pose(fitted);
  shot.image.camera_name = request.camera_name;
  shot.image.camera_position = pose.position;
  shot.image.camera_orientation = pose.orientation;
  shot.image.time_stamp = time_ns_;
  shot.image.compress = request.compress;
  shot.image.width = fitted.camera.width_px;
  shot.image.height = fitted.camera.height_px;
  return shot;
}

AirsimImage AirsimWorld::develop(const AirsimShot& shot) const {
  const cv::Mat bgr = as_bgr(scene.frame(shot.view));
  AirsimImage image = shot.image;
  image.width = bgr.cols;
  image.height = bgr.rows;
  if (image.compress) {
    cv::imencode(".png", bgr, image.image_data_uint8);
  } else {
    image.image_data_uint8.assign(bgr.datastart, bgr.dataend);
  }
  return image;
}

AirsimGeoPoint AirsimWorld::geo_point() const {
  const AirsimPlace here = place();
  return {here.point.lat_deg, here.point.lon_deg, static_cast<float>(here.altitude_m)};
}

AirsimImu AirsimWorld::imu() const {
  AirsimImu imu;
  imu.time_stamp = time_ns_;
  imu.orientation = vehicle.orientation;
  imu.angular_velocity = vehicle.kinematics().angular_velocity;
  const Eigen::Vector3d force_ned(0, 0, -kGravityMps2);
  imu.linear_acceleration = airsim_vector(rotation_of(vehicle.orientation).transpose() * force_ned);
  return imu;
}

AirsimBarometer AirsimWorld::barometer() const {
  const double altitude_m = place().altitude_m;
  return {time_ns_, static_cast<float>(altitude_m), static_cast<float>(standard_pressure_pa(altitude_m)), 1013.25F};
}

AirsimGps AirsimWorld::gps() const {
  AirsimGps gps;
  gps.time_stamp = time_ns_;
  gps.gnss.geo_point = geo_point();
  gps.gnss.velocity = airsim_vector(vehicle.velocity_mps);
  gps.gnss.time_utc = time_ns_ / 1000;
  return gps;
}

AirsimMultirotorState AirsimWorld::state() const {
  AirsimMultirotorState state;
  state.kinematics_estimated = vehicle.kinematics();
  state.gps_location = geo_point();
  state.timestamp = time_ns_;
  state.landed_state = vehicle.flies ? 1 : 0;
  return state;
}

std::vector<std::string> AirsimWorld::object_names(const std::string& pattern) const {
  const NamePattern wanted(pattern);
  std::vector<std::string> names;
  if (wanted.matches(kAirsimVehicle)) names.emplace_back(kAirsimVehicle);
  for (const auto& [name, pose] : scene.objects) {
    if (wanted.matches(name)) names.push_back(name);
  }
  return names;
}

AirsimPose AirsimWorld::object_pose(const std::string& name) const {
  if (name == kAirsimVehicle) return vehicle.pose();
  const auto found = scene.objects.find(name);
  if (found != scene.objects.end()) return found->second;
  const float nan = std::numeric_limits<float>::quiet_NaN();  // as AirSim answers for what it does not know
  return {{nan, nan, nan}, {nan, nan, nan, nan}};
}

}  // namespace pilotage
