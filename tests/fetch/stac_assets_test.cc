#include "pilotage/fetch/stac_assets.h"

#include <algorithm>

#include "testing/error_of.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"

namespace pilotage {
namespace {

using testing::error_of;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::TemporaryFolder;
using Json = nlohmann::ordered_json;

const DegreeBounds kHere{16, 55, 17, 56};

Json item(const std::string& id, const std::string& datetime = "2023-06-14T10:30:00Z") {
  return {
      {"type", "Feature"},
      {"stac_version", "1.0.0"},
      {"id", id},
      {"bbox", {16.1, 55.1, 16.2, 55.2}},
      {"properties", {{"datetime", datetime}}},
      {"links", Json::array()},
      {"assets",
       {{"visual", {{"href", "./" + id + ".tif"}, {"type", "image/tiff; application=geotiff"}, {"roles", {"visual"}}}},
        {"thumbnail", {{"href", "./t.png"}, {"type", "image/png"}, {"roles", {"thumbnail"}}}}}}};
}

std::vector<StacAsset> found_in(const std::filesystem::path& place, const std::string& asset = "") {
  StacAssets found = find_stac_assets({place.string()}, kHere, asset);
  std::sort(found.assets.begin(), found.assets.end(),
            [](const StacAsset& a, const StacAsset& b) { return a.item < b.item; });
  return found.assets;
}

/// Why the one item of a place is left out.
std::string skipped_in(const std::filesystem::path& place, const std::string& asset = "") {
  const StacAssets found = find_stac_assets({place.string()}, kHere, asset);
  EXPECT_TRUE(found.assets.empty());
  return found.skipped.size() == 1 ? found.skipped.front() : "";
}

std::string error_in(const std::filesystem::path& place, const std::string& asset = "") {
  return error_of<DataError>([&] { found_in(place, asset); });
}

void write(const std::filesystem::path& path, const Json& json) {
  std::filesystem::create_directories(path.parent_path());
  write_file(path, json.dump(), true);
}

TEST(StacAssets, OfAnItemItsVisualAssetDateAndLicence) {
  const TemporaryFolder folder;
  Json json = item("a");
  json["properties"]["license"] = "CC-BY-4.0";
  json["properties"]["providers"] = {{{"name", "Host"}, {"roles", {"host"}}},
                                     {{"name", "City"}, {"roles", {"producer"}}}};
  write(folder / "a.json", json);
  const auto found = found_in(folder / "a.json");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].item, "a");
  EXPECT_EQ(found[0].key, "visual");
  EXPECT_EQ(found[0].dataset, (folder / "a.tif").string());
  EXPECT_EQ(found[0].acquired, "2023-06-14T10:30:00Z");
  EXPECT_EQ(found[0].licence, (Licence{"CC-BY-4.0", "City"}));
}

TEST(StacAssets, ACatalogueIsFollowedToItsItemsInTheRectangle) {
  const TemporaryFolder folder;
  write(folder / "catalog.json", {{"type", "Catalog"},
                                  {"id", "c"},
                                  {"links",
                                   {{{"rel", "self"}, {"href", "https://example.org/catalog.json"}},
                                    {{"rel", "child"}, {"href", "./near/collection.json"}},
                                    {{"rel", "child"}, {"href", "./far/collection.json"}}}}});
  const auto collection = [](double west) {
    return Json{{"type", "Collection"},
                {"id", "n"},
                {"license", "proprietary"},
                {"extent", {{"spatial", {{"bbox", {{west, 55, west + 1, 56}}}}}}},
                {"links",
                 {{{"rel", "license"}, {"href", "https://example.org/terms"}},
                  {{"rel", "item"}, {"href", "../items/late.json"}},
                  {{"rel", "item"}, {"href", "../items/early.json"}},
                  {{"rel", "item"}, {"href", "../items/elsewhere.json"}},
                  {{"rel", "root"}, {"href", "../catalog.json"}}}}};
  };
  write(folder / "near/collection.json", collection(16));
  // Were it read, its links would lead to files that are not there.
  Json far = collection(80);
  far["links"].push_back({{"rel", "item"}, {"href", "missing.json"}});
  write(folder / "far/collection.json", far);
  write(folder / "items/late.json", item("late", "2024-01-01T00:00:00Z"));
  Json early = item("early", "2022-05-06T07:08:09.250+00:00");
  early["properties"]["license"] = "CC0-1.0";
  write(folder / "items/early.json", early);
  Json elsewhere = item("elsewhere");
  elsewhere["bbox"] = {20, 55.1, -100, 21, 55.2, 300};  // with heights
  write(folder / "items/elsewhere.json", elsewhere);
  const auto found = found_in(folder / "catalog.json");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].item, "early");
  EXPECT_EQ(found[0].acquired, "2022-05-06T07:08:09Z");
  EXPECT_EQ(found[0].licence.terms, "CC0-1.0") << "the item's own";
  EXPECT_EQ(found[1].item, "late");
  EXPECT_EQ(found[1].acquired, "2024-01-01") << "midnight is a day";
  EXPECT_EQ(found[1].licence.terms, "proprietary, https://example.org/terms");
  EXPECT_EQ(found[1].dataset, (folder / "items/late.tif").string());
}

