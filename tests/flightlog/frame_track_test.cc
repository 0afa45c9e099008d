#include "pilotage/flightlog/frame_track.h"

#include <cmath>

#include "testing/pinhole_camera.h"
#include <gtest/gtest.h>

#include "pilotage/base/random.h"
#include "pilotage/base/statistics.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/match/match_confidence.h"

namespace pilotage {
namespace {

constexpr double kGsd_m = 0.5;
const LocalFrame kAtStart(GeodeticPoint{16.5, 55.5});

GeodeticPoint place(const Eigen::Vector2d& enu_m) {
  return kAtStart.geodetic_from_enu({enu_m.x(), enu_m.y(), 0});
}

/// A flight to the east at 20 m/s, of which only the answers to the frames count.
class Flight {
 public:
  explicit Flight(double rate = 0.001, std::size_t maps = 1)
      : track_(options_of(rate), make_ins_error_model({}), {0, 90, 20}, maps) {}

  /// `dt_s` later a frame is taken and answered: the inertial position is wrong by `off_m`, the best place by
  /// `place_off_m` against the truth; evidence of 20 makes a fix by itself.
  FrameMatch fly(double dt_s, const Eigen::Vector2d& off_m, double evidence,
                 const Eigen::Vector2d& place_off_m = {0, 0}) {
    if (time_s_ > 0) track_.fly_on({dt_s, 90, 20});
    time_s_ += dt_s;
    const Eigen::Vector2d truth_m(20 * time_s_, 0);
    FlightFrame frame;
    frame.frame.file = "x.jpg";
    frame.frame.time_s = time_s_;
    frame.frame.prior = place(truth_m + off_m);
    frame.frame.prior_covariance_en_m2 = isotropic_covariance_m2(25);
    frame.frame.height_agl_m = 60;
    frame.camera = testing::pinhole_camera(160, 120, 140);  // 69 m wide
    FrameMatch match;
    match.frame = track_.with_prior(frame.frame);
    Fix fix;
    fix.position = place(truth_m + place_off_m);
    fix.covariance_en_m2 = isotropic_covariance_m2(1) + isotropic_covariance_m2(map_sigma_m);
    fix.map_sigma_m = map_sigma_m;
    fix.map_error_is_shared = map_error_is_shared;
    match.result.candidate = fix;
    match.result.stats.vote_peak = evidence;
    match.result.stats.gsd_m = kGsd_m;
    match.result.status = MatchStatus::kInconsistent;
    if (std::exp(-evidence) <= track_.options().max_false_fix_rate) {
      match.result.status = MatchStatus::kFix;
      match.result.fix = fix;
    }
    track_.judge(frame, match);
    return match;
  }
  const SequenceSummary& summary() const { return track_.summary(); }

  double map_sigma_m = 1;
  bool map_error_is_shared = true;

