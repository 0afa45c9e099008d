#include "pilotage/gis/qgis_style.h"

#include <cpl_minixml.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/verdict/tile_class.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;

MeasureScale variance_scale() {
  return {*find_measure("gray_variance"), 10, 30, 5, 40};
}

/// The number of elements of a name anywhere in a document; -1 when it is not well-formed.
int count_elements(const std::string& xml, const std::string& name) {
  CPLXMLNode* root = CPLParseXMLString(xml.c_str());
  if (root == nullptr) return -1;
  int count = 0;
  const auto visit = [&](const auto& self, const CPLXMLNode* node) -> void {
    for (; node != nullptr; node = node->psNext) {
      if (node->eType == CXT_Element && name == node->pszValue) ++count;
      self(self, node->psChild);
    }
  };
  visit(visit, root);
  CPLDestroyXMLNode(root);
  return count;
}

TEST(QgisStyle, AHeatMapSpansTheScaleInTheColoursOfTheMeasure) {
  const std::string style = qgis_heat_style(variance_scale(), 4);
  EXPECT_EQ(count_elements(style, "item"), 33);
  EXPECT_THAT(style, HasSubstr("band=\"4\""));
  EXPECT_THAT(style, HasSubstr("classificationMin=\"10\" classificationMax=\"30\""));
  const auto colors = color_table(ColorMap::kCividis);
  EXPECT_THAT(style, HasSubstr("<item value=\"10\" alpha=\"255\" color=\"" + hex_color(colors[0]) + "\""));
  EXPECT_THAT(style, HasSubstr("<item value=\"30\" alpha=\"255\" color=\"" + hex_color(colors[255]) + "\""));
  EXPECT_THAT(style, HasSubstr("suffix=\" gray levels\""));
}

TEST(QgisStyle, ClassesArePaletted) {
  const std::string style = qgis_class_style(tile_classes());
  EXPECT_EQ(count_elements(style, "paletteEntry"), 3);
  EXPECT_THAT(style, HasSubstr("<paletteEntry value=\"1\" color=\"#e69f00\" label=\"marginal\""));
}

TEST(QgisStyle, ScaleClassesCoverTheScaleWithoutGaps) {
  const std::vector<ScaleClass> classes = scale_classes(variance_scale());
  ASSERT_EQ(classes.size(), 5u);
  EXPECT_EQ(classes.front().low, 10);
  EXPECT_EQ(classes.back().high, 30);
  for (std::size_t i = 1; i < classes.size(); ++i) EXPECT_EQ(classes[i].low, classes[i - 1].high);
  EXPECT_EQ(classes[1].label, "14.0 – 18.0 gray levels");
  EXPECT_EQ(classes.front().label, "below 14.0 gray levels") << "values from 5 on";
  EXPECT_EQ(classes.back().label, "from 26.0 gray levels");
  MeasureScale whole = variance_scale();
  whole.least = whole.low;
  whole.most = whole.high;
  EXPECT_EQ(scale_classes(whole).front().label, "10.0 – 14.0 gray levels");
  EXPECT_EQ(scale_classes(whole).back().label, "26.0 – 30.0 gray levels");
}

TEST(QgisStyle, RulesHaveASymbolEach) {
  const std::string tiles = qgis_tile_style(variance_scale(), true);
  EXPECT_EQ(count_elements(tiles, "symbol"), 7);  // five classes, not known, selected
  EXPECT_EQ(count_elements(tiles, "rule"), 7);
  EXPECT_THAT(tiles, HasSubstr("filter=\"&quot;gray_variance&quot; &lt; 14\""));  // below the scale as well
  EXPECT_THAT(tiles, HasSubstr("filter=\"&quot;gray_variance&quot; &gt;= 26\""));
  const std::string lines =
      qgis_line_style("status", {{"good", "good", {1, 2, 3}, 1, false}, {"bad", "b", {}, 2, true}});
  EXPECT_EQ(count_elements(lines, "rule"), 2);
  EXPECT_THAT(lines, HasSubstr("&quot;status&quot; = &#39;good&#39;"));
  EXPECT_EQ(count_elements(qgis_outline_style({9, 9, 9}, 1), "symbol"), 1);
}

TEST(QgisStyle, AliasesStandInside) {
  const std::string style = with_aliases(qgis_outline_style({}, 1), {{"p", "P < 1"}, {"q", "Q"}});
  EXPECT_EQ(count_elements(style, "alias"), 2);
  EXPECT_THAT(style, HasSubstr("name=\"P &lt; 1\""));
}

}  // namespace
}  // namespace pilotage