TEST(StacAssets, AnItemAloneHasTheLicenceOfTheCollectionItNames) {
  const TemporaryFolder folder;
  Json json = item("a");
  json["links"] = {{{"rel", "collection"}, {"href", "../collection.json"}}};
  write(folder / "items/a.json", json);
  EXPECT_EQ(found_in(folder / "items/a.json")[0].licence, Licence{}) << "not there: not known";
  write(folder / "collection.json", {{"type", "Collection"}, {"license", "ODbL-1.0"}, {"links", Json::array()}});
  EXPECT_EQ(found_in(folder / "items/a.json")[0].licence.terms, "ODbL-1.0");
  // Its own licence, and who is named by the collection alone.
  json["properties"]["license"] = "CC0-1.0";
  write(folder / "items/a.json", json);
  write(
      folder / "collection.json",
      {{"type", "Collection"}, {"license", "ODbL-1.0"}, {"providers", {{{"name", "City"}}}}, {"links", Json::array()}});
  EXPECT_EQ(found_in(folder / "items/a.json")[0].licence, (Licence{"CC0-1.0", "City"}));
}

TEST(StacAssets, PagesOfASearchAreFollowed) {
  const TemporaryFolder folder;
  write(folder / "1.json",
        {{"type", "FeatureCollection"}, {"features", {item("a")}}, {"links", {{{"rel", "next"}, {"href", "2.json"}}}}});
  write(folder / "2.json", {{"type", "FeatureCollection"},
                            {"features", {item("b")}},
                            {"links", {{{"rel", "next"}, {"href", "1.json"}}}}});  // in a circle
  EXPECT_EQ(found_in(folder / "1.json").size(), 2u);
  write(folder / "2.json", {{"type", "FeatureCollection"},
                            {"features", {item("b")}},
                            {"links", {{{"rel", "next"}, {"href", "1.json"}, {"method", "POST"}}}}});
  EXPECT_THAT(error_in(folder / "1.json"), HasSubstr("its next page is asked for by POST"));
}

TEST(StacAssets, WhichAssetIsSaidWhereItIsNotPlain) {
  const TemporaryFolder folder;
  Json json = item("a");
  json["assets"] = {{"red", {{"href", "r.tif"}, {"type", "image/tiff"}, {"roles", {"data"}}}},
                    {"green", {{"href", "g.tif"}, {"type", "image/tiff"}, {"roles", {"data"}}}}};
  write(folder / "a.json", json);
  EXPECT_THAT(skipped_in(folder / "a.json"),
              HasSubstr("item a: several of its assets could be the imagery; give --asset red or green"));
  EXPECT_EQ(found_in(folder / "a.json", "green")[0].dataset, (folder / "g.tif").string());
  EXPECT_THAT(skipped_in(folder / "a.json", "blue"), HasSubstr("has no asset \"blue\"; it has red, green"));
  json["assets"] = {{"thumbnail", {{"href", "t.tif"}, {"type", "image/tiff"}, {"roles", {"thumbnail"}}}}};
  write(folder / "a.json", json);
  EXPECT_THAT(skipped_in(folder / "a.json"), HasSubstr("none of its assets is a GeoTIFF"));
  json["assets"] = {{"map", {{"href", "m.tif"}}}};  // neither type nor role
  write(folder / "a.json", json);
  EXPECT_EQ(found_in(folder / "a.json")[0].key, "map");
  // One odd item does not end the run.
  write(folder / "b.json", {{"type", "FeatureCollection"}, {"features", {json, item("good")}}});
  json["assets"] = {{"t", {{"href", "t.tif"}, {"roles", {"overview", "visual"}}}}};
  write(folder / "c.json", {{"type", "FeatureCollection"}, {"features", {json, item("good")}}});
  EXPECT_EQ(found_in(folder / "b.json").size(), 2u);
  const StacAssets found = find_stac_assets({(folder / "c.json").string()}, kHere, "");
  EXPECT_EQ(found.assets.size(), 1u);
  EXPECT_EQ(found.skipped.size(), 1u);
}

