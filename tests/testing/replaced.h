#pragma once

#include <string>

#include <gtest/gtest.h>

namespace pilotage::testing {

/// The text with the first `from` in it, which must be there, become `to`.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

}  // namespace pilotage::testing
