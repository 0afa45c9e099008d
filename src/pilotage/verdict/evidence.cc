#include "pilotage/verdict/evidence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include <nlohmann/json.hpp>

#include "pilotage/base/statistics.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"
#include "pilotage/base/wording.h"
#include "pilotage/mission/simulation_file.h"

namespace pilotage {
namespace {

constexpr double kMarginalSigmas = 2;
constexpr double kBadSigmas = 3;

/// A kind of evidence: what it is called, the words for it where it is not there ("" for the model),
/// the row of the quality table that holds it, how to get it.
struct EvidenceKind {
  std::string_view word;
  std::string_view what;
  std::string_view row;
  std::string_view get_it;
};

// Strongest first.
constexpr std::array<EvidenceKind, 4> kKinds = {
    {{"flown", "flown flights", "flown_flights",
      "`pilotage replay` holds flights against the plan, `report --replay` takes it"},
     {"rendered", "frames of another date", "rendered_flights",
      "`pilotage simulate --fixes rendered --world` flies frames of another date, `report --simulation` takes it"},
     {"drawn", "drawn flights", "simulated_flights",
      "`pilotage simulate` draws flights, `report --simulation` takes it"},
     {"modelled", "", "route_probability", "score with the measure `correct_fix`: no tile has a P"}}};

std::string sigmas_text(double z) {
  return (z < 0 ? "−" : "+") + format_fixed(std::abs(z), 1) + " σ";
}

/// More false fixes than the rate that the plan reckons with.
bool too_many_false(const FlownAgainstPlan& flown, const Selection& selection) {
  if (flown.false_taken == 0 || !selection.tries) return false;
  return Share{flown.false_taken, flown.without_right}.interval().low > selection.tries->false_fix_rate;
}

const QualityRow* row_named(const std::vector<QualityRow>& rows, std::string_view name) {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const QualityRow& row) { return row.name == name; });
  return found == rows.end() ? nullptr : &*found;
}

/// What a row says, and how good that is; `absent` without one.
std::string judged_text(const QualityRow* row, const std::string& absent) {
  return row == nullptr ? absent : row->value + " (" + std::string(status_name(row->status)) + ")";
}

}  // namespace

QualityRow flown_row(const FlownAgainstPlan& flown, const Selection& selection) {
  QualityRow row;
  row.name = "flown_flights";
  row.label = "Fixes that came on flown flights";
  row.kind = NumberKind::kMeasured;
  row.unit = "1";
  row.threshold =
      "bad where fewer came than predicted by 3 σ with the level of the place; marginal by 2, by 3 σ were tries "
      "independent, or with more false fixes than are reckoned with";
  row.decides = true;
  if (flown.tries > 0) {
    row.number = Share{flown.fixes, flown.tries}.value();
    row.value = share_text({flown.fixes, flown.tries}) + ", " + std::to_string(flown.fixes) + " of " +
                std::to_string(flown.tries) + " tries; predicted " + probability_text(flown.predicted) + ": " +
                sigmas_text(flown.z_with_level) + " with the level of the place, " + sigmas_text(flown.z) +
                " were tries independent";
  } else {
    row.value = "no try over a stored tile with a P";
  }
  if (flown.z_with_level < -kBadSigmas) {
    row.status = QualityStatus::kBad;
  } else if (flown.z_with_level < -kMarginalSigmas || flown.z < -kBadSigmas) {
    row.status = QualityStatus::kMarginal;
  }
  if (row.status != QualityStatus::kGood) {
    row.advice =
        "This ground is found less often than its P says: refit P with what was flown (replay --calibration, "
        "calibrate), or refresh the imagery.";
  }
  if (too_many_false(flown, selection)) {
    row.status = std::max(row.status, QualityStatus::kMarginal);
    row.value += "; false " + share_text({flown.false_taken, flown.without_right}) + " of tries without a right fix, " +
                 format_number(selection.tries->false_fix_rate) + " reckoned with";
    row.advice +=
        std::string(row.advice.empty() ? "" : " ") +
        "More fixes are false than are reckoned with: look at them (replay --fixes) before flying by this map.";
  }
  return row;
}

