#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "pilotage/base/options.h"
#include "pilotage/mapdb/map_purpose.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// What the map says that it is for (MapPurpose). Nothing of it is made up: without these the map says nothing.
struct PurposeOptions {
  std::optional<std::string> mission_name;
  std::optional<std::int64_t> map_version;
  std::optional<std::string> created;
  std::optional<std::string> valid_until;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("mission_name", self.mission_name, "The mission that the map is for; match can ask for it.");
    fields.field("map_version", self.map_version,
                 "Number of the map, larger than that of the one it replaces; match can ask for a least one.",
                 Range{1, static_cast<double>(kMaxMapVersion)});
    fields.field(
        "created", self.created,
        "When the map was made: a time like 2026-03-01T06:30:00Z, or now (SOURCE_DATE_EPOCH where it is set).");
    fields.field("valid_until", self.valid_until,
                 "The map is not to be flown from then on: a time like 2026-03-01T06:30:00Z.");
  }
};

/// The purpose that the options spell. Reads the clock for `created` = "now" alone, and then only when
/// SOURCE_DATE_EPOCH is not set. Throws UsageError for a name, number or time that is none, and unless valid_until is
/// after created.
MapPurpose make_purpose(const PurposeOptions& options);

}  // namespace pilotage

#pragma GCC visibility pop
