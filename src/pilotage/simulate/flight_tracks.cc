#include "pilotage/simulate/flight_tracks.h"

#include <cmath>

#include "pilotage/base/angle.h"
#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/mapdb/geopackage_rows.h"
#include "pilotage/mission/selection.h"

namespace pilotage {
namespace {

constexpr int kEllipseCorners = 48;

Eigen::Vector2d beside(const FlightSample& sample, const Eigen::Vector2d& east_north_m) {
  const GeodeticPoint point = LocalFrame(sample.point).geodetic_from_enu({east_north_m.x(), east_north_m.y(), 0});
  return {point.lon_deg, point.lat_deg};
}

VectorFeature track_feature(const Mission& mission, std::size_t flight, const SimulatedTrack& track, bool is_true) {
  const std::vector<FlightSample>& samples = mission.flight.samples;
  const std::vector<Eigen::Vector2d>& off_line_m =
      is_true ? track.places.true_off_line_m : track.places.believed_off_line_m;
  VectorFeature feature;
  for (std::size_t i = 0; i < samples.size(); ++i) feature.points.push_back(beside(samples[i], off_line_m[i]));
  if (samples.size() == 1) feature.points.push_back(feature.points.front());
  const bool within = track.lost_at >= samples.size();
  feature.values = {static_cast<std::int64_t>(flight + 1), std::string(is_true ? "true" : "believed"), within,
                    within ? VectorValue{} : VectorValue{samples[track.lost_at].distance_m}};
  feature.title = "Flight " + std::to_string(flight + 1) + (is_true ? ", true" : ", believed");
  feature.note = within ? "Within the limit all the way"
                        : "Beyond the limit from " + format_fixed(samples[track.lost_at].distance_m / 1000, 2) + " km";
  feature.style = {is_true ? (within ? "#0072b2ff" : "#d55e00ff") : "#808080a0", is_true ? 2.0 : 1.0, ""};
  return feature;
}

VectorLayer track_layer(const Mission& mission, const Simulation& simulation) {
  VectorLayer layer;
  layer.name = "tracks";
  layer.title = "Simulated flights";
  layer.description = "Where the first flights truly were, and where their navigation found them.";
  layer.shape = VectorShape::kLine;
  layer.crs = Crs::wgs84();
  layer.columns = {{"flight", VectorType::kInteger, "Flight"},
                   {"path", VectorType::kText, "Path: true or believed"},
                   {"within", VectorType::kBoolean, "Within the limit all the way"},
                   {"lost_at_m", VectorType::kReal, "First beyond the limit (m along the route)"}};
  for (const bool is_true : {false, true}) {  // what is true lies on top
    for (std::size_t i = 0; i < simulation.tracks.size(); ++i) {
      layer.features.push_back(track_feature(mission, i, simulation.tracks[i], is_true));
    }
  }
  return layer;
}

/// The first sample at or behind a distance; the last one at most.
const FlightSample& sample_at(const Mission& mission, double distance_m) {
  const std::vector<FlightSample>& samples = mission.flight.samples;
  for (const FlightSample& sample : samples) {
    if (sample.distance_m >= distance_m - 1e-6) return sample;
  }
  return samples.back();
}

VectorLayer true_place_layer(const Mission& mission, const Simulation& simulation) {
  VectorLayer layer;
  layer.name = "true_places";
  layer.title = "True places of 95 of 100 flights";
  layer.description = "Ellipses around the line's place that hold 95 of 100 simulated flights.";
  layer.shape = VectorShape::kPolygon;
  layer.crs = Crs::wgs84();
  layer.columns = {{"distance_m", VectorType::kReal, "Along the route (m)"},
                   {"p_within", VectorType::kReal, "Share within the limit so far"},
                   {"lost", VectorType::kInteger, "Flights lost since the mark before"},
                   {"cep50_m", VectorType::kReal, "CEP50 (m)"},
                   {"r95_m", VectorType::kReal, "R95 (m)"},
                   {"nees", VectorType::kReal, "NEES"},
                   {"major_m", VectorType::kReal, "Major semi-axis (m)"},
                   {"minor_m", VectorType::kReal, "Minor semi-axis (m)"},
                   {"azimuth_deg", VectorType::kReal, "Azimuth of the major axis (°)"}};
  for (const SimulatedMark& mark : simulation.marks) {
    if (std::isnan(mark.true_place.major_m)) continue;
    const FlightSample& sample = sample_at(mission, mark.distance_m);
    VectorFeature feature;
    for (const Eigen::Vector2d& corner_m : ellipse_outline_m(mark.true_place, kEllipseCorners)) {
      feature.points.push_back(beside(sample, corner_m));
    }
    feature.values = {mark.distance_m,
                      mark.p_within,
                      mark.lost,
                      mark.cep50_m,
                      mark.r95_m,
                      mark.nees,
                      mark.true_place.major_m,
                      mark.true_place.minor_m,
                      mark.true_place.azimuth_deg};
    feature.title = format_fixed(mark.distance_m / 1000, 2) + " km";
    feature.note = "Within the limit so far " + probability_text(mark.p_within) + ", CEP50 " +
                   format_fixed(mark.cep50_m, 1) + " m, R95 " + format_fixed(mark.r95_m, 1) + " m";
    feature.style = {"#6a3d9aff", 1.5, "#6a3d9a30"};
    layer.features.push_back(std::move(feature));
  }
  return layer;
}

}  // namespace

std::vector<VectorLayer> simulation_layers(const Mission& mission, const Simulation& simulation) {
  return {true_place_layer(mission, simulation), track_layer(mission, simulation)};
}

void check_track_file(const std::filesystem::path& path) {
  if (path.extension() == ".gpkg" || path.extension() == ".kml") return;
  throw UsageError("tracks = \"" + path.string() + "\" ends in neither .gpkg nor .kml");
}

void write_flight_tracks(const std::filesystem::path& path, const Mission& mission, const Simulation& simulation,
                         bool overwrite) {
  check_track_file(path);
  const std::vector<VectorLayer> layers = simulation_layers(mission, simulation);
  if (path.extension() == ".gpkg") {
    write_geopackage(path, layers, geopackage_timestamp(), overwrite);
  } else {
    write_file(path, kml_document("Simulated flights", layers), overwrite);
  }
}

}  // namespace pilotage
