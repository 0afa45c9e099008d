// What takes libFuzzer's place where there is none: runs one of the fuzz targets over every file of the folders it is
// given, and over seeded mutations of each (cut short, bytes changed, pieces doubled), the same ones every time.
//
//   fuzz_replay TARGET MUTATIONS FOLDER_OR_FILE...

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <string>
#include <vector>

#include "fuzz/fuzz_targets.h"

#include "pilotage/base/output_file.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

void run_one(const FuzzTarget& target, const std::string& input) {
  const std::vector<std::uint8_t> bytes(input.begin(), input.end());
  target.run(bytes.data(), bytes.size());
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

void replay(const FuzzTarget& target, const std::filesystem::path& file, int mutations) {
  const std::string content = read_file(file);
  run_one(target, content);
  Random random(seed_from_name(file.filename().string()));
  for (int i = 0; i < mutations; ++i) {
    std::string mutated = content;
    for (std::uint64_t changes = random.below(4); changes > 0; --changes) mutated = mutate(mutated, random);
    run_one(target, mutate(mutated, random));
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
  const auto* const target = std::find_if(std::begin(pilotage::kFuzzTargets), std::end(pilotage::kFuzzTargets),
                                          [&](const auto& one) { return argc > 1 && one.name == argv[1]; });
  if (argc < 4 || target == std::end(pilotage::kFuzzTargets)) {
    std::cerr << "usage: " << argv[0] << " TARGET MUTATIONS FOLDER_OR_FILE..., with TARGET one of";
    for (const auto& one : pilotage::kFuzzTargets) std::cerr << ' ' << one.name;
    std::cerr << '\n';
    return 2;
  }
  const int mutations = std::stoi(argv[2]);
  std::size_t count = 0;
  for (int i = 3; i < argc; ++i) {
    for (const auto& file : pilotage::files_of(argv[i])) {
      pilotage::replay(*target, file, mutations);
      ++count;
    }
  }
  std::cout << count << " files replayed\n";
  return count > 0 ? 0 : 1;
}
