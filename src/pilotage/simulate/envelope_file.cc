#include "pilotage/simulate/envelope_file.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "pilotage/base/csv.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/svg.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

using EnvelopeJson = nlohmann::ordered_json;

constexpr double kCell_px = 52;
constexpr double kCellHeight_px = 40;
constexpr double kRowGap_px = 34;
constexpr double kNames_px = 250;

std::string world_name(const std::string& world) {
  return world.empty() ? "the mission's own imagery, changed" : world;
}

std::string factor_name(EnvelopeFactor factor) {
  return std::string(options_detail::enum_to_name(factor));
}

EnvelopeJson reach_json(const std::optional<Interval>& reached) {
  if (!reached) return nullptr;
  return EnvelopeJson::array({reached->low, reached->high});
}

std::string heights_text(const Interval& reached) {
  return reached.low == reached.high
             ? "at the planned height alone"
             : "from " + format_fixed(reached.low, 0) + " to " + format_fixed(reached.high, 0) + " m";
}

std::string margin_text(const Envelope& envelope, const HeightMargin& margin) {
  std::string text = "height, in " + world_name(envelope.worlds[margin.world]) + ": planned " +
                     format_fixed(envelope.planned_height_m, 0) + " m, P(correct) " +
                     probability_text(margin.planned_p) + "; ";
  text += margin.sure_m ? "surely above 0.5 " + heights_text(*margin.sure_m)
                        : "not surely above 0.5 even at the planned height";
  if (margin.as_good_m) text += "; at least 0.9 of the planned P " + heights_text(*margin.as_good_m);
  return text + "\n";
}

/// Cells that stand in one row of the drawing.
std::vector<std::vector<const EnvelopeCell*>> rows_of(const Envelope& envelope) {
  std::vector<std::vector<const EnvelopeCell*>> rows;
  for (const EnvelopeCell& cell : envelope.cells) {
    const bool same =
        !rows.empty() && rows.back().front()->factor == cell.factor && rows.back().front()->world == cell.world;
    if (!same) rows.emplace_back();
    rows.back().push_back(&cell);
  }
  return rows;
}

std::string cell_text(const EnvelopeCell& cell) {
  const Interval interval = cell.correct_share().interval();
  return "P(correct) " + probability_text(cell.p()) + " [" + probability_text(interval.low) + ", " +
         probability_text(interval.high) + "], " + std::to_string(cell.correct) + " correct and " +
         std::to_string(cell.wrong) + " false of " + std::to_string(cell.frames) + " frames" +
         (cell.wrong > 0 ? ", off by up to " + format_fixed(cell.largest_error_m, 1) + " m" : "");
}

std::string drawn_row(const Envelope& envelope, const std::vector<const EnvelopeCell*>& row, double y) {
  const SvgWriter svg;
  std::string text = svg.text("name", 8, y + 18, factor_name(row.front()->factor)) +
                     svg.text("world", 8, y + 34, world_name(envelope.worlds[row.front()->world]));
  double x = kNames_px;
  for (const EnvelopeCell* cell : row) {
    const int tenth = static_cast<int>(std::floor(std::clamp(cell->p(), 0.0, 1.0) * 10));
    const std::string type = cell->frames == 0 ? "p none" : "p p" + std::to_string(tenth);
    text += svg.rect(type, x, y, kCell_px - 2, kCellHeight_px, cell_text(*cell));
    text += svg.text(tenth >= 6 && cell->frames > 0 ? "share light" : "share", x + kCell_px / 2 - 1, y + 25,
                     cell->frames == 0 ? "–" : format_fixed(cell->p(), 2), " text-anchor=\"middle\"");
    if (cell->factor != EnvelopeFactor::kPlanned) {
      text += svg.text("value", x + kCell_px / 2 - 1, y + kCellHeight_px + 14, format_number(cell->value),
                       " text-anchor=\"middle\"");
    }
    x += kCell_px;
  }
  return text;
}

std::string svg_style() {
  std::string style =
      "<style>\ntext { font: 13px system-ui, sans-serif; fill: #1b1f23; }\n.name { font-weight: 700; }\n.world, .value "
      "{ "
      "font-size: 11px; fill: #57606a; }\n.share.light { fill: #fff; }\n.p.none { fill: #eee; }\n";
  for (int tenth = 0; tenth <= 10; ++tenth) {  // white to a dark blue
    const auto mixed = [&](int dark) { return std::to_string(245 + (dark - 245) * tenth / 10); };
    style +=
        ".p.p" + std::to_string(tenth) + " { fill: rgb(" + mixed(8) + ", " + mixed(64) + ", " + mixed(129) + "); }\n";
  }
  return style + "</style>\n";
}

}  // namespace

