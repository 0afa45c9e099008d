#include "pilotage/base/read_file.h"

#include <cerrno>
#include <cstring>
#include <memory>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pilotage/base/error.h"

namespace pilotage {

std::string read_file(const std::filesystem::path& path, std::uintmax_t max_bytes) {
  const auto fail = [&](const std::string& why) { throw DataError(path.string() + ": " + why); };
  // Opening a pipe would wait for its writer.
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) fail(std::string("cannot be read: ") + std::strerror(errno));
  const std::unique_ptr<const int, void (*)(const int*)> closed(&descriptor, [](const int* file) { ::close(*file); });
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) fail(std::string("cannot be read: ") + std::strerror(errno));
  if (S_ISDIR(status.st_mode)) fail("is a folder, not a file");
  if (!S_ISREG(status.st_mode)) fail("is a pipe or a device, not a file; save what it gives as a file first");
  const auto size = static_cast<std::uintmax_t>(status.st_size);
  if (size > max_bytes) {
    fail("has " + std::to_string(size) + " bytes, at most " + std::to_string(max_bytes) + " are allowed");
  }
  std::string content(size, '\0');
  for (std::size_t done = 0; done < content.size();) {
    const ssize_t got = ::read(descriptor, content.data() + done, content.size() - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail(std::string("cannot be read: ") + std::strerror(errno));
    if (got == 0) fail("cannot be read: it ends after " + std::to_string(done) + " bytes");
    done += static_cast<std::size_t>(got);
  }
  return content;
}

}  // namespace pilotage
