#include "pilotage/report/display.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "pilotage/base/text.h"
#include "pilotage/report/display_plane.h"
#include "pilotage/report/sampled_route.h"
#include "pilotage/report/simulated_flights.h"

namespace pilotage {
namespace {

constexpr int kImagerySide_px = 1600;
constexpr std::size_t kImageryMaxBytes = 1200000;
constexpr std::size_t kPicturesMaxBytes = 700000;
constexpr std::size_t kSeenMaxBytes = 300000;
constexpr std::size_t kMaxLinePoints = 4000;
constexpr std::size_t kMaxPlaces = 2000;

using PlaneFunction = std::function<Eigen::Vector2d(const Eigen::Vector2d&)>;

// A longitude in the middle of what is drawn, so that everything lies within 180° of it.
double reference_lon_deg(const Ground& ground, const std::vector<FlightSample>& samples) {
  if (!ground.tiles.empty()) return ground.tiles[ground.tiles.size() / 2].center.lon_deg;
  return samples.empty() ? 0 : samples[samples.size() / 2].point.lon_deg;
}

std::vector<Eigen::Vector2d> plane_line(const std::vector<GeodeticPoint>& points, double reference_deg) {
  std::vector<Eigen::Vector2d> line;
  for (GeodeticPoint point : points) {
    point.lon_deg = unwrap_lon_deg(point.lon_deg, reference_deg);
    line.push_back(mercator_from_geodetic(point));
  }
  return line;
}

// Corners from the top left, clockwise in the mission grid, of the stride-sized cell around a tile's centre: cells of a
// level touch, while its tiles overlap.
std::array<Eigen::Vector2d, 4> cell_corners(const GroundTile& tile, const GridLevel& level,
                                            const PlaneFunction& display_from_map) {
  const double share = static_cast<double>(level.matrix.stride_px) / std::max(1, level.matrix.tile_size_px);
  const Eigen::Vector2d center = tile.bounds.center_m();
  const Eigen::Vector2d half =
      Eigen::Vector2d(tile.bounds.width_m(), tile.bounds.height_m()) * std::min(share, 1.0) / 2;
  return {display_from_map(center + Eigen::Vector2d(-half.x(), half.y())), display_from_map(center + half),
          display_from_map(center + Eigen::Vector2d(half.x(), -half.y())), display_from_map(center - half)};
}

void add_route(const ReportInput& input, const Report& report, double reference_deg, ReportDisplay& display) {
  const std::vector<FlightSample>& samples = input.mission.flight.samples;
  const std::size_t per_leg = std::max<std::size_t>(8, kMaxLinePoints / std::max<std::size_t>(1, report.legs.size()));
  for (const ReportLeg& leg : report.legs) {
    std::vector<GeodeticPoint> line = leg_line(samples, leg.status.leg, per_leg);
    line.insert(line.begin(), leg.from);
    line.push_back(leg.to);
    display.leg_lines_m.push_back(plane_line(line, reference_deg));
  }
  const std::size_t per_gap = std::max<std::size_t>(8, kMaxLinePoints / std::max<std::size_t>(1, report.gaps.size()));
  for (const ReportGap& gap : report.gaps) {
    display.gap_lines_m.push_back(plane_line(
        route_line_between(samples, gap.gap.from_distance_m, gap.gap.to_distance_m, per_gap), reference_deg));
  }
  for (const DeniedStretch& stretch : report.denied) {
    display.denied_lines_m.push_back(
        plane_line(route_line_between(samples, stretch.from_distance_m, stretch.to_distance_m,
                                      std::max<std::size_t>(8, kMaxLinePoints / report.denied.size())),
                   reference_deg));
  }
  for (const std::vector<GeodeticPoint>& outline : true_place_outlines(input)) {
    display.true_place_lines_m.push_back(plane_line(outline, reference_deg));
  }
  const std::size_t step = std::max<std::size_t>(1, (samples.size() + kMaxPlaces - 1) / kMaxPlaces);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i % step != 0 && i + 1 != samples.size()) continue;
    display.places_m.emplace_back(samples[i].distance_m, plane_line({samples[i].point}, reference_deg).front());
  }
}

// The cells of the tiles.
ReportDisplay cells_of(const Ground& ground, const std::vector<ReportTile>& tiles,
                       const PlaneFunction& display_from_map) {
  ReportDisplay display;
  for (const ReportTile& tile : tiles) {
    display.cells_m.push_back(cell_corners(tile.tile, ground.level_of(tile.tile), display_from_map));
  }
  return display;
}

