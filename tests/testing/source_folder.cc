#include "testing/source_folder.h"

namespace pilotage::testing {

std::filesystem::path source_folder() {
  return PILOTAGE_SOURCE_DIR;
}

}  // namespace pilotage::testing
