#include "pilotage/base/json_object.h"

#include <cmath>
#include <functional>

#include "testing/error_of.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/options_json.h"

namespace pilotage {
namespace {

std::string json_error(const char* text, const std::function<void(JsonObject&)>& read) {
  const auto json = parse_json("plan.json", text);
  return testing::error_of<DataError>([&] {
    JsonObject object(json, "plan.json");
    read(object);
  });
}

TEST(JsonObject, ReadsWhatIsThere) {
  const auto json = parse_json("f", R"({"n": 2.5, "i": -7, "b": true, "t": "x", "ts": ["a", "b"], "ns": [1, 2],
                                        "o": {"k": 1}, "os": [{"k": 2}, {"k": 3}], "gap": null, "$schema": "s"})");
  JsonObject object(json, "f");
  EXPECT_EQ(object.number("n"), 2.5);
  EXPECT_EQ(object.integer("i"), -7);
  EXPECT_TRUE(object.boolean("b"));
  EXPECT_EQ(object.text("t"), "x");
  EXPECT_EQ(object.texts("ts"), (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(object.numbers("ns", 2), (std::vector<double>{1, 2}));
  EXPECT_EQ(object.object("o").integer("k"), 1);
  EXPECT_EQ(object.objects("os").at(1).integer("k"), 3);
  EXPECT_TRUE(std::isnan(object.number_or_nan("gap")));
  EXPECT_TRUE(std::isnan(object.number_or_nan("absent")));
  EXPECT_FALSE(object.has_value("gap"));
  EXPECT_FALSE(object.has_value("absent"));
  EXPECT_TRUE(object.has_value("n"));
  EXPECT_EQ(object.list("os").size(), 2U);
  EXPECT_NO_THROW(object.finish());
}

TEST(JsonObject, SaysWhereAndWhatIsWrong) {
  EXPECT_EQ(json_error("{}", [](JsonObject& o) { o.number("gsd_m"); }), "plan.json.gsd_m is missing");
  EXPECT_EQ(json_error(R"({"gsd_m": "1"})", [](JsonObject& o) { o.number("gsd_m"); }),
            "plan.json.gsd_m is \"1\", expected a number");
  EXPECT_EQ(json_error(R"({"n": 3.5})", [](JsonObject& o) { o.integer("n"); }),
            "plan.json.n is 3.5, expected an integer");
  EXPECT_EQ(json_error(R"({"n": 18446744073709551615})", [](JsonObject& o) { o.integer("n"); }),
            "plan.json.n is 18446744073709551615, expected an integer");
  EXPECT_EQ(json_error(R"({"n": 9})", [](JsonObject& o) { o.integer("n", 0, 8); }),
            "plan.json.n = 9 is outside [0, 8]");
  EXPECT_EQ(json_error(R"({"a": [{"k": 1}, {"k": "x"}]})",
                       [](JsonObject& o) {
                         for (JsonObject& element : o.objects("a")) element.integer("k");
                       }),
            "plan.json.a[1].k is \"x\", expected an integer");
  EXPECT_EQ(json_error(R"({"ns": [1]})", [](JsonObject& o) { o.numbers("ns", 2); }),
            "plan.json.ns is [1], expected a list of 2 numbers");
  EXPECT_EQ(json_error(R"({"known": 1, "unknown": 2})",
                       [](JsonObject& o) {
                         o.integer("known");
                         o.finish();
                       }),
            "plan.json.unknown is not known");
  EXPECT_EQ(json_error(R"({"gap_m": null})", [](JsonObject& o) { o.number("gap_m"); }),
            "plan.json.gap_m is null, expected a number");
  EXPECT_EQ(json_error(R"({"gsd_m": -0.5})", [](JsonObject& o) { o.positive_number("gsd_m"); }),
            "plan.json.gsd_m is -0.5, expected a number above 0");
  EXPECT_EQ(json_error(R"({"ns": [1, null, "x"]})", [](JsonObject& o) { o.numbers_or_nan("ns"); }),
            "plan.json.ns[2] is \"x\", expected a number");
  EXPECT_EQ(json_error(R"({"ts": ["a", 1]})", [](JsonObject& o) { o.texts("ts"); }),
            "plan.json.ts[1] is 1, expected a string");
  EXPECT_EQ(json_error(R"({"list": {}})", [](JsonObject& o) { o.list("list"); }),
            "plan.json.list is {}, expected a list");
  EXPECT_EQ(json_error(R"({"asked": null, "unknown": 2})",
                       [](JsonObject& o) {
                         o.has_value("asked");
                         o.finish();
                       }),
            "plan.json.unknown is not known");
  EXPECT_EQ(json_error("[]", [](JsonObject&) {}), "plan.json is [], expected an object");
}

TEST(JsonObject, IntegersAreNeverRoundedNorWrapped) {
  const auto integer = [](const std::string& text) {
    return json_error(("{\"n\": " + text + "}").c_str(), [](JsonObject& o) { o.small_integer("n", 0, 100); });
  };
  EXPECT_EQ(integer("3"), "");
  EXPECT_EQ(integer("3.0"), "") << "the same number in JSON";
  EXPECT_EQ(integer("3.7"), "plan.json.n is 3.7, expected an integer");
  EXPECT_EQ(integer("-1"), "plan.json.n = -1 is outside [0, 100]");
  EXPECT_EQ(integer("4294967299"), "plan.json.n = 4294967299 is outside [0, 100]") << "3 in 32 bits";
  EXPECT_EQ(integer("1e300"), "plan.json.n is 1e+300, expected an integer");
  EXPECT_EQ(integer("true"), "plan.json.n is true, expected an integer");
}

TEST(JsonObject, NullInAListOfNumbersIsNaN) {
  const auto json = parse_json("f", R"({"ns": [1, null]})");
  JsonObject object(json, "f");
  const std::vector<double> numbers = object.numbers_or_nan("ns");
  ASSERT_EQ(numbers.size(), 2U);
  EXPECT_EQ(numbers[0], 1);
  EXPECT_TRUE(std::isnan(numbers[1]));
}

TEST(JsonNumber, WhatIsNotFiniteIsNull) {
  EXPECT_EQ(json_number(1.5).dump(), "1.5");
  EXPECT_TRUE(json_number(std::nan("")).is_null());
  EXPECT_TRUE(json_number(INFINITY).is_null());
}

TEST(JsonText, StringsThatAreNoUtf8AreWrittenAsNames) {
  EXPECT_EQ(json_text({{"file", "caf\xC3\xA9\\xff"}}), "{\n \"file\": \"caf\xC3\xA9\\\\xff\"\n}\n");
  EXPECT_EQ(json_text({{"a\xFF", {"b\xFE", 1}}, {"c", "\\xfe"}}, -1),
            "{\"a\\\\xff\":[\"b\\\\xfe\",1],\"c\":\"\\\\xfe\"}\n");
}

}  // namespace
}  // namespace pilotage
