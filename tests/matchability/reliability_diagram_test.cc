#include "pilotage/matchability/reliability_diagram.h"

#include <gmock/gmock.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::vector<JudgedPrediction> two_bins() {
  std::vector<JudgedPrediction> predictions;
  for (int i = 0; i < 10; ++i) {
    predictions.push_back({0.25, i < 3, i});
    predictions.push_back({0.75, i < 8, i});
  }
  return predictions;
}

int count(const std::string& text, std::string_view part) {
  int found = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

TEST(ReliabilityDiagram, ShowsBinsWhereTheyBelong) {
  const auto predictions = two_bins();
  const std::string svg = reliability_diagram_svg("Port, 77 m", judge_predictions(predictions, true), predictions);
  EXPECT_EQ(count(svg, "<circle "), 2);
  EXPECT_EQ(count(svg, "class=\"interval\""), 2);
  EXPECT_EQ(count(svg, "class=\"bar\""), 2);
  // The plot is 448 wide from (72, 102): promised 0.25 → x = 184; 3 of 10 → y = 102 + 0.7 · 448 = 415.6.
  EXPECT_THAT(svg, HasSubstr("cx=\"184\" cy=\"415.6\""));
  EXPECT_THAT(svg, HasSubstr("cx=\"408\" cy=\"191.6\""));
  EXPECT_THAT(svg, HasSubstr("promised 0.250 (0.250 … 0.250), came true 3 of 10 = 0.300"));
  EXPECT_THAT(svg, HasSubstr("Port, 77 m"));
  EXPECT_THAT(svg, HasSubstr("20 judged, 11 correct (55.0 %), 10 blocks"));
}

TEST(ReliabilityDiagram, IsSelfContainedAndTheSameEachTime) {
  const auto predictions = two_bins();
  const PredictionQuality quality = judge_predictions(predictions, true);
  const std::string svg = reliability_diagram_svg("A & <B>", quality, predictions);
  EXPECT_EQ(svg, reliability_diagram_svg("A & <B>", quality, predictions));
  EXPECT_THAT(svg, HasSubstr("A &amp; &lt;B&gt;"));
  EXPECT_THAT(svg, HasSubstr("prefers-color-scheme: dark"));
  EXPECT_THAT(svg, Not(HasSubstr("<script")));
  EXPECT_THAT(svg, Not(HasSubstr("href")));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_EQ(count(svg, "http"), 1) << "the name space alone";
}

TEST(ReliabilityDiagram, DrawsItsFrameWithoutPredictions) {
  const std::string svg = reliability_diagram_svg("none", judge_predictions({}, true), {});
  EXPECT_EQ(count(svg, "<circle "), 0);
  EXPECT_THAT(svg, HasSubstr("class=\"diagonal\""));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
}

TEST(ReliabilityDiagram, IsForProbabilitiesOnly) {
  EXPECT_THROW(reliability_diagram_svg("variance", judge_predictions({}, false), {}), UsageError);
}

}  // namespace
}  // namespace pilotage
