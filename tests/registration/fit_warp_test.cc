#include "pilotage/registration/fit_warp.h"

#include <cmath>

#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

Eigen::Vector2d smooth(const Eigen::Vector2d& p) {
  return {8 + 6 * std::sin(p.x() / 300), 4 * std::cos(p.y() / 250) - 3 * p.x() / 1000};
}

struct Made {
  std::vector<Tie> ties;
  std::vector<bool> wrong;
};

/// Ties every 32 m over 960 m, errors of 0.3 m per axis, a share of them anywhere within 25 m.
Made make_ties(double wrong_share, std::string_view seed) {
  Random random(seed_from_name(seed));
  Made made;
  for (int row = 0; row < 30; ++row) {
    for (int col = 0; col < 30; ++col) {
      Tie tie;
      tie.point_m = {32.0 * col, 32.0 * row};
      tie.displacement_m = smooth(tie.point_m) + 0.3 * Eigen::Vector2d(random.normal(), random.normal());
      const bool wrong = random.uniform() < wrong_share;
      if (wrong) tie.displacement_m = {random.uniform(-25, 25), random.uniform(-25, 25)};
      tie.ncc = wrong ? 0.5 : 0.7;
      made.ties.push_back(tie);
      made.wrong.push_back(wrong);
    }
  }
  return made;
}

TEST(FitWarp, FindsASmoothFieldAmongWrongTies) {
  for (const double share : {0.0, 0.3, 0.5}) {
    const Made made = make_ties(share, "wrong ties");
    const WarpFit fit = fit_warp(made.ties, 1, {});
    int unknown = 0;
    for (double x = 0; x <= 928; x += 29) {
      for (double y = 0; y <= 928; y += 29) {
        const Eigen::Vector2d found = fit.field.displacement_m(x, y);
        unknown += found.hasNaN() ? 1 : 0;
        if (found.hasNaN()) continue;
        EXPECT_LT((found - smooth({x, y})).norm(), 0.5 + share) << share << ' ' << x << ' ' << y;
      }
    }
    EXPECT_LE(unknown, share < 0.4 ? 5 : 60) << share << ": of 1089";
    int missed = 0;
    int blamed = 0;
    for (std::size_t i = 0; i < made.ties.size(); ++i) {
      const bool far = (made.ties[i].displacement_m - smooth(made.ties[i].point_m)).norm() > 3;
      missed += made.wrong[i] && far && fit.outlier[i] == 0 ? 1 : 0;
      blamed += !made.wrong[i] && fit.outlier[i] != 0 ? 1 : 0;
    }
    EXPECT_LE(missed, share < 0.4 ? 0 : 4) << share;
    EXPECT_LE(blamed, 2) << share;
    EXPECT_NEAR(fit.residual_m.median, 0.3 * 1.18, 0.05) << share;
    EXPECT_NEAR(fit.disagreement_m.largest, 14.5, 1.0) << share;
  }
}

TEST(FitWarp, PredictsWhatOneMoreTieWouldShow) {
  const WarpFit fit = fit_warp(make_ties(0.2, "sigma").ties, 1, {});
  Random random(seed_from_name("one more tie"));
  double squares = 0;
  int count = 0;
  for (double x = 10; x <= 920; x += 13) {
    for (double y = 10; y <= 920; y += 13) {
      const Eigen::Vector2d more = smooth({x, y}) + 0.3 * Eigen::Vector2d(random.normal(), random.normal());
      squares += (fit.field.displacement_m(x, y) - more).squaredNorm() / 2 / std::pow(fit.field.sigma_m(x, y), 2);
      ++count;
    }
  }
  EXPECT_NEAR(std::sqrt(squares / count), 1, 0.15);
}

TEST(FitWarp, SaysWhereItKnowsNothing) {
  std::vector<Tie> ties;
  for (const Tie& tie : make_ties(0, "known").ties) {
    if (tie.point_m.x() < 300 || tie.point_m.x() > 600) ties.push_back(tie);
  }
  const WarpFit fit = fit_warp(ties, 1, {});
  EXPECT_TRUE(fit.field.known(200, 400));
  EXPECT_TRUE(fit.field.known(700, 400));
  EXPECT_FALSE(fit.field.known(450, 400));
  EXPECT_TRUE(fit.field.displacement_m(450, 400).hasNaN());
  EXPECT_TRUE(std::isnan(fit.field.sigma_m(450, 400)));
  EXPECT_LT((fit.field.continued_m(450, 400) - smooth({450, 400})).norm(), 4) << "the continuation stays sane";
  EXPECT_FALSE(fit.field.known(-500, 400));
  EXPECT_TRUE(fit.field.continued_m(-5000, 4e6).allFinite());
  EXPECT_GT(fit.field.sigma_m(300, 400), fit.field.sigma_m(150, 400)) << "less sure at the edge of the ties";
}

TEST(FitWarp, CoarseTiesHoldWhereThereAreNoFineOnesAndYieldWhereThereAre) {
  Made made = make_ties(0, "coarse");
  std::vector<Tie> ties;
  for (const Tie& tie : made.ties) {
    if (tie.point_m.x() < 450) ties.push_back(tie);
  }
  for (int row = 0; row < 8; ++row) {
    for (int col = 0; col < 8; ++col) {
      Tie tie;
      tie.point_m = {128.0 * col, 128.0 * row};
      tie.displacement_m = smooth(tie.point_m) + Eigen::Vector2d(1, 0);  // all a quarter of their pixel off
      tie.gsd_m = 4;
      tie.ncc = 0.7;
      ties.push_back(tie);
    }
  }
  const WarpFit fit = fit_warp(ties, 1, {});
  EXPECT_LT((fit.field.displacement_m(220, 480) - smooth({220, 480})).norm(), 0.3);
  EXPECT_LT((fit.field.displacement_m(770, 480) - smooth({770, 480})).norm(), 1.6);
  EXPECT_GT(fit.field.sigma_m(770, 480), 1.5 * fit.field.sigma_m(220, 480));
}

TEST(FitWarp, AFewTiesSayNothing) {
  const Made made = make_ties(0, "few");
  const WarpFit fit = fit_warp(std::span(made.ties).first(7), 1, {});
  EXPECT_TRUE(fit.field.control_m.empty());
  EXPECT_FALSE(fit.field.known(0, 0));
  EXPECT_EQ(fit.field.continued_m(0, 0), Eigen::Vector2d::Zero());
  EXPECT_TRUE(std::isnan(fit.disagreement_m.median));
  EXPECT_EQ(fit.outliers, 7);
  EXPECT_TRUE(fit_warp({}, 1, {}).outlier.empty());
}

TEST(FitWarp, IsTheSameTwiceAndRefusesBadOptions) {
  const Made made = make_ties(0.3, "twice");
  EXPECT_EQ(fit_warp(made.ties, 1, {}).field.control_m, fit_warp(made.ties, 1, {}).field.control_m);
  WarpOptions options;
  options.tie_sigma_px = 0;
  EXPECT_THROW(fit_warp(made.ties, 1, options), UsageError);
}

TEST(WarpField, SplineWeightsSumToOneAndMeetAtTheKnots) {
  for (const double t : {0.0, 0.2, 0.7, 1.0}) EXPECT_NEAR(bspline_weights(t).sum(), 1, 1e-15);
  EXPECT_NEAR(bspline_weights(1)[1], bspline_weights(0)[0], 1e-15);
  EXPECT_NEAR(bspline_weights(0.5)[1], 23.0 / 48, 1e-15);
}

}  // namespace
}  // namespace pilotage
