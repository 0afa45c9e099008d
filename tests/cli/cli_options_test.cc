#include "cli_options.h"

#include "cli/toy_command.h"
#include "testing/error_of.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pilotage {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

ToyOptions parsed(const std::vector<std::string>& arguments, std::vector<std::string>* inputs = nullptr) {
  ToyOptions options;
  const OptionList list = list_options(options);
  const ParsedLine line = parse_line({&list}, arguments);
  apply_flags(list, line);
  if (inputs != nullptr) *inputs = line.inputs;
  return options;
}

std::string options_error(const std::vector<std::string>& arguments) {
  return testing::error_of<UsageError>([&] { parsed(arguments); });
}

TEST(CliOptions, NothingGivenLeavesDefaults) {
  std::vector<std::string> inputs{"x"};
  const ToyOptions options = parsed({}, &inputs);
  EXPECT_EQ(options.size_px, 256);
  EXPECT_TRUE(options.check);
  EXPECT_EQ(options.speed_mps, std::nullopt);
  EXPECT_THAT(inputs, IsEmpty());
}

TEST(CliOptions, BothWaysToGiveAValue) {
  EXPECT_EQ(parsed({"--size-px", "64"}).size_px, 64);
  EXPECT_EQ(parsed({"--size-px=64"}).size_px, 64);
  EXPECT_EQ(parsed({"--camera-hfov-deg", "73.7"}).camera.hfov_deg, 73.7);
  EXPECT_EQ(parsed({"--speed-mps", "18"}).speed_mps, 18.0);
  EXPECT_EQ(parsed({"--fate", "gate"}).fate, Fate::kGate);
  EXPECT_EQ(parsed({"--name", "", "--size-px", "32"}).name, "");
}

TEST(CliOptions, NegativeNumbersAreValues) {
  EXPECT_EQ(parsed({"--offset-m", "-3.5"}).offset_m, -3.5);
  EXPECT_EQ(parsed({"--offset-m", "-.5"}).offset_m, -0.5);
  EXPECT_EQ(parsed({"--offset-m=-1e-3"}).offset_m, -1e-3);
  EXPECT_THAT(parsed({"--steps", "-1,0.5"}).steps, ElementsAre(-1, 0.5));
}

TEST(CliOptions, BooleansHaveThreeForms) {
  EXPECT_TRUE(parsed({"--loud"}).loud);
  EXPECT_FALSE(parsed({"--no-check"}).check);
  EXPECT_FALSE(parsed({"--check=false"}).check);
  EXPECT_TRUE(parsed({"--loud=true"}).loud);
  EXPECT_FALSE(parsed({"--loud", "--no-loud"}).loud);
  std::vector<std::string> inputs;
  EXPECT_TRUE(parsed({"--loud", "false.tif"}, &inputs).loud);
  EXPECT_THAT(inputs, ElementsAre("false.tif"));
}

TEST(CliOptions, ListsAreCommaSeparatedOrRepeated) {
  EXPECT_THAT(parsed({"--fates", "gate,done", "--fates=data"}).fates,
              ElementsAre(Fate::kGate, Fate::kDone, Fate::kDataError));
  std::vector<std::string> inputs;
  EXPECT_THAT(parsed({"--steps", "0,1", "a.tif", "b.tif"}, &inputs).steps, ElementsAre(0, 1));
  EXPECT_THAT(inputs, ElementsAre("a.tif", "b.tif"));
}

TEST(CliOptions, PathsMayHoldCommas) {
  const std::string wms = "WMS:http://example.org/?BBOX=1,2,3,4";
  EXPECT_THAT(parsed({"--imagery", wms, "--imagery", "b.tif"}).imagery, ElementsAre(wms, "b.tif"));
}

TEST(CliOptions, InputsMayStandAnywhereAndLookLikeFlags) {
  std::vector<std::string> inputs;
  parsed({"a.tif", "--loud", "b.tif", "--", "--size-px", "-x"}, &inputs);
  EXPECT_THAT(inputs, ElementsAre("a.tif", "b.tif", "--size-px", "-x"));
}

TEST(CliOptions, ErrorsNameTheFlagAsTyped) {
  EXPECT_EQ(options_error({"--size-px", "3"}), "--size-px = 3 is outside [16, 4096]");
  EXPECT_EQ(options_error({"--camera-hfov-deg=180"}), "--camera-hfov-deg = 180 is outside [1, 179]");
  EXPECT_EQ(options_error({"--size-px", "3.7"}), "--size-px = \"3.7\" is not an integer");
  EXPECT_EQ(options_error({"--size-px", "32", "--size-px", "64"}), "--size-px takes one value, 2 given");
  EXPECT_EQ(options_error({"--loud=maybe"}), "--loud = \"maybe\" is not true or false");
  EXPECT_EQ(
      options_error({"--fate", "gat"}),
      "--fate = \"gat\" is not one of: done, gate, data, usage, integrity, memory, other, stopped, endless, deaf; "
      "did you mean \"gate\"?");
  EXPECT_EQ(options_error({"--steps", "0,,1"}), "--steps = \"\" is not a number");
  EXPECT_EQ(options_error({"--offset-m", "nan"}), "--offset-m = nan is not a finite number");
  EXPECT_EQ(options_error({"--size-px", "99999999999999999999"}),
            "--size-px = \"99999999999999999999\" is not an integer");
}

TEST(CliOptions, WrongGrammarIsOurError) {
  EXPECT_EQ(options_error({"--sise-px", "64"}), "unknown option --sise-px; did you mean --size-px?");
  EXPECT_EQ(options_error({"--sise-px=64"}), "unknown option --sise-px; did you mean --size-px?");
  EXPECT_EQ(options_error({"-z"}), "unknown option -z; --help lists them");
  EXPECT_EQ(options_error({"--size-px=", "64"}), "--size-px= gives no value; an empty one is written --size-px ''");
  EXPECT_EQ(options_error({"--size-px"}), "--size-px needs a value");
  EXPECT_EQ(options_error({"--imagery"}), "--imagery needs a value");
}

}  // namespace
}  // namespace pilotage
