#include "pilotage/simulate/envelope.h"

#include "select/straight_mission.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/select/select_tiles.h"
#include "pilotage/simulate/envelope_file.h"

namespace pilotage {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

EnvelopeCell cell_of(EnvelopeFactor factor, double value, std::int64_t correct, std::int64_t wrong, std::int64_t frames,
                     std::size_t world = 0) {
  EnvelopeCell cell;
  cell.factor = factor;
  cell.value = value;
  cell.world = world;
  cell.frames = frames;
  cell.correct = correct;
  cell.wrong = wrong;
  if (correct + wrong > 0) cell.largest_error_m = wrong > 0 ? 7.25 : 3.5;
  return cell;
}

/// P falls to both sides of 120 m, and beyond a gap it is high again.
std::vector<EnvelopeCell> peak_at_120_m() {
  std::vector<EnvelopeCell> cells{cell_of(EnvelopeFactor::kPlanned, 0, 36, 1, 40)};
  const std::vector<std::pair<double, int>> correct{{60, 39},  {80, 10},  {100, 35}, {120, 36},
                                                    {140, 34}, {160, 28}, {180, 5}};
  for (const auto& [height_m, count] : correct) {
    cells.push_back(cell_of(EnvelopeFactor::kHeight, height_m, count, 0, 40));
  }
  cells.push_back(cell_of(EnvelopeFactor::kHeight, 140, 0, 0, 40, 1));
  return cells;
}

TEST(EnvelopeValues, AreRangesOrLists) {
  EXPECT_THAT(envelope_values("x", "60:100:20", {1, 1000}), ElementsAre(60, 80, 100));
  EXPECT_THAT(envelope_values("x", "60:99:20", {1, 1000}), ElementsAre(60, 80));
  EXPECT_THAT(envelope_values("x", "2,1,2", {1, 1000}), ElementsAre(1, 2));
  EXPECT_TRUE(envelope_values("x", "", {1, 1000}).empty());
  for (const char* wrong : {"60:100", "60:100:0", "100:60:5", "1,", "a", "0:5:1", "1:1000:0.1", "60:100:20:3"}) {
    EXPECT_THROW(envelope_values("x", wrong, {1, 1000}), UsageError) << wrong;
  }
}

TEST(EnvelopePlaces, AreOneOfEachStratumOfP) {
  const Mission mission = testing::straight_mission(4000, 100, 2);
  std::vector<TileScores> scores = testing::good_scores(mission);
  for (std::size_t i = 0; i < scores.size(); ++i) {
    scores[i].p_correct_fix = 0.3 + 0.6 * static_cast<double>(i) / static_cast<double>(scores.size());
  }
  const Selection selection = select_tiles(mission, scores, testing::kStoredSize, {});
  const std::vector<EnvelopePlace> places = envelope_places(mission, scores, selection, 10, 1);
  ASSERT_EQ(places.size(), 10U);
  const std::vector<EnvelopePlace> all = envelope_places(mission, scores, selection, 10000, 1);
  EXPECT_LE(all.size(), selection.tile_ids.size());
  ASSERT_GT(all.size(), 20U);
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_GE(places[i].p, all[i * all.size() / 10].p) << i;
    EXPECT_LE(places[i].p, all[(i + 1) * all.size() / 10 - 1].p) << i;
  }
  const std::vector<EnvelopePlace> other = envelope_places(mission, scores, selection, 10, 2);
  EXPECT_FALSE(std::equal(places.begin(), places.end(), other.begin(),
                          [](const auto& a, const auto& b) { return a.tile_id == b.tile_id; }));
}

TEST(EnvelopeMargin, EndsAtTheFirstHeightThatIsNotSo) {
  const HeightMargin margin = height_margin(peak_at_120_m(), 0, 120);
  EXPECT_DOUBLE_EQ(margin.planned_p, 0.9);
  // 28 of 40 has the interval [0.535, 0.834], 10 of 40 begins below 0.5; 60 m lies beyond 80 m.
  ASSERT_TRUE(margin.sure_m.has_value());
  EXPECT_EQ(margin.sure_m->low, 100);
  EXPECT_EQ(margin.sure_m->high, 160);
  // 0.9 of 0.9 is 32.4 of 40.
  EXPECT_EQ(margin.as_good_m->low, 100);
  EXPECT_EQ(margin.as_good_m->high, 140);
  const HeightMargin without = height_margin(peak_at_120_m(), 1, 120);
  EXPECT_FALSE(without.sure_m.has_value());
  EXPECT_FALSE(without.as_good_m.has_value());
}

TEST(EnvelopeFile, SaysCellsMarginsAndWhatTheyRestOn) {
  Envelope envelope;
  envelope.worlds = {"", "later, \"b\".tif"};
  envelope.planned_height_m = 120;
  envelope.cells = peak_at_120_m();
  envelope.cells.push_back(cell_of(EnvelopeFactor::kHeading, 90, 0, 0, 0));
  envelope.margins = {height_margin(envelope.cells, 0, 120), height_margin(envelope.cells, 1, 120)};
  envelope.notes = {"simulated"};
  const std::string text = envelope_text(envelope);
  EXPECT_THAT(text, HasSubstr("planned in the mission's own imagery, changed: P(correct) 0.900 [0.763, 0.97"));
  EXPECT_THAT(text, HasSubstr("surely above 0.5 from 100 to 160 m; at least 0.9 of the planned P from 100 to 140 m\n"));
  EXPECT_THAT(text, HasSubstr("not surely above 0.5 even at the planned height\n"));
  EXPECT_THAT(text, HasSubstr("note: simulated\n"));
  const auto json = envelope_to_json(envelope);
  EXPECT_TRUE(json["cells"][0]["value"].is_null());
  EXPECT_EQ(json["cells"][0]["false"], 1);
  EXPECT_EQ(json["cells"][0]["largest_error_m"], 7.25);
  EXPECT_TRUE(json["cells"].back()["largest_error_m"].is_null());
  EXPECT_THAT(text, HasSubstr("1 false of 40 frames, off by up to 7.2 m\n"));
  EXPECT_TRUE(json["cells"].back()["p_correct"].is_null());
  EXPECT_EQ(json["height_margins"][0]["surely_above_half_m"][1], 160);
  EXPECT_TRUE(json["height_margins"][1]["surely_above_half_m"].is_null());
  EXPECT_THAT(envelope_to_csv(envelope), HasSubstr("height_m,140,\"later, \"\"b\"\".tif\",40,0,0,0,0,"));
  EXPECT_THAT(envelope_to_csv(envelope), HasSubstr("false_share_high,largest_error_m\n"));
  EXPECT_THAT(envelope_to_csv(envelope), HasSubstr("planned,,,40,36,1,0.9,"));
  EXPECT_THAT(envelope_to_csv(envelope), HasSubstr(",7.25\n"));
  const std::string svg = envelope_to_svg(envelope);
  EXPECT_THAT(svg, HasSubstr("class=\"p p9\""));
  EXPECT_THAT(svg, HasSubstr("class=\"p none\""));
  EXPECT_THAT(svg, HasSubstr("later, &quot;b&quot;.tif"));
}

}  // namespace
}  // namespace pilotage
