#include "manual.h"

#include "cli/toy_command.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

TEST(Manual, ACommandsPageHasAllItsParts) {
  const ManualPage page = manual_of_command(make_toy_command(), "pilotage 1.2.3");
  EXPECT_EQ(page.file, "pilotage-toy.1");
  EXPECT_THAT(page.text, StartsWith(".TH \"PILOTAGE\\-TOY\" 1 \"\" \"pilotage 1.2.3\""));
  EXPECT_THAT(page.text, HasSubstr("pilotage\\-toy \\- Does nothing in every possible way\n"));
  EXPECT_THAT(page.text, HasSubstr("pilotage toy [OPTIONS] RASTER... [\\-o OUTPUT]\n"));
  EXPECT_THAT(
      page.text,
      HasSubstr(".SH DESCRIPTION\nDoes nothing in every possible way.\n.PP\n.B \\-o\n.IR OUTPUT :\nThe toy.\n"));
  EXPECT_THAT(page.text, HasSubstr("pilotage toy a.tif \\-o b.tif\n"));
  EXPECT_THAT(page.text,
              HasSubstr(".BI \"\\-\\-size\\-px\" \" INTEGER\"\nSide of a tile.\n[pixels; 16 to 4096; default 256]"));
  EXPECT_THAT(page.text, HasSubstr(".SS \"How the aircraft sees the ground\"\n.TP\n.BI \"\\-\\-camera\\-hfov\\-deg\""));
  EXPECT_THAT(page.text, HasSubstr(".BI \"\\-o, \\-\\-output\" \" PATH\"\nThe toy.\n"));
  EXPECT_THAT(page.text, HasSubstr(".B 130\nInterrupted"));
}

TEST(Manual, TextIsNeverTakenForARequest) {
  Command command = make_toy_command();
  command.inputs.help = ".de is a request, 'x too, and \\fB a font.";
  command.examples = {{"'Quoted'.", ".hidden \\ \"two\""}};
  const std::string page = manual_of_command(command, "").text;
  EXPECT_THAT(page, HasSubstr("\n\\&.de is a request, 'x too, and \\efB a font.\n"));
  EXPECT_THAT(page, HasSubstr("\n\\&'Quoted'.\n"));
  EXPECT_THAT(page, HasSubstr("\n\\&.hidden \\e \"two\"\n"));
}

TEST(Manual, TheProgramsPageListsCommandsByGroup) {
  Command look = make_toy_command();
  look.word = "look";
  look.group = CommandGroup::kInspect;
  const ManualPage page = manual_of_program({look, make_toy_command()}, "");
  EXPECT_EQ(page.file, "pilotage.1");
  EXPECT_LT(page.text.find(".SS \"Stage by stage\"\n.TP\n.BR pilotage\\-toy (1)"),
            page.text.find(".SS \"Look at files and flights\"\n.TP\n.BR pilotage\\-look (1)"));
  EXPECT_THAT(page.text, HasSubstr(".B NO_COLOR\n"));
  EXPECT_THAT(page.text, Not(HasSubstr("Set up"))) << "a group without commands";
}

TEST(Manual, TablesAreMarkdown) {
  const std::string tables = option_tables(make_toy_command());
  EXPECT_THAT(tables, StartsWith("| option | meaning | unit, range, default |\n|---|---|---|\n| `--size-px INTEGER` | "
                                 "Side of a tile. | pixels; 16 to 4096; default 256 |\n"));
  EXPECT_THAT(tables, HasSubstr("| `--fate NAME` | How it ends. | done \\| gate \\| "));
  EXPECT_THAT(tables, HasSubstr("\n**How the aircraft sees the ground**\n\n| option |"));
  EXPECT_THAT(tables, Not(HasSubstr("--output"))) << "common options stand in docs/conventions.md";
}

}  // namespace
}  // namespace pilotage