// The pictures of the report's tiles, in their order.
void add_pictures(const ShownGround& shown, const std::vector<ReportTile>& tiles, ReportDisplay& display) {
  const TilePictures& pictures = shown.pictures;
  if (pictures.sheet.empty()) return;
  std::map<std::int64_t, std::size_t> index;
  for (std::size_t i = 0; i < shown.ground.tiles.size(); ++i) index[shown.ground.tiles[i].tile_id] = i;
  cv::Mat sheet(pictures.sheet.size(), pictures.sheet.type(), cv::Scalar::all(0));
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    pictures.sheet(pictures.place(index.at(tiles[i].tile.tile_id))).copyTo(sheet(pictures.place(i)));
  }
  display.pictures_jpeg = encode_jpeg(sheet, kPicturesMaxBytes);
  display.picture_side_px = pictures.side_px;
  display.picture_columns = pictures.columns;
}

std::string seen_jpeg(const SeenFrames& seen) {
  if (seen.frames.empty()) return "";
  return encode_jpeg(seen.sheet, kSeenMaxBytes);
}

// What is drawn, with a margin of 4 %; empty when a point lies outside the plane.
Bounds drawn_bounds(const ReportDisplay& display) {
  Bounds bounds;
  bool outside = false;
  const auto add = [&](const Eigen::Vector2d& point) {
    if (point.allFinite()) {
      bounds.extend(point);
    } else {
      outside = true;
    }
  };
  for (const auto& cell : display.cells_m) std::for_each(cell.begin(), cell.end(), add);
  for (const auto& line : display.leg_lines_m) std::for_each(line.begin(), line.end(), add);
  for (const auto& line : display.gap_lines_m) std::for_each(line.begin(), line.end(), add);
  for (const auto& [distance_m, point] : display.places_m) add(point);
  if (outside || bounds.empty()) return {};
  return bounds.grown(std::max({bounds.width_m(), bounds.height_m(), 100.0}) * 0.04);
}

// What has all its shapes gets its edges and the imagery between them; or nothing is drawn, and why is told.
ReportDisplay with_imagery(ReportDisplay display, const ShownGround& shown, const PlaneFunction& display_from_map,
                           const std::string& nothing_there) {
  const Bounds bounds = drawn_bounds(display);
  if (bounds.empty()) {
    const bool nothing = display.cells_m.empty() && display.leg_lines_m.empty();
    ReportDisplay none;
    none.pictures_jpeg = display.pictures_jpeg;  // shown beside the numbers of a tile
    none.picture_side_px = display.picture_side_px;
    none.picture_columns = display.picture_columns;
    none.missing = nothing ? nothing_there
                           : "The map is not drawn: a part of it lies beyond " + format_number(kMercatorMaxLat_deg) +
                                 "° of latitude or outside the grid's projection. All numbers stand below.";
    return none;
  }
  const DisplayGrid grid = display_grid(bounds, kImagerySide_px);
  display.drawn = true;
  display.min_x_m = grid.edges_m.min_x_m;
  display.min_y_m = grid.edges_m.min_y_m;
  display.max_x_m = grid.edges_m.max_x_m;
  display.max_y_m = grid.edges_m.max_y_m;
  if (!shown.imagery.pixels.empty()) {
    const Raster& imagery = shown.imagery;
    const Eigen::Vector2d start =
        imagery.map_from_pixel.map_from_pixel(Eigen::Vector2d(imagery.pixels.cols, imagery.pixels.rows) / 2);
    const cv::Mat map_xy = map_from_display(grid, display_from_map, start);
    display.imagery_jpeg = encode_jpeg(warp_imagery(imagery, map_xy), kImageryMaxBytes);
  }
  return display;
}

}  // namespace

ShownGround shown_ground(const ReportInput& input) {
  return {input.mission.ground, input.imagery, input.pictures, input.geodetic_from_map};
}

ReportDisplay make_display(const ShownGround& shown, const std::vector<ReportTile>& tiles) {
  const PlaneFunction display_from_map =
      mercator_from_map(shown.geodetic_from_map, reference_lon_deg(shown.ground, {}));
  ReportDisplay display = cells_of(shown.ground, tiles, display_from_map);
  add_pictures(shown, tiles, display);
  return with_imagery(std::move(display), shown, display_from_map, "There is no tile to draw.");
}

ReportDisplay make_display(const ReportInput& input, const Report& report) {
  const ShownGround shown = shown_ground(input);
  const double reference_deg = reference_lon_deg(shown.ground, input.mission.flight.samples);
  const PlaneFunction display_from_map = mercator_from_map(shown.geodetic_from_map, reference_deg);
  ReportDisplay display = cells_of(shown.ground, report.tiles, display_from_map);
  add_route(input, report, reference_deg, display);
  add_pictures(shown, report.tiles, display);
  display = with_imagery(std::move(display), shown, display_from_map, "There is no tile and no route to draw.");
  display.seen_jpeg = seen_jpeg(input.seen);
  return display;
}

}  // namespace pilotage
