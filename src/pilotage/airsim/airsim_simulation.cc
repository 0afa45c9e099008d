#include "pilotage/airsim/airsim_simulation.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <set>
#include <utility>

#include <nlohmann/json.hpp>

#include "pilotage/airsim/airsim_fields.h"
#include "pilotage/airsim/airsim_world.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

constexpr double kFarthestM = 1e6;
constexpr double kFastestMps = 1000;
constexpr double kLongestWaitS = 86400;
constexpr double kTakeoffM = 3;
constexpr double kClimbMps = 2;
constexpr double kTurnTimePerDegS = 1.0 / 90;
constexpr std::size_t kMostImages = 16;
constexpr double kMostImageBytes = 64 * 1024 * 1024;  ///< Of one answer: what clients of this program take at most.
constexpr double kLongestStepS = 1;                   ///< Time that a long answer took does not pass in the simulation.

/// The answer comes when the motion has ended.
struct AnsweredLater {};

Eigen::Vector3d place_to_go_to(double north_m, double east_m, double down_m) {
  const Eigen::Vector3d place(north_m, east_m, down_m);
  if (!place.allFinite() || place.cwiseAbs().maxCoeff() > kFarthestM) {
    throw DataError("a place to go to is not finite or farther than " + format_number(kFarthestM) + " m");
  }
  return place;
}

double speed(double mps) {
  if (mps > 0 && mps <= kFastestMps) return mps;
  throw DataError("a speed of " + format_number(mps) + " m/s is outside (0, " + format_number(kFastestMps) + "]");
}

Eigen::Vector3d velocity(double north_mps, double east_mps, double down_mps) {
  const Eigen::Vector3d result(north_mps, east_mps, down_mps);
  if (!result.allFinite() || result.norm() > kFastestMps) {
    throw DataError("a velocity is not finite or faster than " + format_number(kFastestMps) + " m/s");
  }
  return result;
}

double duration(double seconds) {
  if (seconds >= 0) return seconds;
  throw DataError("a time of " + format_number(seconds) + " s is not 0 or more");
}

AirsimYawMode checked(const AirsimYawMode& mode) {
  if (std::isfinite(mode.yaw_or_rate)) return mode;
  throw DataError("the yaw is not finite");
}

constexpr AirsimYawMode kSteadyYaw{true, 0};
constexpr std::int64_t kForwardOnly = 1;

RpcAnswer refusal(const std::string& method, const std::string& count, const std::string& why) {
  return {"rpclib: function '" + method + "' (called with " + count +
              " arg(s)) threw an exception. The exception contained this information: " + why + ".",
          {}};
}

void check_vehicle(const std::string& name) {
  if (name.empty() || name == kAirsimVehicle) return;
  throw DataError("Vehicle API for '" + name.substr(0, 60) + "' is not available; the only vehicle is '" +
                  kAirsimVehicle + "'");
}

}  // namespace

/// The methods by their names, as rpclib binds them: each has a fixed number of arguments.
class AirsimSimulation::Methods {
 public:
  Methods(AirsimDialect dialect, AirsimScene scene) : dialect_(dialect), world_(std::move(scene)) {
    const double bytes = 3.0 * world_.scene.camera.width_px * world_.scene.camera.height_px;
    if (bytes > kMostImageBytes) {
      throw DataError("images of " + std::to_string(world_.scene.camera.width_px) + " x " +
                      std::to_string(world_.scene.camera.height_px) + " px are " + format_fixed(bytes / 1048576, 0) +
                      " MiB each; an answer holds " + format_fixed(kMostImageBytes / 1048576, 0));
    }
    bind_server();
    bind_time();
    bind_poses();
    bind_sensors();
    bind_cameras();
    bind_motions();
    bind_paths();
  }

  std::optional<RpcAnswer> call(const RpcTicket& ticket, const std::string& name, const RpcArray& arguments);

