#include "pilotage/base/options.h"

#include "testing/error_of.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/options_json.h"

namespace pilotage {
namespace {

enum class Colour { kRed, kBlue };
EnumNames<Colour> enum_names(Colour) {
  return {{Colour::kRed, "red"}, {Colour::kBlue, "blue"}};
}

struct Inner {
  double angle_deg = 10;
  std::optional<int> width_px;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("angle_deg", self.angle_deg, "An angle.", Range{0, 90});
    fields.field("width_px", self.width_px, "A width.", Range{1, 100});
  }
};

struct Outer {
  int count = 3;
  unsigned limit = 7;
  bool loud = false;
  Colour colour = Colour::kRed;
  std::vector<Colour> palette{Colour::kRed};
  std::vector<double> steps;
  Inner inner;
  Inner plain;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("count", self.count, "How many.", Range{0, 10});
    fields.field("limit", self.limit, "At most.");
    fields.field("loud", self.loud, "Say more.");
    fields.field("colour", self.colour, "Which.");
    fields.field("palette", self.palette, "Which ones.");
    fields.field("steps", self.steps, "Where.", Range{0, 1});
    fields.group("inner", self.inner, "Nested.");
    fields.group("plain", self.plain, "Nested, flags without a prefix.", FlagPrefix::kNone);
  }
};

std::string options_error(const char* json) {
  Outer outer;
  return testing::error_of<std::exception>(
      [&] { set_options_from_json(list_options(outer), parse_json("m.json", json), "m.json"); });
}

TEST(Options, FlagsAndPathsFollowTheDescription) {
  Outer outer;
  const OptionList list = list_options(outer);
  EXPECT_EQ(list.find("inner.angle_deg")->flag, "inner-angle-deg");
  EXPECT_EQ(list.find("plain.angle_deg")->flag, "angle-deg");
  EXPECT_EQ(list.find("nothing"), nullptr);
}

TEST(Options, JsonWritesThrough) {
  Outer outer;
  const OptionList list = list_options(outer);
  set_options_from_json(
      list, parse_json("m.json", R"({"$schema": "x", "count": 10, "colour": "blue", "palette": ["blue","red"],
      "steps": [0, 0.5], "inner": {"angle_deg": 45, "width_px": 7}})"),
      "m.json");
  EXPECT_EQ(outer.count, 10);
  EXPECT_EQ(outer.colour, Colour::kBlue);
  EXPECT_EQ(outer.palette, (std::vector{Colour::kBlue, Colour::kRed}));
  EXPECT_EQ(outer.steps, (std::vector<double>{0, 0.5}));
  EXPECT_EQ(outer.inner.angle_deg, 45);
  EXPECT_EQ(outer.inner.width_px, 7);

  Outer again;
  set_options_from_json(list_options(again), options_to_json(list), "again");
  EXPECT_EQ(options_to_json(list_options(again)), options_to_json(list));
}

TEST(Options, JsonIsStrict) {
  EXPECT_EQ(options_error(R"({"count": 11})"), "m.json: count = 11 is outside [0, 10]");
  EXPECT_EQ(options_error(R"({"count": 3.7})"), "m.json: count is a number, expected an integer");
  EXPECT_EQ(options_error(R"({"count": "3"})"), "m.json: count is a string, expected an integer");
  EXPECT_EQ(options_error(R"({"limit": -1})"), "m.json: limit = -1 is outside [0, 4294967295]");
  EXPECT_EQ(options_error(R"({"limit": 4294967296})"), "m.json: limit = 4294967296 is outside [0, 4294967295]");
  EXPECT_EQ(options_error(R"({"inner": {"angel_deg": 1}})"),
            "m.json: unknown key \"inner.angel_deg\"; did you mean \"inner.angle_deg\"?");
  EXPECT_EQ(options_error(R"({"inner.angle_deg": 1})"),
            "m.json: unknown key \"inner.angle_deg\"; nested options are written as objects");
  EXPECT_EQ(options_error(R"({"inner": 3})"), "m.json: inner is not an object");
  EXPECT_EQ(options_error(R"({"colour": "green"})"), "m.json: colour = \"green\" is not one of: red, blue");
  EXPECT_EQ(options_error(R"({"steps": [0, 2]})"), "m.json: steps = 2 is outside [0, 1]");
  EXPECT_EQ(options_error(R"({"count": null})"), "m.json: count is nothing, expected an integer");
  EXPECT_THAT(options_error(R"({"count": 1, "count": 2})"), ::testing::HasSubstr("duplicate key \"count\""));
  EXPECT_THAT(options_error(R"({"count": 1e999})"),
              ::testing::HasSubstr("m.json: not valid JSON"));  // found by fuzzing
  EXPECT_THAT(options_error("{"), ::testing::StartsWith("m.json: not valid JSON: line 1, column 2: syntax error"));
  EXPECT_THAT(options_error(R"({"count": 9e999})"), ::testing::HasSubstr("m.json: not valid JSON"))
      << "not a parse_error";
}

TEST(Options, DeepNestingIsAnErrorNotACrash) {
  const std::string deep = R"({"steps": )" + std::string(1'000'000, '[') + std::string(1'000'000, ']') + "}";
  EXPECT_EQ(options_error(deep.c_str()), "m.json: nested more than 100 deep");
}

TEST(Options, TextIsStrict) {
  Outer outer;
  const OptionList list = list_options(outer);
  set_from_text(*list.find("palette"), {"red,blue", "red"});
  EXPECT_EQ(outer.palette.size(), 3U);
  set_from_text(*list.find("inner.angle_deg"), {"4.5e1"});
  EXPECT_EQ(outer.inner.angle_deg, 45);
  EXPECT_THROW(set_from_text(*list.find("count"), {"3.0"}), UsageError);
  EXPECT_THROW(set_from_text(*list.find("inner.angle_deg"), {"45deg"}), UsageError);
  EXPECT_THROW(set_from_text(*list.find("inner.angle_deg"), {"nan"}), UsageError);
  EXPECT_THROW(set_from_text(*list.find("inner.angle_deg"), {"1", "2"}), UsageError);
}

TEST(Options, CheckHoldsCodeToTheSameLimits) {
  Outer outer;
  EXPECT_NO_THROW(check_options(outer));
  outer.inner.angle_deg = 91;
  EXPECT_THROW(check_options(outer), UsageError);
}

TEST(Options, SchemaNamesEveryField) {
  Outer outer;
  const auto schema = options_schema(list_options(outer), "Outer");
  EXPECT_EQ(schema["properties"]["inner"]["properties"]["angle_deg"]["maximum"], 90.0);
  EXPECT_EQ(schema["properties"]["colour"]["enum"], (std::vector<std::string>{"red", "blue"}));
  EXPECT_EQ(schema["properties"]["count"]["default"], 3);
  EXPECT_EQ(schema["additionalProperties"], false);
}

}  // namespace
}  // namespace pilotage
