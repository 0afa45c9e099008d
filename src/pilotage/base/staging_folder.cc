#include "pilotage/base/staging_folder.h"

#include <system_error>

#include <unistd.h>

#include "pilotage/base/error.h"

namespace pilotage {

namespace fs = std::filesystem;

StagingFolder::StagingFolder(const fs::path& output_folder)
    : output_folder_(output_folder), path_(output_folder / (".partial-" + std::to_string(::getpid()))) {
  std::error_code error;
  made_output_folder_ = fs::create_directories(output_folder_, error);
  if (!error) fs::remove_all(path_, error);
  if (!error) fs::create_directory(path_, error);
  if (error) throw DataError(output_folder_.string() + ": the folder cannot be made: " + error.message());
}

StagingFolder::~StagingFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  if (made_output_folder_) fs::remove(output_folder_, ignored);  // only when it is empty
}

void StagingFolder::publish(const std::vector<std::string>& names) const {
  for (const std::string& name : names) {
    std::error_code error;
    fs::rename(path_ / name, output_folder_ / name, error);
    if (error) throw DataError((output_folder_ / name).string() + ": cannot be created: " + error.message());
  }
}

}  // namespace pilotage