EnvelopeJson envelope_to_json(const Envelope& envelope) {
  const EnvelopeOptions& options = envelope.options;
  EnvelopeJson json = {{"pilotage_envelope", 1},
                       {"seed", envelope.seed},
                       {"frame_width_px", envelope.frame_width_px},
                       {"planned_height_m", envelope.planned_height_m},
                       {"correct_within_m", options.correct_within_m},
                       {"prior_sigma_m", options.prior_sigma_m},
                       {"tilt_sigma_deg", options.tilt_sigma_deg},
                       {"attitude_sigma_deg", options.attitude_sigma_deg},
                       {"altimeter_sigma", options.altimeter_sigma},
                       {"degradation", options.degradation},
                       {"worlds", envelope.worlds},
                       {"places", EnvelopeJson::array()},
                       {"cells", EnvelopeJson::array()},
                       {"height_margins", EnvelopeJson::array()},
                       {"notes", envelope.notes}};
  for (const EnvelopePlace& place : envelope.places) {
    json["places"].push_back({{"tile_id", place.tile_id}, {"p", place.p}});
  }
  for (const EnvelopeCell& cell : envelope.cells) {
    const Interval correct = cell.correct_share().interval();
    const Interval wrong = cell.wrong_share().interval();
    json["cells"].push_back(
        {{"factor", factor_name(cell.factor)},
         {"value", cell.factor == EnvelopeFactor::kPlanned ? EnvelopeJson() : EnvelopeJson(cell.value)},
         {"world", cell.world},
         {"frames", cell.frames},
         {"correct", cell.correct},
         {"false", cell.wrong},
         {"p_correct", json_number(cell.correct_share().value())},
         {"p_correct_low", correct.low},
         {"p_correct_high", correct.high},
         {"false_share_low", wrong.low},
         {"false_share_high", wrong.high},
         {"largest_error_m", json_number(cell.largest_error_m)}});
  }
  for (const HeightMargin& margin : envelope.margins) {
    json["height_margins"].push_back({{"world", margin.world},
                                      {"planned_p_correct", margin.planned_p},
                                      {"surely_above_half_m", reach_json(margin.sure_m)},
                                      {"as_good_as_planned_m", reach_json(margin.as_good_m)}});
  }
  return json;
}

std::string envelope_to_csv(const Envelope& envelope) {
  std::string text =
      "factor,value,world,frames,correct,false,p_correct,p_correct_low,p_correct_high,false_share_low,false_share_"
      "high,largest_error_m\n";
  for (const EnvelopeCell& cell : envelope.cells) {
    text += factor_name(cell.factor) + "," +
            (cell.factor == EnvelopeFactor::kPlanned ? "" : format_number(cell.value)) + "," +
            csv_cell(envelope.worlds[cell.world]) + "," + std::to_string(cell.frames) + "," +
            std::to_string(cell.correct) + "," + std::to_string(cell.wrong) + "," +
            (cell.frames > 0 ? format_number(cell.correct_share().value()) : "");
    const Interval correct = cell.correct_share().interval();
    const Interval wrong = cell.wrong_share().interval();
    for (const double bound : {correct.low, correct.high, wrong.low, wrong.high}) {
      text += "," + format_number(bound);
    }
    text += "," + (std::isnan(cell.largest_error_m) ? "" : format_number(cell.largest_error_m)) + "\n";
  }
  return text;
}

std::string envelope_to_svg(const Envelope& envelope) {
  std::string body;
  double y = 44;
  std::size_t widest = 1;
  for (const auto& row : rows_of(envelope)) {
    body += drawn_row(envelope, row, y);
    widest = std::max(widest, row.size());
    y += kCellHeight_px + kRowGap_px;
  }
  const SvgWriter svg;
  const double width = kNames_px + kCell_px * static_cast<double>(std::max<std::size_t>(widest, 6)) + 8;
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + svg.number(width) + " " + svg.number(y) +
         "\">\n" + svg_style() +
         svg.text("name", 8, 24,
                  "P(correct fix) at " + std::to_string(envelope.places.size()) + " places, planned height " +
                      format_fixed(envelope.planned_height_m, 0) + " m") +
         "\n" + body + "\n</svg>\n";
}

std::string envelope_text(const Envelope& envelope) {
  std::string text;
  for (const EnvelopeCell& cell : envelope.cells) {
    text += factor_name(cell.factor);
    if (cell.factor != EnvelopeFactor::kPlanned) text += " " + format_number(cell.value);
    text += " in " + world_name(envelope.worlds[cell.world]) + ": " + cell_text(cell) + "\n";
  }
  for (const HeightMargin& margin : envelope.margins) text += margin_text(envelope, margin);
  text += "note: ";
  for (std::size_t i = 0; i < envelope.notes.size(); ++i) text += (i > 0 ? "; " : "") + envelope.notes[i];
  return text + "\n";
}

}  // namespace pilotage
