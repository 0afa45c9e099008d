// What takes libFuzzer's place where there is none: runs one of the fuzz targets over every file of the folders it is
// given, and over seeded mutations of each (cut short, bytes changed, pieces doubled, structures forged), the same ones
// every time.
//
//   fuzz_replay TARGET MUTATIONS [--most-seconds S] [--most-mib M] FOLDER_OR_FILE...
//
// An input that takes more than S seconds of the processor ends it with 1; it is left in ./fuzz_replay.input. So does a
// process that has taken more than M MiB of memory.

#include <algorithm>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/fuzz_targets.h"
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <unistd.h>

#include "pilotage/base/output_file.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

const std::vector<std::uint8_t>* input_at_work = nullptr;  // for the signal handler
double slowest_s = 0;
std::size_t inputs = 0;

double processor_s() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

void leave_input(int /*signal*/) {
  const int file = ::open("fuzz_replay.input", O_WRONLY | O_CREAT | O_TRUNC, 0644);
  constexpr std::string_view kWords = "an input takes longer than --most-seconds: fuzz_replay.input\n";
  if (file < 0 || ::write(file, input_at_work->data(), input_at_work->size()) < 0 ||
      ::write(2, kWords.data(), kWords.size()) < 0) {
    ::_exit(2);
  }
  ::_exit(1);
}

/// Sends SIGPROF after so much of the processor's time; 0: never.
void set_alarm(double seconds) {
  const auto whole = static_cast<long>(seconds);
  const itimerval timer = {{0, 0}, {whole, static_cast<long>(1e6 * (seconds - static_cast<double>(whole)))}};
  ::setitimer(ITIMER_PROF, &timer, nullptr);
}

void run_one(const FuzzTarget& target, const std::string& input, double most_seconds) {
  const std::vector<std::uint8_t> bytes(input.begin(), input.end());
  input_at_work = &bytes;
  const double begin_s = processor_s();
  set_alarm(most_seconds);
  target.run(bytes.data(), bytes.size());
  set_alarm(0);
  slowest_s = std::max(slowest_s, processor_s() - begin_s);
  ++inputs;
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

void replay(const FuzzTarget& target, const std::filesystem::path& file, int mutations, double most_seconds) {
  const std::string content = read_file(file);
  run_one(target, content, most_seconds);
  Random random(seed_from_name(file.filename().string()));
  for (int i = 0; i < mutations; ++i) {
    if (target.forge != nullptr && i % 2 == 1) {
      run_one(target, target.forge(content, random), most_seconds);
      continue;
    }
    std::string mutated = content;
    for (std::uint64_t changes = random.below(4); changes > 0; --changes) mutated = mutate(mutated, random);
    run_one(target, mutate(mutated, random), most_seconds);
  }
}

std::vector<std::filesystem::path> files_of(const std::filesystem::path& place) {
  if (!std::filesystem::is_directory(place)) return {place};
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(place)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// The number behind `option`, which both are taken out of `words`; `otherwise` when it is not there.
double take_number(std::vector<std::string>& words, const std::string& option, double otherwise) {
  const auto found = std::find(words.begin(), words.end(), option);
  if (found == words.end() || found + 1 == words.end()) return otherwise;
  const double number = std::stod(*(found + 1));
  words.erase(found, found + 2);
  return number;
}

double peak_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

int run(std::vector<std::string> words) {
  const double most_seconds = take_number(words, "--most-seconds", 0);
  const double most_mib = take_number(words, "--most-mib", 0);
  const auto* const target = std::find_if(std::begin(kFuzzTargets), std::end(kFuzzTargets),
                                          [&](const auto& one) { return !words.empty() && one.name == words.front(); });
  if (words.size() < 3 || target == std::end(kFuzzTargets)) {
    std::cerr << "usage: fuzz_replay TARGET MUTATIONS [--most-seconds S] [--most-mib M] FOLDER_OR_FILE..., with TARGET "
                 "one of";
    for (const auto& one : kFuzzTargets) std::cerr << ' ' << one.name;
    std::cerr << '\n';
    return 2;
  }
  std::signal(SIGPROF, leave_input);
  std::size_t count = 0;
  for (auto place = words.begin() + 2; place != words.end(); ++place) {
    for (const auto& file : files_of(*place)) {
      replay(*target, file, std::stoi(words[1]), most_seconds);
      ++count;
    }
  }
  std::cout << count << " files replayed, " << inputs << " inputs in all, the slowest " << slowest_s << " s, memory "
            << peak_mib() << " MiB\n";
  if (most_mib > 0 && peak_mib() > most_mib) {
    std::cerr << "more memory than --most-mib\n";
    return 1;
  }
  return count > 0 ? 0 : 1;
}

}  // namespace
}  // namespace pilotage

int main(int argc, char** argv) {
  return pilotage::run(std::vector<std::string>(argv + 1, argv + argc));
}
