#include "pilotage/matchability/reliability_diagram.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pilotage/base/error.h"
#include "pilotage/base/markup.h"
#include "pilotage/base/svg.h"
#include "pilotage/base/text.h"
#include "pilotage/matchability/quality_report.h"

namespace pilotage {
namespace {

constexpr int kHistogramBars = 20;
constexpr double kWidth = 560;
constexpr double kHeight = 668;
constexpr double kLeft = 72;
constexpr double kSide = 448;  // of the square plot
constexpr double kTop = 102;
constexpr double kHistogramTop = kTop + kSide + 22;
constexpr double kHistogramHeight = 44;

// Both palettes keep 4.5 : 1 against their background.
constexpr std::string_view kStyle = R"(<style>
.reliability { --paper: #ffffff; --ink: #1b1f24; --faint: #59636e; --grid: #d8dee4; --mark: #0b62b8; }
@media (prefers-color-scheme: dark) {
  .reliability { --paper: #14181d; --ink: #e8ecf0; --faint: #a3adb8; --grid: #343c45; --mark: #6cb6ff; }
}
.reliability { font: 13px system-ui, sans-serif; }
.reliability .paper { fill: var(--paper); }
.reliability text { fill: var(--ink); }
.reliability .title { font-size: 16px; font-weight: 600; }
.reliability .small { fill: var(--faint); font-size: 12px; }
.reliability .middle { text-anchor: middle; }
.reliability .end { text-anchor: end; }
.reliability .grid { stroke: var(--grid); stroke-width: 1; }
.reliability .diagonal { stroke: var(--faint); stroke-width: 1.5; stroke-dasharray: 6 4; }
.reliability .base { stroke: var(--faint); stroke-width: 1; stroke-dasharray: 2 3; }
.reliability .interval { stroke: var(--mark); stroke-width: 2; }
.reliability .curve { fill: none; stroke: var(--mark); stroke-width: 1; opacity: 0.6; }
.reliability .dot { fill: var(--mark); }
.reliability .bar { fill: var(--mark); opacity: 0.7; }
</style>
)";

constexpr SvgWriter kSvg{.decimals = 2};

double x_of(double probability) {
  return kLeft + probability * kSide;
}

double y_of(double rate) {
  return kTop + (1 - rate) * kSide;
}

std::string heading(const std::string& title, const PredictionQuality& quality) {
  const std::string ranking =
      "AUC " + estimate_text(quality.auc, 2) + " · Brier skill " + estimate_text(quality.brier_skill, 2);
  std::string calibration = "calibration error " + estimate_text(quality.calibration_error, 3);
  if (!std::isnan(quality.chance_calibration_error)) {
    calibration += "; chance alone gives " + format_fixed(quality.chance_calibration_error, 3);
  }
  std::string counts = std::to_string(quality.count) + " judged, " + std::to_string(quality.correct) + " correct";
  if (quality.count > 0) counts += " (" + format_fixed(100 * quality.base_rate, 1) + " %)";
  counts += ", " + std::to_string(quality.blocks) + " blocks";
  return kSvg.text("title", 16, 26, title) + kSvg.text("", 16, 48, ranking) + kSvg.text("", 16, 66, calibration) +
         kSvg.text("small", 16, 84, counts);
}

std::string axes() {
  std::string svg;
  for (int step = 0; step <= 5; ++step) {
    const double share = step / 5.0;
    svg += kSvg.line("grid", x_of(share), y_of(0), x_of(share), y_of(1));
    svg += kSvg.line("grid", x_of(0), y_of(share), x_of(1), y_of(share));
    svg += kSvg.text("small end", kLeft - 8, y_of(share) + 4, format_fixed(share, 1));
    svg += kSvg.text("small middle", x_of(share), kHistogramTop + kHistogramHeight + 16, format_fixed(share, 1));
  }
  svg += kSvg.text("middle", 22, y_of(0.5), "share that came true",
                   " transform=\"rotate(-90 22 " + kSvg.number(y_of(0.5)) + ")\"");
  svg += kSvg.text("middle", x_of(0.5), kHistogramTop + kHistogramHeight + 36, "probability promised");
  return svg;
}

std::string marks(const PredictionQuality& quality) {
  std::string svg = kSvg.line("diagonal", x_of(0), y_of(0), x_of(1), y_of(1));
  if (quality.count > 0) svg += kSvg.line("base", x_of(0), y_of(quality.base_rate), x_of(1), y_of(quality.base_rate));
  std::string points;
  for (const ReliabilityBin& bin : quality.bins) {
    points +=
        (points.empty() ? "" : " ") + kSvg.number(x_of(bin.mean_value)) + "," + kSvg.number(y_of(bin.correct.value()));
  }
  if (quality.bins.size() > 1) svg += "<polyline class=\"curve\" points=\"" + points + "\"/>\n";
  for (const ReliabilityBin& bin : quality.bins) {
    const double x = x_of(bin.mean_value);
    const Interval interval = bin.correct.interval();
    svg += kSvg.line("interval", x, y_of(interval.low), x, y_of(interval.high));
    svg += "<circle class=\"dot\" cx=\"" + kSvg.number(x) + "\" cy=\"" + kSvg.number(y_of(bin.correct.value())) +
           "\" r=\"4.5\"><title>promised " + format_fixed(bin.mean_value, 3) + " (" + format_fixed(bin.low, 3) + " … " +
           format_fixed(bin.high, 3) + "), came true " + std::to_string(bin.correct.count) + " of " +
           std::to_string(bin.correct.of) + " = " + format_fixed(bin.correct.value(), 3) + " (" +
           format_fixed(interval.low, 3) + " … " + format_fixed(interval.high, 3) + ")</title></circle>\n";
  }
  return svg;
}

std::string histogram(std::span<const JudgedPrediction> predictions) {
  std::array<std::int64_t, kHistogramBars> counts{};
  for (const JudgedPrediction& prediction : predictions) {
    if (std::isnan(prediction.value)) continue;
    const double place = std::clamp(prediction.value, 0.0, 1.0) * kHistogramBars;
    ++counts[std::min<std::size_t>(static_cast<std::size_t>(place), kHistogramBars - 1)];
  }
  const std::int64_t most = *std::max_element(counts.begin(), counts.end());
  std::string svg;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] == 0) continue;
    const double height = kHistogramHeight * static_cast<double>(counts[i]) / static_cast<double>(most);
    svg +=
        kSvg.rect("bar", x_of(static_cast<double>(i) / kHistogramBars) + 1, kHistogramTop + kHistogramHeight - height,
                  kSide / kHistogramBars - 2, height, std::to_string(counts[i]) + " predictions");
  }
  svg += kSvg.text("small end", kLeft - 8, kHistogramTop + 10, std::to_string(most));
  return svg + kSvg.line("grid", x_of(0), kHistogramTop + kHistogramHeight, x_of(1), kHistogramTop + kHistogramHeight);
}

}  // namespace

std::string reliability_diagram_svg(const std::string& title, const PredictionQuality& quality,
                                    std::span<const JudgedPrediction> predictions) {
  if (!quality.probability) throw UsageError("a reliability diagram is for probabilities");
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"reliability\" role=\"img\" viewBox=\"0 0 " +
                    kSvg.number(kWidth) + " " + kSvg.number(kHeight) + "\" width=\"" + kSvg.number(kWidth) +
                    "\" height=\"" + kSvg.number(kHeight) + "\">\n";
  svg += "<title>Reliability diagram: " + html_escape(title) + "</title>\n";
  svg += kStyle;
  svg += "<rect class=\"paper\" width=\"" + kSvg.number(kWidth) + "\" height=\"" + kSvg.number(kHeight) + "\"/>\n";
  svg += heading(title, quality) + axes() + marks(quality) + histogram(predictions);
  return svg + "</svg>\n";
}

}  // namespace pilotage
