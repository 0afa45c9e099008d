#include "pilotage/airsim/airsim_client.h"

#include <cmath>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "pilotage/airsim/airsim_fields.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

constexpr std::int64_t kLargestSide = 32'766;
constexpr std::int64_t kCosysVersion = 4;

void check_finite(const char* what, double number) {
  if (!std::isfinite(number)) throw UsageError(std::string(what) + " = " + format_number(number) + " is not finite");
}

void check_finite_pose(const AirsimPose& pose) {
  const AirsimVector& p = pose.position;
  const AirsimQuaternion& q = pose.orientation;
  for (const float number : {p.x_val, p.y_val, p.z_val, q.w_val, q.x_val, q.y_val, q.z_val}) {
    check_finite("a number of a pose", static_cast<double>(number));
  }
}

/// Throws DataError without the place, which the caller knows.
cv::Mat decode_png(const AirsimImage& image) {
  static constexpr std::uint8_t kSignature[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  constexpr std::size_t kHeader = 24;  // signature, length and type of IHDR, width, height
  const RpcBytes& bytes = image.image_data_uint8;
  if (bytes.size() < kHeader || !std::equal(std::begin(kSignature), std::end(kSignature), bytes.begin())) {
    throw DataError("is no PNG");
  }
  // Looked at before any pixel is made room for.
  const auto number = [&](std::size_t at) {
    return std::int64_t{bytes[at]} << 24 | bytes[at + 1] << 16 | bytes[at + 2] << 8 | bytes[at + 3];
  };
  if (number(16) != image.width || number(20) != image.height) {
    throw DataError("is a PNG of " + std::to_string(number(16)) + " x " + std::to_string(number(20)) +
                    " pixels, not of the " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                    " that are said");
  }
  try {
    cv::Mat pixels = cv::imdecode(bytes, cv::IMREAD_COLOR);
    if (pixels.empty()) throw DataError("is a PNG that cannot be decoded");
    return pixels;
  } catch (const cv::Exception& error) {
    throw DataError(std::string("is a PNG that cannot be decoded: ") + error.what());
  }
}

cv::Mat pixels_of(const AirsimImage& image) {
  if (image.width < 1 || image.height < 1 || image.width > kLargestSide || image.height > kLargestSide) {
    throw DataError("has " + std::to_string(image.width) + " x " + std::to_string(image.height) + " pixels; 1 to " +
                    std::to_string(kLargestSide) + " are taken");
  }
  if (image.compress) return decode_png(image);
  const auto pixels = static_cast<std::size_t>(image.width * image.height);
  if (image.image_data_uint8.size() != 3 * pixels) {
    throw DataError("has " + std::to_string(image.image_data_uint8.size()) + " bytes; " + std::to_string(image.width) +
                    " x " + std::to_string(image.height) + " pixels of 3 take " + std::to_string(3 * pixels));
  }
  const cv::Mat wrapped(static_cast<int>(image.height), static_cast<int>(image.width), CV_8UC3,
                        const_cast<std::uint8_t*>(image.image_data_uint8.data()));  // NOLINT: only read
  return wrapped.clone();
}

}  // namespace

AirsimClient::AirsimClient(const HostPort& server, const AirsimClientOptions& options)
    : options_(options), client_(server, options.timeout_s, options.limits, options.go_on) {
  if (!ask<bool>("ping", {})) throw DataError(where("ping") + "false: this is no server of AirSim that is ready");
  server_version_ = ask<std::int64_t>("getServerVersion", {});
  dialect_ = find_dialect();
}

std::string AirsimClient::where(const std::string& method) const {
  return client_.peer().text() + ": " + method + ": ";
}

template <class Result>
Result AirsimClient::ask(const std::string& method, RpcArray arguments) {
  return from_rpc<Result>(dialect_, client_.call(method, std::move(arguments)), where(method) + "the reply");
}

void AirsimClient::tell(const std::string& method, RpcArray arguments) {
  static_cast<void>(client_.call(method, std::move(arguments)));
}

RpcArray AirsimClient::with_external(RpcArray arguments) const {
  if (dialect_ != AirsimDialect::kCosys) arguments.emplace_back(false);
  return arguments;
}

