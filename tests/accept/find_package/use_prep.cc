#include <cstdio>

#include <pilotage/prep.h>

// use_prep MAP NOT_A_MAP: verifies a map, and is told what is wrong with a file that is none and with a mission that
// names no imagery.
int main(int, char** argv) {
  const pilotage::VerifyReport report = pilotage::verify_map(argv[1]);
  pilotage::require_intact(report);
  std::printf("Pilotage %s: %lld tiles\n", PILOTAGE_VERSION, static_cast<long long>(report.tiles));
  int refused = 0;
  try {
    pilotage::require_intact(pilotage::verify_map(argv[2]));
  } catch (const pilotage::DataError& error) {
    std::puts(error.what());
    ++refused;
  }
  try {
    pilotage::plan_tiles(pilotage::TileOptions());
  } catch (const pilotage::UsageError& error) {
    std::puts(error.what());
    ++refused;
  }
  return report.tiles > 0 && refused == 2 ? 0 : 1;
}
