// Writes report.html and report.json of a drawn mission, to look at: write_report_scene FOLDER
// [go|no-go|polar|long|very-long]
#include <iostream>
#include <string>

#include "report/report_scene.h"
#include <nlohmann/json.hpp>

#include "pilotage/base/output_file.h"

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: write_report_scene FOLDER [go|no-go|polar|long|very-long]\n";
    return 2;
  }
  const std::string kind = argc > 2 ? argv[2] : "no-go";
  pilotage::testing::ReportSceneOptions options;
  options.matchable_from = 0.3;
  options.matchable_to = kind == "go" ? 0.5 : 0.98;
  options.drift = kind == "go" ? 0.018 : 0.024;
  if (kind == "polar") options.origin = {40, 88};
  if (kind == "long") options.tiles_along = 650;
  if (kind == "very-long") {  // 200 km and 5,208 tiles on the finer level
    options.tiles_across = 2;
    options.tiles_along = 2604;
    options.turn_deg = 50;
  }
  const pilotage::Report report = pilotage::make_report(pilotage::testing::report_scene(options));
  const std::filesystem::path folder = argv[1];
  pilotage::write_file(folder / "report.html", pilotage::report_html(report), true);
  pilotage::write_file(folder / "report.json", pilotage::report_json(report).dump(1), true);
}
