#include "pilotage/compare/comparison_summary.h"

#include <cmath>

#include "compare/sample_comparison.h"
#include <gtest/gtest.h>

namespace pilotage {
namespace {

double column(const MethodSummary& summary, const std::string& name) {
  for (const SummaryColumn& candidate : summary_columns()) {
    if (candidate.name == name) return candidate.get(summary);
  }
  ADD_FAILURE() << "no column " << name;
  return 0;
}

TEST(ComparisonSummary, CountsWhatTheFramesSay) {
  const std::vector<MethodSummary> summaries = summarise(testing::sample_comparison());
  ASSERT_EQ(summaries.size(), 2U);
  const MethodSummary& orb = summaries[0];
  EXPECT_EQ(orb.method, DescriptorMethod::kOrb);
  // Frames 1 and 2 show the reference, 3 does not, 4 has a problem.
  EXPECT_EQ(orb.best.count, 9 + 3);
  EXPECT_EQ(orb.best.of, 20);
  EXPECT_EQ(orb.matches.count, 40 + 10);
  EXPECT_EQ(orb.matches.of, 200);
  EXPECT_EQ(orb.inliers.count, 30 + 8);
  EXPECT_EQ(orb.inliers.of, 80);
  EXPECT_EQ(orb.correct.count, 1);
  EXPECT_EQ(orb.correct.of, 2);
  EXPECT_EQ(orb.wrong.count, 1);
  EXPECT_EQ(orb.wrong.of, 4);
  EXPECT_EQ(orb.wrong_of_accepted.count, 1);
  EXPECT_EQ(orb.wrong_of_accepted.of, 2);
  // Without the frame that has a problem: 10, 20, 60 ms.
  EXPECT_EQ(orb.detect.median_ms, 20);
  EXPECT_EQ(orb.detect.sum_ms, 90);
  EXPECT_EQ(orb.total.median_ms, 20 + 1 + 2);
  EXPECT_EQ(orb.total.sum_ms, 90 + 3 + 6);
}

TEST(ComparisonSummary, ColumnsHoldTheSameNumbers) {
  const std::vector<MethodSummary> summaries = summarise(testing::sample_comparison());
  EXPECT_EQ(column(summaries[0], "detect_median_ms"), 20);
  EXPECT_EQ(column(summaries[0], "best_10_accuracy"), 0.6);
  EXPECT_EQ(column(summaries[0], "correct_fix_rate"), 0.5);
  // One of two, Clopper–Pearson: 1 − √0.975 and √0.975.
  EXPECT_NEAR(column(summaries[0], "correct_fix_rate_low"), 1 - std::sqrt(0.975), 1e-9);
  EXPECT_NEAR(column(summaries[0], "correct_fix_rate_high"), std::sqrt(0.975), 1e-9);
  // SIFT accepts nothing: no share, and an interval that says nothing.
  EXPECT_TRUE(std::isnan(column(summaries[1], "false_of_accepted")));
  EXPECT_EQ(column(summaries[1], "false_of_accepted_low"), 0);
  EXPECT_EQ(column(summaries[1], "false_of_accepted_high"), 1);
}

TEST(ComparisonSummary, NoFramesGiveNoNumbers) {
  Comparison empty;
  empty.methods = {DescriptorMethod::kSurf};
  const MethodSummary summary = summarise(empty).front();
  EXPECT_TRUE(std::isnan(summary.detect.median_ms));
  EXPECT_TRUE(std::isnan(summary.best.value()));
  EXPECT_EQ(summary.detect.sum_ms, 0);
}

}  // namespace
}  // namespace pilotage
