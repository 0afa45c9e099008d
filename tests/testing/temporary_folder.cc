#include "testing/temporary_folder.h"

#include <cstdlib>
#include <stdexcept>
#include <string>
#include <system_error>

#include "testing/source_folder.h"

namespace pilotage::testing {

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "pilotage-test-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) throw std::system_error(errno, std::generic_category(), pattern);
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path real_data_folder() {
  if (const char* variable = std::getenv("PILOTAGE_DATA"); variable != nullptr) {
    const std::filesystem::path folder(variable);
    if (!std::filesystem::is_directory(folder) || std::filesystem::is_empty(folder)) {
      throw std::runtime_error("PILOTAGE_DATA = \"" + folder.string() + "\" is not a folder with imagery in it");
    }
    return folder;
  }
  const std::filesystem::path beside = testing::source_folder() / "../shared/data";
  return std::filesystem::is_directory(beside) ? beside : std::filesystem::path();
}

}  // namespace pilotage::testing
