#pragma once

#include <optional>
#include <string>
#include <vector>

#include "flight.h"

struct Arguments {
  std::string map;
  std::vector<std::string> also_map;  ///< Others of the same ground, as of imagery of another date.
  std::string link;                   ///< link.h
  std::string recording;              ///< In its place: a recorded flight.
  std::string record;                 ///< Where what is heard and said is written; empty: nowhere.
  std::string public_key;
  bool unverified = false;
  FlightOptions flight;
};

extern const char* const kUsage;

/// Throws std::invalid_argument for arguments that are wrong.
Arguments read_arguments(int argc, char** argv);
