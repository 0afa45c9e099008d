#include "pilotage/base/staging_folder.h"

#include <system_error>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"

namespace pilotage {

StagingFolder::StagingFolder(const std::filesystem::path& output_folder)
    : output_folder_(output_folder), work_(output_folder, make_folder(output_folder)) {}

bool StagingFolder::make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  const bool made = std::filesystem::create_directories(folder, error);
  if (error) throw DataError(folder.string() + ": the folder cannot be made: " + error.message());
  return made;
}

std::filesystem::path StagingFolder::operator/(const std::string& name) const {
  return work_.path() / name;
}

void StagingFolder::publish(const std::vector<std::string>& names, const std::vector<std::string>& stale,
                            const std::vector<const OutputFile*>& others) const {
  std::vector<FileMove> moves;
  for (const OutputFile* other : others) moves.push_back({other->temporary_path(), other->destination()});
  for (const std::string& name : names) moves.push_back({*this / name, output_folder_ / name});
  std::vector<std::filesystem::path> old;
  for (const std::string& name : stale) old.push_back(output_folder_ / name);
  const WorkFolder aside(output_folder_);
  replace_together(moves, old, aside.path());
}

}  // namespace pilotage
