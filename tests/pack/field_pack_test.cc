#include "pilotage/pack/field_pack.h"

#include "testing/error_of.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"

namespace pilotage {
namespace {

using ::testing::ElementsAre;
using testing::error_of;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::TemporaryFolder;

constexpr const char* kDigest = "00112233445566778899aabbccddeeff00112233445566778899aabbccddeeff";

PackManifest manifest_of(const TemporaryFolder& folder) {
  write_file(folder / "map.gpkg", "a map", true);
  write_file(folder / "report.html", "a page", true);
  PackManifest manifest;
  manifest.software_version = "pilotage 0";
  manifest.title = "harbour ü";
  manifest.verdict = "GO: 98 of 100";
  manifest.assumptions = "steady wind";
  manifest.evidence = "2000 flights";
  manifest.purpose.mission_name = "harbour";
  manifest.purpose.map_version = 7;
  manifest.purpose.created = parse_utc_time("2026-03-01T06:30:00Z");
  manifest.purpose.valid_until = parse_utc_time("2027-03-01T06:30:00Z");
  manifest.map_digest = kDigest;
  manifest.files = {pack_file(folder.path(), "report.html"), pack_file(folder.path(), "map.gpkg")};
  manifest.inputs = {{"imagery", "ortho.tif", "2026-01-02", "blake2b-256:0011", {"CC-BY-4.0", "© somebody"}},
                     {"route", "r.plan", "", "", {}}};
  return manifest;
}

TEST(FieldPack, AManifestReadsBackAsItWas) {
  const TemporaryFolder folder;
  const PackManifest manifest = manifest_of(folder);
  const std::string text = pack_manifest_text(manifest);
  const PackManifest back = pack_manifest_from_text(text, "pack_manifest.json");
  EXPECT_EQ(pack_manifest_text(back), text);
  EXPECT_EQ(back.purpose, manifest.purpose);
  EXPECT_EQ(back.title, manifest.title);
  ASSERT_EQ(back.files.size(), 2u);
  EXPECT_EQ(back.files.front().name, "map.gpkg") << "by name";
  EXPECT_EQ(back.files.front().bytes, 5);
  ASSERT_EQ(back.inputs.size(), 2u);
  EXPECT_EQ(back.inputs.front().licence, (Licence{"CC-BY-4.0", "© somebody"}));
  EXPECT_EQ(back.inputs.back().licence, Licence{});
  // What b2sum -l 256 says of "a map".
  EXPECT_THAT(text, HasSubstr("\"digest\": \"" + pack_file(folder.path(), "map.gpkg").digest + "\""));
}

TEST(FieldPack, WhatWasWrittenIsWhole) {
  const TemporaryFolder folder;
  const PackManifest manifest = manifest_of(folder);
  write_file(folder / "pack_manifest.json", pack_manifest_text(manifest), true);
  write_file(folder / "pack_manifest.json.minisig", "a signature", true);
  const PackCheck check = check_pack(folder.path(), manifest);
  EXPECT_THAT(check.problems, IsEmpty());
  EXPECT_THAT(check.strangers, IsEmpty());
}

TEST(FieldPack, EachChangeIsNamed) {
  const TemporaryFolder folder;
  const PackManifest manifest = manifest_of(folder);
  write_file(folder / "map.gpkg", "a nap", true);
  PackCheck check = check_pack(folder.path(), manifest);
  ASSERT_EQ(check.problems.size(), 1u);
  EXPECT_EQ(check.problems[0].file, "map.gpkg");
  EXPECT_EQ(check.problems[0].message,
            (folder / "map.gpkg").string() + ": the digest does not match: it was changed or is damaged");

  write_file(folder / "map.gpkg", "a map too long", true);
  check = check_pack(folder.path(), manifest);
  ASSERT_EQ(check.problems.size(), 1u);
  EXPECT_THAT(check.problems[0].message, HasSubstr("has 14 bytes, the manifest says 5"));

  std::filesystem::remove(folder / "map.gpkg");
  check = check_pack(folder.path(), manifest);
  ASSERT_EQ(check.problems.size(), 1u);
  EXPECT_THAT(check.problems[0].message, HasSubstr("is missing"));

  // A link could lead to other bytes tomorrow.
  write_file(folder / "elsewhere", "a map", true);
  std::filesystem::create_symlink(folder / "elsewhere", folder / "map.gpkg");
  check = check_pack(folder.path(), manifest);
  ASSERT_EQ(check.problems.size(), 1u);
  EXPECT_THAT(check.problems[0].message, HasSubstr("is no regular file"));
  EXPECT_THAT(check.strangers, ElementsAre("elsewhere"));
}

TEST(FieldPack, AManifestThatLeadsAwayOrLiesIsRefused) {
  const TemporaryFolder folder;
  const auto json = nlohmann::ordered_json::parse(pack_manifest_text(manifest_of(folder)));
  const auto error_with = [&](const auto& change) {
    auto changed = json;
    change(changed);
    return error_of<DataError>([&] { pack_manifest_from_text(changed.dump(), "pack_manifest.json"); });
  };
  for (const char* name : {"../map.gpkg", "/etc/passwd", "a\\b", "..", ".", ""}) {
    EXPECT_THAT(error_with([&](auto& j) { j["files"][0]["name"] = name; }),
                HasSubstr("pack_manifest.json.files[0].name"))
        << name;
  }
  EXPECT_THAT(error_with([](auto& j) { j["files"][1]["name"] = "map.gpkg"; }), HasSubstr("each file once"));
  EXPECT_THAT(error_with([](auto& j) { j["files"][1]["name"] = "pack_manifest.json"; }),
              HasSubstr("another file than"));
  EXPECT_THAT(error_with([](auto& j) { j["files"][0]["digest"] = "md5:00"; }), HasSubstr("files[0].digest"));
  EXPECT_THAT(error_with([](auto& j) { j["files"][0]["digest"] = "blake2b-256:" + std::string(64, 'x'); }),
              HasSubstr("files[0].digest"));
  EXPECT_THAT(error_with([](auto& j) { j["files"][0]["bytes"] = -1; }), HasSubstr("files[0].bytes"));
  EXPECT_THAT(error_with([](auto& j) { j["files"][0]["bytes"] = 9223372036854775807; }), HasSubstr("files[0].bytes"));
  EXPECT_THAT(error_with([](auto& j) { j["map_digest"] = "none"; }), HasSubstr("map_digest"));
  EXPECT_THAT(error_with([](auto& j) { j["files"].erase(0); }), HasSubstr("names no map.gpkg"));
  EXPECT_THAT(error_with([](auto& j) { j["pilotage_pack"] = 2; }), HasSubstr("is newer than this program reads"));
  EXPECT_THAT(error_with([](auto& j) { j.erase("pilotage_pack"); }), HasSubstr("is not the manifest of a field pack"));
  EXPECT_THAT(error_with([](auto& j) { j["more"] = 1; }), HasSubstr("more"));
  EXPECT_THAT(error_with([](auto& j) { j["purpose"]["created"] = "yesterday"; }), HasSubstr("purpose.created"));
}

TEST(FieldPack, CheckingStopsWhenAsked) {
  const TemporaryFolder folder;
  const PackManifest manifest = manifest_of(folder);
  EXPECT_THROW(
      check_pack(folder.path(), manifest, [](std::string_view, std::int64_t done, std::int64_t) { return done == 0; }),
      Interrupted);
}

}  // namespace
}  // namespace pilotage
