#include "pilotage/report/simulated_flights.h"

#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/markup.h"
#include "pilotage/base/text.h"
#include "pilotage/base/wording.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/mission/simulation_file.h"
#include "pilotage/report/page_parts.h"
#include "pilotage/report/sampled_route.h"
#include "pilotage/verdict/evidence.h"

namespace pilotage {
namespace {

constexpr int kOutlineCorners = 32;
/// Rows of the table along the route, at most about so many.
constexpr double kMostMarkRows = 20;

std::string difference_text(double planned, const Share& simulated) {
  if (simulated.of == 0 || std::isnan(planned)) return "–";
  const auto part = [&](double share) {
    const double difference = share - planned;
    return (difference < 0 ? "−" : "+") + format_fixed(std::abs(difference), 3);
  };
  const Interval interval = simulated.interval();
  return part(simulated.value()) + " [" + part(interval.low) + ", " + part(interval.high) + "]";
}

std::string metres_or_dash(double length_m) {
  return std::isnan(length_m) ? "–" : format_fixed(length_m, 1) + " m";
}

std::string share_cell(const std::string& label, const Share& share) {
  return cell_html(label, share_text(share));
}

std::string legs_table(const Simulation& simulation) {
  std::string rows;
  for (const SimulatedLeg& leg : simulation.legs) {
    rows += "<tr>" + heading_html("Leg " + std::to_string(leg.leg + 1)) +
            cell_html("Planned P", probability_text(leg.planned_p)) + share_cell("Simulated", leg.within) +
            cell_html("Difference", difference_text(leg.planned_p, leg.within)) + "</tr>\n";
  }
  return table_html("Table of the simulated legs",
                    {"Leg", "Planned P " + kind_mark(NumberKind::kModelled),
                     "Share of flights " + kind_mark(NumberKind::kSimulated), "Difference"},
                    rows);
}

std::string marks_table(const Simulation& simulation) {
  std::string rows;
  const auto step = static_cast<std::size_t>(std::ceil(static_cast<double>(simulation.marks.size()) / kMostMarkRows));
  for (std::size_t i = 0; i < simulation.marks.size(); ++i) {
    const SimulatedMark& mark = simulation.marks[i];
    if ((i + 1) % step != 0 && i + 1 != simulation.marks.size()) continue;
    const bool honest = mark.nees >= mark.nees_band.low && mark.nees <= mark.nees_band.high;
    rows +=
        "<tr>" + heading_html(format_fixed(mark.distance_m / 1000, 2) + " km") +
        cell_html("Within the limit so far", probability_text(mark.p_within)) +
        cell_html("CEP50", metres_or_dash(mark.cep50_m)) + cell_html("R95", metres_or_dash(mark.r95_m)) +
        cell_html("NEES", format_fixed(mark.nees, 2) + (honest ? " in [" : " outside [") +
                              format_fixed(mark.nees_band.low, 2) + ", " + format_fixed(mark.nees_band.high, 2) + "]") +
        "</tr>\n";
  }
  return table_html("Table of the errors along the route",
                    {"Along the route", "Within the limit so far", "CEP50", "R95", "NEES"}, rows);
}

std::string losses_table(const Simulation& simulation) {
  if (simulation.losses.empty()) return "";
  std::string rows;
  for (const SimulatedLoss& loss : simulation.losses) {
    rows += "<tr>" + heading_html(format_fixed(loss.lost_from_m / 1000, 2) + " km") +
            cell_html("Planned P", probability_text(loss.planned_p)) + share_cell("Simulated", loss.within) + "</tr>\n";
  }
  return "  <h3>By where GNSS is lost for good</h3>\n" +
         table_html("Table of the places where GNSS is lost",
                    {"Lost at", "Planned P " + kind_mark(NumberKind::kModelled),
                     "Share of flights " + kind_mark(NumberKind::kSimulated)},
                    rows);
}

/// Who answered the tries.
std::string fixes_from_text(const Simulation& simulation) {
  const std::string from = simulation.options.value("fixes", "drawn");
  if (from == "drawn") return "fixes drawn by the tiles' modelled P";
  if (from == "none") return "without any fix";
  return "fixes of the matcher on " + frames_of_text(simulation);
}

std::string fixes_text(const Simulation& simulation) {
  const TryCounts& fixes = simulation.fixes;
  return "Of " + std::to_string(fixes.tries) + " tries in all flights " + std::to_string(fixes.right) +
         " gave a right fix, " + std::to_string(fixes.missed) + " none over a stored tile, " +
         std::to_string(fixes.not_stored) + " were over ground that is not stored, " + std::to_string(fixes.off_line) +
         " beside the line's tile; " + std::to_string(fixes.false_taken) + " false fixes were taken, " +
         std::to_string(fixes.refused) + " fixes refused by the filter, " + std::to_string(fixes.resets) + " resets.";
}

std::string cost_text(const Simulation& simulation) {
  if (!simulation.as_planned) return "";
  const AsPlanned& planned = *simulation.as_planned;
  return "The same flights in the plan's own conditions: " + share_text(planned.within) +
         ". Those given instead cost " + format_fixed(planned.cost, 3) + " [" +
         format_fixed(planned.cost_interval.low, 3) + ", " + format_fixed(planned.cost_interval.high, 3) +
         "] (pairs of flights).";
}

std::string one_simulation_html(const Simulation& simulation, const std::string& id) {
  std::string html = "<section aria-labelledby=\"" + id + "\">\n  <h2 id=\"" + id + "\">" +
                     (simulation.by_frames() ? "Flights by computed frames " : "Simulated flights ") +
                     kind_mark(NumberKind::kSimulated) + "</h2>\n";
  const auto paragraph = [&](const std::string& text) {
    if (!text.empty()) html += "  <p>" + html_escape(text) + "</p>\n";
  };
  paragraph(flights_of(simulation.within) + " stay within " + error_text(simulation.max_error_m) +
            " all the way and know it: " + share_text(simulation.within) + "; planned " +
            probability_text(simulation.planned_p) + ". By " + format_number(simulation.sigma_multiple) +
            "σ of the filter alone, as the plan counts: " + share_text(simulation.within_sure) +
            "; by the true error alone: " + share_text(simulation.within_true) + "; off without knowing: " +
            share_text(simulation.unaware) + ". Intervals are of 95 %; " + fixes_from_text(simulation) + ".");
  paragraph(capitalized(integrity_text(simulation.integrity)) + ".");
  paragraph(cost_text(simulation));
  paragraph(most_lost_text(simulation));
  paragraph(fixes_text(simulation));
  html += losses_table(simulation);
  html += "  <div class=\"beside\">\n  <div><h3>Legs</h3>\n" + legs_table(simulation) + "</div>\n";
  html += "  <div><h3>Errors along the route</h3>\n" + marks_table(simulation) + "</div>\n  </div>\n";
  html +=
      "  <p class=\"small\">CEP50 and R95: half and 95 of 100 of the true errors of all flights, lost ones with "
      "them, are at most so large. NEES: 2 of a filter whose covariance is honest; false fixes lift it.</p>\n";
  html += "  <h3>Not simulated</h3>\n  <ul>\n" + list_html(simulation.not_simulated) + "  </ul>\n";
  html += "  <details><summary>Options of the simulation, seed " + std::to_string(simulation.seed) +
          "</summary><table class=\"parameters\"><tbody>\n" + parameters_html(simulation.options) +
          "</tbody></table></details>\n";
  return html + "</section>\n";
}

}  // namespace

std::string simulation_html(const Report& report) {
  std::string html;
  for (std::size_t i = 0; i < report.simulations.size(); ++i) {
    html += one_simulation_html(report.simulations[i], i == 0 ? "simulation-heading" : "rendered-heading");
  }
  return html;
}

nlohmann::ordered_json simulated_marks_json(const Report& report) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  if (report.simulations.empty()) return json;
  for (const SimulatedMark& mark : report.simulations.front().marks) {
    json.push_back({mark.distance_m, json_number(mark.cep50_m), json_number(mark.r95_m), mark.p_within});
  }
  return json;
}

