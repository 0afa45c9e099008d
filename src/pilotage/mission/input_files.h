#pragma once

#include <string>
#include <vector>

#include "pilotage/mission/mission.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// A file that went into a plan, as reports and maps list it. Strings may hold any bytes; they are shown as text only.
struct InputFile {
  std::string role;  ///< "imagery", "route", "elevation", "map", …
  std::string name;  ///< As the user gave it.
  std::string date;  ///< Of the data, not of the file; "" when unknown.
  /// With its algorithm: "blake2b-256:…" of a file, "blake2b-256-of-list:…" of a dataset of several files; "" when it
  /// was not computed.
  std::string digest;
  Licence licence = {};
};

/// One file with its digest. Throws as input_files.
InputFile input_file(const std::string& role, const std::string& name, const std::string& date);

/// A raster with the digest over all files that GDAL reads for it (raster/gdal_files.h). Throws as input_files.
InputFile input_dataset(const std::string& role, const std::string& name, const std::string& date,
                        const Licence& licence = {});

/// The files that went into a plan, with date and digest. Only files of this machine have a digest; what GDAL fetches
/// from elsewhere has none. Throws DataError when a file cannot be read.
std::vector<InputFile> input_files(const Mission& mission);

}  // namespace pilotage

#pragma GCC visibility pop