/// Cosys-AirSim says that it is version 4. All others say 1; what a pose looks like tells them apart.
AirsimDialect AirsimClient::find_dialect() {
  if (server_version_ == kCosysVersion) return AirsimDialect::kCosys;
  if (server_version_ != 1) {
    throw DataError(where("getServerVersion") + "version " + std::to_string(server_version_) +
                    "; 1 (AirSim, Colosseum) and 4 (Cosys-AirSim) are understood");
  }
  const RpcValue pose = client_.call("simGetVehiclePose", {options_.vehicle});
  if (std::holds_alternative<RpcMap>(pose.data)) return AirsimDialect::kAirsim;
  if (std::holds_alternative<RpcArray>(pose.data)) return AirsimDialect::kColosseum;
  throw DataError(where("simGetVehiclePose") + "the reply is " + rpc_kind(pose) + ", not a map or an array");
}

AirsimGeoPoint AirsimClient::home() {
  return ask<AirsimGeoPoint>("getHomeGeoPoint", {options_.vehicle});
}

void AirsimClient::pause(bool paused) {
  tell("simPause", {paused});
}

void AirsimClient::continue_for(double seconds) {
  check_finite("seconds", seconds);
  const std::uint32_t call = client_.send("simContinueForTime", {seconds});
  static_cast<void>(client_.wait(call, options_.timeout_s + seconds));
}

void AirsimClient::set_pose(const AirsimPose& pose) {
  check_finite_pose(pose);
  tell("simSetVehiclePose", {to_rpc(dialect_, pose), true, options_.vehicle});
}

AirsimPose AirsimClient::pose() {
  return ask<AirsimPose>("simGetVehiclePose", {options_.vehicle});
}

AirsimKinematics AirsimClient::kinematics() {
  return ask<AirsimKinematics>("simGetGroundTruthKinematics", {options_.vehicle});
}

AirsimMultirotorState AirsimClient::state() {
  return ask<AirsimMultirotorState>("getMultirotorState", {options_.vehicle});
}

AirsimImu AirsimClient::imu() {
  return ask<AirsimImu>("getImuData", {std::string(), options_.vehicle});
}

AirsimCameraInfo AirsimClient::camera_info(const std::string& camera) {
  return ask<AirsimCameraInfo>("simGetCameraInfo", with_external({camera, options_.vehicle}));
}

void AirsimClient::set_camera_pose(const std::string& camera, const AirsimPose& pose) {
  check_finite_pose(pose);
  tell("simSetCameraPose", with_external({camera, to_rpc(dialect_, pose), options_.vehicle}));
}

void AirsimClient::set_camera_fov(const std::string& camera, double degrees) {
  check_finite("degrees", degrees);
  tell("simSetCameraFov", with_external({camera, degrees, options_.vehicle}));
}

cv::Mat AirsimClient::image(const std::string& camera, bool compressed) {
  const std::string method = "simGetImages";
  AirsimImageRequest request;
  request.camera_name = camera;
  request.compress = compressed;
  for (int tries = 0; tries <= options_.image_retries; ++tries) {
    const auto images =
        ask<std::vector<AirsimImage>>(method, with_external({RpcArray{to_rpc(dialect_, request)}, options_.vehicle}));
    if (images.size() != 1) throw DataError(where(method) + std::to_string(images.size()) + " images to 1 request");
    if (images[0].image_data_uint8.empty() || images[0].width == 0) continue;
    try {
      return pixels_of(images[0]);
    } catch (const DataError& error) {
      throw DataError(where(method) + "the image of camera \"" + camera + "\" " + error.what());
    }
  }
  throw DataError(where(method) + "camera \"" + camera + "\" gives empty images, " +
                  std::to_string(options_.image_retries + 1) + " times one after the other");
}

std::vector<std::string> AirsimClient::scene_objects(const std::string& name_regex) {
  return ask<std::vector<std::string>>("simListSceneObjects", {name_regex});
}

AirsimPose AirsimClient::object_pose(const std::string& name) {
  return ask<AirsimPose>("simGetObjectPose", {name});
}

}  // namespace pilotage
