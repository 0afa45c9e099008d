#include "pilotage/base/utc_time.h"

#include <gtest/gtest.h>

namespace pilotage {
namespace {

TEST(UtcTime, ReadsWhatItWrites) {
  for (const char* text :
       {"1970-01-01T00:00:00Z", "2026-03-01T06:30:59Z", "2024-02-29T23:59:59Z", "9999-12-31T23:59:59Z"}) {
    const std::optional<UtcTime> time = parse_utc_time(text);
    ASSERT_TRUE(time) << text;
    EXPECT_EQ(format_utc_time(*time), text);
  }
  EXPECT_EQ(parse_utc_time("2023-11-14T22:13:20Z"), UtcTime{std::chrono::seconds(1700000000)});
}

TEST(UtcTime, RefusesAllOtherForms) {
  for (const char* text :
       {"", "2026-03-01", "2026-03-01T06:30:00", "2026-03-01T06:30:00+00:00", "2026-03-01 06:30:00Z",
        "2026-03-01t06:30:00z", "2026-03-01T06:30:00.5Z", "2026-02-29T00:00:00Z", "2026-13-01T00:00:00Z",
        "2026-00-01T00:00:00Z", "2026-01-00T00:00:00Z", "2026-01-01T24:00:00Z", "2026-01-01T00:60:00Z",
        "2016-12-31T23:59:60Z", "1969-12-31T23:59:59Z", "+026-01-01T00:00:00Z", "2026-01-01T00:00:00Z "}) {
    EXPECT_FALSE(parse_utc_time(text)) << text;
  }
}

}  // namespace
}  // namespace pilotage
