#include <algorithm>
#include <regex>

#include "report/report_scene.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "pilotage/base/error.h"
#include "pilotage/report/report.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::ordered_json;

ReportInput drifting_scene(double drift) {
  testing::ReportSceneOptions options;
  options.matchable_from = 0.3;
  options.matchable_to = 0.9;
  options.drift = drift;
  options.tiles_along = 30;
  return testing::report_scene(options);
}

// Whole pages are not printed on failure.
bool contains(const std::string& page, const std::string& text) {
  return page.find(text) != std::string::npos;
}

std::string between(const std::string& text, const std::string& open, const std::string& close) {
  const std::size_t from = text.find(open);
  if (from == std::string::npos) return "";
  return text.substr(from + open.size(), text.find(close, from + open.size()) - from - open.size());
}

Json page_data(const std::string& html) {
  return Json::parse(between(html, "<script type=\"application/json\" id=\"data\">", "</script>"));
}

TEST(ReportHtml, CarriesTheNumbersOfReportJson) {
  const Report report = make_report(drifting_scene(0.04));
  const Json json = report_json(report);
  const std::string html = report_html(report);
  EXPECT_EQ(page_data(html)["report"], json);
  for (const auto& row : json["quality"])
    EXPECT_THAT(between(html, "<tbody id=\"quality\">", "</tbody>"), HasSubstr(row["status"])) << row;
  const std::string verdict = json["verdict"]["text"];
  EXPECT_EQ(between(html, "<p class=\"word\">", "</p>") + ": " + between(html, "<p class=\"sentence\">", "</p>"),
            std::regex_replace(verdict, std::regex(">"), "&gt;"));
}

TEST(ReportHtml, TheVerdictComesFirstAndIsWordShapeAndColour) {
  EXPECT_TRUE(contains(report_html(drifting_scene(0.04)), "<header class=\"verdict bad\">"));
  EXPECT_TRUE(contains(report_html(drifting_scene(0.018)), "<header class=\"verdict good\">"));
  const std::string html = report_html(drifting_scene(0.03));
  EXPECT_TRUE(contains(html, "<header class=\"verdict marginal\">"));
  const std::string body = html.substr(html.find("<body>"));
  EXPECT_LT(body.find("MARGINAL"), body.find("<main>"));
}

TEST(ReportHtml, AnswersTheQuestionAndSaysWhereToLookFirst) {
  const Report bad = make_report(drifting_scene(0.04));
  const std::string html = report_html(bad);
  EXPECT_EQ(
      between(html, "<p class=\"answer\">", "</p>"),
      "The error is predicted up to 56 m &gt; 50 m, if what is assumed holds and every fix comes; how often fixes come "
      "is not known.");
  EXPECT_EQ(between(html, "<p class=\"assumes\">", "</p>"),
            "assumes: tactical INS (default), GNSS lost at the first point, limit 50 m, map error 1 m on each axis");
  EXPECT_EQ(between(html, "<h2 id=\"first-heading\">", "</h2>"), "Where it cannot, why, and what to do");
  const std::string places = between(html, "<ol class=\"places\">", "</ol>");
  for (const std::string& text : {bad.weak_places[0].where, bad.weak_places[0].why, bad.weak_places[0].todo})
    EXPECT_THAT(places, HasSubstr(text));
  EXPECT_LT(html.find("<dl class=\"figures\">"), html.find("id=\"map\""));
  EXPECT_LT(html.find("id=\"map\""), html.find("<ol class=\"places\">"));
  EXPECT_THAT(between(html, "<dl class=\"figures\">", "</dl>"), HasSubstr("<dt>Largest error</dt><dd><b>56 m</b>"));
  const std::string good = report_html(drifting_scene(0.01));
  EXPECT_THAT(between(good, "<p class=\"answer\">", "</p>"), HasSubstr("how often fixes come is not known."));
  ReportInput judged = drifting_scene(0.01);
  judged.selection.probability = RouteProbability{0.957, 0.9, 41.5, 0.0021, std::nullopt, {}};
  for (LegStatus& leg : judged.selection.legs) leg.p_within_limit = 0.98;
  EXPECT_EQ(between(report_html(judged), "<p class=\"answer\">", "</p>"),
            "95 of 100 flights stay within 50 m all the way, if what is assumed holds (P = 0.957 ≥ 0.900).");
  EXPECT_EQ(between(good, "<h2 id=\"first-heading\">", "</h2>"), "Weakest places");
}

