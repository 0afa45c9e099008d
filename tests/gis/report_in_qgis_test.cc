// What QGIS itself makes of the files: styles found, renderers, bands and legends. Runs where python3-qgis is
// installed.

#include <filesystem>

#include "gis/gis_scene.h"
#include "mapdb/run_command.h"
#include "testing/source_folder.h"
#include "testing/temporary_folder.h"
#include <gtest/gtest.h>

#include "pilotage/gis/report_outputs.h"

namespace pilotage {
namespace {

TEST(ReportInQgisThorough, OpensStyled) {
  // Looked for as a file: importing QGIS loads a hundred libraries.
  if (!std::filesystem::exists("/usr/lib/python3/dist-packages/qgis/core")) {
    GTEST_SKIP() << "QGIS is not installed: apt-get install python3-qgis";
  }
  const testing::TemporaryFolder folder;
  const testing::TemporaryFolder sources;
  const ReportInput input = testing::with_imagery(testing::gis_scene(), sources.path());
  write_report_outputs(folder.path(), "report", input, make_report(input), {ReportOutput::kAll}, true);
  const auto outcome = testing::run_command("QT_QPA_PLATFORM=offscreen XDG_RUNTIME_DIR=" + folder.path().string() +
                                            " HOME=" + folder.path().string() + " timeout 120 /usr/bin/python3 " +
                                            (testing::source_folder() / "tests/gis/check_in_qgis.py ").string() +
                                            folder.path().string());
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("checked in QGIS 3."), std::string::npos) << outcome.output;
}

}  // namespace
}  // namespace pilotage