  std::vector<RpcTicketAnswer> step(double elapsed_s) {
    if (!world_.paused) world_.advance(std::min(elapsed_s, kLongestStepS));
    return world_.take_finished();
  }

  RpcWork work(const std::function<bool(std::uint64_t)>& may_work);
  void forget(std::uint64_t connection) { image_calls_.erase(connection); }

 private:
  struct Method {
    std::size_t arguments = 0;
    std::function<std::optional<RpcValue>(const RpcArray&)> run;
  };

  template <class Result, class... Arguments>
  void bind(const std::string& name, std::function<Result(Arguments...)> run) {
    methods_[name] = {sizeof...(Arguments), [this, run](const RpcArray& given) {
                        return this->apply(run, given, std::index_sequence_for<Arguments...>());
                      }};
  }

  template <class Result, class... Arguments, std::size_t... kIndex>
  std::optional<RpcValue> apply(const std::function<Result(Arguments...)>& run, const RpcArray& given,
                                std::index_sequence<kIndex...> /*all*/) {
    const auto result_of = [&]() {
      return run(from_rpc<std::remove_cvref_t<Arguments>>(dialect_, given[kIndex],
                                                          "argument " + std::to_string(kIndex + 1))...);
    };
    if constexpr (std::is_void_v<Result>) {
      result_of();
      return RpcValue();
    } else if constexpr (std::is_same_v<Result, AnsweredLater>) {
      result_of();
      return std::nullopt;
    } else {
      return to_rpc(dialect_, result_of());
    }
  }

  void bind_server();
  void bind_time();
  void bind_poses();
  void bind_sensors();
  void bind_cameras();
  void bind_motions();
  void bind_paths();
  AnsweredLater begin(const std::string& vehicle, const AirsimMotion& motion);
  AnsweredLater draw(const std::vector<AirsimImageRequest>& requests, bool alone);
  std::string settings() const;

  /// A call for images, which are drawn one by one.
  struct ImageCall {
    RpcTicket ticket;
    bool alone = false;  ///< simGetImage: the answer is the bytes of one.
    std::vector<AirsimShot> shots;
    std::vector<AirsimImage> images;
    double bytes = 0;  ///< Of all its images, uncompressed.
    bool begun = false;
  };
  double begun_bytes() const;

  AirsimDialect dialect_;
  AirsimWorld world_;
  std::map<std::string, Method> methods_;
  RpcTicket ticket_;                                            ///< Of the call that is being answered.
  std::map<std::uint64_t, std::deque<ImageCall>> image_calls_;  ///< Of each connection, in their order.
  std::uint64_t drawn_for_ = 0;                                 ///< The connection that got the last image.
};

double AirsimSimulation::Methods::begun_bytes() const {
  double bytes = 0;
  for (const auto& [connection, calls] : image_calls_) bytes += calls.front().begun ? calls.front().bytes : 0;
  return bytes;
}

/// One image of the call that is next, each connection in its turn.
RpcWork AirsimSimulation::Methods::work(const std::function<bool(std::uint64_t)>& may_work) {
  // What is drawn for an answer that is not whole counts, too: others begin when there is room.
  const double room = kMostImageBytes - begun_bytes();
  const auto allowed = [&](const auto& calls) {
    const ImageCall& next = calls.second.front();
    return next.begun || (may_work(calls.first) && (next.bytes <= room || room == kMostImageBytes));
  };
  const auto behind = image_calls_.upper_bound(drawn_for_);
  auto calls = std::find_if(behind, image_calls_.end(), allowed);
  if (calls == image_calls_.end()) {
    calls = std::find_if(image_calls_.begin(), behind, allowed);
    if (calls == behind) return {};
  }
  drawn_for_ = calls->first;
  ImageCall& call = calls->second.front();
  call.begun = true;
  RpcWork done{std::nullopt, true};
  try {
    if (call.images.size() < call.shots.size()) call.images.push_back(world_.develop(call.shots[call.images.size()]));
    if (call.images.size() < call.shots.size()) return done;
    RpcValue result = call.alone ? RpcValue(std::move(call.images.front().image_data_uint8))
                                 : to_rpc(dialect_, std::exchange(call.images, {}));
    done.answer = RpcTicketAnswer{call.ticket, {{}, std::move(result)}};
  } catch (const std::runtime_error& error) {  // DataError and UsageError
    const std::string name = call.alone ? "simGetImage" : "simGetImages";
    const std::size_t arguments =
        methods_.at(name).arguments - (!call.alone && dialect_ == AirsimDialect::kCosys ? 1 : 0);
    done.answer = RpcTicketAnswer{call.ticket, refusal(name, std::to_string(arguments), error.what())};
  }
  calls->second.pop_front();
  if (calls->second.empty()) image_calls_.erase(calls);
  return done;
}

