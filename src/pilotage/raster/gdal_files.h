#pragma once

#include <string>
#include <vector>

namespace pilotage {

/// The files of this machine that GDAL reads for a dataset: itself, and what lies beside it or is named in it
/// (.aux.xml, .msk, .ovr, world files; of a VRT the sources, and what belongs to these). The dataset's own file comes
/// first, the others in the order of their names. Empty when none of them is a file of this machine. Throws DataError
/// when the dataset cannot be opened.
std::vector<std::string> dataset_files(const std::string& dataset);

/// What dataset_files holds as one digest, so that no file changes pixels or place unseen: of a single file that
/// file's, "blake2b-256:<64 hex digits>"; of several "blake2b-256-of-list:…", which is that of the lines
///
///   <digest of the file>  <its path, relative to the folder of the first>\n
///
/// as `b2sum -l 256 FILES | b2sum -l 256` prints it in that folder. "" when there is no such file. Throws DataError
/// when a file cannot be read.
std::string dataset_digest(const std::string& dataset);

}  // namespace pilotage