QualityRow simulated_row(const Simulation& simulation, const Selection& selection) {
  const bool by_frames = simulation.by_frames();
  QualityRow row;
  row.name = by_frames ? "rendered_flights" : "simulated_flights";
  row.label = by_frames ? "Flights by computed frames that stay within the limit"
                        : "Simulated flights that stay within the limit";
  row.kind = NumberKind::kSimulated;
  row.number = simulation.within.value();
  row.unit = "1";
  row.value = share_text(simulation.within) + ", " + flights_of(simulation.within) + "; planned " +
              probability_text(simulation.planned_p) + (by_frames ? "; " + frames_of_text(simulation) : "");
  if (!selection.probability) {
    row.threshold = "none: the plan has no probability";
    return row;
  }
  const double asked = selection.probability->min_p_within_limit;
  // A flight by frames takes seconds, so that flights are few: what they do not bound, they do not contradict as long
  // as their share is what is asked for.
  row.threshold = "good when " + std::string(by_frames ? "it" : "the lower end of the interval") + " reaches " +
                  probability_text(asked) + ", bad when the upper end of the interval does not";
  row.decides = true;
  if ((by_frames ? simulation.within.value() : simulation.within.interval().low) >= asked) return row;
  row.status = simulation.within.interval().high < asked ? QualityStatus::kBad : QualityStatus::kMarginal;
  row.advice =
      row.status == QualityStatus::kBad
          ? most_lost_text(simulation)
          : "The interval holds what is asked for: fly more (--flights) to know. " + most_lost_text(simulation);
  return row;
}

std::string flights_of(const Share& share) {
  return std::to_string(share.count) + " of " + std::to_string(share.of) + " flights";
}

std::string frames_of_text(const Simulation& simulation) {
  const std::string world = simulation.rendered.value("world", "");
  if (simulation.options.value("fixes", "") == "airsim") return "frames of a simulator";
  return world.empty() ? "frames of the map's own imagery, changed" : "frames of " + name_as_utf8(world);
}

std::string most_lost_text(const Simulation& simulation) {
  const auto worst = std::max_element(simulation.marks.begin(), simulation.marks.end(),
                                      [](const SimulatedMark& a, const SimulatedMark& b) { return a.lost < b.lost; });
  if (worst == simulation.marks.end() || worst->lost == 0) return "No flight is lost.";
  const double from_m = worst == simulation.marks.begin() ? 0 : (worst - 1)->distance_m;
  return "Most flights are lost from " + length_text(from_m) + " to " + length_text(worst->distance_m) + ": " +
         std::to_string(worst->lost) + " of " + std::to_string(simulation.flights - simulation.within.count) +
         " that are lost, " + duration_text(worst->planned_time_s) + " into the flight at planned speed.";
}

std::vector<const QualityRow*> evidence_rows(const std::vector<QualityRow>& rows) {
  std::vector<const QualityRow*> found;
  for (const EvidenceKind& kind : kKinds) {
    if (const QualityRow* row = row_named(rows, kind.row)) found.push_back(row);
  }
  return found;
}

const QualityRow* contradiction(const std::vector<QualityRow>& rows) {
  const std::vector<const QualityRow*> chain = evidence_rows(rows);
  const auto is_bad = [](const QualityRow* row) { return row->decides && row->status == QualityStatus::kBad; };
  const auto against = std::find_if(chain.begin(), chain.end(), is_bad);
  return std::all_of(against, chain.end(), is_bad) ? nullptr : *against;
}

std::string missing_evidence(const std::vector<QualityRow>& rows) {
  std::vector<std::string> missing;
  for (const EvidenceKind& kind : kKinds) {
    if (!kind.what.empty() && row_named(rows, kind.row) == nullptr) missing.emplace_back(kind.what);
  }
  return missing.empty() ? "" : "not there: " + join(missing, ", ");
}

std::vector<std::string> evidence_lines(const std::vector<QualityRow>& rows) {
  std::vector<std::string> lines;
  for (const EvidenceKind& kind : kKinds) {
    lines.push_back(std::string(kind.word) + ": " +
                    judged_text(row_named(rows, kind.row), "none; " + std::string(kind.get_it)));
  }
  return lines;
}

std::string evidence_line(const std::vector<QualityRow>& rows) {
  std::vector<std::string> said;
  for (const EvidenceKind& kind : kKinds) {
    said.push_back(std::string(kind.word) + " " + judged_text(row_named(rows, kind.row), "none"));
  }
  return "evidence, strongest first: " + join(said, "; ");
}

}  // namespace pilotage
