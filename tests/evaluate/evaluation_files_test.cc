#include "pilotage/evaluate/evaluation_files.h"

#include "evaluate/scored_dates.h"
#include "testing/json_schema.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::scored_dates;
using ::testing::StartsWith;

struct Evaluated {
  EvaluationSource source{{"plan.json"}, "pilotage 0", {}, 1};
  Evaluation evaluation;

  Evaluated() {
    const testing::TemporaryFolder work;
    source.options.file = scored_dates().other;
    source.options.matcher = EvaluateMatcher::kNcc;
    source.options.stated_rate = 0.6;
    evaluation = evaluate(scored_dates().judged(), {}, source.options, work / "scratch.gpkg", 1, 2, {});
  }
};

const Evaluated& evaluated() {
  static const Evaluated made;
  return made;
}

TEST(EvaluationFiles, JsonFollowsItsSchema) {
  const auto json = evaluation_json(evaluated().evaluation, evaluated().source);
  EXPECT_EQ(testing::schema_violation("evaluation.schema.json", json), "");
  EXPECT_EQ(json["predictors"].size(), 5U);
  EXPECT_EQ(json["outcomes"]["correct"], evaluated().evaluation.counts.at(Outcome::kCorrect));
  auto broken = json;
  broken["predictors"][0].erase("auc");
  EXPECT_NE(testing::schema_violation("evaluation.schema.json", broken), "");
}

TEST(EvaluationFiles, CsvHasALineForEachOutcome) {
  const std::string csv = evaluation_csv(scored_dates().judged(), evaluated().evaluation);
  EXPECT_THAT(
      csv, StartsWith("tile_id,level,column,row,center_lon_deg,center_lat_deg,block,frame,outcome,status,error_m,"
                      "error_east_m,error_north_m,nadir_error_m,evidence,p_correct_fix,gray_variance,frieden_deficit,"
                      "clean_peak_margin,degraded_peak_margin,map_features,vote_noise,fine_contrast\n"));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 82);
}

TEST(EvaluationFiles, MarkdownAndTextShowEveryPredictor) {
  const std::string page = evaluation_markdown(evaluated().evaluation, evaluated().source, true);
  for (const char* title : {"| P(correct fix) |", "| gray variance |", "| Frieden deficit |", "| uniqueness, clean |",
                            "| uniqueness, degraded copies |", "skill, stated rate", "](reliability.svg)"}) {
    EXPECT_THAT(page, HasSubstr(title));
  }
  EXPECT_THAT(page, Not(HasSubstr("nan")));
  EXPECT_THAT(evaluation_text(evaluated().evaluation), HasSubstr("evaluation: p_correct_fix: AUC 0."));
}

TEST(EvaluationFiles, AppearTogetherAndAreNotReplacedUnasked) {
  const testing::TemporaryFolder out;
  {
    EvaluationFiles files(out.path(), false);
    files.write(scored_dates().judged(), evaluated().evaluation, evaluated().source);
    EXPECT_FALSE(std::filesystem::exists(out / "evaluation.md"));
  }
  EXPECT_TRUE(std::filesystem::is_empty(out.path()));
  EvaluationFiles files(out.path(), false);
  files.write(scored_dates().judged(), evaluated().evaluation, evaluated().source);
  EXPECT_EQ(files.commit().size(), 4U);
  EXPECT_THAT(read_file(out / "reliability.svg"), StartsWith("<svg "));
  EXPECT_THROW(EvaluationFiles(out.path(), false), DataError);

  // Without a model there is no diagram, and none of an earlier run either.
  Evaluation without = evaluated().evaluation;
  without.predictors.erase(without.predictors.begin());
  EvaluationFiles again(out.path(), true);
  again.write(scored_dates().judged(), without, evaluated().source);
  EXPECT_EQ(again.commit().size(), 3U);
  EXPECT_FALSE(std::filesystem::exists(out / "reliability.svg"));
}

}  // namespace
}  // namespace pilotage
