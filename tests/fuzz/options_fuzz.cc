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
#include <nlohmann/json.hpp>

#include "pilotage/base/options_json.h"

namespace pilotage {
namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

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
  require(printed_again == printed);
}

}  // namespace
}  // namespace pilotage

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pilotage::ToyOptions options;
  try {
    pilotage::read_options(pilotage::list_options(options), std::string(data, data + size));
  } catch (const pilotage::UsageError&) {
    return 0;
  } catch (const pilotage::DataError&) {
    return 0;
  }
  pilotage::check_round_trip(options);
  return 0;
}
