#include "pilotage/base/safe_text.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "pilotage/base/random.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

TEST(SafeText, Utf8PassesAndBadBytesBecomeTheReplacement) {
  const std::string good = "Feld \xC3\xBC \xE2\x82\xAC \xF0\x9F\x8C\x8D";
  EXPECT_EQ(valid_utf8(good), good);
  EXPECT_EQ(valid_utf8("a\xFF"
                       "b"),
            "a\xEF\xBF\xBD"
            "b");
  EXPECT_EQ(valid_utf8("\xC3"), "\xEF\xBF\xBD");                                  // cut off
  EXPECT_EQ(valid_utf8("\xC0\xAF"), "\xEF\xBF\xBD\xEF\xBF\xBD");                  // overlong
  EXPECT_EQ(valid_utf8("\xED\xA0\x80"), "\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD");  // surrogate
  EXPECT_EQ(valid_utf8("\xF4\x90\x80\x80").substr(0, 3), "\xEF\xBF\xBD");         // beyond U+10FFFF
}

TEST(SafeText, AnyBytesBecomeJsonThatCanBeWritten) {
  Random random(seed_from_name("AnyBytesBecomeJsonThatCanBeWritten"));
  for (int round = 0; round < 300; ++round) {
    std::string bytes;
    for (int i = 0; i < 40; ++i) bytes += static_cast<char>(random.below(256));
    Json json;
    json[bytes] = Json::array({bytes});
    const Json clean = valid_utf8_json(json);
    EXPECT_EQ(Json::parse(clean.dump()), clean);
  }
}

TEST(SafeText, HtmlEscapesMarkupAndControlCharacters) {
  EXPECT_EQ(html_escape("<a href=\"x\" b='y'>&"), "&lt;a href=&quot;x&quot; b=&#39;y&#39;&gt;&amp;");
  EXPECT_EQ(html_escape(std::string_view("a\0b\x1b", 4)),
            "a\xEF\xBF\xBD"
            "b\xEF\xBF\xBD");
  EXPECT_EQ(html_escape("tab\tline\n"), "tab\tline\n");
}

TEST(SafeText, ScriptJsonCannotCloseItsElementAndParsesBack) {
  Json json;
  json["</script><!--"] = "</SCRIPT>\xE2\x80\xA8\xE2\x80\xA9]]>&";
  const std::string text = script_json(json);
  EXPECT_EQ(text.find_first_of("<>&"), std::string::npos);
  EXPECT_EQ(text.find("\xE2\x80"), std::string::npos);
  EXPECT_EQ(Json::parse(text), json);
}

TEST(SafeText, Base64OfTheTestVectorsOfRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xFF\xFE\xFD"), "//79");
}

TEST(SafeText, TemplateIsFilledOnceAndNamesMustExist) {
  EXPECT_EQ(fill_template("a {{x}} b {{y}}{{x}}", {{"x", "{{y}}"}, {"y", "2"}}), "a {{y}} b 2{{y}}");
  EXPECT_EQ(fill_template("plain }} text", {}), "plain }} text");
  EXPECT_THROW(fill_template("{{z}}", {{"x", "1"}}), std::logic_error);
  EXPECT_THROW(fill_template("{{x", {{"x", "1"}}), std::logic_error);
}

}  // namespace
}  // namespace pilotage
