#pragma once

#include <string>
#include <vector>

#include "pilotage/audit/audit_map.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// The map in gray with an arrow for each part of it, from where the other map has the ground to where the map has it,
/// lengthened so that the largest can be seen (the factor stands below); longer ones than `max_shift_m` in another
/// colour, and nothing where nothing was compared. SVG, its imagery inside. Throws DataError when the imagery cannot
/// be read.
std::string shift_picture_svg(const MapAudit& audit, const std::string& map, const AuditOptions& options);

}  // namespace pilotage

#pragma GCC visibility pop
