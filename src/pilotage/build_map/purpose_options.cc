#include "pilotage/build_map/purpose_options.h"

#include <chrono>

#include "pilotage/base/error.h"
#include "pilotage/base/source_date.h"
#include "pilotage/base/utf8.h"

namespace pilotage {
namespace {

UtcTime time_of_option(const std::string& name, const std::string& text) {
  const std::optional<UtcTime> time = parse_utc_time(text);
  if (!time) throw UsageError(name + " = \"" + text + "\" is not a time like 2026-03-01T06:30:00Z");
  return *time;
}

UtcTime time_of_making(const std::string& text) {
  if (text != "now") return time_of_option("created", text);
  return source_date().value_or(std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()));
}

}  // namespace

MapPurpose make_purpose(const PurposeOptions& options) {
  MapPurpose purpose;
  purpose.mission_name = options.mission_name;
  purpose.map_version = options.map_version;
  if (options.created) purpose.created = time_of_making(*options.created);
  if (options.valid_until) purpose.valid_until = time_of_option("valid_until", *options.valid_until);
  if (purpose.mission_name && valid_utf8(*purpose.mission_name) != *purpose.mission_name) {
    throw UsageError("mission_name is not UTF-8");
  }
  const std::string problem = purpose_problem(purpose);
  if (!problem.empty()) throw UsageError(problem);
  return purpose;
}

}  // namespace pilotage