AnsweredLater AirsimSimulation::Methods::draw(const std::vector<AirsimImageRequest>& requests, bool alone) {
  if (requests.size() > kMostImages) {
    throw DataError(std::to_string(requests.size()) + " images at once; " + std::to_string(kMostImages) +
                    " are given at most");
  }
  ImageCall call;
  call.ticket = ticket_;
  call.alone = alone;
  for (const AirsimImageRequest& request : requests) {
    call.shots.push_back(world_.shot(request));
    call.bytes +=
        3.0 * static_cast<double>(call.shots.back().image.width) * static_cast<double>(call.shots.back().image.height);
  }
  if (call.bytes > kMostImageBytes) {
    throw DataError(std::to_string(requests.size()) + " images of " + std::to_string(world_.scene.camera.width_px) +
                    " x " + std::to_string(world_.scene.camera.height_px) + " px are " +
                    format_fixed(call.bytes / 1048576, 0) + " MiB; " + format_fixed(kMostImageBytes / 1048576, 0) +
                    " are given at once at most");
  }
  if (ticket_.call) image_calls_[ticket_.connection].push_back(std::move(call));  // else nobody would get them
  return {};
}

/// Errors read as those of rpclib (its dispatcher.cc), which scripts may look for.
std::optional<RpcAnswer> AirsimSimulation::Methods::call(const RpcTicket& ticket, const std::string& name,
                                                         const RpcArray& arguments) {
  // Cosys-AirSim has no argument `external`, which stands last in the others.
  static const std::set<std::string> with_external = {"simGetImages", "simGetCameraInfo", "simSetCameraPose",
                                                      "simSetCameraFov"};
  ticket_ = ticket;
  const std::string count = std::to_string(arguments.size());
  const auto found = methods_.find(name);
  if (found == methods_.end()) {
    return RpcAnswer{
        "rpclib: server could not find function '" + name.substr(0, 100) + "' with argument count " + count + ".", {}};
  }
  const bool is_short = dialect_ == AirsimDialect::kCosys && with_external.contains(name);
  const std::size_t expected = found->second.arguments - (is_short ? 1 : 0);
  if (arguments.size() != expected) {
    return RpcAnswer{"rpclib: client error C0001: Function '" + name +
                         "' was called with an invalid number of arguments. Expected: " + std::to_string(expected) +
                         ", got: " + count,
                     {}};
  }
  RpcArray given = arguments;
  if (is_short) given.emplace_back(false);
  try {
    std::optional<RpcValue> result = found->second.run(given);
    if (!result) return std::nullopt;
    return RpcAnswer{{}, *std::move(result)};
  } catch (const std::runtime_error& error) {  // DataError and UsageError
    return refusal(name, count, error.what());
  }
}

