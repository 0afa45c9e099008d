#include "pilotage/compare/comparison_files.h"

#include <algorithm>
#include <fstream>

#include "compare/sample_comparison.h"
#include "testing/source_folder.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Adapter = valijson::adapters::NlohmannJsonAdapter;

ComparisonSource source() {
  ComparisonSource result{{"a.tif", "b.tif"}, "frames.csv", "pilotage 1.2.3", {}, 7};
  result.options.methods = {DescriptorMethod::kOrb, DescriptorMethod::kSift};
  return result;
}

bool follows_schema(const nlohmann::ordered_json& json) {
  const auto schema_json =
      nlohmann::json::parse(read_file(testing::source_folder() / "schemas/comparison.schema.json"));
  valijson::Schema schema;
  valijson::SchemaParser parser;
  parser.populateSchema(Adapter(schema_json), schema);
  const auto plain = nlohmann::json::parse(json.dump());
  valijson::Validator validator;
  return validator.validate(schema, Adapter(plain), nullptr);
}

TEST(ComparisonFiles, JsonFollowsItsSchema) {
  const nlohmann::ordered_json good = comparison_json(testing::sample_comparison(), source());
  EXPECT_TRUE(follows_schema(good));
  Comparison empty;
  empty.methods = {DescriptorMethod::kSurf};
  EXPECT_TRUE(follows_schema(comparison_json(empty, source())));

  nlohmann::ordered_json bad = good;
  bad["methods"][0].erase("correct_fix_rate_low");
  EXPECT_FALSE(follows_schema(bad));
  bad = good;
  bad["methods"][1]["method"] = "FREAK";
  EXPECT_FALSE(follows_schema(bad));
  bad = good;
  bad["frames"][0]["methods"][0]["inliers"] = -1;
  EXPECT_FALSE(follows_schema(bad));
  bad = good;
  bad["surprise"] = 1;
  EXPECT_FALSE(follows_schema(bad));
}

TEST(ComparisonFiles, JsonHoldsFramesAndOptions) {
  const nlohmann::ordered_json json = comparison_json(testing::sample_comparison(), source());
  EXPECT_EQ(json["seed"], 7);
  EXPECT_EQ(json["options"]["tolerance_m"], 5);
  EXPECT_EQ(json["methods"][0]["correct_fix_rate"], 0.5);
  EXPECT_TRUE(json["methods"][1]["false_of_accepted"].is_null());
  EXPECT_EQ(json["frames"][0]["methods"][0]["error_m"], 1.5);
  EXPECT_TRUE(json["frames"][0]["methods"][1]["error_m"].is_null());
  EXPECT_TRUE(json["frames"][0]["problem"].is_null());
  EXPECT_EQ(json["frames"][3]["problem"], "The frame shows no ground.");
}

TEST(ComparisonFiles, CsvHasALineForEachMethod) {
  const std::string csv = comparison_csv(testing::sample_comparison());
  EXPECT_THAT(csv, ::testing::StartsWith("method,detect_median_ms,detect_sum_ms,describe_median_ms,"));
  std::istringstream lines(csv);
  std::vector<std::string> rows;
  for (std::string line; std::getline(lines, line);) rows.push_back(line);
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_THAT(rows[1], ::testing::StartsWith("ORB,20,90,1,3,2,6,23,99,50,150,100,700,0.6,0.25,0.475,0.5,0.0125"));
  for (const std::string& row : rows) {
    EXPECT_EQ(std::count(row.begin(), row.end(), ','), std::count(rows[0].begin(), rows[0].end(), ','));
  }
  // SIFT has no accepted fix: the share is empty, its interval is not.
  EXPECT_THAT(rows[2], ::testing::EndsWith(",,0,1"));
}

TEST(ComparisonFiles, MarkdownHasTheTable) {
  const std::string page = comparison_markdown(testing::sample_comparison(), source(), {"x_ORB.png", "x_SIFT.png"});
  EXPECT_THAT(page, HasSubstr("4 frame(s): 2 show the reference around their prior"));
  EXPECT_THAT(page, HasSubstr("\n| ORB | 20.0 | 1.0 | 2.0 | 23.0 | 50.0 | 100 | 700 | 60.0 % | 25.0 % | 47.5 % |\n"));
  EXPECT_THAT(page, HasSubstr("\n| ORB | 50.0 % (1.3 … 98.7) | 25.0 % (0.6 … 80.6) | 50.0 % (1.3 … 98.7) |\n"));
  EXPECT_THAT(page, HasSubstr("\n| SIFT | 0.0 % (0.0 … 84.2) | 0.0 % (0.0 … 60.2) | – |\n"));
  EXPECT_THAT(page, HasSubstr("![The ten best matches of SIFT](<x_SIFT.png>)"));
  // Every row of a table has as many cells as its head.
  std::istringstream lines(page);
  std::ptrdiff_t bars = 0;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("|")) {
      bars = 0;
      continue;
    }
    const auto here = std::count(line.begin(), line.end(), '|');
    if (bars != 0) {
      EXPECT_EQ(here, bars) << line;
    }
    bars = here;
  }
}

TEST(ComparisonFiles, TheNameSaysWhatIsWritten) {
  const testing::TemporaryFolder folder;
  const Comparison comparison = testing::sample_comparison();
  EXPECT_EQ(write_comparison(folder / "a.b.csv", comparison, source(), false).size(), 1U);
  EXPECT_EQ(read_file(folder / "a.b.csv"), comparison_csv(comparison));
  const auto written = write_comparison(folder / "flight.2.md", comparison, source(), false);
  std::vector<std::string> names;
  for (const auto& file : written) names.push_back(file.filename().string());
  EXPECT_THAT(names, ::testing::ElementsAre("flight.2.md", "flight.2.csv", "flight.2.json", "flight.2_ORB.png",
                                            "flight.2_SIFT.png"));
  EXPECT_EQ(cv::imread(folder / "flight.2_SIFT.png").size(), cv::Size(60, 40));
  EXPECT_THAT(read_file(folder / "flight.2.md"), HasSubstr("(<flight.2_ORB.png>)"));
  EXPECT_THROW(write_comparison(folder / "table.txt", comparison, source(), false), UsageError);
}

