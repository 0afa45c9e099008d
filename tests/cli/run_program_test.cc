#include "run_program.h"

#include <sstream>

#include "cli/toy_command.h"
#include "testing/json_schema.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/output_file.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

struct Outcome {
  int exit_code = 0;
  std::string out;
  std::string err;
};

Outcome run(const std::vector<std::string>& arguments) {
  std::ostringstream out;
  std::ostringstream err;
  Outcome outcome;
  outcome.exit_code = run_program({make_toy_command()}, arguments, out, err);
  outcome.out = out.str();
  outcome.err = err.str();
  return outcome;
}

TEST(RunProgram, ResultsGoToStdoutWarningsToStderr) {
  const Outcome outcome = run({"toy", "a.tif", "--size-px", "64"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.out, "size 64\n");
  EXPECT_EQ(outcome.err, "pilotage toy: warning: small\n");
  EXPECT_EQ(run({"toy", "a.tif", "-q"}).err, "");
}

TEST(RunProgram, JsonIsOneDocumentWithTheWarnings) {
  const auto json = nlohmann::json::parse(run({"toy", "a.tif", "b.tif", "--json", "--threads", "3", "--seed=9"}).out);
  EXPECT_EQ(json["inputs"], (std::vector<std::string>{"a.tif", "b.tif"}));
  EXPECT_EQ(json["threads"], 3);
  EXPECT_EQ(json["seed"], 9);
  EXPECT_EQ(json["warnings"], std::vector<std::string>{"small"});
}

TEST(RunProgram, ExitCodesTellWhatHappened) {
  const std::pair<const char*, int> expected[] = {{"done", 0},      {"gate", 3},   {"data", 1},  {"usage", 2},
                                                  {"integrity", 4}, {"memory", 1}, {"other", 1}, {"stopped", 130}};
  for (const auto& [fate, exit_code] : expected) {
    EXPECT_EQ(run({"toy", "a.tif", "--fate", fate}).exit_code, exit_code) << fate;
  }
}

TEST(RunProgram, AnErrorIsOneLine) {
  const Outcome outcome = run({"toy", "a.tif", "--fate", "data"});
  EXPECT_EQ(outcome.err, "pilotage toy: a.tif: is broken\n");
  EXPECT_EQ(outcome.out, "");
}

TEST(RunProgram, ErrorsAreJsonToo) {
  const auto json = nlohmann::json::parse(run({"toy", "a.tif", "--fate", "integrity", "--json"}).out);
  EXPECT_EQ(json["error"]["kind"], "integrity");
  EXPECT_EQ(json["error"]["exit_code"], 4);
  EXPECT_EQ(json["error"]["message"], "map.gpkg: wrong digest");
  EXPECT_EQ(nlohmann::json::parse(run({"toy", "--json", "--wrong"}).out)["error"]["kind"], "usage");
  for (const char* fate : {"data", "usage", "integrity", "memory", "other", "stopped"}) {
    const auto error = nlohmann::ordered_json::parse(run({"toy", "a.tif", "--json", "--fate", fate}).out);
    EXPECT_EQ(testing::schema_violation("results/error.json", error), "") << fate;
  }
}

TEST(RunProgram, UnknownCommandsSuggestTheNearest) {
  const Outcome outcome = run({"toyy"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.err, "pilotage: unknown command \"toyy\"; did you mean \"toy\"?\n");
  EXPECT_EQ(run({"--versoin"}).err, "pilotage: unknown option --versoin; did you mean \"--version\"?\n");
  EXPECT_EQ(run({"--wrong"}).err, "pilotage: unknown option --wrong; pilotage --help lists them\n");
}

TEST(RunProgram, NoArgumentsIsAUsageErrorWithTheOverview) {
  const Outcome outcome = run({});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err, run({"--help"}).out);
}

TEST(RunProgram, HelpNeedsNoInputs) {
  EXPECT_EQ(run({"toy", "--help"}).exit_code, 0);
  EXPECT_EQ(run({"toy", "--help"}).out, run({"help", "toy"}).out);
  EXPECT_THAT(run({"toy", "-h", "--size-px", "nonsense"}).out, StartsWith("Usage: pilotage toy"));
  EXPECT_THAT(run({"--version"}).out, StartsWith("pilotage "));
}

TEST(RunProgram, CountsInputs) {
  EXPECT_EQ(run({"toy"}).err, "pilotage toy: RASTER is missing: The imagery.\n");
  EXPECT_EQ(run({"toy", "a", "b", "c"}).err,
            "pilotage toy: unexpected argument \"c\"; usage: pilotage toy [OPTIONS] RASTER... [-o OUTPUT]\n");
  EXPECT_EQ(run({"toy", ""}).err, "pilotage toy: RASTER is empty: The imagery.\n");
  EXPECT_EQ(run({"toy", "a", "b", "c"}).exit_code, 2);
}

TEST(RunProgram, DefaultsThenConfigThenCommandLine) {
  const testing::TemporaryFolder folder;
  write_file(folder / "c.json", R"({"size_px": 100, "offset_m": 5, "fates": ["gate"]})", false);
  const auto json = nlohmann::json::parse(
      run({"toy", "--config", (folder / "c.json").string(), "--size-px", "64", "--print-config"}).out);
  EXPECT_EQ(json["size_px"], 64);
  EXPECT_EQ(json["offset_m"], 5.0);
  EXPECT_EQ(json["fates"], std::vector<std::string>{"gate"});
  EXPECT_EQ(json["camera"]["hfov_deg"], 60.0);
}

TEST(RunProgram, PrintedConfigReadsBackTheSame) {
  const testing::TemporaryFolder folder;
  const std::string printed = run({"toy", "--size-px", "64", "--imagery", "a,b.tif", "--print-config"}).out;
  write_file(folder / "c.json", printed, false);
  EXPECT_EQ(run({"toy", "--config", (folder / "c.json").string(), "--print-config"}).out, printed);
}

TEST(RunProgram, SchemaTellsDefaultsNotTheCommandLine) {
  const auto schema = nlohmann::json::parse(run({"toy", "--size-px", "64", "--print-schema"}).out);
  EXPECT_EQ(schema["title"], "pilotage toy");
  EXPECT_EQ(schema["properties"]["size_px"]["default"], 256);
}

TEST(RunProgram, AConfigFileMayBeTheInput) {
  const testing::TemporaryFolder folder;
  write_file(folder / "mission.json", R"({"size_px": 100})", false);
  Command command = make_toy_command();
  command.inputs = {.name = "MISSION", .help = "A mission.", .min = 0, .max = 1, .is_config = true};
  std::ostringstream out;
  std::ostringstream err;
  EXPECT_EQ(run_program({command}, {"toy", (folder / "mission.json").string()}, out, err), 0) << err.str();
  EXPECT_EQ(out.str(), "size 100\n");
  EXPECT_EQ(run_program({command}, {"toy", "a.json", "--config", "b.json"}, out, err), 2);
}

TEST(RunProgram, RefusesOutputsBeforeWork) {
  const testing::TemporaryFolder folder;
  const std::string there = (folder / "there").string();
  write_file(there, "precious", false);
  EXPECT_THAT(run({"toy", "a.tif", "-o", there}).err, HasSubstr("exists already; give --overwrite"));
  EXPECT_EQ(run({"toy", "a.tif", "-o", there}).exit_code, 1);
  EXPECT_EQ(run({"toy", "a.tif", "-o", there, "--overwrite"}).exit_code, 0);
  EXPECT_EQ(run({"toy", there, "-o", there, "--overwrite"}).exit_code, 2) << "the output is the input";
  EXPECT_EQ(run({"toy", "a.tif", "-o", folder.path().string(), "--overwrite"}).exit_code, 1) << "a folder";
}

TEST(RunProgram, GdalConfigIsChecked) {
  EXPECT_EQ(run({"toy", "a.tif", "--gdal-config", "NOVALUE"}).exit_code, 2);
  EXPECT_EQ(run({"toy", "a.tif", "--gdal-config", "CPL_DEBUG=OFF"}).exit_code, 0);
}

TEST(RunProgram, ProgressAsJsonLines) {
  const std::string lines = run({"toy", "a.tif", "--progress", "json"}).err;
  EXPECT_THAT(lines, StartsWith(R"({"what":"running toy","done":0,"total":0)"));
  EXPECT_THAT(lines, HasSubstr(R"({"what":"toying","done":1,"total":1)"));
  EXPECT_EQ(run({"toy", "a.tif", "--progress", "json", "-q"}).err, "");
}

TEST(RunProgram, AFullStandardOutputIsAnError) {
  std::ostringstream err;
  std::ostream broken(nullptr);
  EXPECT_EQ(run_program({make_toy_command()}, {"toy", "a.tif"}, broken, err), 1);
  EXPECT_THAT(err.str(), HasSubstr("standard output cannot be written"));
}

}  // namespace
}  // namespace pilotage
