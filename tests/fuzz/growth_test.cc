// Work of the readers grows with the size of what they read, n log n at most: inputs of 1, 2, 4 and 8 times a size, and
// steps that are counted, not seconds (testing/counted_steps.h). What a reader refuses for its size counts as well: it
// must have found out soon.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "fuzz/fuzz_targets.h"
#include "mapdb/small_map.h"
#include "testing/counted_steps.h"
#include "testing/source_folder.h"
#include "testing/temporary_folder.h"
#include "vehiclelog/log_writers.h"
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/output_file.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

/// How an input of `n` parts is made, for the fuzz target of its reader.
struct Growing {
  std::string name;  ///< Begins with that of the target: "route, KML of many lines".
  std::function<std::string(int n)> make;
  int parts = 250;   ///< Of the smallest.
  bool read = true;  ///< False: larger ones are refused, which must not take longer.
};

std::string corpus(const std::string& file) {
  return read_file(testing::source_folder() / "tests/fuzz/corpus" / file);
}

std::string many(int n, const std::function<std::string(int i)>& part, const std::string& between = "") {
  std::string text;
  for (int i = 0; i < n; ++i) text += (i > 0 ? between : "") + part(i);
  return text;
}

std::function<std::string(int)> wrapped(const std::string& head, const std::function<std::string(int i)>& part,
                                        const std::string& tail = "", const std::string& between = "") {
  return [=](int n) { return head + many(n, part, between) + tail; };
}

std::string text(int i) {
  return std::to_string(i);
}

/// A JSON file of the corpus, the first element of whose list `list` is there `n` times, each changed by `change`.
std::function<std::string(int)> long_list(const std::string& file, const std::string& list,
                                          const std::function<void(Json&, int i)>& change) {
  return [=](int n) {
    Json json = Json::parse(corpus(file));
    Json& elements = json.at(Json::json_pointer(list));
    const Json first = elements.front();
    elements = Json::array();
    for (int i = 0; i < n; ++i) {
      elements.push_back(first);
      change(elements.back(), i);
    }
    return json.dump();
  };
}

void leave(Json& /*element*/, int /*i*/) {}

