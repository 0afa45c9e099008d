#include "pilotage/airsim/airsim_simulation.h"

#include "airsim/serving.h"
#include "testing/error_of.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/airsim/airsim_fields.h"
#include "pilotage/airsim/rpc_client.h"
#include "pilotage/base/error.h"

namespace pilotage {
namespace {

using testing::error_of;
using ::testing::HasSubstr;
using testing::kWaitS;
using testing::painted_scene;
using testing::Served;

constexpr AirsimDialect kDialect = AirsimDialect::kAirsim;
const RpcValue kNoTurn = to_rpc(kDialect, AirsimYawMode{true, 0});

/// Our server, paused, and a client that asks as scripts do.
class AirsimServer : public ::testing::Test {
 protected:
  AirsimServer() { ask<RpcValue>("simPause", {true}); }

  template <class Result>
  Result ask(const std::string& method, RpcArray arguments) {
    return from_rpc<Result>(kDialect, client_.call(method, std::move(arguments)), "the reply");
  }
  AirsimKinematics kinematics() { return ask<AirsimKinematics>("simGetGroundTruthKinematics", {std::string()}); }
  void pass(double seconds) { ask<RpcValue>("simContinueForTime", {seconds}); }
  /// [x, y, z, velocity, timeout, drivetrain, yaw mode, lookahead, adaptive lookahead, vehicle]
  static RpcArray to(double x, double y, double z, double mps, double timeout_s, std::int64_t drivetrain = 0) {
    return {x, y, z, mps, timeout_s, drivetrain, kNoTurn, -1.0, 1.0, std::string()};
  }
  bool answer(std::uint32_t call) { return std::get<bool>(client_.wait(call).data); }

