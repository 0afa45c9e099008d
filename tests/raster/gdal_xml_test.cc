#include "pilotage/raster/gdal_xml.h"

#include <string>

#include "testing/error_of.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;

std::string xml_error(const std::string& text) {
  return testing::error_of<DataError>([&] { parse_xml("x", text); });
}

TEST(OgrXml, NamesLoseTheirPrefixAndTextsTheirBlanks) {
  const XmlElement root = parse_xml("x", "<?xml version=\"1.0\"?><a:b k=\"v\"> <c> 1 </c><!-- d --><e:c>2</e:c></a:b>");
  EXPECT_EQ(root.name, "b");
  ASSERT_EQ(root.children.size(), 2U);
  EXPECT_EQ(root.child_text("c"), "1");
  EXPECT_EQ(root.children[1].text, "2");
  EXPECT_EQ(root.child("k"), nullptr) << "attributes are left out";
}

TEST(OgrXml, DamageIsAnError) {
  EXPECT_THAT(xml_error("<a><b></a>"), HasSubstr("x: is not well-formed XML"));
  EXPECT_THAT(xml_error("no element"), HasSubstr("x: "));
  std::string deep;
  for (int i = 0; i < 100; ++i) deep += "<a>";
  for (int i = 0; i < 100; ++i) deep += "</a>";
  EXPECT_THAT(xml_error(deep), HasSubstr("nested deeper than 64"));
}

}  // namespace
}  // namespace pilotage
