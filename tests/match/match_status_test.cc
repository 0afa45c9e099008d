#include <set>

#include <gtest/gtest.h>

#include "pilotage/match/match.h"

namespace pilotage {
namespace {

TEST(MatchStatus, EveryStatusHasItsOwnNameAndText) {
  std::set<std::string_view> names;
  std::set<std::string_view> texts;
  constexpr int kCount = static_cast<int>(MatchStatus::kOutsideGate) + 1;
  for (int i = 0; i < kCount; ++i) {
    names.insert(match_status_name(static_cast<MatchStatus>(i)));
    texts.insert(match_status_text(static_cast<MatchStatus>(i)));
  }
  EXPECT_EQ(names.size(), static_cast<std::size_t>(kCount));
  EXPECT_EQ(texts.size(), static_cast<std::size_t>(kCount));
  EXPECT_FALSE(names.contains("unknown"));
}

}  // namespace
}  // namespace pilotage