TEST(StacAssets, TheSameRasterIsFoundOnce) {
  const TemporaryFolder folder;
  write(folder / "a.json", item("a"));
  write(folder / "all.json",
        {{"type", "Collection"},
         {"license", "CC0-1.0"},
         {"links", {{{"rel", "item"}, {"href", "./a.json"}}, {{"rel", "items"}, {"href", "page.json"}}}}});
  write(folder / "page.json", {{"type", "FeatureCollection"}, {"features", {item("a")}}});
  EXPECT_EQ(found_in(folder / "all.json").size(), 1u);
  EXPECT_EQ(
      find_stac_assets({(folder / "a.json").string(), (folder / "." / "a.json").string()}, kHere, "").assets.size(),
      1u);
}

TEST(StacAssets, ADateIsOneDayOrNone) {
  const TemporaryFolder folder;
  const auto found_with = [&](const Json& properties, const Json& of_asset = Json::object()) {
    Json json = item("a");
    json["properties"] = properties;
    json["assets"]["visual"].update(of_asset);
    write(folder / "a.json", json);
    return found_in(folder / "a.json")[0];
  };
  EXPECT_EQ(found_with({{"datetime", "2023-06-14T00:30:00+02:00"}}).acquired, "2023-06-13T22:30:00Z");
  EXPECT_EQ(found_with({{"datetime", "2023-06-14t10:30:00.5z"}}).acquired, "2023-06-14T10:30:00Z");
  EXPECT_EQ(
      found_with(
          {{"datetime", nullptr}, {"start_datetime", "2023-06-14T08:00:00Z"}, {"end_datetime", "2023-06-14T09:00:00Z"}})
          .acquired,
      "2023-06-14");
  // A mosaic of years: a moment that stands beside is its middle, no day of it.
  const StacAsset years = found_with({{"datetime", "2020-06-14T08:00:00Z"},
                                      {"start_datetime", "2019-01-01T00:00:00Z"},
                                      {"end_datetime", "2022-01-01T00:00:00Z"}});
  EXPECT_EQ(years.acquired, "");
  EXPECT_TRUE(years.of_several_days);
  // The asset's own word counts.
  const StacAsset own = found_with({{"datetime", "2023-06-14T10:30:00Z"}, {"license", "CC0-1.0"}},
                                   {{"datetime", "2021-01-02T00:00:00Z"}, {"license", "CC-BY-4.0"}});
  EXPECT_EQ(own.acquired, "2021-01-02");
  EXPECT_EQ(own.licence.terms, "CC-BY-4.0");
  EXPECT_EQ(found_with({{"datetime", "soon"}}).acquired, "");
}

TEST(StacAssets, ReferencesLeadFromWhereTheirFileLies) {
  const TemporaryFolder folder;
  const auto dataset_of = [&](const std::string& href) {
    Json json = item("a");
    json["assets"]["visual"]["href"] = href;
    write(folder / "a.json", json);
    return found_in(folder / "a.json")[0].dataset;
  };
  EXPECT_EQ(dataset_of("https://example.org/x/y.tif?key=1"), "/vsicurl/https://example.org/x/y.tif?key=1");
  EXPECT_EQ(dataset_of("s3://bucket/y.tif"), "/vsis3/bucket/y.tif");
  EXPECT_EQ(dataset_of("/data/y.tif"), "/data/y.tif");
  EXPECT_EQ(dataset_of("file:///data/y.tif"), "/data/y.tif");
  EXPECT_EQ(dataset_of("../y.tif"), (folder.path().parent_path() / "y.tif").string());
}