std::vector<Growing> tables_and_lists() {
  const std::string frames =
      "file,time_s,prior_lon_deg,prior_lat_deg,prior_sigma_m,height_agl_m,yaw_deg,pitch_deg,roll_deg";
  const std::string row = ",1,16.5,55.5,10,60,0,0,0";
  const std::string tiles = corpus("tiles/small_mission.csv");
  const std::string tiles_head = tiles.substr(0, tiles.find('\n') + 1);
  const std::string tile_row = tiles.substr(tiles_head.size(), tiles.find('\n', tiles_head.size()) - tiles_head.size());
  // Behind its number, level and column, which no two tiles have alike.
  const std::string of_tile = tile_row.substr(tile_row.find(',', tile_row.find(',', tile_row.find(',') + 1) + 1));
  const auto row_of_tile = [=](int i) { return text(i) + ",0," + text(i) + of_tile + "\n"; };
  const std::string key = "signer RWQDAwMDAwMDAwMDAwMDAwMDAwMDAwMDAwMDAwMDAwMDAwMDAwMDAwMD desk ";
  return {
      {"frames", wrapped(frames + "\n", [=](int i) { return "f" + text(i) + ".png" + row + "\n"; })},
      {"frames, columns",
       [=](int n) {
         return frames + many(n, [](int i) { return ",c" + text(i); }) + "\n" +
                many(n, [&](int i) { return "f" + text(i) + ".png" + row + "\n"; });
       }},
      {"frames, quotes", wrapped(
                             frames + "\n\"", [](int) { return std::string("\"\""); }, "\"" + row)},
      {"tiles", wrapped(tiles_head, row_of_tile)},
      {"tiles, columns",
       [=](int n) {
         const std::string line = tiles_head.substr(0, tiles_head.size() - 1);
         return line + many(n, [](int i) { return ",c" + text(i); }) + "\n" + many(n, row_of_tile);
       }},
      {"shard",
       [](int n) {
         const std::string shard = corpus("shard/all_measures.shard");
         return shard + many(n, [&](int) { return shard.substr(shard.rfind('\n', shard.size() - 2)); });
       },
       250, false},  // by its digest
      {"key_list", wrapped("pilotage key list 1\nversion 7\nvalid-until 2027-03-01T00:00:00Z\n",
                           [=](int i) { return key + text(i) + "\n"; })},
      {"key_list, comments", wrapped("pilotage key list 1\n", [](int i) { return "# " + text(i) + "\n"; })},
      {"signature",
       wrapped(
           "untrusted comment: ", [](int) { return std::string("a"); }, "\nRWQ=\n"),
       250, false},  // by its length
      {"signature, lines", wrapped(corpus("signature/prehashed.minisig"), [](int i) { return text(i) + "\n"; })},
      {"camera, YAML keys", wrapped("image_width: 640\n", [](int i) { return "k" + text(i) + ": 1\n"; })},
      {"camera, YAML list", wrapped("image_width: [", text, "]\n", ", ")},
      {"camera, YAML anchors", wrapped("", [](int i) { return "k" + text(i) + ": &a" + text(i) + " [1]\n"; })},
      {"camera, XML elements", wrapped(
                                   "<?xml version=\"1.0\"?><calibration>",
                                   [](int i) { return "<e" + text(i) + ">1</e" + text(i) + ">"; }, "</calibration>")},
      {"camera, COLMAP", wrapped("", [](int i) { return text(i) + " OPENCV 640 480 500 500 320 240 0 0 0 0\n"; })},
      {"options, keys", wrapped(
                            "{", [](int i) { return "\"k" + text(i) + "\": 1"; }, "}", ", ")},
      {"options, list", wrapped(
                            "{\"steps\": [", [](int) { return std::string("0.5"); }, "]}", ", ")},
      {"options, line", wrapped("", [](int) { return std::string("--imagery\na\n"); })},
      {"model", long_list("model/default.json", "/matchers", leave)},
      {"plan, tiles", long_list("plan/small_mission.json", "/tiles",
                                [](Json& element, int i) {
                                  element["tile_id"] = i;
                                  element["column"] = i;
                                })},
      {"plan, samples",
       long_list("plan/small_mission.json", "/route_samples", [](Json& element, int i) { element["distance_m"] = i; })},
      {"plan, vertices", long_list("plan/small_mission.json", "/route/vertices", leave)},
      {"plan, imagery", long_list("plan/small_mission.json", "/imagery", leave)},
      {"plan, levels",
       long_list("plan/small_mission.json", "/levels", [](Json& element, int i) { element["level"] = i; })},
      {"selection, gaps", long_list("selection/small_mission.json", "/gaps", leave)},
      {"selection, legs",
       long_list("selection/small_mission.json", "/legs", [](Json& element, int i) { element["leg"] = i + 1; })},
      {"selection, profile", long_list("selection/small_mission.json", "/error_profile",
                                       [](Json& element, int i) { element["distance_m"] = i; })},
      {"selection, tiles",
       long_list("selection/small_mission.json", "/tile_ids", [](Json& element, int i) { element = i; })},
      {"pack, files", long_list("pack/two_files.json", "/files",
                                [](Json& element, int i) {
                                  if (i > 0) element["name"] = "file" + text(i);
                                })},
      {"pack, inputs", long_list("pack/two_files.json", "/inputs", leave)},
      {"delta", [](int n) { return corpus("delta/moved.delta") + std::string(static_cast<std::size_t>(n) * 32, 'x'); },
       250, false},  // behind its end
      {"chunks",
       [](int n) { return corpus("chunks/two_chunks.chunks") + std::string(static_cast<std::size_t>(n) * 32, 'x'); },
       250, false},  // by the size that it states
  };
}

