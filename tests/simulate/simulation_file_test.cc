#include "pilotage/simulate/simulation_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace pilotage {
namespace {

using ::testing::HasSubstr;

Simulation small_simulation() {
  Simulation simulation;
  simulation.flights = 100;
  simulation.seed = 5;
  simulation.max_error_m = 60;
  simulation.planned_p = 0.9688;
  simulation.within = simulated_share(94, 100);
  simulation.legs = {{0, 0.97, simulated_share(94, 100)}, {1, 0.99, simulated_share(0, 0)}};
  simulation.marks = {{1000, 0.94, 2.44, std::numeric_limits<double>::quiet_NaN(), 2.01, {1.6, 2.4}, 6}};
  simulation.by_p = {{0.42, simulated_share(30, 60)}};
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
}

TEST(SimulationFile, HoldsWhatWasFound) {
  const auto json = simulation_to_json(small_simulation());
  EXPECT_EQ(json["within"]["flights"], 94);
  EXPECT_NEAR(json["within"]["low"].get<double>(), 0.8740, 1e-4);
  EXPECT_TRUE(json["legs"][1]["within"]["share"].is_null());
  EXPECT_TRUE(json["along"][0]["r95_m"].is_null());
  EXPECT_EQ(json["seed"], 5);
  EXPECT_EQ(json["by_p"][0]["right"], 30);
  EXPECT_FALSE(json.contains("rendered"));
}

}  // namespace
}  // namespace pilotage
