#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/simulate/envelope.h"

namespace pilotage {

/// envelope.json (schemas/envelope.schema.json).
nlohmann::ordered_json envelope_to_json(const Envelope& envelope);

/// A line of names, then one for each cell (docs/commands/envelope.md).
std::string envelope_to_csv(const Envelope& envelope);

/// A drawing that needs nothing else: a row of cells for each factor and world, the darker the higher P(correct).
std::string envelope_to_svg(const Envelope& envelope);

/// The same for people: whole lines.
std::string envelope_text(const Envelope& envelope);

}  // namespace pilotage