std::vector<Growing> routes() {
  const std::string kml = "<kml xmlns=\"http://www.opengis.net/kml/2.2\"><Document>";
  const auto position = [](int i) { return "10," + std::to_string(40 + 1e-4 * i) + ",100"; };
  const auto json_position = [](int i) { return "[10, " + std::to_string(40 + 1e-4 * i) + "]"; };
  const std::string track =
      "<kml xmlns=\"http://www.opengis.net/kml/2.2\" xmlns:gx=\"http://www.google.com/kml/ext/2.2\">"
      "<Placemark><gx:Track>";
  return {
      {"route, QGC WPL", wrapped("QGC WPL 110\n0\t1\t0\t16\t0\t0\t0\t0\t40\t10\t12\t1\n",
                                 [](int i) {
                                   return text(i + 1) + "\t0\t3\t16\t0\t0\t0\t0\t" + std::to_string(40 + 1e-4 * i) +
                                          "\t10\t80\t1\n";
                                 })},
      {"route, QGC WPL of jumps", wrapped("QGC WPL 110\n0\t1\t0\t16\t0\t0\t0\t0\t40\t10\t12\t1\n",
                                          [](int i) { return text(i + 1) + "\t0\t3\t177\t1\t1\t0\t0\t0\t0\t0\t1\n"; })},
      {"route, plan",
       [](int n) {
         Json plan = Json::parse(corpus("route/loop.plan"));
         Json& items = plan["mission"]["items"];
         const Json item = items[1];
         for (int i = 0; i < n; ++i) {
           items.push_back(item);
           items.back()["params"][4] = 47.01 + 1e-4 * i;
         }
         return plan.dump();
       }},
      {"route, plan of fences",
       [](int n) {
         Json plan = Json::parse(corpus("route/loop.plan"));
         const Json fence = {{"circle", {{"center", {47, 8}}, {"radius", 10}}}, {"inclusion", false}, {"version", 1}};
         for (int i = 0; i < n; ++i) plan["geoFence"]["circles"].push_back(fence);
         return plan.dump();
       }},
      {"route, Litchi", wrapped("latitude,longitude,altitude(m),heading(deg),curvesize(m),altitudemode,speed(m/s)\n",
                                [](int i) { return std::to_string(40 + 1e-4 * i) + ",8,100,0,0,0,8\n"; })},
      {"route, KML positions", wrapped(kml + "<Placemark><LineString><coordinates>", position,
                                       "</coordinates></LineString></Placemark></Document></kml>", " ")},
      {"route, KML lines", wrapped(
                               kml,
                               [=](int i) {
                                 return "<Placemark><LineString><coordinates>" + position(i) +
                                        " 11,50,100</coordinates></LineString></Placemark>";
                               },
                               "</Document></kml>")},
      {"route, KML folders",
       [=](int n) {
         return kml + many(n, [](int) { return std::string("<Folder>"); }) +
                many(n, [](int) { return std::string("</Folder>"); }) + "</Document></kml>";
       },
       50},
      {"route, KML attributes", wrapped(
                                    "<kml", [](int i) { return " a" + text(i) + "=\"1\""; }, "></kml>")},
      {"route, KML track",
       [=](int n) {
         return track + many(n, [](int i) { return "<when>2026-01-01T00:00:" + text(10 + i % 50) + "Z</when>"; }) +
                many(n, [](int i) { return "<gx:coord>10 " + std::to_string(40 + 1e-4 * i) + " 5</gx:coord>"; }) +
                "</gx:Track></Placemark></kml>";
       }},
      {"route, GPX",
       wrapped(
           "<gpx version=\"1.1\" creator=\"t\" xmlns=\"http://www.topografix.com/GPX/1/1\"><rte>",
           [](int i) { return "<rtept lat=\"" + std::to_string(40 + 1e-4 * i) + "\" lon=\"10\"/>"; }, "</rte></gpx>")},
      {"route, GPX of tracks",
       wrapped(
           "<gpx version=\"1.1\" creator=\"t\" xmlns=\"http://www.topografix.com/GPX/1/1\">",
           [](int i) {
             return "<trk><name>t" + text(i) +
                    "</name><trkseg><trkpt lat=\"40\" lon=\"10\"/><trkpt lat=\"41\" lon=\"10\"/></trkseg></trk>";
           },
           "</gpx>")},
      {"route, GeoJSON", wrapped("{\"type\": \"LineString\", \"coordinates\": [", json_position, "]}", ", ")},
      {"route, GeoJSON features", wrapped(
                                      "{\"type\": \"FeatureCollection\", \"features\": [",
                                      [=](int i) {
                                        return "{\"type\": \"Feature\", \"properties\": {\"p" + text(i) +
                                               "\": 1}, \"geometry\": {\"type\": \"Point\", "
                                               "\"coordinates\": " +
                                               json_position(i) + "}}";
                                      },
                                      "]}", ", ")},
      {"route, WPML",
       [](int n) {
         const std::string whole = corpus("route/waylines.wpml");
         const std::size_t begin = whole.find("<Placemark>");
         const std::size_t end = whole.rfind("</Placemark>") + std::string("</Placemark>").size();
         const std::size_t first_end = whole.find("</Placemark>") + std::string("</Placemark>").size();
         return whole.substr(0, begin) + many(n, [&](int) { return whole.substr(begin, first_end - begin); }) +
                whole.substr(end);
       }},
  };
}