TEST(ReportHtml, CoordinatesStandAsDegreesAndAsMinutesAndSeconds) {
  Report report = make_report(drifting_scene(0.04));
  report.gaps[0].from = {-7.5, 52.99999999};
  report.gaps[0].to = {179.0125, -0.25};
  const std::string gaps = between(report_html(report), "<tbody id=\"gaps\">", "</tbody>");
  EXPECT_THAT(gaps, HasSubstr("<code>53.000000, -7.500000</code>"));
  EXPECT_THAT(gaps, HasSubstr("data-copy=\"-0.250000, 179.012500\""));  // one place, as a map's search takes it
  EXPECT_THAT(
      gaps, HasSubstr("53°00&#39;00.0&quot; N 7°30&#39;00.0&quot; W → 0°15&#39;00.0&quot; S 179°00&#39;45.0&quot; E"));
}

TEST(ReportHtml, PicturesFollowTheOrderOfTheTiles) {
  ReportInput input = drifting_scene(0.04);
  input.pictures.sheet.setTo(cv::Scalar::all(0));
  input.pictures.sheet(input.pictures.place(7)).setTo(cv::Scalar::all(255));
  const std::int64_t white = input.mission.ground.tiles[7].tile_id;
  const Report report = make_report(input);
  const std::string& jpeg = report.display.pictures_jpeg;
  const cv::Mat sheet = cv::imdecode(std::vector<char>(jpeg.begin(), jpeg.end()), cv::IMREAD_GRAYSCALE);
  ASSERT_FALSE(sheet.empty());
  for (std::size_t i = 0; i < 20; ++i) {
    const double mean = cv::mean(sheet(input.pictures.place(i)))[0];
    EXPECT_NEAR(mean, report.tiles[i].tile.tile_id == white ? 255 : 0, 20) << i;
  }
  input.pictures.sheet = input.pictures.sheet.rowRange(0, 40).clone();
  EXPECT_THROW(make_report(input), DataError);
}