  AirsimSimulation simulation_{kDialect, painted_scene()};
  Served server_{simulation_.service()};
  RpcClient client_{server_.address(), kWaitS};
};

TEST_F(AirsimServer, AnswersWhatAScriptAsksFirst) {
  EXPECT_TRUE(ask<bool>("ping", {}));
  EXPECT_EQ(ask<std::int64_t>("getMinRequiredClientVersion", {}), 1);
  EXPECT_FALSE(ask<bool>("isApiControlEnabled", {std::string()}));
  ask<RpcValue>("enableApiControl", {true, "SimpleFlight"});
  EXPECT_TRUE(ask<bool>("isApiControlEnabled", {std::string()}));
  EXPECT_TRUE(ask<bool>("armDisarm", {true, std::string()}));
  EXPECT_TRUE(ask<bool>("simIsPaused", {}));
  EXPECT_EQ(ask<std::vector<std::string>>("listVehicles", {}), std::vector<std::string>{"SimpleFlight"});
  const auto settings = nlohmann::json::parse(ask<std::string>("getSettingsString", {}));
  EXPECT_EQ(settings["OriginGeopoint"]["Altitude"], 100);
  EXPECT_EQ(settings["CameraDefaults"]["CaptureSettings"][0]["Width"], 64);
}

TEST_F(AirsimServer, ErrorsAreThoseOfRpclib) {
  const auto error = [&](const std::string& method, const RpcArray& arguments) {
    return error_of<DataError>([&] { client_.call(method, arguments); });
  };
  EXPECT_THAT(error("simGetLidar", {true}),
              HasSubstr("rpclib: server could not find function 'simGetLidar' with argument count 1."));
  EXPECT_THAT(error("ping", {true}), HasSubstr("rpclib: client error C0001: Function 'ping' was called with an invalid "
                                               "number of arguments. Expected: 0, got: 1"));
  EXPECT_THAT(error("simPause", {"yes"}), HasSubstr("rpclib: function 'simPause' (called with 1 arg(s)) threw an "
                                                    "exception. The exception contained this information: argument 1 "
                                                    "is a string, not a bool."));
  EXPECT_THAT(error("simGetVehiclePose", {"Drone7"}), HasSubstr("Vehicle API for 'Drone7' is not available"));
  EXPECT_THAT(error("simContinueForTime", {1e9}), HasSubstr("outside [0, 86400]"));
  EXPECT_THAT(error("moveToPosition", to(1e9, 0, 0, 1, 1)), HasSubstr("farther than"));
  EXPECT_THAT(error("moveToPosition", to(1, 0, 0, 0, 1)), HasSubstr("a speed of 0 m/s"));
  const RpcValue depth =
      RpcMap{{"camera_name", "0"}, {"image_type", std::int64_t{1}}, {"pixels_as_float", true}, {"compress", false}};
  EXPECT_THAT(error("simGetImages", {RpcArray{depth}, std::string(), false}), HasSubstr("type Scene (0)"));
  EXPECT_THAT(error("simGetImages", {RpcArray(17, depth), std::string(), false}), HasSubstr("17 images at once"));
  EXPECT_TRUE(ask<bool>("ping", {}));
}

TEST_F(AirsimServer, MovesWhileTimePasses) {
  const std::uint32_t move = client_.send("moveToPosition", to(30, 40, -20, 10, 100));
  pass(1);
  const double way = vector_of(kinematics().position).norm();
  EXPECT_NEAR(way, 10, 1e-4);
  EXPECT_NEAR(vector_of(kinematics().linear_velocity).norm(), 10, 1e-3);
  pass(10);  // 53.9 m at 10 m/s
  EXPECT_TRUE(answer(move));
  EXPECT_EQ(kinematics().position, airsim_vector({30, 40, -20}));
  EXPECT_EQ(kinematics().linear_velocity, AirsimVector());
  EXPECT_EQ(ask<AirsimMultirotorState>("getMultirotorState", {std::string()}).landed_state, 1);
}

TEST_F(AirsimServer, GivesUpWhatTakesTooLong) {
  const std::uint32_t move = client_.send("moveToPosition", to(100, 0, 0, 1, 5));
  pass(20);
  EXPECT_FALSE(answer(move));
  EXPECT_NEAR(static_cast<double>(kinematics().position.x_val), 5, 1e-3);
}

TEST_F(AirsimServer, ANewMotionEndsTheOneBefore) {
  const std::uint32_t first = client_.send("moveToPosition", to(100, 0, 0, 1, 1000));
  const std::uint32_t second =
      client_.send("moveByVelocity", {0.0, 2.0, -1.0, 3.0, std::int64_t{0}, kNoTurn, std::string()});
  EXPECT_FALSE(answer(first));
  pass(10);
  EXPECT_TRUE(answer(second));
  EXPECT_LT((vector_of(kinematics().position) - Eigen::Vector3d(0, 6, -3)).norm(), 1e-4);
}

TEST_F(AirsimServer, TakesOffTurnsFliesAPathAndLands) {
  const std::uint32_t up = client_.send("takeoff", {20.0, std::string()});
  pass(20);
  EXPECT_TRUE(answer(up));
  EXPECT_EQ(kinematics().position.z_val, -3.0F);
  const std::uint32_t turn = client_.send("rotateToYaw", {-90.0, 60.0, 5.0, std::string()});
  pass(3);
  EXPECT_TRUE(answer(turn));
  EXPECT_NEAR(attitude_of(rotation_of(kinematics().orientation)).yaw_deg, -90, 1e-3);
  const RpcValue path = to_rpc(kDialect, std::vector<AirsimVector>{{10, 0, -3}, {10, 10, -3}});
  const std::uint32_t fly =
      client_.send("moveOnPath", {path, 5.0, 60.0, std::int64_t{1}, kNoTurn, -1.0, 1.0, std::string()});
  pass(5);
  EXPECT_TRUE(answer(fly));
  EXPECT_NEAR(attitude_of(rotation_of(kinematics().orientation)).yaw_deg, 90, 1e-2);  // the nose ahead, to the east
  EXPECT_EQ(kinematics().position, airsim_vector({10, 10, -3}));
  const std::uint32_t down = client_.send("land", {60.0, std::string()});
  pass(60);
  EXPECT_TRUE(answer(down));
  EXPECT_EQ(kinematics().position.z_val, 0.0F);
  EXPECT_EQ(ask<AirsimMultirotorState>("getMultirotorState", {std::string()}).landed_state, 0);
  ask<RpcValue>("reset", {});
  EXPECT_EQ(kinematics().position, AirsimVector());
}

TEST_F(AirsimServer, APoseWithoutNumbersChangesNothing) {
  const float nan = std::nanf("");
  ask<RpcValue>("simSetVehiclePose", {to_rpc(kDialect, AirsimPose{{1, 2, -3}, {0, 1, 0, 0}}), true, std::string()});
  ask<RpcValue>("simSetVehiclePose",
                {to_rpc(kDialect, AirsimPose{{nan, 5, nan}, {nan, nan, nan, nan}}), true, std::string()});
  EXPECT_EQ(kinematics().position, airsim_vector({1, 5, -3}));
  EXPECT_EQ(kinematics().orientation, (AirsimQuaternion{0, 1, 0, 0}));
}

TEST_F(AirsimServer, MovesByAVelocityAtAHeight) {
  const std::uint32_t move =
      client_.send("moveByVelocityZ", {3.0, -1.0, -10.0, 8.0, std::int64_t{0}, kNoTurn, std::string()});
  pass(2);
  EXPECT_NEAR(static_cast<double>(kinematics().position.z_val), -4, 0.1) << "climbs at 2 m/s";
  pass(7);
  EXPECT_TRUE(answer(move));
  const AirsimVector place = kinematics().position;
  EXPECT_NEAR(static_cast<double>(place.x_val), 24, 0.1);
  EXPECT_NEAR(static_cast<double>(place.y_val), -8, 0.1);
  EXPECT_NEAR(static_cast<double>(place.z_val), -10, 1e-3);
}

TEST_F(AirsimServer, MovesByAVelocityOfItsBody) {
  const std::uint32_t turn = client_.send("rotateToYaw", {90.0, 5.0, 1.0, std::string()});
  pass(2);
  EXPECT_TRUE(answer(turn));
  const std::uint32_t move =
      client_.send("moveByVelocityBodyFrame", {2.0, 1.0, -0.5, 4.0, std::int64_t{0}, kNoTurn, std::string()});
  pass(5);
  EXPECT_TRUE(answer(move));
  AirsimVector place = kinematics().position;  // nose to the east, right to the south
  EXPECT_NEAR(static_cast<double>(place.x_val), -4, 0.05);
  EXPECT_NEAR(static_cast<double>(place.y_val), 8, 0.05);
  EXPECT_NEAR(static_cast<double>(place.z_val), -2, 0.05);
  const std::uint32_t home = client_.send("goHome", {100.0, std::string()});
  pass(60);
  EXPECT_TRUE(answer(home));
  place = kinematics().position;
  EXPECT_NEAR(static_cast<double>(std::abs(place.x_val) + std::abs(place.y_val) + std::abs(place.z_val)), 0, 1e-3);
}

TEST_F(AirsimServer, SensorsAgreeWithThePose) {
  ask<RpcValue>("simSetVehiclePose", {to_rpc(kDialect, AirsimPose{{0, 0, -900}, {}}), true, std::string()});
  const auto barometer = ask<AirsimBarometer>("getBarometerData", {std::string(), std::string()});
  EXPECT_EQ(barometer.altitude, 1000.0F);
  EXPECT_NEAR(static_cast<double>(barometer.pressure), 89874.6, 1);  // ISO 2533 at 1000 m
  ask<RpcValue>("simSetVehiclePose", {to_rpc(kDialect, AirsimPose{{0, 0, -14900}, {}}), true, std::string()});
  EXPECT_NEAR(static_cast<double>(ask<AirsimBarometer>("getBarometerData", {std::string(), std::string()}).pressure),
              12044.6, 5);  // ISO 2533 at 15 km
  ask<RpcValue>("simSetVehiclePose", {to_rpc(kDialect, AirsimPose{{0, 0, -60000}, {}}), true, std::string()});
  EXPECT_GT(ask<AirsimBarometer>("getBarometerData", {std::string(), std::string()}).pressure, 0);
  ask<RpcValue>("simSetVehiclePose", {to_rpc(kDialect, AirsimPose{{0, 0, -900}, {}}), true, std::string()});
  const auto gps = ask<AirsimGps>("getGpsData", {std::string(), std::string()});
  EXPECT_EQ(gps.gnss.geo_point.altitude, 1000.0F);
  EXPECT_EQ(gps.gnss.fix_type, 3);
}

TEST_F(AirsimServer, ServesSeveralAtOnce) {
  RpcClient other(server_.address(), kWaitS);
  const std::uint32_t move = client_.send("moveToPosition", to(0, 0, -8, 4, 100));
  other.call("simContinueForTime", {3.0});
  EXPECT_TRUE(answer(move));
  RpcClient third(server_.address(), kWaitS);
  EXPECT_EQ(from_rpc<AirsimPose>(kDialect, third.call("simGetVehiclePose", {std::string()}), "").position.z_val, -8.0F);
}

TEST(AirsimServing, DropsWhoSendsNoCallsAndServesOn) {
  AirsimSimulation simulation(kDialect, painted_scene());
  RpcServerLimits limits;
  limits.request.message_bytes = 1000;
  limits.connections = 2;
  Served server(simulation.service(), limits);
  const RpcBytes wrong[] = {{'G', 'E', 'T', ' ', '/'},
                            {0xC1},
                            {0xDD, 0xFF, 0xFF, 0xFF, 0xFF},
                            {0xC6, 0x7F, 0xFF, 0xFF, 0xFF},
                            encode_rpc(RpcArray{std::uint64_t{0}, "ping", RpcArray{}, std::uint64_t{1}})};
  for (const RpcBytes& bytes : wrong) {
    const Descriptor connection = connect_to(server.address(), testing::soon());
    testing::send_bytes(connection, bytes);
    testing::wait_for_end(connection);
  }
  {
    const Descriptor half = connect_to(server.address(), testing::soon());
    testing::send_bytes(half, {0x94, 0x00});
  }
  RpcClient client(server.address(), kWaitS);
  EXPECT_TRUE(std::get<bool>(client.call("ping", {}).data));
  const RpcServed served = server.finish();
  EXPECT_EQ(served.connections, 7);
  EXPECT_EQ(served.dropped, 5);
  EXPECT_EQ(served.calls, 1);
}

TEST(AirsimServing, CountsWhatItRefusesByWhatWasWrong) {
  AirsimSimulation simulation(kDialect, painted_scene());
  Served server(simulation.service());
  RpcClient client(server.address(), kWaitS);
  const auto refused = [&](const std::string& method, RpcArray arguments) {
    EXPECT_FALSE(error_of<DataError>([&] { client.call(method, std::move(arguments)); }).empty());
  };
  for (int i = 0; i < 2; ++i) refused("getLidarData", {std::string(), std::string()});
  refused("moveToZ", {-20.0, 1.0, std::string()});
  client.call("ping", {});
  for (int i = 0; i < 100; ++i) refused("method" + std::to_string(i), {});
  const RpcServed served = server.finish();
  EXPECT_EQ(served.refused.at("rpclib: server could not find function 'getLidarData' with argument count 2."), 2);
  EXPECT_EQ(served.refused.at("rpclib: client error C0001: Function 'moveToZ' was called with an invalid number of "
                              "arguments. Expected: 7, got: 3"),
            1);
  EXPECT_EQ(served.refused.size(), kMostRefusals + 1) << "what many names would fill";
  EXPECT_EQ(served.refused.at("other errors"), 52);
}

TEST(AirsimServing, DoesNotAnswerNotifications) {
  AirsimSimulation simulation(kDialect, painted_scene());
  Served server(simulation.service());
  const Descriptor connection = connect_to(server.address(), testing::soon());
  RpcBytes both = encode_rpc(RpcArray{std::uint64_t{2}, "simPause", RpcArray{true}});
  const RpcBytes call = encode_rpc(RpcArray{std::uint64_t{0}, std::uint64_t{9}, "simIsPaused", RpcArray{}});
  both.insert(both.end(), call.begin(), call.end());
  testing::send_bytes(connection, both);
  EXPECT_EQ(encode_rpc(testing::take_call(connection)),
            encode_rpc(RpcArray{std::uint64_t{1}, std::uint64_t{9}, RpcValue(), true}));
}

TEST(AirsimSimulation, RefusesACameraThatIsNone) {
  AirsimScene scene = painted_scene();
  scene.camera.fx_px = 0;
  EXPECT_THROW(AirsimSimulation(kDialect, scene), DataError);
  scene = painted_scene();
  scene.camera.width_px = scene.camera.height_px = 5000;
  EXPECT_THAT(error_of<DataError>([&] { AirsimSimulation(kDialect, scene); }), HasSubstr("are 72 MiB each"));
}

}  // namespace
}  // namespace pilotage
