// Changes one bit or one byte of a signed map or of its signature, or cuts one of them short, again and again, and asks
// the keyed reader: it must refuse each time.
//   flip_bytes MAP KEY COUNT SEED
// MAP: a map with MAP.minisig beside it; KEY: the public key. Copies are changed, in the folder for temporary files.

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include "testing/temporary_folder.h"
#include <fcntl.h>
#include <unistd.h>

#include "pilotage/base/error.h"
#include "pilotage/base/read_file.h"
#include "pilotage/mapdb/map_reader.h"

namespace {

using pilotage::MapReader;
namespace fs = std::filesystem;

void put(const fs::path& path, std::size_t at, char byte) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (file < 0 || ::pwrite(file, &byte, 1, static_cast<off_t>(at)) != 1) std::abort();
  ::close(file);
}

bool is_refused(const fs::path& map, const std::vector<std::string>& keys) {
  try {
    MapReader::open(map, keys);
    return false;
  } catch (const pilotage::IntegrityError&) {
    return true;
  } catch (const pilotage::DataError&) {
    return true;
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::cerr << "usage: flip_bytes MAP KEY COUNT SEED\n";
    return 2;
  }
  const std::vector<std::string> keys{argv[2]};
  const pilotage::testing::TemporaryFolder folder;
  const fs::path map = folder / "map.gpkg";
  const fs::path signature = folder / "map.gpkg.minisig";
  fs::copy_file(argv[1], map);
  fs::copy_file(std::string(argv[1]) + ".minisig", signature);
  if (is_refused(map, keys)) {
    std::cerr << "the map itself is refused\n";
    return 1;
  }
  std::mt19937_64 random(std::strtoull(argv[4], nullptr, 10));
  const auto below = [&](std::size_t count) { return static_cast<std::size_t>(random() % count); };
  const long count = std::strtol(argv[3], nullptr, 10);
  long refused = 0;
  for (long i = 0; i < count; ++i) {
    const fs::path& path = below(10) == 0 ? signature : map;
    const std::string bytes = pilotage::read_file(path.string());
    const std::size_t at = below(bytes.size());
    const bool cuts = below(20) == 0;
    // The untrusted comment, the first line of a signature, is nobody's word, nor is the end of the last line.
    if (path == signature && ((!cuts && at < bytes.find('\n')) || at + 1 == bytes.size())) {
      --i;
      continue;
    }
    char byte = bytes[at];
    if (cuts) {
      fs::resize_file(path, at);
    } else {
      byte = static_cast<char>(byte ^ static_cast<char>(below(2) == 0 ? 1U << below(8) : 1U + below(255)));
      put(path, at, byte);
    }
    if (is_refused(map, keys)) {
      ++refused;
    } else {
      std::cerr << "not refused: " << path.filename() << (cuts ? " cut at byte " : ", byte ") << at;
      if (!cuts) std::cerr << " made " << (byte & 0xff) << " of " << (bytes[at] & 0xff);
      std::cerr << '\n';
    }
    if (cuts)
      fs::copy_file(path == map ? argv[1] : std::string(argv[1]) + ".minisig", path,
                    fs::copy_options::overwrite_existing);
    if (!cuts) put(path, at, bytes[at]);
  }
  std::cout << refused << " of " << count << " changes refused\n";
  return refused == count ? 0 : 1;
}
