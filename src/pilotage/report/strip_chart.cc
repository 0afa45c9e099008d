#include "pilotage/report/strip_chart.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pilotage/base/markup.h"
#include "pilotage/base/svg.h"
#include "pilotage/base/text.h"
#include "pilotage/base/wording.h"
#include "pilotage/report/report.h"

namespace pilotage {
namespace {

constexpr double kHeight = 322;
constexpr double kTop = 16;
constexpr double kBottom = 200;
// Below the ribbons, where GNSS may be lost anywhere.
constexpr double kLossTop = kBottom + 106;
constexpr double kLossBottom = kLossTop + 50;

struct Axes {
  double height = kHeight;
  double distance_m = 1;  ///< At the right end.
  double error_m = 1;     ///< At the top.

  double x(double at_m) const {
    return kChartLeft + std::clamp(at_m / distance_m, 0.0, 1.0) * (kChartRight - kChartLeft);
  }
  // What is unknown or unbounded is drawn at the top.
  double y(double at_m) const {
    const double share = std::isfinite(at_m) ? std::clamp(at_m / error_m, 0.0, 1.0) : 1.0;
    return kBottom - share * (kBottom - kTop);
  }
};

constexpr SvgWriter kSvg{.decimals = 1};

// From corner to corner, never narrower than can be seen.
std::string band(const std::string& type, double x1, double y1, double x2, double y2, const std::string& title) {
  return kSvg.rect(type, x1, y1, std::max(x2 - x1, 1.0), y2 - y1, title);
}

bool has_loss_curve(const Report& report) {
  return report.loss_anywhere && report.probability && !report.loss_anywhere->points.empty();
}

Axes make_axes(const Report& report) {
  Axes axes;
  axes.distance_m = chart_distance_m(report);
  double most_m = std::isfinite(report.max_error_m) ? std::max(report.max_error_m, 1.0) : 1.0;
  for (const ErrorSample& sample : report.error_profile) {
    if (std::isfinite(sample.error_m)) most_m = std::max(most_m, sample.error_m);
  }
  axes.error_m = most_m * 1.08;
  if (has_loss_curve(report)) axes.height = kHeight + kLossBottom - kLossTop + 30;
  return axes;
}

std::string error_lines(const Axes& axes) {
  std::string svg;
  const double step_m = tick_step(axes.error_m, 5);
  for (int i = 0; i * step_m <= axes.error_m; ++i) {
    svg += kSvg.line("grid", kChartLeft, axes.y(i * step_m), kChartRight, axes.y(i * step_m));
    svg += kSvg.text("tick-y", kChartLeft - 8, axes.y(i * step_m) + 5, format_number(i * step_m));
  }
  return svg;
}

std::string distance_ticks(const Axes& axes) {
  std::string svg;
  const bool kilometres = axes.distance_m >= 2000;
  const double unit_m = kilometres ? 1000 : 1;
  const double along_step_m = tick_step(axes.distance_m / unit_m, 12) * unit_m;
  for (int i = 0; i * along_step_m <= axes.distance_m; ++i) {
    const double x = axes.x(i * along_step_m);
    svg += kSvg.line("tick", x, kBottom, x, kBottom + 6);
    svg += kSvg.text(i % 2 == 0 ? "tick-x" : "tick-x odd", x, kBottom + 22,
                     format_number(std::round(i * along_step_m / unit_m * 1e6) / 1e6));
  }
  svg += kSvg.text("axis", (kChartLeft + kChartRight) / 2, axes.height - 6,
                   std::string("Distance along the route (") + (kilometres ? "km)" : "m)"));
  svg += "<text class=\"axis\" transform=\"translate(16 " + kSvg.number((kTop + kBottom) / 2) +
         ") rotate(-90)\">Predicted error (m)</text>\n";
  return svg;
}

std::string error_curve(const Report& report, const Axes& axes) {
  if (report.error_profile.empty())
    return kSvg.text("axis", (kChartLeft + kChartRight) / 2, (kTop + kBottom) / 2, "No prediction along the route");
  std::string path;
  for (const ErrorSample& sample : report.error_profile) {
    path +=
        (path.empty() ? "M" : "L") + kSvg.number(axes.x(sample.distance_m)) + " " + kSvg.number(axes.y(sample.error_m));
  }
  const std::string area = path + "L" + kSvg.number(axes.x(report.error_profile.back().distance_m)) + " " +
                           kSvg.number(kBottom) + "L" + kSvg.number(axes.x(report.error_profile.front().distance_m)) +
                           " " + kSvg.number(kBottom) + "Z";
  return "<path class=\"area\" d=\"" + area + "\"/>\n<path class=\"curve\" d=\"" + path + "\"/>\n";
}

// P(correct fix) of the tile under each place, in the colours of its heat map from 0 to 1; nothing without
// probabilities.
std::string probability_ribbon(const Report& report, const Axes& axes, double top) {
  constexpr int kShades = 16;  // neighbours of one shade become one rectangle
  const std::vector<ErrorSample>& profile = report.error_profile;
  const std::array<Rgb, 256> colors = color_table(ColorMap::kBlues);
  const auto shade_of = [](const ErrorSample& sample) {
    if (std::isnan(sample.p_correct_fix)) return -1;
    return std::min(kShades - 1, static_cast<int>(std::clamp(sample.p_correct_fix, 0.0, 1.0) * kShades));
  };
  std::string svg;
  for (std::size_t from = 0; from < profile.size();) {
    const int shade = shade_of(profile[from]);
    std::size_t to = from + 1;
    while (to < profile.size() && shade_of(profile[to]) == shade) ++to;
    const double x1 = axes.x(profile[from].distance_m);
    const double x2 = axes.x(profile[std::min(to, profile.size() - 1)].distance_m);
    if (shade >= 0) {
      svg += "<rect x=\"" + kSvg.number(x1) + "\" y=\"" + kSvg.number(top) + "\" width=\"" +
             kSvg.number(std::max(x2 - x1, 0.5)) + "\" height=\"12\" fill=\"" +
             hex_color(colors[static_cast<std::size_t>(shade * 255 / (kShades - 1))]) + "\"/>";
    }
    from = to;
  }
  if (svg.empty()) return "";
  return "<g><title>P(correct fix) of the chosen tile under the route: pale 0, dark blue 1</title>" + svg + "</g>\n" +
         kSvg.text("ribbon", kChartLeft - 8, top + 11.5, "P(fix)");
}

std::string ribbons(const Report& report, const Axes& axes) {
  std::string svg;
  const double leg_top = kBottom + 30;
  for (const ReportLeg& leg : report.legs) {
    if (!std::isfinite(leg.from_distance_m)) continue;
    const double x1 = axes.x(leg.from_distance_m);
    const double x2 = axes.x(leg.from_distance_m + leg.status.length_m);
    const std::string number = std::to_string(leg.status.leg + 1);
    svg += band("leg " + std::string(status_name(leg.quality)), x1, leg_top, x2, leg_top + 16,
                "Leg " + number + ": largest error " + comparison_text(leg.status.max_error_m, report.max_error_m) +
                    (std::isnan(leg.status.p_within_limit)
                         ? ""
                         : ", within the limit with P = " + probability_text(leg.status.p_within_limit)));
    if (x2 - x1 >= 26)
      svg += kSvg.text(x2 - x1 >= 60 ? "leg-number" : "leg-number tight", (x1 + x2) / 2, leg_top + 12.5, number);
  }
  svg += kSvg.text("ribbon", kChartLeft - 8, leg_top + 12.5, "Legs");
  const double fix_top = leg_top + 25;  // far enough for the larger letters of a small screen
  std::string path;
  for (const FixStretch& fix : report.fixes) {
    const double x1 = axes.x(fix.from_distance_m);
    path += "M" + kSvg.number(x1) + " " + kSvg.number(fix_top) + "h" +
            kSvg.number(std::max(axes.x(fix.to_distance_m) - x1, 1.0)) + "v12H" + kSvg.number(x1) + "Z";
  }
  if (!path.empty())
    svg += "<path class=\"fixes\" d=\"" + path + "\"><title>Over selected tiles: fixes are expected</title></path>\n";
  svg += kSvg.text("ribbon", kChartLeft - 8, fix_top + 11.5, "Fixes");
  return svg + probability_ribbon(report, axes, fix_top + 21);
}

// P of the whole flight by the place where GNSS is lost, on a scale of its own below the ribbons.
std::string loss_curve(const Report& report, const Axes& axes) {
  if (!has_loss_curve(report)) return "";
  const auto y = [](double p) { return kLossBottom - std::clamp(p, 0.0, 1.0) * (kLossBottom - kLossTop); };
  std::string svg;
  for (const double p : {0.0, 1.0}) {
    svg += kSvg.line("grid", kChartLeft, y(p), kChartRight, y(p));
    svg += kSvg.text("tick-y", kChartLeft - 8, y(p) + 5, format_number(p));
  }
  const double asked = report.probability->min_p_within_limit;
  svg += kSvg.line("limit", kChartLeft, y(asked), kChartRight, y(asked));
  std::string path;
  for (const LossPoint& point : report.loss_anywhere->points) {
    if (std::isnan(point.p_within_limit)) continue;
    path +=
        (path.empty() ? "M" : "L") + kSvg.number(axes.x(point.distance_m)) + " " + kSvg.number(y(point.p_within_limit));
  }
  const LossPoint& worst = report.loss_anywhere->points[report.loss_anywhere->worst];
  svg += "<path class=\"curve loss\" d=\"" + path +
         "\"><title>P that the flight stays within the limit, by where GNSS is lost for good: " + "at worst " +
         probability_text(worst.p_within_limit) + ", lost at " + length_text(worst.distance_m) + "; asked for " +
         probability_text(asked) + "</title></path>\n";
  return svg + kSvg.text("loss-label", kChartLeft, kLossBottom + 16,
                         "P within the limit, if GNSS is lost here (dashed: asked for)");
}

// Half and 95 of 100 of the simulated flights' true errors; what a chart of the plan's errors cannot hold runs along
// its top.
std::string simulated_curves(const Report& report, const Axes& axes) {
  if (report.simulations.empty()) return "";
  const auto curve = [&](const char* type, const char* what, double SimulatedMark::*error_m) {
    std::string path;
    for (const SimulatedMark& mark : report.simulations.front().marks) {
      if (std::isnan(mark.*error_m)) continue;
      path +=
          (path.empty() ? "M" : "L") + kSvg.number(axes.x(mark.distance_m)) + " " + kSvg.number(axes.y(mark.*error_m));
    }
    return "<path class=\"" + std::string(type) + "\" d=\"" + path + "\"><title>" + what +
           " of the simulated flights, lost ones with them</title></path>\n";
  };
  return curve("simulated-cep50", "CEP50", &SimulatedMark::cep50_m) +
         curve("simulated-r95", "R95", &SimulatedMark::r95_m);
}

// Where GNSS is denied: a light band behind all else, with a bar and words above the plot.
std::string denied_bands(const Report& report, const Axes& axes) {
  std::string svg;
  for (const DeniedStretch& stretch : report.denied) {
    const double x1 = axes.x(stretch.from_distance_m);
    const double x2 = axes.x(stretch.to_distance_m);
    const std::string words = report.loss_anywhere ? "GNSS lost for good: the worst point" : "GNSS denied";
    svg += band("denied", x1, kTop, x2, kBottom,
                words + ", " + length_text(stretch.from_distance_m) + " to " + length_text(stretch.to_distance_m));
    svg += kSvg.line("denied-edge", x1, kTop - 2, std::max(x2, x1 + 1), kTop - 2);
    if (x2 - x1 >= 7.5 * static_cast<double>(words.size())) {
      svg += kSvg.text("denied-label", (x1 + x2) / 2, kTop - 5, words);
    }
  }
  return svg;
}

// Bad ones are hatched too, so that colour is not alone. Wide ones say how long they are.
std::string gap_bands(const Report& report, const Axes& axes) {
  std::string svg;
  for (const ReportGap& gap : report.gaps) {
    const double x1 = axes.x(gap.gap.from_distance_m);
    const double x2 = axes.x(gap.gap.to_distance_m);
    const std::string title = "Gap of " + length_text(gap.length_m) + ", error at its end " +
                              comparison_text(gap.gap.error_m, report.max_error_m);
    svg += band("gap " + std::string(status_name(gap.quality)), x1, kTop, x2, kBottom, title);
    if (gap.quality == QualityStatus::kBad) svg += band("hatch", x1, kTop, x2, kBottom, title);
  }
  return svg;
}

// Where most flights are lost, over the gaps: a bar with words where there is room.
std::string lost_band(const Report& report, const Axes& axes) {
  const WorstStretch* worst = most_lost(report);
  if (worst == nullptr) return "";
  const double x1 = axes.x(worst->from_distance_m);
  const double x2 = std::max(axes.x(worst->to_distance_m), x1 + 4);
  std::string svg = band("lost", x1, kTop, x2, kTop + 10,
                         std::string(kMostLost) + ", P = " + probability_text(worst->p_first_excess) + ": " +
                             length_text(worst->from_distance_m) + " to " + length_text(worst->to_distance_m));
  const double width = 7.5 * static_cast<double>(std::string_view(kMostLost).size());
  if (x2 - x1 >= width) svg += kSvg.text("lost-label", (x1 + x2) / 2, kTop + 26, kMostLost);
  return svg;
}

std::string gap_labels(const Report& report, const Axes& axes) {
  std::string svg;
  for (const ReportGap& gap : report.gaps) {
    const double x1 = axes.x(gap.gap.from_distance_m);
    const double x2 = axes.x(gap.gap.to_distance_m);
    if (x2 - x1 < 70) continue;
    svg += kSvg.text("gap-label", (x1 + x2) / 2, kBottom - 8,
                     (gap.quality == QualityStatus::kBad ? "✕ " : "") + length_text(gap.length_m));
  }
  return svg;
}

}  // namespace

double chart_distance_m(const Report& report) {
  double distance_m = std::max(report.route_length_m, 1.0);
  if (!report.error_profile.empty()) distance_m = std::max(distance_m, report.error_profile.back().distance_m);
  for (const ReportGap& gap : report.gaps) {
    if (std::isfinite(gap.gap.to_distance_m)) distance_m = std::max(distance_m, gap.gap.to_distance_m);
  }
  return distance_m;
}

double tick_step(double extent, int most) {
  if (!(extent > 0) || !std::isfinite(extent)) return 1;
  const double power = std::pow(10, std::floor(std::log10(extent / most)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (extent / (factor * power) <= most) return factor * power;
  }
  return 10 * power;
}

std::string strip_chart_svg(const Report& report) {
  const Axes axes = make_axes(report);
  std::string svg = "<svg id=\"chart\" class=\"strip\" viewBox=\"0 0 " + kSvg.number(kChartWidth) + " " +
                    kSvg.number(axes.height) + "\" preserveAspectRatio=\"none\" role=\"img\" aria-label=\"" +
                    html_escape("Predicted position error along the route. " + report.verdict_text) +
                    "\" data-left=\"" + kSvg.number(kChartLeft) + "\" data-right=\"" + kSvg.number(kChartRight) +
                    "\" data-top=\"" + kSvg.number(kTop) + "\" data-bottom=\"" + kSvg.number(kBottom) +
                    "\" data-distance-m=\"" + format_number(axes.distance_m) + "\" data-error-m=\"" +
                    format_number(axes.error_m) + "\">\n";
  svg +=
      "<defs><pattern id=\"chart-hatch\" width=\"9\" height=\"9\" patternUnits=\"userSpaceOnUse\" "
      "patternTransform=\"rotate(45)\"><line y2=\"9\"/></pattern></defs>\n";
  // What the page draws anew for other settings (page_what_if.js).
  svg += "<g id=\"chart-plot\">\n" + denied_bands(report, axes) + gap_bands(report, axes) + lost_band(report, axes) +
         error_lines(axes) + error_curve(report, axes);
  if (std::isfinite(report.max_error_m)) {
    const double y = axes.y(report.max_error_m);
    svg += kSvg.line("limit", kChartLeft, y, kChartRight, y);
    svg += kSvg.text("limit-label", kChartLeft + 8, y < kTop + 24 ? y + 18 : y - 6,
                     "limit " + error_text(report.max_error_m));
  }
  svg += gap_labels(report, axes) + "</g>\n<g id=\"chart-simulated\">" + simulated_curves(report, axes) + "</g>\n";
  svg += distance_ticks(axes) + kSvg.line("axis-line", kChartLeft, kBottom, kChartRight, kBottom) +
         ribbons(report, axes) + "<g id=\"chart-loss\">" + loss_curve(report, axes) + "</g>\n";
  svg += "<g id=\"chart-cursor\" visibility=\"hidden\"><line class=\"cursor\" y1=\"" + kSvg.number(kTop) + "\" y2=\"" +
         kSvg.number(kBottom) + "\"/><circle class=\"cursor-dot\" r=\"5\"/></g>\n</svg>";
  return svg;
}

}  // namespace pilotage
