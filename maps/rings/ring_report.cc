#include "ring_report.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <nlohmann/json.hpp>

#include "pilotage/base/json_object.h"
#include "pilotage/base/statistics.h"
#include "pilotage/base/text.h"
#include "pilotage/geo/local_frame.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, 3> kDecoyNames = {"disc", "square", "painted"};

Json vector_json(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

Json rate_json(int count, int of) {
  const Interval interval = binomial_interval(count, of);
  return {{"count", count}, {"of", of}, {"low", interval.low}, {"high", interval.high}};
}

std::string rate_text(int count, int of) {
  const Interval interval = binomial_interval(count, of);
  return std::to_string(count) + " of " + std::to_string(of) + " (95 %: " + format_fixed(100 * interval.low, 1) +
         " to " + format_fixed(100 * interval.high, 1) + " %)";
}

Json located_json(const LocatedRing& ring, const LocalFrame& frame) {
  const GeodeticPoint point = frame.geodetic_from_enu(ring.center_m);
  Json covariance = Json::array();
  for (int i = 0; i < 3; ++i) covariance.push_back(vector_json(ring.covariance_m2.row(i)));
  return {{"class", kRingClasses[static_cast<std::size_t>(ring.ring_class)].name},
          {"lon_deg", point.lon_deg},
          {"lat_deg", point.lat_deg},
          {"enu_m", vector_json(ring.center_m)},
          {"covariance_enu_m2", covariance},
          {"normal_azimuth_deg", ring.azimuth_deg},
          {"normal_azimuth_sigma_deg", ring.azimuth_sigma_deg},
          {"normal_lean_deg", ring.lean_deg},
          {"inner_radius_m", ring.inner_radius_m},
          {"inner_radius_sigma_m", ring.inner_radius_sigma_m},
          {"views", ring.views}};
}

Json array_json(const RingFlight& flight, const LocalFrame& frame) {
  Json array = Json::array();
  for (const JudgedRing& judged : flight.array) {
    Json element = located_json(judged.ring, frame);
    element["truth"] = judged.truth < 0 ? Json() : Json(judged.truth);
    if (judged.truth >= 0) {
      element["position_error_m"] = judged.error_m;
      element["position_nees"] = judged.nees;
      element["azimuth_error_deg"] = judged.azimuth_error_deg;
      element["inner_radius_error_m"] = judged.radius_error_m;
      element["nearest_view_m"] = judged.nearest_view_m;
    }
    array.push_back(element);
  }
  return array;
}

Json course_json(const CourseFlight& course) {
  Json crossings = Json::array();
  for (std::size_t i = 0; i < course.outcome.crossings.size(); ++i) {
    const Crossing& crossing = course.outcome.crossings[i];
    Json one = {{"ring", i}, {"crossed", crossing.crossed()}, {"collided", crossing.collided}};
    if (crossing.offset_m) {
      one["offset_m"] = *crossing.offset_m;
      one["angle_deg"] = crossing.angle_deg;
      one["clearance_m"] = crossing.clearance_m;
      one["planned_clearance_m"] = json_number(course.planned_clearance_m[i]);
      one["time_s"] = crossing.time_s;
    }
    crossings.push_back(one);
  }
  return {{"crossed", course.outcome.crossed},       {"in_order", course.outcome.in_order},
          {"collisions", course.outcome.collisions}, {"time_s", course.outcome.time_s},
          {"end_error_m", course.end_error_m},       {"frames", course.fixes.frames},
          {"fixes_taken", course.fixes.taken},       {"crossings", crossings}};
}

Json flight_json(const RingFlight& flight, const LocalFrame& frame) {
  Json rings = Json::array();
  for (const Ring& ring : flight.scene.rings) {
    rings.push_back({{"class", ring.kind().name},
                     {"enu_m", vector_json(ring.center_m)},
                     {"normal_azimuth_deg", ring.azimuth_deg},
                     {"normal_lean_deg", ring.lean_deg},
                     {"inner_radius_m", ring.kind().inner_radius_m}});
  }
  Json decoys = Json::array();
  for (const Decoy& decoy : flight.scene.decoys) {
    decoys.push_back(
        {{"kind", kDecoyNames[static_cast<std::size_t>(decoy.kind)]}, {"enu_m", vector_json(decoy.center_m)}});
  }
  Json refused = Json::array();
  for (const RingArray::Refused& one : flight.refused) {
    Json element = located_json(one.ring, frame);
    element["refused"] = refused_ring_name(one.why);
    refused.push_back(element);
  }
  const DetectionCounts& seen = flight.detections;
  return {{"rings", rings},
          {"decoys", decoys},
          {"scan",
           {{"frames", flight.scan_frames},
            {"patches", seen.patches},
            {"no_hole", seen.no_hole},
            {"cut", seen.cut},
            {"too_thin", seen.too_thin},
            {"no_ellipse", seen.no_ellipse},
            {"sights", flight.sights},
            {"fix_frames", flight.scan_fixes.frames},
            {"fixes_taken", flight.scan_fixes.taken}}},
          {"array", array_json(flight, frame)},
          {"refused", refused},
          {"missed", flight.missed()},
          {"false", flight.false_rings},
          {"with_fixes", course_json(flight.with_fixes)},
          {"without_fixes", course_json(flight.without_fixes)}};
}

std::string offset_text(const Crossing& crossing) {
  std::string text = crossing.offset_m ? format_fixed(*crossing.offset_m, 2) + " m" : "not met";
  return text + (crossing.collided ? ", hit" : crossing.crossed() ? "" : ", missed");
}

std::string padded(std::string text, std::size_t width) {
  text.resize(std::max(width, text.size()), ' ');
  return text;
}

std::string row(const std::vector<std::string>& cells) {
  std::string line;
  for (const std::string& cell : cells) line += padded(cell, 15) + " ";
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

std::string one_flight_text(const RingFlight& flight) {
  std::string text = row({"ring", "found off by", "3 sigma", "views", "with fixes", "clearance", "without fixes"});
  for (std::size_t i = 0; i < flight.scene.rings.size(); ++i) {
    const auto found = std::find_if(flight.array.begin(), flight.array.end(),
                                    [&](const JudgedRing& judged) { return judged.truth == static_cast<int>(i); });
    std::vector<std::string> cells = {std::to_string(i + 1) + " " + std::string(flight.scene.rings[i].kind().name)};
    if (found == flight.array.end()) {
      cells.insert(cells.end(), {"missed", "", ""});
    } else {
      cells.insert(cells.end(), {format_fixed(found->error_m, 2) + " m",
                                 format_fixed(3 * std::sqrt(found->ring.covariance_m2.trace() / 3), 2) + " m",
                                 std::to_string(found->ring.views)});
    }
    const Crossing& with = flight.with_fixes.outcome.crossings[i];
    cells.push_back(offset_text(with));
    cells.push_back(with.offset_m ? format_fixed(with.clearance_m, 2) + " m" : "");
    cells.push_back(offset_text(flight.without_fixes.outcome.crossings[i]));
    text += row(cells);
  }
  return text + "Of the array " + std::to_string(flight.false_rings) + " are false. The course took " +
         format_fixed(flight.with_fixes.outcome.time_s, 0) + " s; the position at its end was off by " +
         format_fixed(flight.with_fixes.end_error_m, 2) + " m with fixes, " +
         format_fixed(flight.without_fixes.end_error_m, 2) + " m without.\n\n";
}

}  // namespace

RingSummary summarise(const std::vector<RingFlight>& flights) {
  RingSummary sum;
  std::vector<double> errors_m;
  for (const RingFlight& flight : flights) {
    ++sum.flights;
    sum.rings += static_cast<int>(flight.scene.rings.size());
    sum.found += flight.found;
    sum.false_rings += flight.false_rings;
    for (const JudgedRing& judged : flight.array) {
      if (judged.truth < 0) continue;
      errors_m.push_back(judged.error_m);
      sum.mean_nees += judged.nees;
    }
    sum.crossed_with += flight.with_fixes.outcome.crossed;
    sum.crossed_without += flight.without_fixes.outcome.crossed;
    sum.all_with += flight.with_fixes.outcome.in_order ? 1 : 0;
    sum.all_without += flight.without_fixes.outcome.in_order ? 1 : 0;
    sum.collisions_with += flight.with_fixes.outcome.collisions;
    for (const Crossing& crossing : flight.with_fixes.outcome.crossings) {
      if (crossing.crossed()) sum.worst_offset_m = std::max(sum.worst_offset_m, *crossing.offset_m);
    }
  }
  if (errors_m.empty()) return sum;
  sum.median_error_m = quantile(errors_m, 0.5);
  sum.worst_error_m = quantile(errors_m, 1);
  sum.mean_nees /= static_cast<double>(errors_m.size());
  return sum;
}

Json rings_json(const std::vector<RingFlight>& flights, const GeodeticPoint& middle) {
  const RingSummary sum = summarise(flights);
  const LocalFrame frame(middle);
  Json all = Json::array();
  for (const RingFlight& flight : flights) all.push_back(flight_json(flight, frame));
  return {{"origin", {{"lon_deg", middle.lon_deg}, {"lat_deg", middle.lat_deg}}},
          {"summary",
           {{"flights", sum.flights},
            {"rings_found", rate_json(sum.found, sum.rings)},
            {"false_rings", sum.false_rings},
            {"median_position_error_m", sum.median_error_m},
            {"worst_position_error_m", sum.worst_error_m},
            {"mean_position_nees", sum.mean_nees},
            {"rings_crossed_with_fixes", rate_json(sum.crossed_with, sum.rings)},
            {"rings_crossed_without_fixes", rate_json(sum.crossed_without, sum.rings)},
            {"flights_all_in_order_with_fixes", rate_json(sum.all_with, sum.flights)},
            {"flights_all_in_order_without_fixes", rate_json(sum.all_without, sum.flights)},
            {"collisions_with_fixes", sum.collisions_with},
            {"worst_offset_with_fixes_m", sum.worst_offset_m}}},
          {"flights", all}};
}

std::string rings_text(const std::vector<RingFlight>& flights) {
  std::string text = flights.size() == 1 ? one_flight_text(flights.front()) : "";
  const RingSummary sum = summarise(flights);
  text += "rings found                    " + rate_text(sum.found, sum.rings) +
          "; false: " + std::to_string(sum.false_rings) + "\n";
  text += "position error of found rings  median " + format_fixed(sum.median_error_m, 3) + " m, worst " +
          format_fixed(sum.worst_error_m, 3) + " m, mean NEES " + format_fixed(sum.mean_nees, 2) + " (3 is honest)\n";
  text += "rings crossed with fixes       " + rate_text(sum.crossed_with, sum.rings) + ", at most " +
          format_fixed(sum.worst_offset_m, 2) + " m off the axis; collisions: " + std::to_string(sum.collisions_with) +
          "\n";
  text += "rings crossed without fixes    " + rate_text(sum.crossed_without, sum.rings) + "\n";
  text += "all in order with fixes        " + rate_text(sum.all_with, sum.flights) + " flights\n";
  return text + "all in order without fixes     " + rate_text(sum.all_without, sum.flights) + " flights\n";
}

}  // namespace pilotage
