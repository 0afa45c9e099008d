#include "pilotage/airsim/airsim_client.h"

#include <cmath>

#include "airsim/serving.h"
#include "testing/error_of.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "pilotage/airsim/airsim_fields.h"
#include "pilotage/base/angle.h"
#include "pilotage/base/error.h"

namespace pilotage {
namespace {

using ::testing::ElementsAre;
using testing::error_of;
using ::testing::HasSubstr;
using testing::painted_scene;
using testing::Served;

/// A client of our server in a dialect.
class AirsimDialects : public ::testing::TestWithParam<AirsimDialect> {
 protected:
  AirsimSimulation simulation_{GetParam(), painted_scene()};
  Served server_{simulation_.service()};
  AirsimClient client_{server_.address(), {}};
};

bool same_pixels(const cv::Mat& one, const cv::Mat& other) {
  return one.size() == other.size() && one.type() == other.type() && cv::norm(one, other, cv::NORM_INF) == 0;
}

AirsimPose some_pose() {
  return {airsim_vector({12.5, -33.25, -80}), quaternion_of(ned_from_body({37, 4, -6}))};
}

TEST_P(AirsimDialects, AreFound) {
  EXPECT_EQ(client_.dialect(), GetParam());
  EXPECT_EQ(client_.server_version(), GetParam() == AirsimDialect::kCosys ? 4 : 1);
}

TEST_P(AirsimDialects, SayWhereTheVehicleIs) {
  client_.pause(true);
  client_.set_pose(some_pose());
  EXPECT_EQ(client_.pose(), some_pose());
  EXPECT_EQ(client_.kinematics().position, some_pose().position);
  const AirsimMultirotorState state = client_.state();
  EXPECT_EQ(state.kinematics_estimated.orientation, some_pose().orientation);
  EXPECT_EQ(state.gps_location.altitude, 180.0F);
  EXPECT_NEAR(state.gps_location.longitude, -33.25 / 111319.49, 1e-9);
  const AirsimGeoPoint home = client_.home();
  EXPECT_EQ(home.latitude, 0.0);
  EXPECT_EQ(home.altitude, 100.0F);
}

TEST_P(AirsimDialects, GiveTheFramesOfTheRenderer) {
  client_.set_pose(some_pose());
  for (const bool compressed : {false, true}) {
    const cv::Mat image = client_.image("bottom_center", compressed);
    AirsimView view;
    view.camera = painted_scene().camera;
    view.place = place_from_ned(painted_scene().home, vector_of(some_pose().position));
    view.attitude = attitude_of_camera(rotation_of(some_pose().orientation) * airsim_camera_rotation({}));
    cv::Mat expected;
    cv::cvtColor(testing::painted_frame(view), expected, cv::COLOR_GRAY2BGR);
    EXPECT_TRUE(same_pixels(image, expected)) << compressed;
    EXPECT_GT(cv::mean(image)[0], 50);
  }
}

TEST_P(AirsimDialects, TakeCamerasAsTheyAreSet) {
  client_.set_pose({airsim_vector({0, 0, -50}), {1, 0, 0, 0}});
  const AirsimCameraInfo before = client_.camera_info("3");
  EXPECT_NEAR(static_cast<double>(before.fov), 2 * std::atan(32 / 60.0) / kRadPerDeg, 1e-5);
  const cv::Mat image = client_.image("bottom_center");
  client_.set_camera_fov("3", static_cast<double>(before.fov));
  EXPECT_TRUE(same_pixels(client_.image("3"), image));

  client_.set_camera_fov("3", 90);
  EXPECT_NEAR(static_cast<double>(client_.camera_info("bottom_center").fov), 90, 1e-5);
  EXPECT_FALSE(same_pixels(client_.image("3"), image));

  // A camera 10 m ahead of the vehicle sees what the vehicle sees 10 m farther on.
  client_.set_camera_pose("bottom_center", {airsim_vector({10, 0, 0}), quaternion_of(airsim_camera_rotation({}))});
  EXPECT_EQ(client_.camera_info("bottom_center").pose.position, airsim_vector({10, 0, -50}));
  const cv::Mat ahead = client_.image("bottom_center");
  client_.set_camera_pose("bottom_center", {{}, quaternion_of(airsim_camera_rotation({}))});
  client_.set_pose({airsim_vector({10, 0, -50}), {1, 0, 0, 0}});
  EXPECT_TRUE(same_pixels(client_.image("bottom_center"), ahead));
  EXPECT_THAT(error_of<DataError>([&] { client_.image("bottom"); }), HasSubstr("there is no camera \"bottom\""));
  EXPECT_THAT(error_of<DataError>([&] { client_.set_camera_fov("0", 0.5); }), HasSubstr("outside [1, 170]"));
}

TEST_P(AirsimDialects, KnowObjectsAndSensors) {
  client_.pause(true);
  EXPECT_THAT(client_.scene_objects("Gate.*"), ElementsAre("Gate1"));
  EXPECT_THAT(client_.scene_objects(".*"), ElementsAre("SimpleFlight", "Gate1"));
  EXPECT_EQ(client_.object_pose("Gate1").position, airsim_vector({10, 20, -5}));
  EXPECT_TRUE(std::isnan(client_.object_pose("Gate2").position.x_val));
  EXPECT_THAT(error_of<DataError>([&] { client_.scene_objects("("); }), HasSubstr("are understood alone"));

  client_.set_pose({{}, quaternion_of(ned_from_body({0, 30, 0}))});
  const AirsimImu imu = client_.imu();
  EXPECT_NEAR(static_cast<double>(imu.linear_acceleration.x_val), 9.80665 * std::sin(30 * kRadPerDeg), 1e-5);
  EXPECT_NEAR(static_cast<double>(imu.linear_acceleration.z_val), -9.80665 * std::cos(30 * kRadPerDeg), 1e-5);
}

TEST_P(AirsimDialects, LetTimePass) {
  client_.pause(true);
  const std::uint64_t before = client_.state().timestamp;
  client_.continue_for(2.5);
  EXPECT_EQ(client_.state().timestamp - before, 2'500'000'000U);
}

INSTANTIATE_TEST_SUITE_P(All, AirsimDialects,
                         ::testing::Values(AirsimDialect::kAirsim, AirsimDialect::kColosseum, AirsimDialect::kCosys),
                         [](const auto& tested) { return std::string(options_detail::enum_to_name(tested.param)); });

/// A server that knows ping, version 1, and what a test adds.
RpcService scripted(std::map<std::string, RpcAnswer> answers, std::int64_t version = 1) {
  answers["ping"] = {{}, true};
  answers["getServerVersion"] = {{}, version};
  answers.try_emplace("simGetVehiclePose", RpcAnswer{{}, to_rpc(AirsimDialect::kAirsim, AirsimPose())});
  return {[answers](const RpcTicket&, const std::string& method, const RpcArray&) -> std::optional<RpcAnswer> {
            const auto found = answers.find(method);
            return found == answers.end() ? RpcAnswer{"unknown", {}} : found->second;
          },
          [](double) { return std::vector<RpcTicketAnswer>(); }};
}

std::string image_error(const AirsimImage& image) {
  const RpcValue images = to_rpc(AirsimDialect::kAirsim, std::vector<AirsimImage>{image});
  const Served server(scripted({{"simGetImages", {{}, images}}}));
  AirsimClient client(server.address());
  return error_of<DataError>([&] { client.image("0"); });
}

TEST(AirsimClient, RefusesImagesThatAreNone) {
  AirsimImage image;
  EXPECT_THAT(image_error(image), HasSubstr("gives empty images, 11 times"));
  image.image_data_uint8 = RpcBytes(17, 0);
  image.width = image.height = 2;
  EXPECT_THAT(image_error(image), HasSubstr("simGetImages: the image of camera \"0\" is no PNG"));
  image.compress = false;
  EXPECT_THAT(image_error(image), HasSubstr("has 17 bytes; 2 x 2 pixels of 3 take 12"));
  image.width = 40000;
  EXPECT_THAT(image_error(image), HasSubstr("has 40000 x 2 pixels; 1 to 32766 are taken"));
  image.width = 2;
  image.compress = true;
  image.image_data_uint8 = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n', 0, 0, 0, 13,
                            'I',  'H', 'D', 'R', 0x7F, 0xFF, 0xFF, 0xFF, 0, 0, 0, 2};
  EXPECT_THAT(image_error(image), HasSubstr("a PNG of 2147483647 x 2 pixels, not of the 2 x 2"));
  image.image_data_uint8[16] = image.image_data_uint8[17] = image.image_data_uint8[18] = 0;
  image.image_data_uint8[19] = 2;
  EXPECT_THAT(image_error(image), HasSubstr("a PNG that cannot be decoded"));
}

TEST(AirsimClient, AsksAgainForAnEmptyImage) {
  int asked = 0;
  RpcService service = scripted({});
  service.call = [&asked, call = service.call](const RpcTicket& ticket, const std::string& method,
                                               const RpcArray& arguments) -> std::optional<RpcAnswer> {
    if (method != "simGetImages") return call(ticket, method, arguments);
    AirsimImage image;
    image.compress = false;
    if (++asked == 3) {
      image.width = image.height = 1;
      image.image_data_uint8 = {1, 2, 3};
    }
    return RpcAnswer{{}, to_rpc(AirsimDialect::kAirsim, std::vector<AirsimImage>{image})};
  };
  Served server(service);
  AirsimClient client(server.address());
  EXPECT_EQ(client.image("0").at<cv::Vec3b>(0, 0), cv::Vec3b(1, 2, 3));
  server.finish();
  EXPECT_EQ(asked, 3);
}

TEST(AirsimClient, RefusesServersThatItDoesNotKnow) {
  const Served project(scripted({}, 7));
  EXPECT_THAT(error_of<DataError>([&] { AirsimClient client(project.address()); }),
              HasSubstr(": getServerVersion: version 7; 1 (AirSim, Colosseum) and 4 (Cosys-AirSim)"));
  const Served strange(scripted({{"simGetVehiclePose", {{}, std::int64_t{-3}}}}));
  EXPECT_THAT(error_of<DataError>([&] { AirsimClient client(strange.address()); }),
              HasSubstr(": simGetVehiclePose: the reply is an integer, not a map or an array"));
}

TEST(AirsimClient, NamesWhatIsWrongInAReply) {
  const Served server(scripted({{"getHomeGeoPoint", {{}, RpcMap{{"latitude", 1.0}, {"longitude", "east"}}}},
                                {"simGetObjectPose", {{}, RpcArray{1.0}}},
                                {"simListSceneObjects", {{}, RpcArray{"a", RpcValue()}}}}));
  AirsimClient client(server.address());
  const std::string who = server.address().text();
  EXPECT_EQ(error_of<DataError>([&] { client.home(); }),
            who + ": getHomeGeoPoint: the reply.longitude is a string, not a number");
  EXPECT_EQ(error_of<DataError>([&] { client.object_pose("a"); }),
            who + ": simGetObjectPose: the reply is an array of 1, not a map of members");
  EXPECT_EQ(error_of<DataError>([&] { client.scene_objects(".*"); }),
            who + ": simListSceneObjects: the reply[1] is nil, not a string");
  EXPECT_EQ(error_of<DataError>([&] { client.camera_info("0"); }),
            who + ": simGetCameraInfo: the server says: unknown");
  EXPECT_THROW(client.set_pose({{std::nanf(""), 0, 0}, {}}), UsageError);
}

TEST(AirsimClient, PassesOverMembersOfNewerServers) {
  RpcValue map = to_rpc(AirsimDialect::kAirsim, AirsimPose());
  std::get<RpcMap>(map.data).insert(std::get<RpcMap>(map.data).begin(), {"velocity", 1.0F});
  EXPECT_EQ(from_rpc<AirsimPose>(AirsimDialect::kAirsim, map, "it"), AirsimPose());
  RpcValue array = to_rpc(AirsimDialect::kColosseum, AirsimPose());
  std::get<RpcArray>(array.data).emplace_back(1.0F);
  EXPECT_EQ(from_rpc<AirsimPose>(AirsimDialect::kColosseum, array, "it"), AirsimPose());
}

}  // namespace
}  // namespace pilotage
