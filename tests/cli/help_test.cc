#include "help.h"

#include <array>
#include <sstream>
#include <string>

#include "cli/toy_command.h"
#include "common_options.h"
#include "option_text.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string toy_help() {
  const Command command = make_toy_command();
  CommonOptions common;
  return command_help(command, common_fields_for(command, common), false);
}

TEST(Help, TellsRangeUnitDefaultAndChoices) {
  std::string flat = toy_help();
  flat.erase(std::remove(flat.begin(), flat.end(), '\n'), flat.end());
  std::istringstream stream(flat);
  std::string text;
  for (std::string word; stream >> word;) text += word + " ";
  EXPECT_THAT(text, HasSubstr("--size-px INTEGER Side of a tile. [pixels; 16 to 4096; default 256]"));
  EXPECT_THAT(text, HasSubstr("--speed-mps NUMBER Speed over ground. [m/s; 0 to 400]"));
  EXPECT_THAT(text, HasSubstr("--fate NAME How it ends. [done | gate | data"));
  EXPECT_THAT(text, HasSubstr("--no-check Do not look twice."));
  EXPECT_THAT(text, HasSubstr("--imagery PATH Rasters. [may be repeated]"));
  EXPECT_THAT(text, HasSubstr("How the aircraft sees the ground: --camera-hfov-deg NUMBER"));
  EXPECT_THAT(text, HasSubstr("Usage: pilotage toy [OPTIONS] RASTER... [-o OUTPUT]"));
  EXPECT_THAT(text, HasSubstr("-o, --output PATH The toy."));
  EXPECT_THAT(text, HasSubstr("pilotage toy a.tif -o b.tif"));
}

/// Many options, most of them in a group.
struct ManyOptions {
  double first = 0;
  struct Group {
    std::array<double, kManyOptions + 1> numbers{};
    template <class Self, class Fields>
    static void describe(Self& self, Fields& fields) {
      for (std::size_t i = 0; i < self.numbers.size(); ++i) {
        fields.field("number_" + std::to_string(i), self.numbers[i], "One of many.");
      }
    }
  } group;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("first", self.first, "Stands alone.");
    fields.group("group", self.group, "Things that few need.");
  }
};

TEST(Help, GroupsOfManyOptionsAreNamedUntilAllIsAskedFor) {
  Command command = make_toy_command();
  bind_options<ManyOptions>(command, [](const ManyOptions&, const Invocation&) { return CommandResult{}; });
  CommonOptions common;
  const OptionList fields = common_fields_for(command, common);
  const std::string brief = command_help(command, fields, false);
  EXPECT_THAT(brief, HasSubstr("Stands alone."));
  EXPECT_THAT(brief, HasSubstr("`pilotage toy --help all`"));
  EXPECT_THAT(brief, HasSubstr("--group-number-* (41)       Things that few need."));
  EXPECT_THAT(brief, Not(HasSubstr("One of many.")));
  const std::string all = command_help(command, fields, true);
  EXPECT_THAT(all, HasSubstr("--group-number-40 NUMBER"));
  EXPECT_THAT(all, Not(HasSubstr("--help all`:")));
}

TEST(Help, LinesFitEightyColumns) {
  std::istringstream lines(toy_help());
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80U) << line;
}

TEST(Help, NamesEveryFlagOnce) {
  const Command command = make_toy_command();
  CommonOptions common;
  const OptionList fields = common_fields_for(command, common);
  const std::string text = toy_help();
  for (const OptionField& field : fields.fields) EXPECT_THAT(text, HasSubstr("--" + field.flag));
  for (const OptionField& field : command.options.fields) EXPECT_THAT(text, HasSubstr(field.flag));
}

TEST(Help, WithoutOutputThereAreNoOutputFlags) {
  Command command = make_toy_command();
  command.output = {};
  CommonOptions common;
  const std::string text = command_help(command, common_fields_for(command, common), false);
  EXPECT_THAT(text, Not(HasSubstr("--output")));
  EXPECT_THAT(text, Not(HasSubstr("--overwrite")));
}

TEST(Help, ACommandsOwnFlagReplacesTheCommonOne) {
  struct Seeded {
    int seed = 7;
    static void describe(Seeded& self, options_detail::FieldCollector& fields) {
      fields.field("seed", self.seed, "Mine.");
    }
  };
  Command command = make_toy_command();
  bind_options<Seeded>(command, [](const Seeded&, const Invocation&) { return CommandResult{}; });
  CommonOptions common;
  const OptionList fields = common_fields_for(command, common);
  EXPECT_EQ(fields.find("seed"), nullptr);
  EXPECT_NE(fields.find("threads"), nullptr);
}

TEST(Help, OverviewGroupsByTheWayOfTheData) {
  Command look = make_toy_command();
  look.word = "look";
  look.group = CommandGroup::kInspect;
  const std::string text = overview_help({look, make_toy_command()});
  EXPECT_LT(text.find("Stage by stage:\n  toy "), text.find("Look at files and flights:\n  look "));
}

TEST(Help, WrapCountsCharactersNotBytes) {
  EXPECT_EQ(wrap_text("één twéé drie", 2, 10), "  één twéé\n  drie\n");
  EXPECT_EQ(wrap_text("unbreakable-word", 2, 8), "  unbreakable-word\n");
}

TEST(Help, BrokenCommandLinesCanStillBePasted) {
  EXPECT_EQ(wrap_command("pilotage toy a.tif", 2, 40), "  pilotage toy a.tif\n");
  EXPECT_EQ(wrap_command("pilotage toy a.tif --size-px 64 --loud -o b.tif", 2, 32),
            "  pilotage toy a.tif \\\n      --size-px 64 --loud \\\n      -o b.tif\n");
}

TEST(Help, NumbersAreWrittenOut) {
  struct Wide {
    double size_m = 1;
    static void describe(Wide& self, options_detail::FieldCollector& fields) {
      fields.field("size_m", self.size_m, "Size.", Range{1e-4, 1e5});
    }
  };
  Wide wide;
  EXPECT_EQ(describe_option(list_options(wide).fields.front()).limits,
            (std::vector<std::string>{"m", "0.0001 to 100000", "default 1"}));
}

TEST(Help, AListThatHasAllNamesSaysSo) {
  struct Everything {
    std::vector<Fate> fates{Fate::kDone,     Fate::kGate,  Fate::kDataError, Fate::kUsageError, Fate::kIntegrityError,
                            Fate::kNoMemory, Fate::kOther, Fate::kStopped,   Fate::kEndless,    Fate::kDeaf};
    static void describe(Everything& self, options_detail::FieldCollector& fields) {
      fields.field("fates", self.fates, "All.");
    }
  };
  Everything everything;
  EXPECT_EQ(describe_option(list_options(everything).fields.front()).limits.back(), "default all");
}

}  // namespace
}  // namespace pilotage
