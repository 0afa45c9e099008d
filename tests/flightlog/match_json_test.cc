#include "pilotage/flightlog/match_json.h"

#include <cmath>
#include <limits>
#include <set>

#include "flightlog/numbered_match.h"
#include "testing/json_schema.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/flightlog/fix_table.h"
#include "pilotage/flightlog/match_evaluation.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::numbered_match;

using Json = nlohmann::ordered_json;

std::string violation(const Json& json) {
  return testing::schema_violation("match.schema.json", json);
}

FrameMatch refused_match() {
  FrameMatch match = numbered_match();
  match.result.status = MatchStatus::kAmbiguous;
  match.result.fix.reset();
  match.error.reset();
  return match;
}

const std::vector<TakenField> kTaken{{"a.jpg", "yaw_deg", 45, "drone-dji:GimbalYawDegree"},
                                     {"b.jpg", "yaw_deg", 46, "drone-dji:GimbalYawDegree"},
                                     {"b.jpg", "height_agl_m", 40.1, "drone-dji:RelativeAltitude"}};

TEST(MatchJson, FollowsItsSchema) {
  EXPECT_EQ(violation(to_json(numbered_match(), kTaken)), "");
  EXPECT_EQ(violation(to_json(refused_match(), {}, false)), "");
  EXPECT_EQ(violation(to_json(FrameMatch{}, {})), "");
  FrameMatch unreadable;
  unreadable.problem = "x";
  const std::vector<FrameMatch> flight{numbered_match(), refused_match(), unreadable};
  EXPECT_EQ(violation(to_json(evaluate_matches(flight, 5))), "");
  EXPECT_EQ(violation(to_json(evaluate_matches({}, 5), false)), "");
}

TEST(MatchJson, TheSchemaRefusesWhatIsWrong) {
  const Json good = to_json(numbered_match(), kTaken);
  Json bad = good;
  bad["status"] = "perhaps";
  EXPECT_NE(violation(bad), "");
  bad = good;
  bad["fix"].erase("tile_id");
  EXPECT_NE(violation(bad), "");
  bad = good;
  bad["stats"]["new"] = 1;
  EXPECT_NE(violation(bad), "");
  Json flight = to_json(evaluate_matches({}, 5));
  flight["refused"]["perhaps"] = 1;
  EXPECT_NE(violation(flight), "");
}

TEST(MatchJson, NumbersStandUnderTheirNames) {
  const Json json = to_json(numbered_match(), kTaken);
  EXPECT_EQ(json["fix"]["lon_deg"], 16.1);
  EXPECT_EQ(json["fix"]["covariance_en_m2"], Json({4, 1.5, 1.5, 9}));
  EXPECT_EQ(json["fix"]["center"]["north_sigma_m"], 5);
  EXPECT_EQ(json["fix"]["error_m"], 2.25);
  EXPECT_EQ(json["map_index"], 2);
  EXPECT_EQ(json["map_statuses"], Json({"no_map", "ambiguous", "fix"}));
  EXPECT_EQ(json["taken"][2]["value"], 40.1);
  EXPECT_EQ(json["milliseconds"], 21.5);
  EXPECT_FALSE(to_json(numbered_match(), {}, false).contains("milliseconds"));
  const Json refused = to_json(refused_match(), {});
  EXPECT_TRUE(refused["fix"].is_null());
  EXPECT_EQ(refused["candidate"]["lat_deg"], 55.2);
  FrameMatch odd = numbered_match();
  odd.result.stats.residual_m = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(to_json(odd, {})["stats"]["residual_m"].is_null());
}

// The table and the JSON say the same of a frame, under the same names.
TEST(MatchJson, NamesAreThoseOfTheTable) {
  std::set<std::string> columns;
  for (const FixColumn& column : fix_columns()) columns.insert(column.name);
  const Json json = to_json(numbered_match(), {});
  for (const auto& [name, value] : json["stats"].items()) EXPECT_TRUE(columns.contains(name)) << name;
  for (const auto& [name, value] : json["fix"].items()) {
    EXPECT_TRUE(name == "center" || columns.contains(name)) << name;
  }
  for (const auto& [name, value] : json["fix"]["center"].items()) {
    EXPECT_TRUE(columns.contains("center_" + name)) << name;
  }
}

TEST(MatchText, SaysTheFixOrTheReason) {
  const std::string fix = frame_match_text(numbered_match());
  EXPECT_THAT(fix,
              HasSubstr("fix: a fix\naircraft: lon 16.1000000, lat 55.2000000, sigma east 2.00 m, north 3.00 m\n"));
  EXPECT_THAT(fix, HasSubstr("error of the aircraft's place: 2.25 m\n"));
  EXPECT_THAT(fix, HasSubstr("time of matching: 21.5 ms\n"));
  const std::string refused = frame_match_text(refused_match(), false);
  EXPECT_THAT(refused, HasSubstr("ambiguous: another place in the window looks as good, or another map says another "
                                 "place\n210 inliers of 1500 features"));
  EXPECT_THAT(refused, Not(HasSubstr("aircraft")));
  EXPECT_THAT(refused, Not(HasSubstr("ms")));
}

TEST(TakenText, OneLineForEachFieldAndTag) {
  EXPECT_EQ(taken_text(kTaken),
            "from the picture: height_agl_m = 40.1 (drone-dji:RelativeAltitude)\n"
            "from the picture: yaw_deg of 2 frames (drone-dji:GimbalYawDegree)\n");
}

}  // namespace
}  // namespace pilotage
