// Any bytes as a configuration file, or, when they begin with "-", as a command line (one argument a line): either an
// error of ours, or options that hold their own limits and survive a round trip.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "cli/toy_command.h"
#include "cli_options.h"
#include "fuzz/fuzz_targets.h"
#include <nlohmann/json.hpp>

#include "pilotage/base/options_json.h"

namespace pilotage {
namespace {

void read_options(const OptionList& list, const std::string& text) {
  if (!text.starts_with("-")) return set_options_from_json(list, parse_json("fuzz.json", text), "fuzz.json");
  std::vector<std::string> arguments;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) arguments.push_back(line);
  apply_flags(list, parse_line({&list}, arguments));
}

void check_round_trip(const ToyOptions& options) {
  check_options(options);
  ToyOptions original = options;
  ToyOptions again;
  const auto json = options_to_json(list_options(original));
  // A command line may hold bytes that are not UTF-8, which JSON cannot say: they are replaced when printed.
  const std::string printed = json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  set_options_from_json(list_options(again), parse_json("again.json", printed), "again.json");
  const auto printed_again =
      options_to_json(list_options(again)).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  require(printed_again == printed, "printed options are read as the same options");
}

}  // namespace

void fuzz_options(const std::uint8_t* data, std::size_t size) {
  ToyOptions options;
  try {
    read_options(list_options(options), std::string(data, data + size));
  } catch (const UsageError&) {
    return;
  } catch (const DataError&) {
    return;
  }
  check_round_trip(options);
}

}  // namespace pilotage