void AirsimSimulation::Methods::bind_server() {
  const std::int64_t version = dialect_ == AirsimDialect::kCosys ? 4 : 1;
  bind("ping", std::function([]() { return true; }));
  bind("getServerVersion", std::function([version]() { return version; }));
  bind("getMinRequiredClientVersion", std::function([version]() { return version; }));
  bind("listVehicles", std::function([]() { return std::vector<std::string>{kAirsimVehicle}; }));
  bind("getSettingsString", std::function([this]() { return settings(); }));
  bind("reset", std::function([this]() { world_.reset(); }));
  bind("enableApiControl", std::function([this](bool on, const std::string& vehicle) {
         check_vehicle(vehicle);
         world_.controlled = on;
       }));
  bind("isApiControlEnabled", std::function([this](const std::string& vehicle) {
         check_vehicle(vehicle);
         return world_.controlled;
       }));
  bind("armDisarm", std::function([this](bool on, const std::string& vehicle) {
         check_vehicle(vehicle);
         world_.armed = on;
         return true;
       }));
}

std::string AirsimSimulation::Methods::settings() const {
  const AirsimHome& home = world_.scene.home;
  const Camera& camera = world_.scene.camera;
  nlohmann::ordered_json capture = {{"ImageType", kAirsimScene},
                                    {"Width", camera.width_px},
                                    {"Height", camera.height_px},
                                    {"FOV_Degrees", world_.camera_info("bottom_center").fov}};
  nlohmann::ordered_json settings = {
      {"SettingsVersion", 1.2},
      {"SimMode", "Multirotor"},
      {"OriginGeopoint",
       {{"Latitude", home.point.lat_deg}, {"Longitude", home.point.lon_deg}, {"Altitude", home.altitude_m}}},
      {"CameraDefaults", {{"CaptureSettings", nlohmann::ordered_json::array({capture})}}},
      {"Vehicles", {{kAirsimVehicle, {{"VehicleType", "SimpleFlight"}}}}}};
  return settings.dump();
}

void AirsimSimulation::Methods::bind_time() {
  bind("simPause", std::function([this](bool paused) { world_.paused = paused; }));
  bind("simIsPaused", std::function([this]() { return world_.paused; }));
  bind("simContinueForTime", std::function([this](double seconds) {
         if (!(seconds >= 0 && seconds <= kLongestWaitS)) {
           throw DataError("a time of " + format_number(seconds) + " s is outside [0, " + format_number(kLongestWaitS) +
                           "]");
         }
         world_.advance(seconds);
         world_.paused = true;
       }));
}

void AirsimSimulation::Methods::bind_poses() {
  bind("simSetVehiclePose",
       std::function([this](AirsimPose pose, bool /*ignore_collision*/, const std::string& vehicle) {
         check_vehicle(vehicle);
         const Eigen::Vector3d place = vector_of(pose.position);
         for (int i = 0; i < 3; ++i) {  // NaN stands for what is not to change
           if (std::abs(place[i]) > kFarthestM) throw DataError("the position is farther than 1e6 m");
         }
         world_.vehicle.put(pose);
       }));
  bind("simGetVehiclePose", std::function([this](const std::string& vehicle) {
         check_vehicle(vehicle);
         return world_.vehicle.pose();
       }));
  bind("simGetGroundTruthKinematics", std::function([this](const std::string& vehicle) {
         check_vehicle(vehicle);
         return world_.vehicle.kinematics();
       }));
  bind("simGetCollisionInfo", std::function([](const std::string& vehicle) {
         check_vehicle(vehicle);
         return AirsimCollision();
       }));
  bind("getHomeGeoPoint", std::function([this](const std::string& vehicle) {
         check_vehicle(vehicle);
         const AirsimHome& home = world_.scene.home;
         return AirsimGeoPoint{home.point.lat_deg, home.point.lon_deg, static_cast<float>(home.altitude_m)};
       }));
  bind("simListSceneObjects",
       std::function([this](const std::string& pattern) { return world_.object_names(pattern); }));
  bind("simGetObjectPose", std::function([this](const std::string& name) { return world_.object_pose(name); }));
}

