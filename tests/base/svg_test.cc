#include "pilotage/base/svg.h"

#include <gtest/gtest.h>

namespace pilotage {
namespace {

TEST(SvgWriter, RoundsCoordinatesToItsDecimals) {
  EXPECT_EQ(SvgWriter{.decimals = 1}.number(1.26), "1.3");
  EXPECT_EQ(SvgWriter{.decimals = 2}.number(1.256), "1.26");
  EXPECT_EQ(SvgWriter{.decimals = 2}.number(3), "3");
}

TEST(SvgWriter, WritesElementsWithEscapedTexts) {
  const SvgWriter svg{.decimals = 1};
  EXPECT_EQ(svg.line("grid", 1, 2, 3.04, 4), "<line class=\"grid\" x1=\"1\" y1=\"2\" x2=\"3\" y2=\"4\"/>\n");
  EXPECT_EQ(svg.text("small", 1, 2, "a < b"), "<text class=\"small\" x=\"1\" y=\"2\">a &lt; b</text>\n");
  EXPECT_EQ(svg.text("small", 1, 2, "up", " transform=\"rotate(-90)\""),
            "<text class=\"small\" x=\"1\" y=\"2\" transform=\"rotate(-90)\">up</text>\n");
  EXPECT_EQ(svg.rect("bar", 1, 2, 3, 4), "<rect class=\"bar\" x=\"1\" y=\"2\" width=\"3\" height=\"4\"></rect>\n");
  EXPECT_EQ(svg.rect("bar", 1, 2, 3, 4, "A & B"),
            "<rect class=\"bar\" x=\"1\" y=\"2\" width=\"3\" height=\"4\"><title>A &amp; B</title></rect>\n");
}

}  // namespace
}  // namespace pilotage
