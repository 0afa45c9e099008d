#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "ring_report.h"
#include <Eigen/Dense>

#include "pilotage/base/angle.h"
#include "pilotage/base/svg.h"

namespace pilotage {
namespace {

constexpr double kHalf_m = 34;
constexpr double kPxPerMetre = 10;
constexpr double kPathEach_m = 0.3;
constexpr double kEllipseTimes = 10;
constexpr SvgWriter kSvg{.decimals = 1};
constexpr std::string_view kStyle =
    "<style>text{font:13px sans-serif;fill:#222}.back{fill:#f4f3ee}.grid{stroke:#ddd8cc}"
    "polyline{fill:none;stroke-width:2}.scan{stroke:#b9b4a6}.with{stroke:#1b7837}.without{stroke:#d9730d;stroke-"
    "dasharray:6 4}"
    ".red{stroke:#c62828;stroke-width:5}.blue{stroke:#1e50c8;stroke-width:5}.sigma{fill:#00000018;stroke:#222}"
    ".decoy{fill:#9993;stroke:#999}.lwith{stroke:#1b7837;stroke-width:3}"
    ".lwithout{stroke:#d9730d;stroke-width:3;stroke-dasharray:6 4}.lscan{stroke:#b9b4a6;stroke-width:3}</style>\n";

double x_of(const Eigen::Vector3d& at) {
  return (at.x() + kHalf_m) * kPxPerMetre;
}
double y_of(const Eigen::Vector3d& at) {
  return (kHalf_m - at.y()) * kPxPerMetre;
}

std::string line_between(std::string_view type, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return kSvg.line(type, x_of(a), y_of(a), x_of(b), y_of(b));
}

std::string path_svg(std::string_view type, const std::vector<PathPoint>& path) {
  std::string points;
  Eigen::Vector3d last = Eigen::Vector3d::Constant(1e9);
  for (const PathPoint& point : path) {
    if ((point.position_m - last).norm() < kPathEach_m) continue;
    last = point.position_m;
    points += kSvg.number(x_of(last)) + "," + kSvg.number(y_of(last)) + " ";
  }
  return "<polyline class=\"" + std::string(type) + "\" points=\"" + points + "\"/>\n";
}

std::string ellipse_svg(const LocatedRing& ring) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(ring.covariance_m2.topLeftCorner<2, 2>());
  const Eigen::Vector2d half_px = 3 * kEllipseTimes * kPxPerMetre * axes.eigenvalues().cwiseMax(0).cwiseSqrt();
  const double turn_deg = -std::atan2(axes.eigenvectors()(1, 1), axes.eigenvectors()(0, 1)) / kRadPerDeg;
  return "<ellipse class=\"sigma\" rx=\"" + kSvg.number(half_px[1]) + "\" ry=\"" + kSvg.number(half_px[0]) +
         "\" transform=\"translate(" + kSvg.number(x_of(ring.center_m)) + " " + kSvg.number(y_of(ring.center_m)) +
         ") rotate(" + kSvg.number(turn_deg) + ")\"/>\n";
}

std::string ring_svg(const Ring& ring, std::size_t number) {
  const Eigen::Vector3d across = ring.kind().inner_radius_m * direction(ring.azimuth_deg + 90, 0);
  const Eigen::Vector3d label = ring.center_m + 2.6 * direction(bearing_deg(ring.center_m), 0);
  return line_between(ring.kind().name, ring.center_m - across, ring.center_m + across) +
         kSvg.text("n", x_of(label), y_of(label) + 4, std::to_string(number), " text-anchor=\"middle\"");
}

std::string legend_svg() {
  const std::array<std::pair<const char*, const char*>, 3> kinds = {
      {{"lwith", "with fixes"}, {"lwithout", "without fixes"}, {"lscan", "scan"}}};
  std::string text;
  double y = 20;
  for (const auto& [type, words] : kinds) {
    text += kSvg.line(type, 12, y - 4, 42, y - 4) + kSvg.text("n", 50, y, words);
    y += 18;
  }
  return text + kSvg.text("n", 12, y, "grid 10 m; ellipses: found rings, 3 σ, ten times as large");
}

}  // namespace

std::string rings_svg(const RingFlight& flight) {
  const double side_px = 2 * kHalf_m * kPxPerMetre;
  const std::string side = kSvg.number(side_px);
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + side + " " + side + "\">\n";
  svg += kStyle;
  svg += kSvg.rect("back", 0, 0, side_px, side_px);
  for (int metres = -30; metres <= 30; metres += 10) {
    svg += line_between("grid", Eigen::Vector3d(metres, -kHalf_m, 0), Eigen::Vector3d(metres, kHalf_m, 0));
    svg += line_between("grid", Eigen::Vector3d(-kHalf_m, metres, 0), Eigen::Vector3d(kHalf_m, metres, 0));
  }
  for (const Decoy& decoy : flight.scene.decoys) {
    svg += "<circle class=\"decoy\" cx=\"" + kSvg.number(x_of(decoy.center_m)) + "\" cy=\"" +
           kSvg.number(y_of(decoy.center_m)) + "\" r=\"" + kSvg.number(decoy.radius_m * kPxPerMetre) + "\"/>\n";
  }
  svg += path_svg("scan", flight.scan) + path_svg("without", flight.without_fixes.path) +
         path_svg("with", flight.with_fixes.path);
  for (std::size_t i = 0; i < flight.scene.rings.size(); ++i) svg += ring_svg(flight.scene.rings[i], i + 1);
  for (const JudgedRing& judged : flight.array) svg += ellipse_svg(judged.ring);
  return svg + legend_svg() + "</svg>\n";
}

}  // namespace pilotage