 private:
  static MatchOptions options_of(double rate) {
    MatchOptions options;
    options.max_false_fix_rate = rate;
    return options;
  }
  FrameTrack track_;
  double time_s_ = 0;
};

const Eigen::Vector2d kOff(30, -20);

TEST(FrameTrack, AFixMovesAndNarrowsTheNextPrior) {
  Flight flight;
  EXPECT_EQ(flight.fly(1, kOff, 20).frame.prior_covariance_en_m2, isotropic_covariance_m2(25));
  const FrameMatch next = flight.fly(5, kOff, 20);
  EXPECT_LT((kAtStart.enu_from_geodetic(next.frame.prior).head<2>() - Eigen::Vector2d(120, 0)).norm(), 0.1);
  EXPECT_LT(largest_sigma_m(next.frame.prior_covariance_en_m2), 3);
  EXPECT_EQ(flight.summary().narrowed, 1);
}

TEST(FrameTrack, AWeakPlaceWhereTheTrackSaysIsAFix) {
  Flight flight;
  flight.fly(1, kOff, 20);
  const FrameMatch weak = flight.fly(5, kOff, 4);
  EXPECT_TRUE(weak.has_fix());
  EXPECT_TRUE(weak.confirmed);
  EXPECT_EQ(weak.result.status, MatchStatus::kFix);
  EXPECT_GE(weak.result.stats.confidence, 1 - 0.0005);
  EXPECT_FALSE(flight.fly(5, kOff, 0.5).has_fix()) << "too weak even there";
  EXPECT_FALSE(flight.fly(5, kOff, 4, {40, 0}).has_fix()) << "elsewhere";
  EXPECT_EQ(flight.summary().confirmed, 1);
}

TEST(FrameTrack, TheBestOfSeveralMapsIsConfirmedByChanceAsManyTimesAsOften) {
  const auto doubt = [](std::size_t maps) {
    Flight flight(0.001, maps);
    flight.fly(1, kOff, 20);
    return 1 - flight.fly(5, kOff, 6).result.stats.confidence;
  };
  EXPECT_NEAR(doubt(3), 3 * doubt(1), 1e-12);
  const auto confirmed = [](std::size_t maps) {
    Flight flight(0.001, maps);
    flight.fly(1, kOff, 20);
    return flight.fly(5, kOff, 4).confirmed;
  };
  EXPECT_TRUE(confirmed(1));
  EXPECT_FALSE(confirmed(50));
}

TEST(FrameTrack, TwoWeakPlacesConfirmEachOther) {
  Flight flight;
  EXPECT_FALSE(flight.fly(1, kOff, 4).has_fix());
  EXPECT_TRUE(flight.fly(5, kOff, 4).confirmed);
  EXPECT_EQ(flight.summary().narrowed, 0) << "a weak place narrows nothing before it is confirmed";
  flight.fly(5, kOff, 4);
  EXPECT_EQ(flight.summary().narrowed, 1);
  Flight apart;
  apart.fly(1, kOff, 4);
  EXPECT_FALSE(apart.fly(5, kOff, 4, {20, 0}).has_fix()) << "they contradict each other";
}

TEST(FrameTrack, FramesThatShareGroundDoNotConfirmEachOther) {
  Flight flight;
  flight.fly(1, kOff, 4);
  EXPECT_FALSE(flight.fly(1, kOff, 5).has_fix()) << "20 m further, of 69 m";
  EXPECT_TRUE(flight.fly(4, kOff, 4).confirmed);
}

TEST(FrameTrack, AFixAgainstTheTrackIsRefused) {
  Flight flight;
  flight.fly(1, kOff, 20);
  const FrameMatch against = flight.fly(5, kOff, 20, {60, 0});
  EXPECT_EQ(against.result.status, MatchStatus::kOutsideGate);
  EXPECT_FALSE(against.has_fix());
  EXPECT_EQ(flight.summary().gate_refusals, 1);
}

TEST(FrameTrack, FixesOfTwoMapsMayLieAsFarApartAsTheirMapsDo) {
  for (const bool shared : {true, false}) {
    Flight flight;
    flight.map_sigma_m = 5;
    flight.map_error_is_shared = shared;
    flight.fly(1, kOff, 20);
    EXPECT_EQ(flight.fly(5, kOff, 20, {10, 0}).has_fix(), !shared);
  }
}

TEST(FrameTrack, AfterRefusalsInARowTheRowsCountAlone) {
  Flight flight;
  flight.fly(1, kOff, 20, {50, 0});  // false
  for (int i = 0; i < kTrackRefusals; ++i) {
    EXPECT_EQ(flight.summary().resets, 0);
    EXPECT_FALSE(flight.fly(5, kOff, 20).has_fix()) << i;
  }
  EXPECT_EQ(flight.summary().resets, 1);
  const FrameMatch after = flight.fly(5, kOff, 20);
  EXPECT_EQ(after.frame.prior_covariance_en_m2, isotropic_covariance_m2(25));
  EXPECT_TRUE(after.has_fix());
}

/// Frames of other ground all the way: places anywhere in the calibrated window, evidence exponential. A high rate, so
/// that tracks begin by chance and are flown on.
TEST(FrameTrack, OtherGroundKeepsTheRateAskedFor) {
  constexpr double kRate = 0.04;
  constexpr int kFrames = 20000;
  Random random(seed_from_name("other ground"));
  Flight flight(kRate);
  const double half_m = kCalibratedHalfWidthPx * kGsd_m;
  int fixes = 0;
  for (int i = 0; i < kFrames; ++i) {
    const double east_m = random.uniform(-half_m, half_m);
    const Eigen::Vector2d off_m(east_m, random.uniform(-half_m, half_m));
    fixes += flight.fly(5, {0, 0}, -std::log(1 - random.uniform()), off_m).has_fix() ? 1 : 0;
  }
  EXPECT_GT(flight.summary().confirmed, 0);
  EXPECT_LE(binomial_interval(fixes, kFrames, 0.999).low, kRate);
}

}  // namespace
}  // namespace pilotage
