#pragma once

#include <string>
#include <vector>

#include "pilotage/report/report.h"

namespace pilotage {

/// The files of a report (and, where it lies among them, the map database) as one item of a SpatioTemporal Asset
/// Catalog, STAC 1.0.0 (stacspec.org, item-spec/item-spec.md), so that a catalogue of maps finds it by place and time:
/// GeoJSON text. The geometry is the rectangle around the plan's tiles. The time is that of the imagery, from the first
/// day to the last; where a part of the imagery says no date, from 1826, before which there are no photographs, to the
/// year 9999, and pilotage:imagery_dates says so. `files`: names beside the item, which become its assets.
std::string stac_item(const ReportInput& input, const Report& report, const std::vector<std::string>& files);

}  // namespace pilotage
