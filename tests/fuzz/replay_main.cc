// What takes libFuzzer's place where there is none: runs a fuzz target over every file of the folders it is given, and
// over seeded mutations of each (cut short, bytes changed, pieces doubled), the same ones every time.
//
//   fuzz_<name> MUTATIONS FOLDER_OR_FILE...

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "pilotage/base/output_file.h"
#include "pilotage/base/random.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace pilotage {
namespace {

void run_one(const std::string& input) {
  const std::vector<std::uint8_t> bytes(input.begin(), input.end());
  LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
}

std::string mutate(std::string bytes, Random& random) {
  if (bytes.empty()) return bytes;
  const auto at = static_cast<std::size_t>(random.below(bytes.size()));
  switch (random.below(4)) {
    case 0:
      bytes.resize(at);
      break;
    case 1:
      bytes[at] = static_cast<char>(random.below(256));
      break;
    case 2:
      bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.below(8)));
      break;
    default:
      bytes.insert(at, bytes.substr(random.below(bytes.size()), random.below(64)));
      break;
  }
  return bytes;
}

void replay(const std::filesystem::path& file, int mutations) {
  const std::string content = read_file(file);
  run_one(content);
  Random random(seed_from_name(file.filename().string()));
  for (int i = 0; i < mutations; ++i) {
    std::string mutated = content;
    for (std::uint64_t changes = random.below(4); changes > 0; --changes) mutated = mutate(mutated, random);
    run_one(mutate(mutated, random));
  }
}

std::vector<std::filesystem::path> files_of(const std::filesystem::path& place) {
  if (!std::filesystem::is_directory(place)) return {place};
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(place)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace
}  // namespace pilotage

int main(int argc, char** argv) {
  if (argc < 3) {
    std::cerr << "usage: " << argv[0] << " MUTATIONS FOLDER_OR_FILE...\n";
    return 2;
  }
  const int mutations = std::stoi(argv[1]);
  std::size_t count = 0;
  for (int i = 2; i < argc; ++i) {
    for (const auto& file : pilotage::files_of(argv[i])) {
      pilotage::replay(file, mutations);
      ++count;
    }
  }
  std::cout << count << " files replayed\n";
  return count > 0 ? 0 : 1;
}
