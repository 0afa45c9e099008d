#include "pilotage/select/byte_budget.h"

#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

TEST(ByteBudget, UnitsAreWhatTheyMean) {
  EXPECT_EQ(parse_byte_budget("500000"), 500000);
  EXPECT_EQ(parse_byte_budget("20MB"), 20000000);
  EXPECT_EQ(parse_byte_budget("20 MiB"), 20 << 20);
  EXPECT_EQ(parse_byte_budget("1.5gib"), 1610612736);
  EXPECT_EQ(parse_byte_budget("2kB"), 2000);
}

TEST(ByteBudget, AnythingElseIsRefused) {
  for (const char* text : {"", "MB", "-1", "0", "1e9x", "20 parsecs", "nan", "1..5", "1e99", "99999999GiB"}) {
    EXPECT_THROW(parse_byte_budget(text), UsageError) << text;
  }
}

}  // namespace
}  // namespace pilotage
