#include "pilotage/mapdb/geopackage_rows.h"

#include <charconv>
#include <optional>

#include "pilotage/base/source_date.h"
#include "pilotage/mapdb/map_tables.h"

namespace pilotage {
namespace {

constexpr std::int64_t kCustomSrsId = 100000;
constexpr const char* kDefinition = "schemas/pilotage_descriptors.md";
constexpr const char* kWgs84Wkt =
    R"wkt(GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563,AUTHORITY["EPSG","7030"]],)wkt"
    R"wkt(AUTHORITY["EPSG","6326"]],PRIMEM["Greenwich",0,AUTHORITY["EPSG","8901"]],)wkt"
    R"wkt(UNIT["degree",0.0174532925199433,AUTHORITY["EPSG","9122"]],)wkt"
    R"wkt(AXIS["Latitude",NORTH],AXIS["Longitude",EAST],AUTHORITY["EPSG","4326"]])wkt";
constexpr const char* kWgs84Wkt2 =
    R"wkt(GEOGCRS["WGS 84",DATUM["World Geodetic System 1984",ELLIPSOID["WGS 84",6378137,298.257223563]],)wkt"
    R"wkt(CS[ellipsoidal,2],AXIS["geodetic latitude (Lat)",north],AXIS["geodetic longitude (Lon)",east],)wkt"
    R"wkt(ANGLEUNIT["degree",0.0174532925199433],ID["EPSG",4326]])wkt";

/// The code of an authority like "EPSG:32750", when it may serve as srs_id.
std::optional<std::int64_t> authority_code(const std::string& authority) {
  const std::size_t colon = authority.find(':');
  if (colon == std::string::npos || colon == 0) return std::nullopt;
  std::int64_t code = 0;
  const char* last = authority.data() + authority.size();
  const auto [end, error] = std::from_chars(authority.data() + colon + 1, last, code);
  if (error != std::errc{} || end != last || code < 1 || code >= kCustomSrsId || code == 4326) return std::nullopt;
  return code;
}

}  // namespace

std::string geopackage_timestamp() {
  std::string text = format_utc_time(source_date().value_or(UtcTime{}));
  return text.insert(text.size() - 1, ".000");  // milliseconds, as GeoPackage writes them
}

bool is_wkt2(std::string_view wkt) {
  for (const char* keyword : {"PROJCRS", "PROJECTEDCRS", "GEOGCRS", "GEODCRS", "GEODETICCRS", "GEOGRAPHICCRS",
                              "BOUNDCRS", "DERIVEDPROJCRS", "COMPOUNDCRS", "ENGCRS", "ENGINEERINGCRS"}) {
    if (wkt.starts_with(keyword)) return true;
  }
  return false;
}

std::int64_t srs_id_of(const MapCrs& crs) {
  return authority_code(crs.authority).value_or(kCustomSrsId);
}

std::string insert_sql(std::string_view table, int count) {
  std::string sql = "INSERT INTO ";
  sql.append(table).append(" VALUES (?");
  for (int i = 1; i < count; ++i) sql += ",?";
  return sql + ")";
}

void insert_spatial_reference_systems(const Database& database, const MapCrs& crs) {
  const bool wkt2 = is_wkt2(crs.wkt);
  const std::optional<std::int64_t> code = authority_code(crs.authority);
  const std::int64_t srs_id = srs_id_of(crs);
  Statement insert = database.prepare(insert_sql("gpkg_spatial_ref_sys", wkt2 ? 7 : 6), "gpkg_spatial_ref_sys");
  const auto add = [&](const std::string& name, std::int64_t id, const std::string& organization,
                       const std::string& definition, const std::string& definition2) {
    insert.bind(1, std::string_view(name)).bind(2, id).bind(3, std::string_view(organization)).bind(4, id);
    insert.bind(5, std::string_view(definition)).bind_null(6);
    if (wkt2) insert.bind(7, std::string_view(definition2));
    insert.run();
  };
  add("Undefined Cartesian SRS", -1, "NONE", "undefined", "undefined");
  add("Undefined geographic SRS", 0, "NONE", "undefined", "undefined");
  add("WGS 84 geodetic", 4326, "EPSG", kWgs84Wkt, kWgs84Wkt2);
  const std::string organization = code ? crs.authority.substr(0, crs.authority.find(':')) : std::string("NONE");
  add(crs.name, srs_id, organization, wkt2 ? "undefined" : crs.wkt, crs.wkt);
}

void insert_extensions(const Database& database, bool wkt2, bool chips, bool landmarks) {
  Statement insert = database.prepare(insert_sql("gpkg_extensions", 5), "gpkg_extensions");
  const auto add = [&](std::string_view table, std::string_view column, std::string_view name,
                       std::string_view definition, std::string_view scope) {
    insert.bind(1, table).bind(3, name).bind(4, definition).bind(5, scope);
    if (!column.empty()) insert.bind(2, column);
    insert.run();
  };
  add("tiles", "geom", "gpkg_rtree_index", "http://www.geopackage.org/spec130/#extension_rtree", "write-only");
  if (wkt2) {
    add("gpkg_spatial_ref_sys", "definition_12_063", "gpkg_crs_wkt",
        "http://www.geopackage.org/spec130/#extension_crs_wkt", "read-write");
  }
  for (const char* table : {"gpkg_data_columns", "gpkg_data_column_constraints"}) {
    add(table, "", "gpkg_schema", "http://www.geopackage.org/spec130/#extension_schema", "read-write");
  }
  for (const std::string_view table :
       {std::string_view("pilotage_levels"), std::string_view("pilotage_descriptors"), kCenterIndex}) {
    add(table, "", "pilotage_descriptors", kDefinition, "read-write");
  }
  if (chips) add("pilotage_chips", "", "pilotage_chips", kDefinition, "read-write");
  if (landmarks) add("pilotage_detectors", "", "pilotage_landmarks", kDefinition, "read-write");
}

void insert_column_descriptions(const Database& database, std::string_view table,
                                const std::vector<MapColumn>& columns) {
  Statement insert = database.prepare(
      "INSERT INTO gpkg_data_columns (table_name, column_name, description) VALUES (?, ?, ?)", "gpkg_data_columns");
  for (const MapColumn& column : columns) {
    if (column.description.empty()) continue;
    insert.bind(1, table).bind(2, std::string_view(column.name)).bind(3, std::string_view(column.description));
    insert.run();
  }
}

}  // namespace pilotage
