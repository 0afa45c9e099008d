#include "pilotage/report/page_text.h"

#include <stdexcept>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/random.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

TEST(PageText, AnyBytesBecomeJsonThatCanBeWritten) {
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

TEST(PageText, ScriptJsonCannotCloseItsElementAndParsesBack) {
  Json json;
  json["</script><!--"] = "</SCRIPT>\xE2\x80\xA8\xE2\x80\xA9]]>&";
  const std::string text = script_json(json);
  EXPECT_EQ(text.find_first_of("<>&"), std::string::npos);
  EXPECT_EQ(text.find("\xE2\x80"), std::string::npos);
  EXPECT_EQ(Json::parse(text), json);
}

TEST(PageText, Base64OfTheTestVectorsOfRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xFF\xFE\xFD"), "//79");
}

TEST(PageText, TemplateIsFilledOnceAndNamesMustExist) {
  EXPECT_EQ(fill_template("a {{x}} b {{y}}{{x}}", {{"x", "{{y}}"}, {"y", "2"}}), "a {{y}} b 2{{y}}");
  EXPECT_EQ(fill_template("plain }} text", {}), "plain }} text");
  EXPECT_THROW(fill_template("{{z}}", {{"x", "1"}}), std::logic_error);
  EXPECT_THROW(fill_template("{{x", {{"x", "1"}}), std::logic_error);
}

}  // namespace
}  // namespace pilotage
