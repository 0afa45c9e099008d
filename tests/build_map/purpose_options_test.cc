#include "pilotage/build_map/purpose_options.h"

#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(PurposeOptions, SayNothingUnlessAsked) {
  EXPECT_EQ(make_purpose({}), MapPurpose{});
}

TEST(PurposeOptions, NowIsTheSourceDateWhereThereIsOne) {
  PurposeOptions options;
  options.created = "now";
  ::setenv("SOURCE_DATE_EPOCH", "1700000000", 1);
  EXPECT_EQ(make_purpose(options).created, parse_utc_time("2023-11-14T22:13:20Z"));
  ::setenv("SOURCE_DATE_EPOCH", "yesterday", 1);
  EXPECT_THROW(make_purpose(options), UsageError);
  ::unsetenv("SOURCE_DATE_EPOCH");
  EXPECT_GT(make_purpose(options).created, parse_utc_time("2023-11-14T22:13:20Z"));
}

TEST(PurposeOptions, RefuseWhatIsNoneWithItsName) {
  const auto refused = [](const char* message, auto change) {
    PurposeOptions options;
    change(options);
    EXPECT_THAT([&] { make_purpose(options); }, ThrowsMessage<UsageError>(HasSubstr(message)));
  };
  refused("mission_name is not 1 to 100 bytes", [](auto& o) { o.mission_name = ""; });
  refused("without control characters", [](auto& o) { o.mission_name = "a\x1b[2J"; });
  refused("mission_name is not UTF-8", [](auto& o) { o.mission_name = "\xff"; });
  refused("map_version = 0 is outside [1, 2147483647]", [](auto& o) { o.map_version = 0; });
  refused("created = \"2026-03-01\" is not a time like 2026", [](auto& o) { o.created = "2026-03-01"; });
  refused("valid_until = \"now\" is not a time", [](auto& o) { o.valid_until = "now"; });
  refused("is not after created", [](auto& o) { o.created = o.valid_until = "2026-03-01T00:00:00Z"; });
}

}  // namespace
}  // namespace pilotage
