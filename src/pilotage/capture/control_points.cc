#include "pilotage/capture/control_points.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>

#include "pilotage/base/error.h"
#include "pilotage/base/read_file.h"
#include "pilotage/base/text.h"
#include "pilotage/raster/gdal_crs.h"

namespace pilotage {
namespace {

/// "WGS84 UTM 16N" is EPSG:32616, and EPSG:327… in the south; anything else is what GDAL understands.
Crs crs_of(const std::string& path, const std::string& line) {
  std::istringstream words(line);
  std::string datum;
  std::string utm;
  std::string zone;
  words >> datum >> utm >> zone;
  if (datum == "WGS84" && utm == "UTM" && zone.size() >= 2) {
    const char side = zone.back();
    const auto number = parse_number(std::string_view(zone).substr(0, zone.size() - 1));
    if ((side != 'N' && side != 'S') || !number || *number < 1 || *number > 60) {
      throw DataError(path + ": line 1: \"" + line + "\" is no UTM zone; as \"WGS84 UTM 16N\"");
    }
    return Crs::from_user_input("EPSG:" + std::to_string((side == 'N' ? 32600 : 32700) + static_cast<int>(*number)));
  }
  try {
    return Crs::from_user_input(line);
  } catch (const UsageError& error) {
    throw DataError(path + ": line 1 is to name the points' CRS: " + error.what());
  }
}

double number_of(const std::string& where, const char* name, const std::string& word) {
  const auto number = parse_number(word);
  if (!number || !(std::abs(*number) < 1e8)) throw DataError(where + name + " \"" + word + "\" is no number");
  return *number;
}

/// Frames whose path ends with all parts of `name`.
std::vector<int> frames_named(const std::vector<std::string>& files, const std::string& name) {
  const std::filesystem::path wanted = std::filesystem::path(name).lexically_normal();
  const auto parts = std::distance(wanted.begin(), wanted.end());
  std::vector<int> found;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::filesystem::path path(files[i]);
    if (std::distance(path.begin(), path.end()) < parts) {
      if (path.filename() == wanted.filename()) found.push_back(static_cast<int>(i));
      continue;
    }
    const auto tail = std::prev(path.end(), parts);
    if (std::equal(tail, path.end(), wanted.begin())) found.push_back(static_cast<int>(i));
  }
  if (!found.empty() || parts == 1) return found;
  return frames_named(files, wanted.filename().string());
}

}  // namespace

std::vector<ControlPoint> read_control_points(const std::string& path, const std::vector<std::string>& files,
                                              const LocalFrame& frame, int& unused_marks) {
  std::istringstream lines(read_file(path));
  std::string line;
  int number = 0;
  std::optional<CrsTransform> transform;
  std::vector<ControlPoint> points;
  std::map<std::string, std::size_t> by_name;
  unused_marks = 0;
  while (std::getline(lines, line)) {
    ++number;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.find_first_not_of(" \t") == std::string::npos || line.front() == '#') continue;
    if (!transform) {
      transform.emplace(crs_of(path, line));
      continue;
    }
    const std::string where = path + ": line " + std::to_string(number) + ": ";
    std::istringstream words(line);
    std::string x;
    std::string y;
    std::string z;
    std::string column;
    std::string row;
    std::string file;
    std::string name;
    if (!(words >> x >> y >> z >> column >> row >> file)) {
      throw DataError(where + "is to have x, y, z, column, row and file");
    }
    if (!(words >> name)) name = x + " " + y + " " + z;
    const auto point = transform->geodetic_from_map({number_of(where, "x", x), number_of(where, "y", y)});
    if (!point) throw DataError(where + x + ", " + y + " has no longitude and latitude in the CRS of line 1");
    Eigen::Vector3d enu_m = frame.enu_from_geodetic(*point);
    enu_m.z() = number_of(where, "z", z);
    const auto [found, added] = by_name.emplace(name, points.size());
    if (added) points.push_back({name, enu_m, {}});
    ControlPoint& control = points[found->second];
    if ((control.enu_m - enu_m).norm() > 1e-3) {
      throw DataError(where + "point \"" + name + "\" stands at two places, " +
                      format_fixed((control.enu_m - enu_m).norm(), 3) + " m apart");
    }
    const std::vector<int> in_frames = frames_named(files, file);
    if (in_frames.empty()) {
      ++unused_marks;
      continue;
    }
    if (in_frames.size() > 1) {
      throw DataError(where + "\"" + file + "\" is the name of " + std::to_string(in_frames.size()) +
                      " frames; say it with its folder");
    }
    control.marks.push_back({in_frames.front(), {number_of(where, "column", column), number_of(where, "row", row)}});
  }
  std::erase_if(points, [](const ControlPoint& point) { return point.marks.empty(); });
  if (points.empty()) throw DataError(path + ": holds no mark in any of the frames");
  return points;
}

}  // namespace pilotage