void AirsimSimulation::Methods::bind_sensors() {
  const auto of_sensor = [this](const std::string& name, auto read) {
    bind(name, std::function([this, read](const std::string& /*sensor*/, const std::string& vehicle) {
           check_vehicle(vehicle);
           return read(world_);
         }));
  };
  of_sensor("getImuData", [](const AirsimWorld& world) { return world.imu(); });
  of_sensor("getBarometerData", [](const AirsimWorld& world) { return world.barometer(); });
  of_sensor("getGpsData", [](const AirsimWorld& world) { return world.gps(); });
  bind("getMultirotorState", std::function([this](const std::string& vehicle) {
         check_vehicle(vehicle);
         return world_.state();
       }));
}

void AirsimSimulation::Methods::bind_cameras() {
  bind("simGetImages",
       std::function([this](const std::vector<AirsimImageRequest>& requests, const std::string& vehicle, bool) {
         check_vehicle(vehicle);
         return draw(requests, false);
       }));
  // The last argument is `external`, and the annotation's name in Cosys-AirSim.
  bind("simGetImage",
       std::function([this](const std::string& camera, std::int64_t type, const std::string& vehicle, const RpcValue&) {
         check_vehicle(vehicle);
         AirsimImageRequest request;
         request.camera_name = camera;
         request.image_type = type;
         return draw({request}, true);
       }));
  bind("simGetCameraInfo", std::function([this](const std::string& camera, const std::string& vehicle, bool) {
         check_vehicle(vehicle);
         return world_.camera_info(camera);
       }));
  bind("simSetCameraPose",
       std::function([this](const std::string& camera, AirsimPose pose, const std::string& vehicle, bool) {
         check_vehicle(vehicle);
         world_.set_camera_pose(camera, pose);
       }));
  bind("simSetCameraFov",
       std::function([this](const std::string& camera, double degrees, const std::string& vehicle, bool) {
         check_vehicle(vehicle);
         world_.set_camera_fov(camera, degrees);
       }));
}

AnsweredLater AirsimSimulation::Methods::begin(const std::string& vehicle, const AirsimMotion& motion) {
  check_vehicle(vehicle);
  world_.begin(ticket_, motion);
  return {};
}

void AirsimSimulation::Methods::bind_motions() {
  bind("hover", std::function([this](const std::string& vehicle) {
         check_vehicle(vehicle);
         world_.cancel();
         world_.vehicle.flies = true;
         return true;
       }));
  bind("cancelLastTask", std::function([this](const std::string& vehicle) {
         check_vehicle(vehicle);
         world_.cancel();
       }));
  // [velocity ahead or north, right or east, down or the height to hold, duration, drivetrain, yaw mode, vehicle]
  const auto by_velocity = [this](const std::string& name, bool in_body_frame, bool holds_height) {
    bind(name, std::function([this, in_body_frame, holds_height](double x, double y, double z, double seconds,
                                                                 std::int64_t drivetrain, AirsimYawMode yaw,
                                                                 const std::string& vehicle) {
           AirsimMotion motion;
           motion.velocity_mps = velocity(x, y, holds_height ? 0 : z);
           if (holds_height) motion.hold_down_m = place_to_go_to(0, 0, z).z();
           motion.in_body_frame = in_body_frame;
           motion.left_s = duration(seconds);
           motion.nose_ahead = drivetrain == kForwardOnly;
           motion.yaw = checked(yaw);
           return begin(vehicle, motion);
         }));
  };
  by_velocity("moveByVelocity", false, false);
  by_velocity("moveByVelocityZ", false, true);
  by_velocity("moveByVelocityBodyFrame", true, false);
  by_velocity("moveByVelocityZBodyFrame", true, true);
  bind("rotateByYawRate", std::function([this](double degps, double seconds, const std::string& vehicle) {
         AirsimMotion motion;
         motion.left_s = duration(seconds);
         motion.yaw = checked({true, static_cast<float>(degps)});
         return begin(vehicle, motion);
       }));
  bind("rotateToYaw",
       std::function([this](double yaw_deg, double /*timeout*/, double /*margin*/, const std::string& vehicle) {
         const AirsimYawMode yaw = checked({false, static_cast<float>(yaw_deg)});
         const double now_deg = attitude_of(rotation_of(world_.vehicle.orientation)).yaw_deg;
         const double seconds = std::abs(std::remainder(yaw_deg - now_deg, 360.0)) * kTurnTimePerDegS;
         AirsimMotion motion;
         motion.left_s = seconds;
         motion.yaw = yaw;
         return begin(vehicle, motion);
       }));
}

