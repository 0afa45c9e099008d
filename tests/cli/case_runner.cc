// Runs one CLI case (tests/cli/cases/README.md) and says what did not come out as expected.
//
//   cli_case_runner FILE.case BIN_FOLDER SOURCE_FOLDER GIVEN_FOLDER

#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "testing/json_schema.h"
#include "testing/temporary_folder.h"
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

constexpr int kSkip = 77;  // ctest's SKIP_RETURN_CODE

struct Expectation {
  std::string key;
  std::string value;
  int line = 0;
};

/// A command and what is expected of it.
struct Step {
  std::string command;
  int line = 0;
  std::vector<Expectation> expectations;
};

struct Case {
  std::vector<std::string> needs;  ///< Paths; the case is skipped when one does not exist.
  std::vector<std::string> given;  ///< Names of folders whose content the case begins with.
  std::vector<Step> steps;
};

struct Outcome {
  int exit_code = 0;
  std::string out;
  std::string err;
};

Case parse_case(const std::string& text) {
  Case parsed;
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (line.empty() || line.front() == '#') continue;
    const auto colon = line.find(": ");
    if (colon == std::string::npos) throw std::runtime_error("line " + std::to_string(number) + ": no \"key: value\"");
    const std::string key = line.substr(0, colon);
    const std::string value = line.substr(colon + 2);
    if (key == "needs") {
      parsed.needs.push_back(value);
    } else if (key == "given") {
      parsed.given.push_back(value);
    } else if (key == "run") {
      parsed.steps.push_back({value, number, {}});
    } else if (parsed.steps.empty()) {
      throw std::runtime_error("line " + std::to_string(number) + ": \"" + key + "\" stands before the first run");
    } else {
      parsed.steps.back().expectations.push_back({key, value, number});
    }
  }
  if (parsed.steps.empty()) throw std::runtime_error("no \"run: ...\" line");
  return parsed;
}

Outcome run_in(const std::filesystem::path& folder, const std::filesystem::path& logs, const std::string& command) {
  write_file(logs / "command.sh", "cd '" + folder.string() + "' || exit 99\n" + command + "\n", true);
  const std::string line = "/bin/sh '" + (logs / "command.sh").string() + "' >'" + (logs / "out").string() + "' 2>'" +
                           (logs / "err").string() + "' </dev/null";
  const int status = std::system(line.c_str());
  Outcome outcome;
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  outcome.out = read_file(logs / "out");
  outcome.err = read_file(logs / "err");
  return outcome;
}

/// Some line of `text` matches.
bool matches(const std::string& text, const std::string& pattern) {
  const std::regex expression(pattern);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (std::regex_search(line, expression)) return true;
  }
  return false;
}

/// `text` is JSON that satisfies a schema; says what is wrong where it does not.
bool satisfies(const std::string& text, const std::string& schema) {
  const auto json = nlohmann::ordered_json::parse(text, nullptr, false);
  const std::string wrong = json.is_discarded() ? "is not JSON" : testing::schema_violation(schema, json);
  if (!wrong.empty()) std::cout << "schema " << schema << ": " << wrong << "\n";
  return wrong.empty();
}

/// Every line that begins with a brace does, and there is one.
bool lines_satisfy(const std::string& text, const std::string& schema) {
  std::istringstream lines(text);
  int count = 0;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("{")) continue;
    if (!satisfies(line, schema)) return false;
    ++count;
  }
  return count > 0;
}

bool holds(const Expectation& expected, const Outcome& outcome, const std::filesystem::path& folder) {
  const auto& [key, value, line] = expected;
  if (key == "exit") return parse_number(value) == static_cast<double>(outcome.exit_code);
  if (key == "stdout") return value == "empty" ? outcome.out.empty() : matches(outcome.out, value);
  if (key == "stderr") return value == "empty" ? outcome.err.empty() : matches(outcome.err, value);
  if (key == "stdout-not") return !matches(outcome.out, value);
  if (key == "stderr-not") return !matches(outcome.err, value);
  if (key == "stdout-schema") return satisfies(outcome.out, value);
  if (key == "stderr-schema") return lines_satisfy(outcome.err, value);
  if (key == "file-schema") {  // FILE SCHEMA
    const auto blank = value.find(' ');
    return satisfies(read_file(folder / value.substr(0, blank)), value.substr(blank + 1));
  }
  if (key == "exists") return std::filesystem::exists(folder / value);
  if (key == "absent") return !std::filesystem::exists(folder / value);
  if (key == "files") {  // exactly so many entries, hidden ones included
    const std::filesystem::directory_iterator entries(folder);
    return parse_number(value) == static_cast<double>(std::distance(begin(entries), end(entries)));
  }
  throw std::runtime_error("line " + std::to_string(line) + ": unknown key \"" + key + "\"");
}

/// Every step must say what its exit code is to be; otherwise a case could pass without having run anything.
void check_complete(const Step& step) {
  for (const Expectation& expected : step.expectations) {
    if (expected.key == "exit") return;
  }
  throw std::runtime_error("line " + std::to_string(step.line) + ": the run has no \"exit: \"");
}

int run_case(const Case& parsed, const std::filesystem::path& all_given) {
  const testing::TemporaryFolder folder;
  for (const std::string& name : parsed.given) {
    std::filesystem::copy(all_given / name, folder.path(), std::filesystem::copy_options::recursive);
  }
  const testing::TemporaryFolder logs;
  int failures = 0;
  for (const Step& step : parsed.steps) {
    check_complete(step);
    const Outcome outcome = run_in(folder.path(), logs.path(), step.command);
    const int before = failures;
    for (const Expectation& expected : step.expectations) {
      if (holds(expected, outcome, folder.path())) continue;
      std::cout << "line " << expected.line << ": not so: " << expected.key << ": " << expected.value << "\n";
      ++failures;
    }
    if (failures == before) continue;
    std::cout << "$ " << step.command << "\nexit: " << outcome.exit_code << "\nstdout:\n"
              << outcome.out << "stderr:\n"
              << outcome.err;
    break;
  }
  return failures == 0 ? 0 : 1;
}

int run(const std::vector<std::string>& arguments) {
  if (arguments.size() != 4) {
    throw std::runtime_error("usage: cli_case_runner FILE.case BIN_FOLDER SOURCE_FOLDER GIVEN_FOLDER");
  }
  const Case parsed = parse_case(read_file(arguments[0]));
  const char* path = std::getenv("PATH");
  ::setenv("PATH", (arguments[1] + ":" + (path != nullptr ? path : "")).c_str(), 1);
  ::setenv("SOURCE", arguments[2].c_str(), 1);
  ::setenv("DATA", testing::real_data_folder().c_str(), 1);
  ::setenv("LC_ALL", "C.UTF-8", 1);
  for (const std::string& need : parsed.needs) {
    const std::string test = "test -e " + need;
    if (std::system(test.c_str()) == 0) continue;
    std::cout << "skipped: " << need
              << " does not exist: it comes with the target sample_mission or tools/install-packages\n";
    return kSkip;
  }
  return run_case(parsed, arguments[3]);
}

}  // namespace
}  // namespace pilotage

int main(int argc, char** argv) {
  try {
    return pilotage::run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::cout << (argc > 1 ? argv[1] : "") << ": " << error.what() << "\n";
    return 1;
  }
}
