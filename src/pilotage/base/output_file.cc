#include "pilotage/base/output_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <random>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;

void sync_to_disk(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) throw DataError(path.string() + ": cannot be opened: " + std::strerror(errno));
  const int result = ::fsync(descriptor);
  const int error = errno;
  ::close(descriptor);
  if (result != 0) throw DataError(path.string() + ": cannot be written to disk: " + std::strerror(error));
}

}  // namespace

OutputFile::OutputFile(fs::path destination, bool overwrite) : destination_(std::move(destination)) {
  std::error_code ignored;
  const fs::path folder = destination_.has_parent_path() ? destination_.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, ignored)) {
    throw DataError(destination_.string() + ": the folder " + folder.string() + " does not exist");
  }
  if (fs::is_directory(destination_, ignored)) throw DataError(destination_.string() + ": is a folder");
  if (!overwrite && fs::exists(destination_, ignored)) {
    throw DataError(destination_.string() + ": exists already; give --overwrite to replace it");
  }
  // Two machines that share the folder may write the same file with the same process number.
  temporary_ = folder / ("." + destination_.stem().string() + ".partial-" + std::to_string(::getpid()) + "-" +
                         std::to_string(std::random_device()()) + destination_.extension().string());
}

OutputFile::~OutputFile() {
  if (committed_) return;
  std::error_code ignored;
  fs::remove(temporary_, ignored);
}

void OutputFile::commit() {
  sync_to_disk(temporary_);
  std::error_code error;
  fs::rename(temporary_, destination_, error);
  if (error) throw DataError(destination_.string() + ": cannot be created: " + error.message());
  committed_ = true;
}

void OutputFile::write(std::string_view content) {
  std::ofstream stream(temporary_, std::ios::binary);
  stream.write(content.data(), static_cast<std::streamsize>(content.size()));
  stream.flush();
  if (!stream) throw DataError(destination_.string() + ": cannot be written: " + std::strerror(errno));
}

void write_file(const fs::path& destination, std::string_view content, bool overwrite) {
  OutputFile output(destination, overwrite);
  output.write(content);
  output.commit();
}

}  // namespace pilotage
