#include "pilotage/base/utf8.h"

#include <gtest/gtest.h>

namespace pilotage {
namespace {

TEST(Utf8, GoodTextPassesAndBadBytesBecomeTheReplacement) {
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

// Every string of one to four bytes whose first two bytes decide: RFC 3629, section 4, spelled out as code points.
TEST(Utf8, LengthsAreThoseOfTheTableOfRfc3629) {
  EXPECT_EQ(utf8_sequence_length(""), 0U);
  for (unsigned first = 0; first < 256; ++first) {
    for (unsigned second = 0; second < 256; ++second) {
      const char bytes[] = {static_cast<char>(first), static_cast<char>(second), '\x80', '\xBF'};
      const bool continues = second >= 0x80 && second <= 0xBF;
      const unsigned code3 = (first & 0x0F) << 12 | (second & 0x3F) << 6;
      const unsigned code4 = (first & 0x07) << 18 | (second & 0x3F) << 12;
      std::size_t expected = 0;
      if (first < 0x80) expected = 1;
      if (first >> 5 == 0b110 && continues && (first & 0x1F) >= 2) expected = 2;
      if (first >> 4 == 0b1110 && continues && code3 >= 0x800 && (code3 < 0xD800 || code3 > 0xDFFF)) expected = 3;
      if (first >> 3 == 0b11110 && continues && code4 >= 0x10000 && code4 <= 0x10FFFF) expected = 4;
      EXPECT_EQ(utf8_sequence_length({bytes, 4}), expected) << first << " " << second;
      if (expected < 2) continue;
      EXPECT_EQ(utf8_sequence_length({bytes, expected - 1}), 0U) << "cut off";
    }
  }
}

TEST(Utf8, NamesOfAnyBytesBecomeTextAndBytesAgain) {
  EXPECT_EQ(name_as_utf8("ortho.tif"), "ortho.tif");
  EXPECT_EQ(name_as_utf8("caf\xC3\xA9\\x.tif"), "caf\xC3\xA9\\x.tif") << "a backslash alone means itself";
  EXPECT_EQ(name_as_utf8("caf\xE9 \xFF"), "caf\\xe9 \\xff");
  EXPECT_EQ(name_as_utf8("\\xff"), "\\x5cxff") << "four characters that look like a byte";
  for (const char* name : {"a", "caf\xE9", "\\xff", "\\x5cxff", "\\\\xff\xFF", "\xED\xA0\x80", "\\xFF", "\\"}) {
    EXPECT_EQ(bytes_of_name(name_as_utf8(name)), name);
    EXPECT_EQ(valid_utf8(name_as_utf8(name)), name_as_utf8(name));
  }
}

}  // namespace
}  // namespace pilotage