std::string numbered_format(int i) {
  return "t" + std::to_string(i) + ":uint64_t timestamp;float x;";
}

std::vector<Growing> logs() {
  const std::string recording = "VehicleName\tTimeStamp\tPOS_X\tPOS_Y\tPOS_Z\tQ_W\tQ_X\tQ_Y\tQ_Z\tImageFile";
  const auto pose = [](int i) {
    return "Drone1\t" + std::to_string(1700000001000 + 1000LL * i) +
           "\t0\t6.3\t-120\t0.7071068\t0\t0\t0.7071068\ti.png\n";
  };
  const std::string ulog_begin =
      ulog_head() + ulog_flags(0) + ulog_format(kAttitudeFormat) + ulog_format(kPositionFormat);
  return {
      {"airsim_recording", wrapped(recording + "\n", pose)},
      {"airsim_recording, columns",
       [=](int n) {
         return many(n, [](int i) { return "c" + text(i) + "\t"; }) + recording + "\n" +
                many(n, [](int) { return std::string("Drone1\n"); });
       },
       250, false},  // of more than 1,000 columns
      {"airsim_recording, names",
       wrapped(recording + "\n", [=](int i) { return "D" + text(i) + pose(i).substr(std::string("Drone1").size()); })},
      {"ulog, records",
       [=](int n) {
         return ulog_begin + ulog_stream(1, "vehicle_attitude") +
                many(n, [](int i) { return ulog_record(1, ulog_attitude_record(0.1 * i, 90)); });
       }},
      {"ulog, formats",
       [=](int n) { return ulog_begin + many(n, [](int i) { return ulog_format(numbered_format(i)); }); }},
      {"ulog, nested formats",
       [=](int n) {
         return ulog_begin + many(n, [](int i) { return ulog_format("t" + text(i) + ":t" + text(i + 1) + " a;"); });
       }},
      {"ulog, fields",
       [=](int n) {
         return ulog_begin + ulog_format("wide:" + many(n, [](int i) { return "float f" + text(i) + ";"; })) +
                ulog_stream(1, "wide") + many(n, [](int) { return ulog_record(1, LogText().u(0, 8)); });
       }},
      {"ulog, streams",
       [=](int n) {
         return ulog_begin +
                many(n, [](int i) { return ulog_stream(static_cast<unsigned>(i), "vehicle_attitude", 1); }) +
                many(n, [](int i) { return ulog_record(static_cast<unsigned>(i), ulog_attitude_record(0.1 * i, 90)); });
       }},
      {"ulog, noise", [=](int n) { return ulog_begin + many(n, [](int i) { return text(i) + ulog_sync(); }); }},
      {"dataflash", [](int n) { return many(n / 50, [](int) { return small_dataflash(); }); }},
      {"dataflash, formats",
       [](int n) {
         return many(
             n, [](int i) { return dataflash_format(static_cast<unsigned>(i % 256), "A" + text(i % 100), "Q", "T"); });
       }},
      {"dataflash, noise",
       [](int n) { return small_dataflash() + many(n, [](int i) { return text(i) + "\xA3\x95"; }); }},
      {"telemetry", [](int n) { return many(n / 50, [](int) { return small_telemetry(); }); }},
      {"telemetry, systems",
       [](int n) {
         return many(n, [](int i) {
           return telemetry_record(2, 1e9 + i, 0, std::string(9, '\3'), 50, static_cast<std::uint8_t>(1 + i % 250));
         });
       }},
      {"telemetry, noise",
       [](int n) { return small_telemetry() + many(n, [](int i) { return text(i) + "\xFD\xFE"; }); }},
      {"airsim, list",
       [](int n) {
         return std::string("\x94\x00\x01\xA1m\xDC", 6) + static_cast<char>(n >> 8) + static_cast<char>(n) +
                std::string(static_cast<std::size_t>(n), '\1');
       }},
      {"airsim, map",
       [](int n) {
         return std::string("\x94\x00\x01\xA1m\x91\xDE", 7) + static_cast<char>(n >> 8) + static_cast<char>(n) +
                many(n, [](int i) { return "\xA5k" + std::to_string(1000 + i) + "\1"; });
       }},
      {"airsim, nesting",
       [](int n) { return std::string("\x94\x00\x01\xA1m", 5) + std::string(static_cast<std::size_t>(n), '\x91'); }},
  };
}

