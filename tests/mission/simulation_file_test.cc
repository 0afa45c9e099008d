#include "pilotage/mission/simulation_file.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;

Simulation small_simulation() {
  Simulation simulation;
  simulation.flights = 100;
  simulation.seed = 5;
  simulation.max_error_m = 60;
  simulation.planned_p = 0.9688;
  simulation.within = {94, 100};
  simulation.legs = {{0, 0.97, {94, 100}}, {1, 0.99, {0, 0}}};
  SimulatedMark mark;
  mark.distance_m = 1000;
  mark.p_within = 0.94;
  mark.cep50_m = 2.44;
  mark.r95_m = std::numeric_limits<double>::quiet_NaN();
  mark.nees = 2.01;
  mark.nees_band = {1.6, 2.4};
  mark.lost = 6;
  mark.true_place = {12, 5, 30};
  SimulatedMark between = mark;
  between.distance_m = 700;
  simulation.marks = {between, mark};
  simulation.as_planned = AsPlanned{{97, 100}, 0.03, {-0.01, 0.07}};
  simulation.losses = {{0, 0.9688, {94, 100}}, {1000, 0.98, {99, 100}}};
  simulation.inputs = {{"plan", "/somewhere/plan.json", "", "blake2b-256:ab"}};
  simulation.by_p = {{0.42, {30, 60}}};
  simulation.notes = {"dry"};
  simulation.not_simulated = {"rain", "snow"};
  return simulation;
}

TEST(SimulationFile, SaysSimulatedBesidePlanned) {
  const std::string text = simulation_text(small_simulation());
  EXPECT_THAT(text, HasSubstr("94 of 100 flights stay within 60 m all the way and know it: 0.940 [0.873, 0.977], "
                              "planned 0.968\n"));
  EXPECT_THAT(text, HasSubstr("leg 2: planned 0.990, simulated no flight came here\n"));
  EXPECT_THAT(text, HasSubstr("at 1.00 km: within the limit 0.940, CEP50 2.4 m, R95 – m"));
  EXPECT_THAT(text, HasSubstr("where P is 0.420: right fixes of 60 tries 0.500 [0.368, 0.631]\n"));
  EXPECT_THAT(text, HasSubstr("note: dry\nnot simulated: rain; snow\n"));
  EXPECT_THAT(text, ::testing::Not(HasSubstr("at 0.70 km"))) << "people get whole kilometres";
  EXPECT_THAT(text, HasSubstr("in the plan's own conditions: 0.970 [0.914, 0.993]; those given instead cost "
                              "0.030 [-0.010, 0.070]\n"));
  EXPECT_THAT(text, HasSubstr("lost for good at 0.00 km: planned 0.968, simulated 0.940 [0.873, 0.977], the worst "
                              "place: all that follows is of it\n"));
}

TEST(SimulationFile, HoldsWhatWasFound) {
  const auto json = simulation_to_json(small_simulation());
  EXPECT_EQ(json["within"]["flights"], 94);
  EXPECT_NEAR(json["within"]["low"].get<double>(), 0.8740, 1e-4);
  EXPECT_TRUE(json["legs"][1]["within"]["share"].is_null());
  EXPECT_TRUE(json["along"][0]["r95_m"].is_null());
  EXPECT_EQ(json["seed"], 5);
  EXPECT_EQ(json["by_p"][0]["right"], 30);
  EXPECT_TRUE(json["rendered"].is_null());
  EXPECT_EQ(json["along"][0]["true_place"]["major_m"], 12);
  EXPECT_EQ(json["lost_at"][1]["within"]["flights"], 99);
  EXPECT_EQ(json["as_planned"]["cost_low"], -0.01);
  EXPECT_EQ(json["inputs"].dump(), R"([{"role":"plan","digest":"blake2b-256:ab"}])") << "no names of this machine";
  Simulation matched = small_simulation();
  matched.as_planned.reset();
  EXPECT_TRUE(simulation_to_json(matched)["as_planned"].is_null());
}

TEST(SimulationFile, ReadsBackWhatItWrote) {
  const auto json = simulation_to_json(small_simulation());
  const Simulation read = simulation_from_json(json, "simulation.json");
  EXPECT_EQ(simulation_to_json(read), json);
  EXPECT_EQ(read.legs[1].leg, 1);
  EXPECT_TRUE(std::isnan(read.marks[0].r95_m));
}

TEST(SimulationFile, RefusesWhatItIsNot) {
  const auto problem = [](const nlohmann::ordered_json& json) {
    try {
      simulation_from_json(json, "a.json");
    } catch (const DataError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(problem({{"pilotage_plan", 1}}), HasSubstr("a.json: is no simulation"));
  auto json = simulation_to_json(small_simulation());
  json["pilotage_simulation"] = 3;
  EXPECT_THAT(problem(json), HasSubstr("is of version 3, this program knows 2"));
  json = simulation_to_json(small_simulation());
  json["within"]["of"] = 3;
  EXPECT_THAT(problem(json), HasSubstr("a.json.within.of")) << "fewer than those within";
  json = simulation_to_json(small_simulation());
  json["along"][0]["nees_low"] = "low";
  EXPECT_THAT(problem(json), HasSubstr("nees_low"));
  json = simulation_to_json(small_simulation());
  json["more"] = 1;
  EXPECT_THAT(problem(json), HasSubstr("more"));
}

}  // namespace
}  // namespace pilotage