std::vector<std::vector<GeodeticPoint>> true_place_outlines(const ReportInput& input) {
  std::vector<std::vector<GeodeticPoint>> outlines;
  if (input.simulations.empty()) return outlines;
  for (const SimulatedMark& mark : input.simulations.front().marks) {
    if (std::isnan(mark.true_place.major_m)) continue;
    const LocalFrame frame(route_point_at(input.mission.flight.samples, mark.distance_m));
    std::vector<GeodeticPoint>& outline = outlines.emplace_back();
    for (const Eigen::Vector2d& corner_m : ellipse_outline_m(mark.true_place, kOutlineCorners)) {
      outline.push_back(frame.geodetic_from_enu({corner_m.x(), corner_m.y(), 0}));
    }
    outline.push_back(outline.front());
  }
  return outlines;
}

void add_simulation(ReportInput& input, Simulation simulation, const std::string& name,
                    const std::vector<InputFile>& of) {
  for (const InputFile& file : of) {
    for (const InputFile& simulated : simulation.inputs) {
      if (simulated.role != file.role || simulated.digest == file.digest) continue;
      throw DataError(name + ": was simulated with another " + file.role + " than " + file.name +
                      "; run `pilotage simulate` again");
    }
  }
  if (simulation.by_frames()) {
    const auto& matches = simulation.rendered.value("matches", nlohmann::ordered_json::object());
    if (matches.value("fixes_by_map", nlohmann::ordered_json::array()).size() > 1) {
      throw DataError(name +
                      ": flew with several maps, and the plan is of one; run `pilotage simulate` without --also-map");
    }
  }
  for (const Simulation& other : input.simulations) {
    if (other.by_frames() != simulation.by_frames()) continue;
    throw DataError(name + ": is the second simulation with " + (other.by_frames() ? "frames" : "drawn fixes") +
                    "; a report takes one with drawn fixes and one by frames");
  }
  const auto at = simulation.by_frames() ? input.simulations.end() : input.simulations.begin();
  input.simulations.insert(at, std::move(simulation));
}

}  // namespace pilotage
