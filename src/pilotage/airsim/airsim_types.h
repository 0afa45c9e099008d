#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "pilotage/airsim/rpc_value.h"
#include "pilotage/base/options.h"

namespace pilotage {

/// What a server of the AirSim family puts on the wire (docs/methods/airsim.md). They cannot be asked for it: all but
/// one say that they are version 1.
enum class AirsimDialect {
  kAirsim,     ///< AirSim to its last version, Colosseum to 2.2: structs are maps.
  kColosseum,  ///< Colosseum from 2.3: structs are arrays of their members in order.
  kCosys,      ///< Cosys-AirSim: maps; server version 4, and no argument `external`.
};
inline EnumNames<AirsimDialect> enum_names(AirsimDialect) {
  return {
      {AirsimDialect::kAirsim, "airsim"}, {AirsimDialect::kColosseum, "colosseum"}, {AirsimDialect::kCosys, "cosys"}};
}

inline constexpr int kAirsimPort = 41451;

// The structs of AirSim's RpcLibAdaptorsBase.hpp and MultirotorRpcLibAdaptors.hpp, with the names and the order of
// their members. Positions in metres north, east and down of the place where the vehicle starts; a body's axes are
// nose, right wing and belly; quaternions turn vectors of the body into north, east, down. AirSim's numbers are
// float32.

struct AirsimVector {
  float x_val = 0;
  float y_val = 0;
  float z_val = 0;

  bool operator==(const AirsimVector&) const = default;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("x_val", self.x_val);
    fields.field("y_val", self.y_val);
    fields.field("z_val", self.z_val);
  }
};

struct AirsimQuaternion {
  float w_val = 1;
  float x_val = 0;
  float y_val = 0;
  float z_val = 0;

  bool operator==(const AirsimQuaternion&) const = default;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("w_val", self.w_val);
    fields.field("x_val", self.x_val);
    fields.field("y_val", self.y_val);
    fields.field("z_val", self.z_val);
  }
};

struct AirsimPose {
  AirsimVector position;
  AirsimQuaternion orientation;

  bool operator==(const AirsimPose&) const = default;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("position", self.position);
    fields.field("orientation", self.orientation);
  }
};

struct AirsimGeoPoint {
  double latitude = 0;   ///< Degrees.
  double longitude = 0;  ///< Degrees.
  float altitude = 0;    ///< Metres.

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("latitude", self.latitude);
    fields.field("longitude", self.longitude);
    fields.field("altitude", self.altitude);
  }
};

struct AirsimKinematics {
  AirsimVector position;
  AirsimQuaternion orientation;
  AirsimVector linear_velocity;
  AirsimVector angular_velocity;
  AirsimVector linear_acceleration;
  AirsimVector angular_acceleration;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("position", self.position);
    fields.field("orientation", self.orientation);
    fields.field("linear_velocity", self.linear_velocity);
    fields.field("angular_velocity", self.angular_velocity);
    fields.field("linear_acceleration", self.linear_acceleration);
    fields.field("angular_acceleration", self.angular_acceleration);
  }
};

struct AirsimProjection {
  std::vector<std::vector<float>> matrix;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("matrix", self.matrix);
  }
};

struct AirsimCameraInfo {
  AirsimPose pose;
  float fov = 0;  ///< Degrees across.
  AirsimProjection proj_mat;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("pose", self.pose);
    fields.field("fov", self.fov);
    fields.field("proj_mat", self.proj_mat);
  }
};

inline constexpr std::int64_t kAirsimScene = 0;  ///< ImageType of what a camera sees in daylight.

struct AirsimImageRequest {
  std::string camera_name;
  std::int64_t image_type = kAirsimScene;
  bool pixels_as_float = false;
  bool compress = true;  ///< PNG.
  std::string annotation_name;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("camera_name", self.camera_name);
    fields.field("image_type", self.image_type);
    fields.field("pixels_as_float", self.pixels_as_float);
    fields.field("compress", self.compress);
    fields.field_of(AirsimDialect::kCosys, "annotation_name", self.annotation_name);
  }
};

struct AirsimImage {
  RpcBytes image_data_uint8;  ///< Blue, green, red of the rows from the top, without padding; or a PNG.
  std::vector<float> image_data_float;
  AirsimVector camera_position;
  std::string camera_name;
  AirsimQuaternion camera_orientation;
  std::uint64_t time_stamp = 0;  ///< ns
  std::string message;
  bool pixels_as_float = false;
  bool compress = true;
  std::int64_t width = 0;
  std::int64_t height = 0;
  std::int64_t image_type = kAirsimScene;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("image_data_uint8", self.image_data_uint8);
    fields.field("image_data_float", self.image_data_float);
    fields.field("camera_position", self.camera_position);
    fields.field("camera_name", self.camera_name);
    fields.field("camera_orientation", self.camera_orientation);
    fields.field("time_stamp", self.time_stamp);
    fields.field("message", self.message);
    fields.field("pixels_as_float", self.pixels_as_float);
    fields.field("compress", self.compress);
    fields.field("width", self.width);
    fields.field("height", self.height);
    fields.field("image_type", self.image_type);
  }
};

