#include "pilotage/route/ogr_track.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"
#include "pilotage/raster/gdal_xml.h"
#include "pilotage/route/route_builder.h"

namespace pilotage {
namespace {

double when_s(const std::string& text) {
  OGRField field;
  if (text.find('-') == std::string::npos || OGRParseDate(text.c_str(), &field, 0) == FALSE) return kNaN;
  return seconds_of(field);
}

/// "lon lat height" or "lon lat"; nothing for an empty element, which stands for a position that is not known.
bool read_coord(const std::string& text, LinePoint& point) {
  std::vector<double> numbers;
  for (std::size_t begin = 0; (begin = text.find_first_not_of(" \t\r\n", begin)) != std::string::npos;) {
    const std::size_t end = std::min(text.find_first_of(" \t\r\n", begin), text.size());
    numbers.push_back(parse_number(std::string_view(text).substr(begin, end - begin)).value_or(kNaN));
    begin = end;
  }
  if (numbers.size() < 2) return false;
  point.x = numbers[0];
  point.y = numbers[1];
  if (numbers.size() > 2) point.z_m = numbers[2];
  return true;
}

KmlTrack track_of(const XmlElement& element) {
  KmlTrack track;
  track.altitude_mode = element.child_text("altitudeMode");
  std::vector<double> times_s;
  std::vector<std::size_t> positions;  // which of the coords each point is
  for (const XmlElement& child : element.children) {
    if (child.name == "when") times_s.push_back(when_s(child.text));
    if (child.name != "coord") continue;
    LinePoint point;
    if (read_coord(child.text, point)) {
      track.points.push_back(point);
      positions.push_back(track.coords);
    }
    ++track.coords;
  }
  track.times = times_s.size();
  for (std::size_t i = 0; times_s.size() == track.coords && i < positions.size(); ++i) {
    track.points[i].time_s = times_s[positions[i]];
  }
  return track;
}

void collect_tracks(const XmlElement& element, std::vector<KmlTrack>& tracks) {
  if (element.name == "Track") {
    tracks.push_back(track_of(element));
    return;
  }
  for (const XmlElement& child : element.children) collect_tracks(child, tracks);
}

}  // namespace

bool same_positions(const std::vector<LinePoint>& line, const std::vector<LinePoint>& other) {
  constexpr double kSame = 1e-9;
  return std::equal(line.begin(), line.end(), other.begin(), other.end(), [](const LinePoint& a, const LinePoint& b) {
    return std::abs(a.x - b.x) < kSame && std::abs(a.y - b.y) < kSame;
  });
}

double seconds_of(const OGRField& field) {
  const auto& date = field.Date;
  const std::chrono::sys_days day = std::chrono::year(date.Year) / date.Month / date.Day;
  // 100 is UTC, and one more for each quarter of an hour to the east of it; 0 and 1 are times of no known zone.
  const double zone_s = date.TZFlag > 1 ? (date.TZFlag - 100) * 900.0 : 0;
  return static_cast<double>(day.time_since_epoch().count()) * 86'400 + date.Hour * 3600.0 + date.Minute * 60.0 +
         static_cast<double>(date.Second) - zone_s;
}

std::vector<KmlTrack> kml_tracks(const std::string& name, std::string_view document) {
  std::vector<KmlTrack> tracks;
  if (document.find(":Track") == std::string_view::npos && document.find("<Track") == std::string_view::npos) {
    return tracks;
  }
  collect_tracks(parse_xml(name, document), tracks);
  for (const KmlTrack& track : tracks) {
    if (track.times > 0 && track.times >= track.coords) continue;
    throw DataError(name + ": has a gx:Track with " + std::to_string(track.times) + " times (<when>) for " +
                    std::to_string(track.coords) +
                    " positions, and KML wants one for each; save it as a line (LineString), or with its times");
  }
  return tracks;
}

void apply_kml_tracks(Route& route, const std::vector<KmlTrack>& tracks, std::vector<Line>& lines) {
  for (Line& line : lines) {
    for (auto& part : line.parts) {
      const auto track = std::find_if(tracks.begin(), tracks.end(),
                                      [&](const KmlTrack& one) { return same_positions(part, one.points); });
      if (track == tracks.end() || line.what == "points") continue;
      line.what = "track";
      if (track->altitude_mode == "absolute") line.heights = HeightReference::kAmsl;
      if (track->altitude_mode == "relativeToGround") line.heights = HeightReference::kAgl;
      for (std::size_t i = 0; i < part.size(); ++i) {
        part[i].time_s = track->points[i].time_s;
        if (std::isnan(track->points[i].z_m)) part[i].z_m = track->points[i].z_m;
      }
      if (track->times != track->coords) {
        add_note(route, "The track \"" + line.name + "\" has " + std::to_string(track->times) + " times for " +
                            std::to_string(track->coords) + " positions: they are not used.");
      }
    }
  }
}

}  // namespace pilotage
