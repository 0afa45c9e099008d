#include "pilotage/camera/camera_text.h"

#include "testing/error_of.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/options_json.h"
#include "pilotage/camera/camera_json.h"

namespace pilotage {
namespace {

using testing::error_of;
using ::testing::HasSubstr;

Camera odd_camera() {
  Camera camera{4000, 2250, 2600.1, 1.0 / 3, 2010.5, -1e-17};
  camera.distortion_model = DistortionModel::kFisheye;
  camera.distortion = {0.1, -2e-9, 3, 1e8, 0};
  camera.mount = {-90, 12.5, 1e-3};
  return camera;
}

TEST(CameraText, ReadsBackExactly) {
  EXPECT_EQ(camera_from_text("map", camera_to_text(odd_camera())), odd_camera());
  EXPECT_EQ(camera_from_text("map", camera_to_text({640, 480, 500, 500, 320, 240})),
            (Camera{640, 480, 500, 500, 320, 240}));
}

TEST(CameraText, RefusesEveryDamagedPair) {
  const CameraText text = camera_to_text(odd_camera());
  for (std::size_t i = 0; i < text.size(); ++i) {
    CameraText changed = text;
    changed.erase(changed.begin() + static_cast<std::ptrdiff_t>(i));
    EXPECT_EQ(error_of<DataError>([&] { camera_from_text("map", changed); }),
              "map: \"" + text[i].first + "\" is missing");
    changed = text;
    changed.push_back(text[i]);
    EXPECT_EQ(error_of<DataError>([&] { camera_from_text("map", changed); }),
              "map: duplicate key \"" + text[i].first + "\"");
    for (const char* bad : {"", "x", "1 ", " 1", "nan", "1e400", "0x10"}) {
      changed = text;
      changed[i].second = bad;
      EXPECT_THAT(error_of<DataError>([&] { camera_from_text("map", changed); }), HasSubstr("map: "))
          << text[i].first << bad;
    }
  }
  CameraText more = text;
  more.emplace_back("colour", "red");
  EXPECT_EQ(error_of<DataError>([&] { camera_from_text("map", more); }), "map: unknown key \"colour\"");
}

TEST(CameraText, FiveCoefficientsNoMoreNoLess) {
  for (const char* bad : {"1 2 3 4", "1 2 3 4 5 6", "1  2 3 4 5", "1,2,3,4,5", "1 2 3 4 inf"}) {
    CameraText text = camera_to_text(odd_camera());
    for (auto& [key, value] : text) {
      if (key == "distortion") value = bad;
    }
    EXPECT_NE(error_of<DataError>([&] { camera_from_text("map", text); }), "") << bad;
  }
}

TEST(CameraJson, ReadsBackExactly) {
  const auto json = camera_to_json(odd_camera());
  EXPECT_EQ(camera_from_json("plan", parse_json("plan", json.dump())), odd_camera());
  EXPECT_EQ(json["width_px"], 4000);
  EXPECT_EQ(json["mount"]["pitch_deg"], 12.5);
  EXPECT_EQ(json["distortion_model"], "fisheye");
}

TEST(CameraJson, IsStrict) {
  const auto with = [](const char* key, const nlohmann::ordered_json& value) {
    auto json = camera_to_json(odd_camera());
    json[key] = value;
    return error_of<DataError>([&] { camera_from_json("plan", json); });
  };
  EXPECT_EQ(with("width_px", "4000"), "plan.width_px is \"4000\", expected an integer");
  EXPECT_EQ(with("width_px", 3.5), "plan.width_px is 3.5, expected an integer");
  EXPECT_EQ(with("width_px", -1), "plan.width_px = -1 is outside [1, 100000]");
  EXPECT_EQ(with("fx_px", nullptr), "plan.fx_px is null, expected a number");
  EXPECT_EQ(with("colour", 1), "plan.colour is not known");
  EXPECT_EQ(with("mount_yaw_deg", 1), "plan.mount_yaw_deg is not known");
  EXPECT_EQ(with("mount", 1), "plan.mount is 1, expected an object");
  EXPECT_EQ(with("mount", {{"yaw_deg", 1}}), "plan.mount.pitch_deg is missing");
  EXPECT_EQ(with("distortion_model", 1), "plan.distortion_model is 1, expected a string");
  EXPECT_EQ(with("distortion_model", "tilted"),
            "plan.distortion_model is \"tilted\", expected one of: none, brown_conrady, fisheye");
  EXPECT_EQ(with("distortion", {1, 2, "x", 4, 5}), "plan.distortion[2] is \"x\", expected a number");
  EXPECT_EQ(with("distortion", {1, 2}), "plan.distortion is [1,2], expected a list of 5 numbers");
  EXPECT_EQ(error_of<DataError>([] { camera_from_json("plan", nlohmann::ordered_json::array()); }),
            "plan is [], expected an object");
}

}  // namespace
}  // namespace pilotage