void AirsimSimulation::Methods::bind_paths() {
  bind("takeoff", std::function([this](double timeout, const std::string& vehicle) {
         const Eigen::Vector3d up = world_.vehicle.position_m - Eigen::Vector3d(0, 0, kTakeoffM);
         return begin(vehicle, {{up}, kClimbMps, {0, 0, 0}, duration(timeout), false, kSteadyYaw});
       }));
  // To the height of the home: what the ground is below, nobody tells.
  bind("land", std::function([this](double timeout, const std::string& vehicle) {
         const Eigen::Vector3d& here = world_.vehicle.position_m;
         const Eigen::Vector3d down(here.x(), here.y(), std::max(here.z(), 0.0));
         return begin(vehicle, {{down}, kClimbMps, {0, 0, 0}, duration(timeout), false, kSteadyYaw, true});
       }));
  // Straight to where it began.
  bind(
      "goHome", std::function([this](double timeout, const std::string& vehicle) {
        return begin(vehicle, {{Eigen::Vector3d(0, 0, 0)}, kClimbMps, {0, 0, 0}, duration(timeout), false, kSteadyYaw});
      }));
  bind("moveToPosition",
       std::function([this](double north, double east, double down, double mps, double timeout, std::int64_t drivetrain,
                            AirsimYawMode yaw, double /*lookahead*/, double /*adaptive*/, const std::string& vehicle) {
         return begin(vehicle, {{place_to_go_to(north, east, down)},
                                speed(mps),
                                {0, 0, 0},
                                duration(timeout),
                                drivetrain == kForwardOnly,
                                checked(yaw)});
       }));
  bind("moveOnPath",
       std::function([this](const std::vector<AirsimVector>& path, double mps, double timeout, std::int64_t drivetrain,
                            AirsimYawMode yaw, double /*lookahead*/, double /*adaptive*/, const std::string& vehicle) {
         if (path.empty()) throw DataError("the path has no places");
         AirsimMotion motion{{}, speed(mps), {0, 0, 0}, duration(timeout), drivetrain == kForwardOnly, checked(yaw)};
         for (const AirsimVector& place : path) {
           const Eigen::Vector3d to = vector_of(place);
           motion.path.push_back(place_to_go_to(to.x(), to.y(), to.z()));
         }
         return begin(vehicle, motion);
       }));
  bind("moveToZ", std::function([this](double down, double mps, double timeout, AirsimYawMode yaw, double /*lookahead*/,
                                       double /*adaptive*/, const std::string& vehicle) {
         const Eigen::Vector3d& here = world_.vehicle.position_m;
         return begin(vehicle, {{place_to_go_to(here.x(), here.y(), down)},
                                speed(mps),
                                {0, 0, 0},
                                duration(timeout),
                                false,
                                checked(yaw)});
       }));
}

AirsimSimulation::AirsimSimulation(AirsimDialect dialect, AirsimScene scene)
    : methods_(std::make_unique<Methods>(dialect, std::move(scene))) {}

AirsimSimulation::~AirsimSimulation() = default;

RpcService AirsimSimulation::service() {
  return {[this](const RpcTicket& ticket, const std::string& name, const RpcArray& arguments) {
            return methods_->call(ticket, name, arguments);
          },
          [this](double elapsed_s) { return methods_->step(elapsed_s); },
          [this](const std::function<bool(std::uint64_t)>& may_work) { return methods_->work(may_work); },
          [this](std::uint64_t connection) { methods_->forget(connection); }};
}

}  // namespace pilotage
