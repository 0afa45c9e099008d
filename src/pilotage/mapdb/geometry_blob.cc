#include "pilotage/mapdb/geometry_blob.h"

#include <algorithm>
#include <cmath>

#include "pilotage/base/error.h"
#include "pilotage/mapdb/byte_order.h"

namespace pilotage {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Line = std::vector<GeodeticPoint>;

constexpr std::uint32_t kPoint = 1;
constexpr std::uint32_t kLineString = 2;
constexpr std::uint32_t kPolygon = 3;
constexpr std::uint32_t kMultiLineString = 5;
constexpr std::int32_t kWgs84SrsId = 4326;
constexpr std::size_t kHeaderBytes = 40;

/// Flags 0x03: little-endian, envelope [min x, max x, min y, max y].
Bytes header(const Bounds& envelope, std::int32_t srs_id) {
  Bytes bytes = {'G', 'P', 0, 0x03};
  append_le(bytes, srs_id);
  for (const double edge : {envelope.min_x_m, envelope.max_x_m, envelope.min_y_m, envelope.max_y_m}) {
    append_le(bytes, edge);
  }
  return bytes;
}

void append_type(Bytes& bytes, std::uint32_t type, std::size_t count) {
  bytes.push_back(1);  // little-endian
  append_le(bytes, type);
  append_le(bytes, static_cast<std::uint32_t>(count));
}

bool all_equal(const Line& line) {
  return std::all_of(line.begin(), line.end(), [&](GeodeticPoint p) {
    return p.lon_deg == line.front().lon_deg && p.lat_deg == line.front().lat_deg;
  });
}

/// Reads forward; every read checks that the bytes are there.
class Cursor {
 public:
  Cursor(std::span<const std::uint8_t> bytes, const std::string& where) : bytes_(bytes), where_(where) {}

  template <class T>
  T next() {
    need(sizeof(T));
    const T value = read_le<T>(bytes_.data() + at_);
    at_ += sizeof(T);
    return value;
  }
  double next_double() {
    need(sizeof(double));
    const double value = read_le_double(bytes_.data() + at_);
    at_ += sizeof(double);
    return value;
  }
  void need(std::size_t bytes) const {
    if (bytes_.size() - at_ < bytes) fail("is shorter than it says");
  }
  void skip(std::size_t bytes) {
    need(bytes);
    at_ += bytes;
  }
  bool at_end() const { return at_ == bytes_.size(); }
  [[noreturn]] void fail(const char* what) const { throw DataError(where_ + ": geometry blob " + what); }

 private:
  std::span<const std::uint8_t> bytes_;
  const std::string& where_;
  std::size_t at_ = 0;
};

Line parse_line(Cursor& cursor) {
  const auto count = cursor.next<std::uint32_t>();
  cursor.need(std::size_t{count} * 16);
  Line line(count);
  for (GeodeticPoint& point : line) {
    point.lon_deg = cursor.next_double();
    point.lat_deg = cursor.next_double();
    if (!(std::abs(point.lon_deg) <= 180 && std::abs(point.lat_deg) <= 90)) cursor.fail("has a point not on Earth");
  }
  if (count < 2) cursor.fail("has a line of less than two points");
  return line;
}

std::uint32_t parse_type(Cursor& cursor) {
  if (cursor.next<std::uint8_t>() != 1) cursor.fail("is not little-endian");
  return cursor.next<std::uint32_t>();
}

}  // namespace

std::vector<std::uint8_t> polygon_blob(const Bounds& b, std::int32_t srs_id) {
  Bytes bytes = header(b, srs_id);
  append_type(bytes, kPolygon, 1);
  append_le(bytes, std::uint32_t{5});
  for (const auto& [x, y] : {std::pair{b.min_x_m, b.min_y_m},
                             {b.max_x_m, b.min_y_m},
                             {b.max_x_m, b.max_y_m},
                             {b.min_x_m, b.max_y_m},
                             {b.min_x_m, b.min_y_m}}) {
    append_le(bytes, x);
    append_le(bytes, y);
  }
  return bytes;
}

std::vector<Line> cut_at_antimeridian(const Line& points) {
  std::vector<Line> parts(1);
  if (points.empty()) return parts;
  // Longitudes without jumps; the strip [turn − 180, turn + 180] is the one the current part lies in.
  double lon = wrap_lon_deg(points.front().lon_deg);
  double turn = 0;
  parts.back().push_back({lon, points.front().lat_deg});
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double next = unwrap_lon_deg(points[i].lon_deg, lon);
    if (next < turn - 180 || next > turn + 180) {
      const double side = next > lon ? 180 : -180;
      const double part = (turn + side - lon) / (next - lon);
      const double lat = points[i - 1].lat_deg + part * (points[i].lat_deg - points[i - 1].lat_deg);
      parts.back().push_back({side, lat});
      turn += 2 * side;
      parts.push_back({{-side, lat}});
    }
    parts.back().push_back({next - turn, points[i].lat_deg});
    lon = next;
  }
  // A line that starts or ends on the antimeridian leaves parts without length.
  if (parts.size() > 1) std::erase_if(parts, all_equal);
  if (parts.empty()) parts.push_back({points.front(), points.front()});
  return parts;
}

std::vector<std::uint8_t> point_blob(GeodeticPoint point) {
  Bounds envelope;
  envelope.extend({point.lon_deg, point.lat_deg});
  Bytes bytes = header(envelope, kWgs84SrsId);
  bytes.push_back(1);  // little-endian
  append_le(bytes, kPoint);
  append_le(bytes, point.lon_deg);
  append_le(bytes, point.lat_deg);
  return bytes;
}

std::vector<std::uint8_t> line_blob(const std::vector<Line>& parts, bool multi) {
  Bounds envelope;
  for (const Line& line : parts) {
    for (const GeodeticPoint point : line) envelope.extend({point.lon_deg, point.lat_deg});
  }
  Bytes bytes = header(envelope, kWgs84SrsId);
  if (multi) append_type(bytes, kMultiLineString, parts.size());
  for (const Line& line : parts) {
    append_type(bytes, kLineString, line.size());
    for (const GeodeticPoint point : line) {
      append_le(bytes, point.lon_deg);
      append_le(bytes, point.lat_deg);
    }
  }
  return bytes;
}

std::vector<Line> parse_line_blob(std::span<const std::uint8_t> blob, const std::string& where) {
  Cursor cursor(blob, where);
  cursor.need(kHeaderBytes);
  if (blob[0] != 'G' || blob[1] != 'P' || blob[2] != 0 || blob[3] != 0x03 ||
      read_le<std::uint32_t>(blob.data() + 4) != static_cast<std::uint32_t>(kWgs84SrsId)) {
    cursor.fail("does not begin as a GeoPackage geometry in EPSG:4326");
  }
  cursor.skip(kHeaderBytes);
  std::vector<Line> parts;
  const std::uint32_t type = parse_type(cursor);
  if (type == kLineString) {
    parts.push_back(parse_line(cursor));
  } else if (type == kMultiLineString) {
    const auto count = cursor.next<std::uint32_t>();
    for (std::uint32_t i = 0; i < count; ++i) {
      if (parse_type(cursor) != kLineString) cursor.fail("holds something other than lines");
      parts.push_back(parse_line(cursor));
    }
  } else {
    cursor.fail("is not a line");
  }
  if (!cursor.at_end()) cursor.fail("is longer than it says");
  return parts;
}

}  // namespace pilotage
