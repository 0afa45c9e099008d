#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "onboard_module.h"
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/utc_time.h"
#include "pilotage/mapdb/map_purpose.h"
#include "pilotage/mapdb/map_reader.h"
#include "pilotage/vision/descriptor.h"

namespace py = pybind11;

namespace pilotage::python {
namespace {

/// A tile as numpy has it.
struct TileRecord {
  std::int64_t tile_id, level, column, row;
  double min_x_m, min_y_m, max_x_m, max_y_m, lon_deg, lat_deg;
};
struct NearTileRecord {
  std::int64_t tile_id, level, column, row;
  double min_x_m, min_y_m, max_x_m, max_y_m, lon_deg, lat_deg, distance_m;
};

template <class Record>
Record record_of(const MapTile& tile) {
  Record record{};
  record.tile_id = tile.tile_id;
  record.level = tile.level;
  record.column = tile.column;
  record.row = tile.row;
  record.min_x_m = tile.bounds.min_x_m;
  record.min_y_m = tile.bounds.min_y_m;
  record.max_x_m = tile.bounds.max_x_m;
  record.max_y_m = tile.bounds.max_y_m;
  record.lon_deg = tile.center.lon_deg;
  record.lat_deg = tile.center.lat_deg;
  return record;
}

/// What a tile stores, held by what numpy is shown of it.
struct StoredDescriptors {
  std::shared_ptr<const TileDescriptors> row;
  TileMatrix matrix;
};
struct StoredChip {
  std::shared_ptr<const DecodedChip> chip;
};

py::array read_only(py::array array) {
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

/// The memory of `owner` as numpy sees it, without a copy; it lives as long as the array does.
template <class Element>
py::array view_of(const Element* data, std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides,
                  const py::object& owner) {
  return read_only(py::array(py::dtype::of<Element>(), std::move(shape), std::move(strides), data, owner));
}

/// Positions and octaves as they lie in the row; a map stores no response.
py::array keypoints(const py::object& self) {
  const auto& features = self.cast<const StoredDescriptors&>().row->features.features;
  const py::list names(py::make_tuple("x_px", "y_px", "octave"));
  const py::list formats(py::make_tuple(py::dtype::of<float>(), py::dtype::of<float>(), py::dtype::of<int>()));
  const py::list offsets(py::make_tuple(offsetof(Feature, x_px), offsetof(Feature, y_px), offsetof(Feature, octave)));
  const py::dtype type(names, formats, offsets, sizeof(Feature));
  return read_only(py::array(type, {features.size()}, {sizeof(Feature)}, features.data(), self));
}

py::array descriptor_bytes(const py::object& self) {
  const FeatureSet& set = self.cast<const StoredDescriptors&>().row->features;
  return view_of(set.descriptors.data(), {static_cast<py::ssize_t>(set.size()), set.descriptor_bytes},
                 {set.descriptor_bytes, 1}, self);
}

std::optional<py::array> ground_heights(const py::object& self) {
  const std::vector<float>& heights = self.cast<const StoredDescriptors&>().row->ground_height_m;
  if (heights.empty()) return std::nullopt;
  return view_of(heights.data(), {static_cast<py::ssize_t>(heights.size())}, {sizeof(float)}, self);
}

py::array_t<double> grid_points(const StoredDescriptors& stored) {
  const std::vector<Feature>& features = stored.row->features.features;
  py::array_t<double> points({features.size(), std::size_t{2}});
  auto at = points.mutable_unchecked<2>();
  for (std::size_t i = 0; i < features.size(); ++i) {
    const Eigen::Vector2d pixel(static_cast<double>(stored.row->window.col) + static_cast<double>(features[i].x_px),
                                static_cast<double>(stored.row->window.row) + static_cast<double>(features[i].y_px));
    const Eigen::Vector2d point_m = stored.matrix.map_from_pixel.map_from_pixel(pixel);
    at(static_cast<py::ssize_t>(i), 0) = point_m.x();
    at(static_cast<py::ssize_t>(i), 1) = point_m.y();
  }
  return points;
}

py::array pixels_of(const cv::Mat& picture, const py::object& owner) {
  return view_of(picture.ptr<std::uint8_t>(), {picture.rows, picture.cols},
                 {static_cast<py::ssize_t>(picture.step[0]), 1}, owner);
}

py::tuple window_of(const PixelWindow& window) {
  return py::make_tuple(window.col, window.row, window.width, window.height);
}

/// A tile's level; of a tile that the map does not have, nothing.
std::optional<int> level_of(MapReader& reader, std::int64_t tile_id, std::optional<int> level) {
  if (level) return level;
  const std::optional<MapTile> tile = reader.tile(tile_id);
  return tile ? std::optional<int>(tile->level) : std::nullopt;
}

std::optional<StoredDescriptors> descriptors_of(SharedMap& map, std::int64_t tile_id, std::optional<int> level) {
  return map.use([&](MapReader& reader) -> std::optional<StoredDescriptors> {
    const std::optional<int> at = level_of(reader, tile_id, level);
    const MapLevel* const found = at ? reader.find_level(*at) : nullptr;
    if (found == nullptr) return std::nullopt;
    std::shared_ptr<const TileDescriptors> row = reader.descriptors(tile_id, *at);
    if (!row) return std::nullopt;
    return StoredDescriptors{std::move(row), found->matrix};
  });
}

std::optional<StoredChip> chip_of(SharedMap& map, std::int64_t tile_id, std::optional<int> level) {
  return map.use([&](MapReader& reader) -> std::optional<StoredChip> {
    const std::optional<int> at = level_of(reader, tile_id, level);
    std::shared_ptr<const DecodedChip> chip = at ? reader.decoded_chip(tile_id, *at) : nullptr;
    if (!chip) return std::nullopt;
    return StoredChip{std::move(chip)};
  });
}

py::array_t<TileRecord> tiles(SharedMap& map, std::optional<int> level) {
  const std::vector<MapTile> found = map.use([&](MapReader& reader) { return reader.tiles(level); });
  std::vector<TileRecord> records;
  for (const MapTile& tile : found) records.push_back(record_of<TileRecord>(tile));
  return py::array_t<TileRecord>(static_cast<py::ssize_t>(records.size()), records.data());
}

py::array_t<NearTileRecord> near(SharedMap& map, double lon_deg, double lat_deg, double radius_m,
                                 std::optional<int> level) {
  const std::vector<NearTile> found = map.use([&](MapReader& reader) {
    return reader.tiles_near(GeodeticPoint{lon_deg, lat_deg}, radius_m, level);
  });
  std::vector<NearTileRecord> records;
  for (const NearTile& tile : found) {
    records.push_back(record_of<NearTileRecord>(tile.tile));
    records.back().distance_m = tile.distance_m;
  }
  return py::array_t<NearTileRecord>(static_cast<py::ssize_t>(records.size()), records.data());
}

py::object object_of(const MapValue& value) {
  return std::visit(
      [](const auto& held) -> py::object {
        if constexpr (std::is_same_v<std::decay_t<decltype(held)>, std::monostate>) {
          return py::none();
        } else {
          return py::cast(held);
        }
      },
      value);
}

py::dict tile_values(SharedMap& map, std::int64_t tile_id) {
  const auto values = map.use([&](MapReader& reader) { return reader.tile_values(tile_id); });
  if (!values) throw UsageError("tile_id = " + std::to_string(tile_id) + ": the map has no such tile");
  py::dict result;
  for (std::size_t i = 0; i < values->size(); ++i) {
    result[py::str(map.reader().tile_columns()[i].name)] = object_of((*values)[i]);
  }
  return result;
}

py::list levels(const SharedMap& map) {
  py::list result;
  for (const MapLevel& level : map.reader().levels()) {
    py::dict item;
    item["level"] = level.matrix.level;
    item["gsd_m"] = level.gsd_m;
    item["tile_size_px"] = level.matrix.tile_size_px;
    item["stride_px"] = level.matrix.stride_px;
    item["min_agl_m"] = level.min_agl_m;
    item["max_agl_m"] = level.max_agl_m;
    result.append(item);
  }
  return result;
}

py::dict info(const SharedMap& map) {
  const MapInfo& said = map.reader().info();
  py::dict result;
  result["schema_version"] = said.schema_version;
  result["crs"] = said.crs.name;
  result["crs_authority"] = said.crs.authority;
  result["crs_wkt"] = said.crs.wkt;
  py::dict entries;
  for (const MapInfoEntry& entry : said.entries) entries[py::str(entry.key)] = entry.value;
  result["entries"] = entries;
  return result;
}

py::dict purpose(const SharedMap& map) {
  const MapPurpose& said = map.reader().purpose();
  py::dict result;
  result["mission_name"] = said.mission_name;
  result["map_version"] = said.map_version;
  result["created"] = said.created ? std::optional(format_utc_time(*said.created)) : std::nullopt;
  result["valid_until"] = said.valid_until ? std::optional(format_utc_time(*said.valid_until)) : std::nullopt;
  return result;
}

void check_purpose_of(SharedMap& map, const std::optional<std::string>& mission_name,
                      std::optional<std::int64_t> min_version, const std::optional<Camera>& camera,
                      const std::optional<std::string>& now) {
  MapRequirements required{mission_name, min_version, camera, std::nullopt};
  if (now) {
    required.now = parse_utc_time(*now);
    if (!required.now) throw UsageError("now = \"" + *now + "\" is no moment in UTC, as 2027-01-01T00:00:00Z");
  }
  map.use([&](MapReader& reader) { check_purpose(reader, required); });
}

/// One key or several, each as its text or as the file that holds it.
std::vector<std::string> keys_of(const py::object& given) {
  const py::object fsdecode = py::module_::import("os").attr("fsdecode");
  const bool alone =
      py::isinstance<py::str>(given) || py::isinstance<py::bytes>(given) || py::hasattr(given, "__fspath__");
  std::vector<std::string> keys;
  for (const py::handle key : alone ? py::object(py::make_tuple(given)) : given) {
    keys.push_back(fsdecode(key).cast<std::string>());
  }
  if (keys.empty()) throw UsageError("trusted_keys is empty; None opens a map that nobody vouches for");
  return keys;
}

std::shared_ptr<SharedMap> open_map(const py::object& path, const py::object& trusted_keys, std::size_t cache_bytes) {
  const std::string file = py::bytes(py::module_::import("os").attr("fsencode")(path));
  if (trusted_keys.is_none()) {
    const py::gil_scoped_release released;
    return std::make_shared<SharedMap>(MapReader::open_unverified(file, cache_bytes));
  }
  const std::vector<std::string> keys = keys_of(trusted_keys);
  const py::gil_scoped_release released;
  return std::make_shared<SharedMap>(MapReader::open(file, keys, cache_bytes));
}

}  // namespace

void bind_map(py::module_& module) {
  PYBIND11_NUMPY_DTYPE(TileRecord, tile_id, level, column, row, min_x_m, min_y_m, max_x_m, max_y_m, lon_deg, lat_deg);
  PYBIND11_NUMPY_DTYPE(NearTileRecord, tile_id, level, column, row, min_x_m, min_y_m, max_x_m, max_y_m, lon_deg,
                       lat_deg, distance_m);

  py::class_<StoredDescriptors>(module, "TileDescriptors",
                                "What a map stores of one tile at one level. Arrays are views, not copies.")
      .def_property_readonly(
          "keypoints", &keypoints,
          "Structured array (n,): x_px, y_px (float32, from the window's outer top-left corner) and octave (int32).")
      .def_property_readonly("descriptors", &descriptor_bytes, "uint8[n, bytes]: one row for each key point.")
      .def_property_readonly(
          "ground_height_m", &ground_heights,
          "float32[n]: height of the ground above mean sea level, NaN where unknown; None where no height is known.")
      .def_property_readonly(
          "window", [](const StoredDescriptors& stored) { return window_of(stored.row->window); },
          "(column, row, width, height) in pixels of the level: the cell whose descriptors these are.")
      .def_property_readonly("level", [](const StoredDescriptors& stored) { return stored.row->level; })
      .def("grid_points_m", &grid_points, "float64[n, 2]: easting and northing of the key points in the map's CRS.")
      .def("__len__", [](const StoredDescriptors& stored) { return stored.row->features.size(); });

  py::class_<StoredChip>(module, "Chip",
                         "The small gray picture that a map stores of a tile. Arrays are views, not copies.")
      .def_property_readonly(
          "gray",
          [](const py::object& self) { return pixels_of(self.cast<const StoredChip&>().chip->picture.gray, self); },
          "uint8[rows, columns].")
      .def_property_readonly(
          "valid",
          [](const py::object& self) { return pixels_of(self.cast<const StoredChip&>().chip->picture.valid, self); },
          "uint8[rows, columns]: 255 where there is ground, else 0.")
      .def_property_readonly(
          "factor", [](const StoredChip& stored) { return stored.chip->picture.factor; },
          "Side of a chip's pixel in pixels of the level.")
      .def_property_readonly(
          "window", [](const StoredChip& stored) { return window_of(stored.chip->window); },
          "(column, row, width, height) in pixels of the level: the ground that it shows.");

  py::class_<SharedMap, std::shared_ptr<SharedMap>>(
      module, "Map",
      "An onboard map database (schemas/map-database.md), read-only.\n\n"
      "Any number of threads may use one; they take turns. For matching in parallel open one for each thread.")
      .def(py::init(&open_map), py::arg("path"), py::kw_only(), py::arg("trusted_keys") = py::none(),
           py::arg("cache_bytes") = kDefaultTileCacheBytes,
           "Opens a map that one of `trusted_keys` signed: minisign public keys, or their files. Without keys whatever "
           "the file holds, and\n"
           "nobody says who wrote it: for the ground. `cache_bytes` bounds the memory for decoded tiles.\n\n"
           "Throws IntegrityError for a wrong signature, DataError for a file that is no map, UsageError for a key "
           "that is none.")
      .def_property_readonly("name", [](const SharedMap& map) { return python_text(map.reader().name()); })
      .def_property_readonly("info", &info,
                             "dict: schema_version, crs, crs_authority, crs_wkt, and the entries of map_info.")
      .def_property_readonly("purpose", &purpose,
                             "dict: mission_name, map_version, created, valid_until; None where it says nothing.")
      .def_property_readonly("levels", &levels,
                             "A dict for each level: gsd_m, tile_size_px, stride_px, min_agl_m, max_agl_m.")
      .def_property_readonly(
          "camera", [](const SharedMap& map) { return map.reader().camera(); },
          "The Camera that the map was prepared for; None where it does not say.")
      .def_property_readonly(
          "elevation_sigma_m", [](const SharedMap& map) { return map.reader().elevation_sigma_m(); },
          "Standard deviation of the ground's heights; None where it does not say.")
      .def_property_readonly("has_chips", [](const SharedMap& map) { return map.reader().has_chips(); })
      .def_property_readonly("has_landmarks", [](const SharedMap& map) { return map.reader().has_landmarks(); })
      .def("tiles", &tiles, py::arg("level") = py::none(),
           "The tiles by ascending number, as a structured array: tile_id, level, column, row, min_x_m … max_y_m (the "
           "footprint in the\n"
           "map's CRS), lon_deg, lat_deg (its centre).")
      .def("near", &near, py::arg("lon_deg"), py::arg("lat_deg"), py::arg("radius_m"), py::arg("level") = py::none(),
           "Tiles whose footprint comes within `radius_m` of a point on the ground, nearest first: as tiles(), with "
           "distance_m.\n\n"
           "Throws UsageError for a latitude beyond the poles, and unless radius_m is in [0, 100000].")
      .def("tile_values", &tile_values, py::arg("tile_id"),
           "dict: what the stages said of a tile (schemas/tiles-csv.md); None where nothing is known. Throws "
           "UsageError for no tile.")
      .def("descriptors", &descriptors_of, py::arg("tile_id"), py::arg("level") = py::none(),
           "TileDescriptors of a tile at its own level, or at `level`; None when the map has none.")
      .def("chip", &chip_of, py::arg("tile_id"), py::arg("level") = py::none(),
           "The Chip of a tile likewise; None when the map has none.")
      .def("check_purpose", &check_purpose_of, py::kw_only(), py::arg("mission_name") = py::none(),
           py::arg("min_version") = py::none(), py::arg("camera") = py::none(), py::arg("now") = py::none(),
           "Throws IntegrityError when the map is not for this mission, is older than this version, was prepared for "
           "another camera, or\n"
           "has expired `now` (2027-01-01T00:00:00Z), or does not say what one of these asks for.")
      .def("__repr__", [](const SharedMap& map) { return python_text("Map('" + map.reader().name() + "')"); });
}

}  // namespace pilotage::python
