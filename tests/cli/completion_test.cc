#include "completion.h"

#include "cli/toy_command.h"
#include "completion_model.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pilotage {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

const CompletionFlag& flag_of(const CompletionCommand& command, const std::string& name) {
  for (const CompletionFlag& flag : command.flags) {
    if (flag.flag == name) return flag;
  }
  throw std::runtime_error("no flag " + name);
}

TEST(CompletionModel, KnowsWhatEachFlagTakes) {
  const CompletionCommand toy = completion_model({make_toy_command()}).front();
  EXPECT_EQ(flag_of(toy, "size-px").value, ValueKind::kAny);
  EXPECT_EQ(flag_of(toy, "loud").value, ValueKind::kNone);
  EXPECT_EQ(flag_of(toy, "no-check").value, ValueKind::kNone) << "on by default";
  EXPECT_EQ(flag_of(toy, "fate").value, ValueKind::kChoice);
  EXPECT_EQ(flag_of(toy, "fates").value, ValueKind::kChoices);
  EXPECT_EQ(flag_of(toy, "fates").choices.size(), 10U);
  EXPECT_EQ(flag_of(toy, "imagery").value, ValueKind::kFile);
  EXPECT_TRUE(flag_of(toy, "imagery").repeated);
  EXPECT_EQ(flag_of(toy, "output").value, ValueKind::kFile);
  EXPECT_EQ(flag_of(toy, "output").letter, "o");
  EXPECT_EQ(flag_of(toy, "gdal-config").value, ValueKind::kAny);
  EXPECT_EQ(flag_of(toy, "help").value, ValueKind::kNone);
}

TEST(CompletionModel, OutputFoldersCommandWordsAndHelp) {
  Command folder = make_toy_command();
  folder.word = "folder";
  folder.output.kind = OutputKind::kFolder;
  folder.inputs.is_command = true;
  const auto model = completion_model({make_toy_command(), folder});
  ASSERT_EQ(model.size(), 3U);
  EXPECT_EQ(flag_of(model[1], "output").value, ValueKind::kFolder);
  EXPECT_THAT(model[1].input_choices, ElementsAre("toy", "folder"));
  EXPECT_EQ(model[2].word, "help");
  EXPECT_THAT(model[2].input_choices, ElementsAre("toy", "folder"));
}

Command awkward_command() {
  struct Awkward {
    std::string name;
    static void describe(Awkward& self, options_detail::FieldCollector& fields) {
      fields.field("name", self.name, "It's [odd]: a\\b.");
    }
  };
  Command command = make_toy_command();
  command.summary = "One's own: a summary";
  bind_options<Awkward>(command, [](const Awkward&, const Invocation&) { return CommandResult{}; });
  return command;
}

TEST(Completion, TextIsQuotedAsEachShellWantsIt) {
  const std::string zsh = zsh_completion({awkward_command()});
  EXPECT_THAT(zsh, HasSubstr(R"('toy:One'\''s own\: a summary')"));
  EXPECT_THAT(zsh, HasSubstr(R"('--name=[It'\''s \[odd\]: a\\b.]:TEXT: ')"));
  const std::string fish = fish_completion({awkward_command()});
  EXPECT_THAT(fish, HasSubstr(R"(-d 'One\'s own: a summary')"));
  EXPECT_THAT(fish, HasSubstr(R"(-l name -x -d 'It\'s [odd]: a\\b.')"));
}

TEST(Completion, BashHasEveryFlagAndTheValuesOfNames) {
  const std::string script = bash_completion({make_toy_command()});
  for (const CompletionFlag& flag : completion_model({make_toy_command()}).front().flags) {
    EXPECT_THAT(script, HasSubstr(" --" + flag.flag)) << flag.flag;
  }
  EXPECT_THAT(script, HasSubstr("'toy --fates') _pilotage_list done gate"));
  EXPECT_THAT(script, HasSubstr("'toy --output' | 'toy -o') _pilotage_paths -f ;;"));
  EXPECT_THAT(script, Not(HasSubstr("'toy --loud')"))) << "takes no value";
}

}  // namespace
}  // namespace pilotage