TEST(ComparisonFiles, AllOrNothing) {
  const testing::TemporaryFolder folder;
  std::ofstream(folder / "x_SIFT.png") << "mine";
  EXPECT_THROW(check_comparison_output(folder / "x.md", source().options, false), DataError);
  EXPECT_THROW(write_comparison(folder / "x.md", testing::sample_comparison(), source(), false), DataError);
  const auto entries = [&] {
    return std::distance(std::filesystem::directory_iterator(folder.path()), std::filesystem::directory_iterator());
  };
  EXPECT_EQ(entries(), 1);
  EXPECT_EQ(read_file(folder / "x_SIFT.png"), "mine");
  check_comparison_output(folder / "x.md", source().options, true);
  EXPECT_EQ(entries(), 1);
  write_comparison(folder / "x.md", testing::sample_comparison(), source(), true);
  EXPECT_EQ(entries(), 5);
}

// Twelve frames of the ground and one of other ground; each method with its features, times and right ones of ten.
Comparison beside_the_paper() {
  Comparison comparison;
  comparison.methods = {DescriptorMethod::kSurf, DescriptorMethod::kSift, DescriptorMethod::kBrief512};
  for (int i = 0; i < 13; ++i) {
    FrameComparison frame{std::to_string(i) + ".jpg", "", i < 12, std::vector<MethodOutcome>(3)};
    const auto set = [&](std::size_t index, int features, double detect_ms, double match_ms, double reference_ms,
                         int best_agreeing) {
      MethodOutcome& outcome = frame.methods[index];
      outcome.frame_features = features;
      outcome.detect_ms = detect_ms;
      outcome.match_ms = match_ms;
      outcome.reference_ms = reference_ms;
      outcome.best = 10;
      outcome.best_agreeing = i < 12 ? best_agreeing : 0;
    };
    set(0, 100, 10, 1, 200, i % 2 == 0 ? 3 : 5);
    set(1, 1000, 200, 100, 900, 2);
    set(2, 1000, 5, 90, 40, 4);
    comparison.frames.push_back(frame);
  }
  return comparison;
}

TEST(ComparisonFiles, MarkdownHoldsEachPairBesideThePapers) {
  const std::string page = comparison_markdown(beside_the_paper(), source(), {});
  // SURF is quicker on the frame alone, because it finds a tenth of the features; with the reference it is not.
  EXPECT_THAT(page,
              HasSubstr("| BRIEF-512 (0.49 s) than SURF (1.55 s) | 13 of 13 frames: as the paper | 0 of 13 frames: "
                        "the other way round |\n"));
  EXPECT_THAT(page,
              HasSubstr("| SURF (1.55 s) than SIFT (2.44 s) | 13 of 13 frames: as the paper | 13 of 13 frames: as "
                        "the paper |\n"));
  EXPECT_THAT(page,
              HasSubstr("- SURF 100 features, 10.0 ms to find and describe, 1.0 ms to match; BRIEF-512 1000 features, "
                        "5.0 ms to find and describe, 90.0 ms to match.\n"));
  // The frame of other ground does not count here.
  EXPECT_THAT(page, HasSubstr("| SURF (10) than BRIEF-512 (9) | 6 of 12 frames: not told apart |\n"));
  EXPECT_THAT(page, HasSubstr("| SIFT (10) than BRIEF-512 (9) | 0 of 12 frames: the other way round |\n"));
  EXPECT_THAT(page, HasSubstr("Frames lie north up here"));
  ComparisonSource raw = source();
  raw.options.raw = true;
  EXPECT_THAT(comparison_markdown(beside_the_paper(), raw, {}), Not(HasSubstr("Frames lie north up here")));
}

TEST(ComparisonFiles, MarkdownSaysWherePairsDoNotDifferOrThePaperHasNone) {
  Comparison same = beside_the_paper();
  for (FrameComparison& frame : same.frames) frame.methods[2] = frame.methods[1];
  EXPECT_THAT(
      comparison_markdown(same, source(), {}),
      HasSubstr("| BRIEF-512 (0.49 s) than SIFT (2.44 s) | no frame in which they differ | no frame in which they "
                "differ |\n"));
  // The paper has these two equal.
  Comparison turned = beside_the_paper();
  turned.methods[2] = DescriptorMethod::kOrb;
  EXPECT_THAT(comparison_markdown(turned, source(), {}), Not(HasSubstr("more right of the best ten in the paper")));
  // Two lengths of one method, one method alone, and frames of other ground alone have nothing to be held against.
  Comparison lengths = beside_the_paper();
  lengths.methods = {DescriptorMethod::kBrief128, DescriptorMethod::kOrb, DescriptorMethod::kBrief512};
  EXPECT_THAT(comparison_markdown(lengths, source(), {}), Not(HasSubstr("Table I")));
  EXPECT_THAT(comparison_markdown(testing::sample_comparison(), source(), {}), Not(HasSubstr("Table I")));
  Comparison elsewhere = beside_the_paper();
  for (FrameComparison& frame : elsewhere.frames) frame.shows_reference = false;
  EXPECT_THAT(comparison_markdown(elsewhere, source(), {}), Not(HasSubstr("Table I")));
}

}  // namespace
}  // namespace pilotage
