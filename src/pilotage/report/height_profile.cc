#include "pilotage/report/height_profile.h"

#include <algorithm>
#include <cmath>

#include "pilotage/base/svg.h"
#include "pilotage/base/text.h"
#include "pilotage/base/wording.h"
#include "pilotage/report/strip_chart.h"

namespace pilotage {
namespace {

constexpr std::size_t kMostSamples = 1000;
constexpr double kHeightOfDrawing = 170;
constexpr double kTopOfHeights = 12;
constexpr double kBottomOfHeights = 140;

constexpr SvgWriter kHeightSvg{.decimals = 1};

double agl_m(const HeightSample& sample) {
  return sample.flown_m - sample.ground_m;
}

/// The first sample of each run of equal length, and its lowest above ground.
std::vector<HeightSample> thin(const std::vector<HeightSample>& all) {
  if (all.size() <= kMostSamples) return all;
  const std::size_t runs = kMostSamples / 2 - 1;
  std::vector<HeightSample> kept;
  for (std::size_t run = 0; run < runs; ++run) {
    const auto from = all.begin() + static_cast<std::ptrdiff_t>(run * all.size() / runs);
    const auto to = all.begin() + static_cast<std::ptrdiff_t>((run + 1) * all.size() / runs);
    const auto lowest =
        std::min_element(from, to, [](const HeightSample& a, const HeightSample& b) { return agl_m(a) < agl_m(b); });
    kept.push_back(*from);
    if (lowest != from) kept.push_back(*lowest);
  }
  kept.push_back(all.back());
  return kept;
}

}  // namespace

HeightProfile height_profile(const Flight& flight) {
  HeightProfile profile;
  profile.min_agl_m = flight.min_agl_m;
  profile.above_sea = std::any_of(flight.samples.begin(), flight.samples.end(),
                                  [](const FlightSample& sample) { return std::isfinite(sample.amsl_m); });
  std::vector<HeightSample> all;
  for (const FlightSample& sample : flight.samples) {
    const double flown_m = profile.above_sea ? sample.amsl_m : sample.agl_m;
    if (!std::isfinite(flown_m) || !std::isfinite(sample.agl_m)) continue;
    all.push_back({sample.distance_m, flown_m - sample.agl_m, flown_m});
  }
  profile.samples = thin(all);
  return profile;
}

std::string height_profile_svg(const HeightProfile& profile, double distance_m) {
  const std::vector<HeightSample>& samples = profile.samples;
  if (samples.empty()) return "";
  double low_m = samples.front().ground_m;
  double high_m = samples.front().flown_m;
  double least_agl_m = agl_m(samples.front());
  for (const HeightSample& sample : samples) {
    low_m = std::min({low_m, sample.ground_m, sample.flown_m});
    high_m = std::max({high_m, sample.ground_m, sample.flown_m});
    least_agl_m = std::min(least_agl_m, agl_m(sample));
  }
  const double step_m = tick_step(std::max(high_m - low_m, 1.0), 4);
  const double bottom_m = std::floor(low_m / step_m) * step_m;
  const double top_m = std::max(high_m, bottom_m + step_m);
  const auto x = [&](double at_m) {
    return kChartLeft + std::clamp(at_m / distance_m, 0.0, 1.0) * (kChartRight - kChartLeft);
  };
  const auto y = [&](double at_m) {
    return kBottomOfHeights - (at_m - bottom_m) / (top_m - bottom_m) * (kBottomOfHeights - kTopOfHeights);
  };
  const std::string scale = profile.above_sea ? "above sea level" : "above ground";
  std::string svg = "<svg id=\"heights\" viewBox=\"0 0 " + kHeightSvg.number(kChartWidth) + " " +
                    kHeightSvg.number(kHeightOfDrawing) +
                    "\" preserveAspectRatio=\"none\" role=\"img\" aria-label=\"Heights " + scale +
                    " along the route: at least " + number_text(least_agl_m, 0) + " m above ground\">\n";
  for (int i = 0; bottom_m + i * step_m <= top_m; ++i) {
    const double at_m = bottom_m + i * step_m;
    svg += kHeightSvg.line("grid", kChartLeft, y(at_m), kChartRight, y(at_m));
    svg += kHeightSvg.text("tick-y", kChartLeft - 8, y(at_m) + 5, format_number(std::round(at_m * 1e6) / 1e6));
  }
  std::string ground;
  std::string least;
  std::string flown;
  for (const HeightSample& sample : samples) {
    const std::string to = (flown.empty() ? "M" : "L") + kHeightSvg.number(x(sample.distance_m)) + " ";
    ground += to + kHeightSvg.number(y(sample.ground_m));
    least += to + kHeightSvg.number(y(std::min(sample.ground_m + profile.min_agl_m, top_m)));
    flown += to + kHeightSvg.number(y(sample.flown_m));
  }
  const std::string floor = kHeightSvg.number(y(bottom_m));
  svg += "<path class=\"ground\" d=\"" + ground + "L" + kHeightSvg.number(x(samples.back().distance_m)) + " " + floor +
         "L" + kHeightSvg.number(x(samples.front().distance_m)) + " " + floor + "Z\"><title>Ground</title></path>\n";
  svg += "<path class=\"least\" d=\"" + least + "\"><title>Lower than " + number_text(profile.min_agl_m, 0) +
         " m above ground no matching is expected</title></path>\n";
  svg += "<path class=\"flown\" d=\"" + flown + "\"><title>Flown</title></path>\n";
  svg += kHeightSvg.line("axis-line", kChartLeft, kBottomOfHeights, kChartRight, kBottomOfHeights);
  svg += kHeightSvg.text("axis", (kChartLeft + kChartRight) / 2, kHeightOfDrawing - 8,
                         "Height (m " + scale + "): flown, ground, and " + number_text(profile.min_agl_m, 0) +
                             " m above it, below which nothing is matched");
  return svg + "<line id=\"heights-cursor\" class=\"cursor\" visibility=\"hidden\" y1=\"" +
         kHeightSvg.number(kTopOfHeights) + "\" y2=\"" + kHeightSvg.number(kBottomOfHeights) + "\"/>\n</svg>";
}

}  // namespace pilotage