struct AirsimImu {
  std::uint64_t time_stamp = 0;  ///< ns
  AirsimQuaternion orientation;
  AirsimVector angular_velocity;     ///< rad/s, of the body.
  AirsimVector linear_acceleration;  ///< m/s²: specific force, of the body.

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("time_stamp", self.time_stamp);
    fields.field("orientation", self.orientation);
    fields.field("angular_velocity", self.angular_velocity);
    fields.field("linear_acceleration", self.linear_acceleration);
  }
};

struct AirsimBarometer {
  std::uint64_t time_stamp = 0;  ///< ns
  float altitude = 0;            ///< m
  float pressure = 0;            ///< Pa
  float qnh = 0;                 ///< hPa

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("time_stamp", self.time_stamp);
    fields.field("altitude", self.altitude);
    fields.field("pressure", self.pressure);
    fields.field("qnh", self.qnh);
  }
};

struct AirsimGnssReport {
  AirsimGeoPoint geo_point;
  float eph = 0;
  float epv = 0;
  AirsimVector velocity;
  std::int64_t fix_type = 3;   ///< 3: a fix of three dimensions.
  std::uint64_t time_utc = 0;  ///< µs

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("geo_point", self.geo_point);
    fields.field("eph", self.eph);
    fields.field("epv", self.epv);
    fields.field("velocity", self.velocity);
    fields.field("fix_type", self.fix_type);
    fields.field("time_utc", self.time_utc);
  }
};

struct AirsimGps {
  std::uint64_t time_stamp = 0;  ///< ns
  AirsimGnssReport gnss;
  bool is_valid = true;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("time_stamp", self.time_stamp);
    fields.field("gnss", self.gnss);
    fields.field("is_valid", self.is_valid);
  }
};

struct AirsimCollision {
  bool has_collided = false;
  float penetration_depth = 0;
  std::uint64_t time_stamp = 0;
  AirsimVector normal;
  AirsimVector impact_point;
  AirsimVector position;
  std::string object_name;
  std::int64_t object_id = -1;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("has_collided", self.has_collided);
    fields.field("penetration_depth", self.penetration_depth);
    fields.field("time_stamp", self.time_stamp);
    fields.field("normal", self.normal);
    fields.field("impact_point", self.impact_point);
    fields.field("position", self.position);
    fields.field("object_name", self.object_name);
    fields.field("object_id", self.object_id);
  }
};

struct AirsimRemoteControl {
  std::uint64_t timestamp = 0;
  std::array<float, 6> axes{};  ///< pitch, roll, throttle, yaw, left_z, right_z
  std::int64_t switches = 0;
  std::string vendor_id;
  bool is_initialized = false;
  bool is_valid = false;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("timestamp", self.timestamp);
    static constexpr const char* kAxes[] = {"pitch", "roll", "throttle", "yaw", "left_z", "right_z"};
    for (std::size_t i = 0; i < self.axes.size(); ++i) fields.field(kAxes[i], self.axes[i]);
    fields.field("switches", self.switches);
    fields.field("vendor_id", self.vendor_id);
    fields.field("is_initialized", self.is_initialized);
    fields.field("is_valid", self.is_valid);
  }
};

struct AirsimMultirotorState {
  AirsimCollision collision;
  AirsimKinematics kinematics_estimated;
  AirsimGeoPoint gps_location;
  std::uint64_t timestamp = 0;    ///< ns
  std::int64_t landed_state = 0;  ///< 0 landed, 1 flying.
  AirsimRemoteControl rc_data;
  bool ready = true;
  std::string ready_message;
  bool can_arm = true;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("collision", self.collision);
    fields.field("kinematics_estimated", self.kinematics_estimated);
    fields.field("gps_location", self.gps_location);
    fields.field("timestamp", self.timestamp);
    fields.field("landed_state", self.landed_state);
    fields.field("rc_data", self.rc_data);
    fields.field_of(AirsimDialect::kColosseum, "ready", self.ready);
    fields.field_of(AirsimDialect::kColosseum, "ready_message", self.ready_message);
    fields.field_of(AirsimDialect::kColosseum, "can_arm", self.can_arm);
  }
};

struct AirsimYawMode {
  bool is_rate = true;
  float yaw_or_rate = 0;  ///< Degrees, or degrees a second.

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("is_rate", self.is_rate);
    fields.field("yaw_or_rate", self.yaw_or_rate);
  }
};

}  // namespace pilotage
