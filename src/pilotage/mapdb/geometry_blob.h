#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pilotage/geo/bounds.h"
#include "pilotage/geo/geodetic_point.h"

namespace pilotage {

// GeoPackageBinary (OGC 12-128r17, clause 2.1.3): a header with an envelope, then OGC well-known binary, little-endian.

/// The outline of `bounds`, counter-clockwise from its lower left corner.
std::vector<std::uint8_t> polygon_blob(const Bounds& bounds, std::int32_t srs_id);

/// A point in EPSG:4326.
std::vector<std::uint8_t> point_blob(GeodeticPoint point);

/// A line through points in degrees, cut where it crosses the antimeridian: each part has longitudes in [-180, 180].
/// Points are joined the short way round. Always one part at least.
std::vector<std::vector<GeodeticPoint>> cut_at_antimeridian(const std::vector<GeodeticPoint>& points);

/// A LINESTRING (`multi` false; one part) or MULTILINESTRING in EPSG:4326.
std::vector<std::uint8_t> line_blob(const std::vector<std::vector<GeodeticPoint>>& parts, bool multi);

/// The parts of what line_blob made. Throws DataError beginning with `where` when the bytes are anything else.
std::vector<std::vector<GeodeticPoint>> parse_line_blob(std::span<const std::uint8_t> blob, const std::string& where);

}  // namespace pilotage