Growing maps() {
  return {"map",
          [](int n) {
            const testing::TemporaryFolder folder;
            testing::SmallMapOptions options;
            options.columns = n;
            options.rows = 4;
            options.levels = 1;
            testing::write_map(folder / "map.gpkg", testing::make_small_map(options));
            return read_file(folder / "map.gpkg");
          },
          30};
}

/// What the last doubling adds beside what the one before it added: 2 when work is in proportion, 2.2 with a logarithm,
/// 4 when it is the square. A few steps more are allowed, and none are needed where the largest are refused.
bool grows_as_the_input(const std::array<double, 4>& steps, double few) {
  constexpr double kMostGrowth = 2.7;
  return steps[3] - steps[2] <= kMostGrowth * std::max(0.0, steps[2] - steps[1]) + few;
}

std::string counts(const std::array<double, 4>& steps) {
  std::string words;
  for (const double count : steps) words += std::to_string(static_cast<std::int64_t>(count)) + " ";
  return words;
}

void PrintTo(const Growing& growing, std::ostream* out) {
  *out << growing.name;
}

bool is_of(const Growing& growing, const FuzzTarget& target) {
  return growing.name == target.name || growing.name.starts_with(std::string(target.name) + ", ");
}

class Growth : public ::testing::TestWithParam<Growing> {};

TEST_P(Growth, IsThatOfTheInput) {
  const Growing& growing = GetParam();
  const auto target = std::find_if(std::begin(kFuzzTargets), std::end(kFuzzTargets),
                                   [&](const FuzzTarget& one) { return is_of(growing, one); });
  ASSERT_NE(target, std::end(kFuzzTargets));
  std::array<double, 4> blocks{};
  std::array<double, 4> allocations{};
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const std::string input = growing.make(growing.parts << i);
    const std::vector<std::uint8_t> bytes(input.begin(), input.end());
    if (i == 0) target->run(bytes.data(), bytes.size());  // what is made once is made now
    const testing::CountedSteps before = testing::counted_steps();
    target->run(bytes.data(), bytes.size());
    const testing::CountedSteps after = testing::counted_steps();
    blocks[i] = static_cast<double>(after.blocks - before.blocks);
    allocations[i] = static_cast<double>(after.allocations - before.allocations);
  }
  EXPECT_EQ(blocks[3] > 2 * blocks[0], growing.read) << counts(blocks) << "blocks";
  EXPECT_TRUE(grows_as_the_input(blocks, 20'000)) << counts(blocks) << "blocks";
  EXPECT_TRUE(grows_as_the_input(allocations, 1'000)) << counts(allocations) << "allocations";
}

std::vector<Growing> all() {
  std::vector<Growing> growing = tables_and_lists();
  for (const auto& more : {routes(), logs(), std::vector{maps()}})
    growing.insert(growing.end(), more.begin(), more.end());
  return growing;
}

INSTANTIATE_TEST_SUITE_P(Readers, Growth, ::testing::ValuesIn(all()), [](const auto& one) {
  std::string name = one.param.name;
  std::replace_if(
      name.begin(), name.end(), [](unsigned char letter) { return std::isalnum(letter) == 0; }, '_');
  return name;
});

TEST(GrowthTest, TellsSquaresFromLogarithms) {
  const auto steps = [](double (*work)(double n)) {
    return std::array<double, 4>{1e5 + work(1e4), 1e5 + work(2e4), 1e5 + work(4e4), 1e5 + work(8e4)};
  };
  EXPECT_TRUE(grows_as_the_input(steps([](double n) { return n; }), 0));
  EXPECT_TRUE(grows_as_the_input(steps([](double n) { return n * std::log(n); }), 0));
  EXPECT_FALSE(grows_as_the_input(steps([](double n) { return n * std::sqrt(n); }), 0));
  EXPECT_FALSE(grows_as_the_input(steps([](double n) { return n * n / 1e4; }), 0));
  EXPECT_TRUE(grows_as_the_input({1e5, 2e5, 1e3, 1e3}, 0)) << "the largest are refused";
}

// Each reader that takes bytes of others is among them, but match, whose input is of one size.
TEST(GrowthTest, KnowsEveryTarget) {
  for (const FuzzTarget& target : kFuzzTargets) {
    if (target.name == "match") continue;
    const std::vector<Growing> growing = all();
    EXPECT_TRUE(std::any_of(growing.begin(), growing.end(), [&](const Growing& one) { return is_of(one, target); }))
        << target.name;
  }
}

}  // namespace
}  // namespace pilotage
