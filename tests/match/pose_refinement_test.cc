#include "pilotage/match/pose_refinement.h"

#include <cmath>
#include <limits>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "pilotage/base/random.h"
#include "pilotage/base/statistics.h"
#include "pilotage/geo/position_covariance.h"

namespace pilotage {
namespace {

constexpr double kHeight_m = 120;
constexpr double kHalfFootprint_m = 70;
constexpr double kLeanLength_m = 35;

/// The true pose against the prior one.
struct TruePose {
  Eigen::Vector2d position_m{0, 0};
  Eigen::Vector3d turn_rad{0, 0, 0};
  double log_height = 0;

  Eigen::Matrix<double, 6, 1> vector() const {
    Eigen::Matrix<double, 6, 1> all;
    all << position_m, turn_rad, log_height;
    return all;
  }
};

Eigen::Matrix<double, 6, 1> vector_of(const PoseCorrection& pose) {
  Eigen::Matrix<double, 6, 1> all;
  all << pose.position_m, pose.tilt_rad, pose.turn_rad, pose.log_height;
  return all;
}

/// Where a ray meets ground that rises by rise_m: by an exact rotation, written without the code under test.
Eigen::Vector2d seen_at(const TruePose& pose, const Eigen::Vector3d& ray_m, double rise_m = 0) {
  const double angle = pose.turn_rad.norm();
  const Eigen::AngleAxisd rotation(angle,
                                   angle > 0 ? Eigen::Vector3d(pose.turn_rad / angle) : Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d turned = rotation * ray_m;
  const double height_m = -ray_m.z() * std::exp(pose.log_height) - rise_m;
  return pose.position_m + height_m / -turned.z() * turned.head<2>();
}

Eigen::Vector3d random_ray(Random& random) {
  return {random.uniform(-kHalfFootprint_m, kHalfFootprint_m), random.uniform(-kHalfFootprint_m, kHalfFootprint_m),
          -kHeight_m};
}

std::vector<GroundPair> pairs_of(const TruePose& pose, Random& random, int count, double noise_m = 0, int times = 1) {
  std::vector<GroundPair> pairs;
  for (int i = 0; i < count; ++i) {
    GroundPair pair;
    pair.ray_m = random_ray(random);
    pair.map_m = seen_at(pose, pair.ray_m) + noise_m * Eigen::Vector2d(random.normal(), random.normal());
    for (int copy = 0; copy < times; ++copy) pairs.push_back(pair);
  }
  return pairs;
}

/// Of pairs that are wrong each by itself.
PosePrior weak_prior() {
  return {isotropic_covariance_m2(30), 0.035, 0.035, 0.06};
}

TruePose draw_pose(Random& random, const PosePrior& prior) {
  TruePose pose;
  pose.position_m = largest_sigma_m(prior.position_covariance_m2) * Eigen::Vector2d(random.normal(), random.normal());
  pose.turn_rad = {prior.tilt_sigma_rad * random.normal(), prior.tilt_sigma_rad * random.normal(),
                   prior.yaw_sigma_rad * random.normal()};
  pose.log_height = prior.log_height_sigma * random.normal();
  return pose;
}

TEST(RefinePose, RecoversThePoseFromPairsWithoutNoise) {
  Random random(seed_from_name("noise-free"));
  for (int round = 0; round < 20; ++round) {
    const TruePose truth = draw_pose(random, weak_prior());
    const auto pairs = pairs_of(truth, random, 40);
    const PoseCorrection pose =
        refine_pose(pairs, weak_prior(), {0, 0}, truth.position_m + Eigen::Vector2d(2, -3), 1e-3);
    ASSERT_TRUE(pose.converged);
    EXPECT_EQ(pose.inliers, 40);
    // The rotation's third order, left out, is 2e-3 m at turns of 0.1 rad.
    EXPECT_LT((pose.position_m - truth.position_m).norm(), 0.05);
    EXPECT_LT((pose.tilt_rad - truth.turn_rad.head<2>()).norm(), 5e-4);
    EXPECT_NEAR(pose.turn_rad, truth.turn_rad.z(), 5e-4);
    EXPECT_NEAR(pose.log_height, truth.log_height, 5e-4);
    EXPECT_LT(pose.residual_m, 0.02);
  }
}

TEST(RefinePose, EachUnknownHasItsOwnSign) {
  for (int unknown = 0; unknown < 6; ++unknown) {
    for (const double sign : {-1.0, 1.0}) {
      Random random(seed_from_name("signs"));
      TruePose truth;
      if (unknown < 2) truth.position_m(unknown) = sign * 5;
      if (unknown >= 2 && unknown < 5) truth.turn_rad(unknown - 2) = sign * 0.02;
      if (unknown == 5) truth.log_height = sign * 0.04;
      const PoseCorrection pose = refine_pose(pairs_of(truth, random, 40), weak_prior(), {0, 0}, {0, 0}, 1e-3);
      EXPECT_LT((vector_of(pose) - truth.vector()).cwiseAbs().maxCoeff(), 0.01) << unknown << " " << sign;
    }
  }
}

/// Means of the normalised error squared, poses drawn from the prior.
struct Nees {
  double pose = 0;      ///< Of the six unknowns.
  double position = 0;  ///< Of the position.
};

Nees mean_nees(int runs, int pairs, int times, double noise_m) {
  Random random(seed_from_name("nees"));
  const PosePrior prior = weak_prior();
  Nees sum;
  for (int run = 0; run < runs; ++run) {
    const TruePose truth = draw_pose(random, prior);
    const PoseCorrection pose =
        refine_pose(pairs_of(truth, random, pairs, noise_m, times), prior, {0, 0}, truth.position_m, 0.05);
    EXPECT_TRUE(pose.converged);
    const Eigen::Matrix<double, 6, 1> error = vector_of(pose) - truth.vector();
    sum.pose += error.dot(pose.covariance.ldlt().solve(error)) / runs;
    const Eigen::Vector2d off = error.head<2>();
    sum.position += off.dot(pose.covariance.topLeftCorner<2, 2>().ldlt().solve(off)) / runs;
  }
  return sum;
}

void expect_in_band(double mean_nees, int degrees, int runs) {
  EXPECT_GT(mean_nees, 0.9 * chi_squared_quantile(0.001, degrees * runs) / runs);
  EXPECT_LT(mean_nees, 1.15 * chi_squared_quantile(0.999, degrees * runs) / runs);
}

TEST(RefinePose, CovarianceIsThatOfPairsThatOverlapAsAssumed) {
  constexpr int kRuns = 300;
  const Nees nees = mean_nees(kRuns, 40, static_cast<int>(kPairsPerIndependentPair), 0.5);
  expect_in_band(nees.pose, 6, kRuns);
  expect_in_band(nees.position, 2, kRuns);
}

TEST(RefinePose, OfIndependentPairsItIsAsManyTimesTooLarge) {
  constexpr int kRuns = 300;
  const Nees nees = mean_nees(kRuns, 160, 1, 0.5);
  expect_in_band(kPairsPerIndependentPair * nees.pose, 6, kRuns);
  expect_in_band(kPairsPerIndependentPair * nees.position, 2, kRuns);
}

/// Errors along one axis, or of heights, that neighbours share: waves in any direction, which add up to a Gaussian
/// likeness of this length.
class SharedError {
 public:
  SharedError(Random& random, double sigma, double length_m) {
    for (int i = 0; i < kWaves; ++i) {
      waves_.push_back({Eigen::Vector2d(random.normal(), random.normal()) / length_m, random.uniform(0, 2 * M_PI),
                        sigma * std::sqrt(2.0 / kWaves)});
    }
  }
  double at(const Eigen::Vector2d& place_m) const {
    double sum = 0;
    for (const Wave& wave : waves_) sum += wave.height * std::cos(wave.number_per_m.dot(place_m) + wave.phase_rad);
    return sum;
  }

 private:
  struct Wave {
    Eigen::Vector2d number_per_m;
    double phase_rad;
    double height;
  };
  static constexpr int kWaves = 40;
  std::vector<Wave> waves_;
};

/// Of the position, of pairs whose errors are shared: by their places, and by the heights of their ground.
double shared_nees(double lean_sigma_m, double height_sigma_m, const PosePrior& prior) {
  constexpr int kRuns = 300;
  Random random(seed_from_name("shared errors"));
  double nees = 0;
  for (int run = 0; run < kRuns; ++run) {
    const TruePose truth = draw_pose(random, prior);
    const SharedError east(random, lean_sigma_m, kLeanLength_m);
    const SharedError north(random, lean_sigma_m, kLeanLength_m);
    const SharedError height(random, height_sigma_m, kHeightErrorLength_m);
    std::vector<GroundPair> pairs = pairs_of(truth, random, 200, 0.05);
    for (GroundPair& pair : pairs) {
      pair.rise_m = height.at(pair.map_m) - height.at(truth.position_m);  // the ground is level in truth
      pair.map_m += Eigen::Vector2d(east.at(pair.map_m), north.at(pair.map_m));
    }
    const PoseCorrection pose = refine_pose(pairs, prior, {0, 0}, truth.position_m, 0.05);
    EXPECT_TRUE(pose.converged);
    const Eigen::Vector2d off = pose.position_m - truth.position_m;
    nees += off.dot(pose.covariance.topLeftCorner<2, 2>().ldlt().solve(off)) / kRuns;
  }
  return nees;
}

TEST(RefinePose, ErrorsThatNeighboursShareAreInTheCovariance) {
  PosePrior knowing = weak_prior();
  knowing.lean_sigma_m = 0.4;
  knowing.lean_length_m = kLeanLength_m;
  EXPECT_NEAR(shared_nees(0.4, 0, knowing), 2, 0.5);
  EXPECT_GT(shared_nees(0.4, 0, weak_prior()), 5) << "residuals do not show them: tilt follows";
}

TEST(RefinePose, ErrorsOfTheHeightsAreInTheCovariance) {
  PosePrior knowing = weak_prior();
  knowing.height_sigma_m = 3;
  EXPECT_NEAR(shared_nees(0, 3, knowing), 2, 0.6);
  EXPECT_GT(shared_nees(0, 3, weak_prior()), 5);
}

/// Four pairs whose noise is far above the prior's: what is known before is all there is.
TEST(RefinePose, ThePriorsWholeCovarianceCounts) {
  Random random(seed_from_name("prior"));
  PosePrior prior = weak_prior();
  prior.position_covariance_m2 << 1, 0.9, 0.9, 1;
  const TruePose truth;
  const PoseCorrection pose = refine_pose(pairs_of(truth, random, 40), prior, {0, 0}, {0, 0}, 1000);
  ASSERT_TRUE(pose.converged);
  EXPECT_LT((pose.covariance.topLeftCorner<2, 2>() - prior.position_covariance_m2).norm(), 1e-3);
  // The frame says (1, −1) and knows it as badly as the prior does along (1, 1): there it moves the pose, across not.
  const TruePose moved{{1, -1}, {0, 0, 0}, 0};
  const TruePose along{{1, 1}, {0, 0, 0}, 0};
  const double floor_m = 1.0;
  const auto shift = [&](const TruePose& to) {
    return refine_pose(pairs_of(to, random, 10), prior, {0, 0}, {0, 0}, floor_m).position_m.norm();
  };
  EXPECT_GT(shift(along), 3 * shift(moved));
}

TEST(RefinePose, ThirtyPercentOfOutliersDoLittle) {
  Random random(seed_from_name("outliers"));
  for (int round = 0; round < 10; ++round) {
    const TruePose truth = draw_pose(random, {isotropic_covariance_m2(30), 0.0175, 0.0175, 0.03});
    auto pairs = pairs_of(truth, random, 100, 0.3);
    for (std::size_t i = 0; i < 30; ++i) {
      pairs[i].map_m += Eigen::Vector2d(random.uniform(-25, 25), random.uniform(-25, 25));
    }
    const PosePrior prior{isotropic_covariance_m2(30), 0.0175, 0.0175, 0.03};
    const PoseCorrection pose = refine_pose(pairs, prior, {0, 0}, truth.position_m + Eigen::Vector2d(1, 1), 0.05);
    ASSERT_TRUE(pose.converged);
    EXPECT_LT((pose.position_m - truth.position_m).norm(), 1);
    EXPECT_LT((pose.ground_from_ray({0, 0, -kHeight_m}) - seen_at(truth, {0, 0, -kHeight_m})).norm(), 0.3);
    EXPECT_GE(pose.inliers, 55);
    EXPECT_LE(pose.inliers, 75);
  }
}

TEST(RefinePose, ReliefCounts) {
  Random random(seed_from_name("relief"));
  const TruePose truth{{3, -2}, {0.01, -0.02, 0.015}, 0.02};
  std::vector<GroundPair> pairs;
  for (int i = 0; i < 60; ++i) {
    GroundPair pair;
    pair.ray_m = random_ray(random);
    pair.rise_m = 0.1 * pair.ray_m.x() + random.uniform(-3, 3);  // a slope
    pair.map_m = seen_at(truth, pair.ray_m, pair.rise_m);
    pairs.push_back(pair);
  }
  const PoseCorrection with = refine_pose(pairs, weak_prior(), {0, 0}, {0, 0}, 1e-3);
  EXPECT_LT((vector_of(with) - truth.vector()).cwiseAbs().maxCoeff(), 0.02);
  for (GroundPair& pair : pairs) pair.rise_m = 0;
  const PoseCorrection without = refine_pose(pairs, weak_prior(), {0, 0}, {0, 0}, 1e-3);
  EXPECT_GT(without.residual_m, 10 * with.residual_m);
  EXPECT_GT((vector_of(without) - truth.vector()).norm(), 10 * (vector_of(with) - truth.vector()).norm());
}

TEST(RefinePose, ThePriorDecidesWhatPairsLeaveOpen) {
  // All pairs in one place: they fix its place on the map, not the attitude.
  Random random(seed_from_name("one place"));
  std::vector<GroundPair> pairs;
  for (int i = 0; i < 200; ++i) {
    GroundPair pair;
    pair.ray_m = {random.uniform(-1, 1), random.uniform(-1, 1), -kHeight_m};
    pair.map_m = pair.ray_m.head<2>() + Eigen::Vector2d(4, 0);
    pairs.push_back(pair);
  }
  const PosePrior prior{isotropic_covariance_m2(30), 0.01, 0.02, 0.03};
  const PoseCorrection pose = refine_pose(pairs, prior, {0, 0}, {4, 0}, 0.05);
  ASSERT_TRUE(pose.converged);
  EXPECT_NEAR(std::sqrt(pose.covariance(2, 2)), 0.01, 0.0005);
  EXPECT_NEAR(std::sqrt(pose.covariance(3, 3)), 0.01, 0.0005);
  EXPECT_NEAR(std::sqrt(pose.covariance(0, 0)), 0.01 * kHeight_m, 0.1) << "what tilt moves the view by";
  const Eigen::Matrix<double, 2, 6> jacobian = pose.ground_jacobian({0, 0, -kHeight_m});
  const Eigen::Matrix2d of_center = jacobian * pose.covariance * jacobian.transpose();
  EXPECT_LT(std::sqrt(of_center(0, 0)), 0.1) << "the point in view is known well";
}

TEST(RefinePose, UnknownYawIsFree) {
  Random random(seed_from_name("yaw"));
  TruePose truth;
  truth.turn_rad.z() = 0.3;
  PosePrior prior = weak_prior();
  prior.yaw_sigma_rad = 3.14;
  const PoseCorrection pose = refine_pose(pairs_of(truth, random, 40), prior, {0, 0}, {0, 0}, 1e-3);
  ASSERT_TRUE(pose.converged);
  // To the rotation's second order: 0.3³/6.
  EXPECT_NEAR(pose.turn_rad, 0.3, 0.006);
}

TEST(RefinePose, TooFewPairsOrNumbersThatAreNone) {
  Random random(seed_from_name("few"));
  for (int count = 0; count < 4; ++count) {
    const PoseCorrection pose = refine_pose(pairs_of({}, random, count), weak_prior(), {0, 0}, {1, 2}, 0.1);
    EXPECT_FALSE(pose.converged);
    EXPECT_EQ(pose.position_m, Eigen::Vector2d(1, 2));
  }
  EXPECT_TRUE(refine_pose(pairs_of({}, random, 4), weak_prior(), {0, 0}, {0, 0}, 0.1).converged);
  auto pairs = pairs_of({}, random, 20);
  for (GroundPair& pair : pairs) pair.map_m.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(refine_pose(pairs, weak_prior(), {0, 0}, {0, 0}, 0.1).converged);
}

TEST(PoseCorrectionTest, JacobianIsThatOfDifferences) {
  PoseCorrection pose;
  pose.position_m = {3, -4};
  pose.tilt_rad = {0.02, -0.03};
  pose.turn_rad = 0.05;
  pose.log_height = -0.02;
  const Eigen::Vector3d ray(30, -50, -kHeight_m);
  const Eigen::Matrix<double, 2, 6> jacobian = pose.ground_jacobian(ray);
  for (int unknown = 0; unknown < 6; ++unknown) {
    constexpr double kStep = 1e-5;
    const auto moved = [&](double by) {
      PoseCorrection other = pose;
      double* const values[] = {&other.position_m.x(), &other.position_m.y(), &other.tilt_rad.x(),
                                &other.tilt_rad.y(),   &other.turn_rad,       &other.log_height};
      *values[unknown] += by;
      return other.ground_from_ray(ray);
    };
    const Eigen::Vector2d difference = (moved(kStep) - moved(-kStep)) / (2 * kStep);
    EXPECT_LT((jacobian.col(unknown) - difference).norm(), 1e-5) << unknown;
  }
}

}  // namespace
}  // namespace pilotage
