#include "pilotage/replay/grade_fit.h"

#include <gtest/gtest.h>

#include "pilotage/base/random.h"
#include "pilotage/flightlog/drifting_priors.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/geo/position_covariance.h"

namespace pilotage {
namespace {

constexpr double kFixSigma_m = 1.5;
constexpr double kSpeed_mps = 20;

InsErrorModel tactical() {
  InsOptions options;
  options.grade = InsGrade::kTactical;
  return make_ins_error_model(options);
}

/// Eastward, a fix every `every_s` seconds, the inertial errors drawn by `model`.
ReplayedFlight drawn_flight(const InsErrorModel& model, std::uint64_t seed, int fixes, double every_s) {
  std::vector<FlownPlace> places;
  for (int i = 0; i < fixes; ++i) places.push_back({i * every_s, 90});
  const std::vector<DriftingPrior> priors = drifting_priors(places, kSpeed_mps, model, seed);
  Random random(seed + 1);
  const LocalFrame start({16.5, 55.5});
  ReplayedFlight flight;
  flight.priors = "inertial";
  for (std::size_t i = 0; i < places.size(); ++i) {
    const GeodeticPoint truth = start.geodetic_from_enu({kSpeed_mps * places[i].time_s, 0, 0});
    ReplayedFrame frame;
    frame.time_s = places[i].time_s;
    frame.yaw_deg = 90;
    frame.outcome = Outcome::kCorrect;
    const Eigen::Vector2d& error_m = priors[i].error_en_m;
    frame.prior = LocalFrame(truth).geodetic_from_enu({error_m.x(), error_m.y(), 0});
    frame.inertial_error = InertialError{error_m + kFixSigma_m * Eigen::Vector2d(random.normal(), random.normal()),
                                         isotropic_covariance_m2(kFixSigma_m)};
    flight.frames.push_back(frame);
  }
  return flight;
}

TEST(GradeFit, ThirtyFlightsOfTheModelHoldTheModelAsOftenAsPromised) {
  const InsErrorModel model = tactical();
  int held = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const std::vector<ReplayedFlight> flights{drawn_flight(model, seed_from_name("GradeFit") + seed, 30, 20)};
    const GradeFit fit = fit_grade(flights, model);
    ASSERT_TRUE(fit.factor);
    EXPECT_EQ(fit.innovations, 29);
    EXPECT_NEAR(fit.longest_gap_s, 20, 1e-9);
    if ((!fit.low || *fit.low <= 1) && (!fit.high || *fit.high >= 1)) ++held;
  }
  EXPECT_GE(held, 25);  // 95 % of 30 is 28.5; fewer than 25 come once in 300 times
}

TEST(GradeFit, WorseSystemIsFoundWorse) {
  const InsErrorModel model = tactical();
  std::vector<ReplayedFlight> flights;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) flights.push_back(drawn_flight(scaled_model(model, 4), seed, 30, 20));
  const GradeFit fit = fit_grade(flights, model);
  ASSERT_TRUE(fit.factor && fit.low && fit.high);
  EXPECT_GT(*fit.low, 2);
  EXPECT_LT(*fit.low, *fit.factor);
  EXPECT_GT(*fit.high, *fit.factor);
  EXPECT_LT(*fit.high, 8);
  EXPECT_GT(fit.mean_nis, fit.nis_band.high);
}

TEST(GradeFit, AnEndOfWhatIsLookedAtIsNoFactor) {
  const InsErrorModel model = tactical();
  const std::vector<ReplayedFlight> wild{drawn_flight(scaled_model(model, 200), 1, 30, 20)};
  const GradeFit fit = fit_grade(wild, model);
  EXPECT_FALSE(fit.factor || fit.high);
  EXPECT_NE(fit.why_not.find("beyond 32 times the model's"), std::string::npos) << fit.why_not;
  EXPECT_GT(fit.mean_nis, fit.nis_band.high);
  // A second between fixes is too short for a drift: what they say is a bound.
  const std::vector<ReplayedFlight> steady{drawn_flight(scaled_model(model, 0.001), 1, 30, 1)};
  const GradeFit bounded = fit_grade(steady, model);
  EXPECT_FALSE(bounded.factor);
  ASSERT_TRUE(bounded.high);
  EXPECT_NE(bounded.why_not.find("fixes do not tell its drift from none; it is below "), std::string::npos)
      << bounded.why_not;
}

TEST(GradeFit, FewGapsSayNothing) {
  const std::vector<ReplayedFlight> flights{drawn_flight(tactical(), 1, 10, 20)};
  const GradeFit fit = fit_grade(flights, tactical());
  EXPECT_FALSE(fit.factor);
  EXPECT_NE(fit.why_not.find("at least 10"), std::string::npos);
}

TEST(GradeFit, FalseFixesAndFramesWithoutPriorTakeNoPart) {
  ReplayedFlight flight = drawn_flight(tactical(), 1, 30, 20);
  flight.frames[10].outcome = Outcome::kFalse;
  flight.frames[20].prior.reset();
  const std::vector<ReplayedFlight> flights{flight};
  EXPECT_EQ(fit_grade(flights, tactical()).innovations, 27);
}

}  // namespace
}  // namespace pilotage