TEST(ReportHtml, NeedsNoOtherFileAndNoNetwork) {
  std::string html = report_html(drifting_scene(0.04));
  EXPECT_TRUE(contains(html, "default-src 'none'"));
  EXPECT_FALSE(contains(html, "sourceMappingURL"));
  const std::regex outside(R"re((?:src|href)\s*=\s*"(?!data:|#)|url\((?!data:|#)|@import)re");
  // Leaflet's script builds such texts from options that the page does not set; everything else must have none.
  const std::size_t script = html.find("<script>");
  const std::string before = html.substr(0, html.find("<script type=\"application/json\""));
  ASSERT_NE(script, std::string::npos);
  EXPECT_FALSE(std::regex_search(before, outside));
  std::string own = html.substr(html.rfind("<script>"));
  const std::string name_of_kml =
      "http://www.opengis.net/kml/2.2";  // what a saved sketch calls its format; nobody asks for it
  own.erase(own.find(name_of_kml), name_of_kml.size());
  EXPECT_FALSE(contains(own, "http"));
  EXPECT_FALSE(contains(own, "fetch("));
}

TEST(ReportHtml, TextIsNeverMarkup) {
  const std::string evil = "</script><img src=x onerror=alert(1)>\"'&{{data}}\xFF\x01";
  ReportInput input = drifting_scene(0.04);
  input.title = evil;
  input.software_version = evil;
  input.mission.flight.route.name = evil;
  input.mission.flight.route.format = evil;
  input.mission.ground.crs = testing::local_crs("</script><img src=x onerror=alert(1)>'&{{data}}");
  input.mission.ground.elevation = evil;
  input.mission.warnings = {evil};
  input.mission.flight.route.notes = {evil};
  input.selection.notes = {evil};
  input.assumptions = {evil};
  input.mission.ground.imagery.datasets = {{evil, 0.3, evil, evil, 10, 10}};
  input.inputs = {{evil, evil, evil, evil}};
  input.parameters = {{evil, {{evil, evil}}}, {"list", {evil}}};
  const std::string html = report_html(input);
  EXPECT_FALSE(contains(html, "<img src=x"));
  EXPECT_FALSE(contains(html, "\xFF"));
  EXPECT_EQ(page_data(html)["report"]["warnings"][0],
            "</script><img src=x onerror=alert(1)>\"'&{{data}}\xEF\xBF\xBD\x01");
  const auto count = [&](const std::string& what) {
    std::size_t times = 0;
    for (std::size_t at = html.find(what); at != std::string::npos; at = html.find(what, at + 1)) ++times;
    return times;
  };
  EXPECT_EQ(count("</script>"), 3U);
  EXPECT_EQ(count("<script"), 3U);
}

TEST(ReportHtml, ImageryLiesUnderTheCells) {
  ReportInput input = drifting_scene(0.04);
  // One tile of level 0 painted white: in the picture the middle of its cell must be white.
  const GroundTile& tile = input.mission.ground.tiles[60];
  const Eigen::Vector2d a = input.imagery.map_from_pixel.pixel_from_map({tile.bounds.min_x_m, tile.bounds.max_y_m});
  const Eigen::Vector2d b = input.imagery.map_from_pixel.pixel_from_map({tile.bounds.max_x_m, tile.bounds.min_y_m});
  input.imagery.pixels.setTo(cv::Scalar(0, 0, 0));
  input.imagery
      .pixels(cv::Rect(cv::Point(static_cast<int>(a.x()), static_cast<int>(a.y())),
                       cv::Point(static_cast<int>(b.x()), static_cast<int>(b.y()))))
      .setTo(cv::Scalar(255, 255, 255));
  const Report report = make_report(input);
  const ReportDisplay& display = report.display;
  const cv::Mat picture =
      cv::imdecode(std::vector<char>(display.imagery_jpeg.begin(), display.imagery_jpeg.end()), cv::IMREAD_COLOR);
  ASSERT_FALSE(picture.empty());
  const auto brightness = [&](const Eigen::Vector2d& point) {
    const double pixel_m = (display.max_x_m - display.min_x_m) / picture.cols;
    return picture.at<cv::Vec3b>(static_cast<int>((display.max_y_m - point.y()) / pixel_m),
                                 static_cast<int>((point.x() - display.min_x_m) / pixel_m))[1];
  };
  const auto& cell = display.cells_m[60];
  const Eigen::Vector2d middle = (cell[0] + cell[2]) / 2;
  EXPECT_GT(brightness(middle), 230);
  // The tile reaches twice as far as its cell (stride is half a tile): 90 % of the way is white, 110 % is black.
  for (const Eigen::Vector2d& corner : cell) {
    EXPECT_GT(brightness(middle + 1.8 * (corner - middle)), 200);
    EXPECT_LT(brightness(middle + 2.2 * (corner - middle)), 55);
  }
}

TEST(ReportHtml, EveryTileHasAShadeOfEveryMeasure) {
  const Report report = make_report(drifting_scene(0.04));
  const Json display = page_data(report_html(report))["display"];
  ASSERT_EQ(display["shades"].size(), report.measures.size());
  for (std::size_t m = 0; m < report.measures.size(); ++m) {
    ASSERT_EQ(display["shades"][m].size(), report.tiles.size());
    for (std::size_t i = 0; i < report.tiles.size(); ++i) {
      EXPECT_EQ(display["shades"][m][i],
                shade(report.measures[m], report.measures[m].measure.get(report.tiles[i].score)));
    }
  }
  EXPECT_EQ(display["colors"]["blues"].size(), 256U);
  EXPECT_EQ(display["colors"]["cividis"][0], hex_color(color_table(ColorMap::kCividis)[0]));
}

TEST(ReportHtml, ControlsAreRealAndLabelled) {
  const std::string html = report_html(drifting_scene(0.04));
  const std::regex control(R"re(<(?:input|button)[^>]*>)re");
  const std::string panel = between(html, "<main>", "<section aria-labelledby=\"quality-heading\">");
  int controls = 0;
  for (std::sregex_iterator it(panel.begin(), panel.end(), control); it != std::sregex_iterator(); ++it, ++controls) {
    const std::string tag = it->str();
    const std::string id = between(tag, "id=\"", "\"");
    const std::size_t content = static_cast<std::size_t>(it->position()) + tag.size();
    const bool labelled = tag.find("aria-label") != std::string::npos ||
                          (tag.starts_with("<button") && panel[content] != '<') ||
                          panel.find("for=\"" + id + "\"") != std::string::npos ||
                          panel.substr(0, static_cast<std::size_t>(it->position())).rfind("<label>") + 7 ==
                              static_cast<std::size_t>(it->position());
    EXPECT_TRUE(labelled) << tag;
  }
  EXPECT_GE(controls, 10);
}

TEST(ReportHtml, IsSmallAndTheSameEachTime) {
  const ReportInput input = drifting_scene(0.04);
  const std::string html = report_html(input);
  EXPECT_LT(html.size(), 3U << 20);
  EXPECT_TRUE(report_html(input) == html);
}

// Noise is what JPEG likes least: the picture must keep its budget all the same.
TEST(ReportHtml, NoisyImageryStaysSmall) {
  ReportInput input = drifting_scene(0.04);
  input.imagery.pixels.create(3000, 900, CV_8UC3);
  cv::RNG(3).fill(input.imagery.pixels, cv::RNG::UNIFORM, 0, 256);
  input.imagery.valid = cv::Mat(3000, 900, CV_8UC1, cv::Scalar(255));
  input.imagery.map_from_pixel.x_per_col *= 0.25;
  input.imagery.map_from_pixel.y_per_row *= 0.25;
  EXPECT_LT(report_html(input).size(), 3U << 20);
}

}  // namespace
}  // namespace pilotage
