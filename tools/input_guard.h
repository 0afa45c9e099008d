#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pilotage/base/options.h"

namespace pilotage {

/// A file that a command reads or writes, and what named it.
struct NamedFile {
  std::string flag;  ///< "--table", or the name of an argument.
  std::filesystem::path path;
};

/// The strings of an option that holds paths.
std::vector<std::string> paths_of(const OptionField& field);

/// Throws UsageError when a file that would be written is one that is read, by whatever name (the same inode), or when
/// two outputs are the same file. What an input leads to is read, too: files beside a raster and sources of a VRT,
/// rasters and route of a plan, pictures of a table of frames, files in a folder. Before any work: --overwrite is meant
/// for outputs of an earlier run, never for inputs.
void refuse_shared_files(const std::vector<NamedFile>& inputs, const std::vector<NamedFile>& outputs);

}  // namespace pilotage