TEST(StacAssets, ReferencesOnTheNetworkStayThere) {
  const std::string base = "/vsicurl/https://example.org/a/b/item.json?token=1";
  EXPECT_EQ(resolve_stac_reference("x.tif", base), "/vsicurl/https://example.org/a/b/x.tif");
  EXPECT_EQ(resolve_stac_reference("../x.tif?key=a/../b", base), "/vsicurl/https://example.org/a/x.tif?key=a/../b");
  EXPECT_EQ(resolve_stac_reference("/x.tif", base), "/vsicurl/https://example.org/x.tif");
  EXPECT_EQ(resolve_stac_reference("?page=2", base), "/vsicurl/https://example.org/a/b/item.json?page=2");
  EXPECT_EQ(resolve_stac_reference("//cdn.example.org/x.tif", base), "/vsicurl/https://cdn.example.org/x.tif");
  EXPECT_EQ(resolve_stac_reference("../../../../etc/passwd", base), "/vsicurl/https://example.org/etc/passwd");
  EXPECT_EQ(resolve_stac_reference("x.tif", "/vsis3/bucket/a/item.json"), "/vsis3/bucket/a/x.tif");
  for (const char* place : {"/vsicurl/https://example.org/item.json", "/vsis3/b/item.json", "/vsiaz/b/item.json",
                            "/vsizip//vsis3/b/a.zip/item.json", "/vsizip/{/vsiaz/b/a.zip}/item.json",
                            "/vsicurl?url=https%3A%2F%2Fexample.org%2Fitem.json"}) {
    for (const char* reference : {"file:///etc/passwd", "/vsizip/home.zip/x.tif", "/vsigzip//etc/x.gz"}) {
      EXPECT_THAT(error_of<DataError>([&] { resolve_stac_reference(reference, place); }),
                  HasSubstr("leads from the network to files of this machine"))
          << place;
    }
  }
  EXPECT_THAT(error_of<DataError>([&] { resolve_stac_reference("ftp://example.org/x.tif", base); }),
              HasSubstr("is an address of a kind that is not read"));
}

TEST(StacAssets, OverTheAntimeridian) {
  const DegreeBounds pacific{179.5, -17, -179.5, -16};
  EXPECT_TRUE(pacific.intersects({-179.9, -16.5, -179.8, -16.4}));
  EXPECT_TRUE(pacific.intersects({179.8, -16.5, 180, -16.4}));
  EXPECT_TRUE(pacific.intersects({179.9, -16.5, -179.9, -16.4}));
  EXPECT_FALSE(pacific.intersects({0, -16.5, 1, -16.4}));
  EXPECT_FALSE(pacific.intersects({179.8, -15, 180, -14}));
}

TEST(StacAssets, WhatIsNoStacIsSaid) {
  const TemporaryFolder folder;
  EXPECT_THAT(error_in(folder / "none.json"), HasSubstr("none.json"));
  write_file(folder / "x.json", "{", false);
  EXPECT_THAT(error_in(folder / "x.json"), HasSubstr("x.json"));
  write(folder / "x.json", {{"type", "Topology"}});
  EXPECT_THAT(error_in(folder / "x.json"), HasSubstr("is no STAC item, collection or catalogue (type \"Topology\")"));
  Json json = item("a");
  json.erase("id");
  write(folder / "x.json", json);
  EXPECT_THAT(error_in(folder / "x.json"), HasSubstr("holds an item without an id"));
  for (const Json& odd : {Json(7), Json::array(), Json("text"), Json(nullptr)}) {  // of another type than it should be
    for (const char* key : {"properties", "assets", "links", "bbox", "id"}) {
      Json changed = item("a");
      changed[key] = odd;
      write(folder / "x.json", changed);
      try {
        found_in(folder / "x.json");
      } catch (const DataError&) {
      }
    }
  }
  EXPECT_THAT(error_of<DataError>([&] { find_stac_assets({"https://example.org/x.json"}, kHere, ""); }),
              HasSubstr("/vsicurl/https://example.org/x.json"))
      << "the network is switched off";
  EXPECT_THROW(find_stac_assets({}, kHere, ""), UsageError);
}

}  // namespace
}  // namespace pilotage
