#include "pilotage/base/markup.h"

#include <gtest/gtest.h>

namespace pilotage {
namespace {

TEST(HtmlEscape, EscapesMarkupAndControlCharacters) {
  EXPECT_EQ(html_escape("<a href=\"x\" b='y'>&"), "&lt;a href=&quot;x&quot; b=&#39;y&#39;&gt;&amp;");
  EXPECT_EQ(html_escape(std::string_view("a\0b\x1b", 4)),
            "a\xEF\xBF\xBD"
            "b\xEF\xBF\xBD");
  EXPECT_EQ(html_escape("tab\tline\n"), "tab\tline\n");
}

}  // namespace
}  // namespace pilotage
