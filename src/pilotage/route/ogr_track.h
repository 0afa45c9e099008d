#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <ogr_core.h>

#include "pilotage/route/route_line.h"

// Private to route/ogr_*.cc.

namespace pilotage {

/// Seconds since 1970 (UTC; a time without a zone counts as UTC) of a date and time of OGR.
double seconds_of(const OGRField& field);

/// A gx:Track of a KML document ("KML Reference", Google, extension namespace): what OGR leaves out of it.
struct KmlTrack {
  std::string altitude_mode;
  std::vector<LinePoint> points;  ///< Heights where they are written; times where there are as many as positions.
  std::size_t coords = 0;         ///< With those that are empty.
  std::size_t times = 0;
};

/// The tracks of a document. Throws DataError when it is not well formed, and for a track with fewer <when> than
/// positions, beyond the last of which GDAL 3.6 reads: so look before OGR opens the document.
std::vector<KmlTrack> kml_tracks(const std::string& name, std::string_view document);

/// Whether two lines have the same coordinates, within 1e-9.
bool same_positions(const std::vector<LinePoint>& line, const std::vector<LinePoint>& other);

/// `lines` are what OGR read of the document; a line that has the positions of a track takes what the track's
/// heights are above and its times, and has no height where the track has none. A track with another number of times
/// than of positions keeps none, and a note says so.
void apply_kml_tracks(Route& route, const std::vector<KmlTrack>& tracks, std::vector<Line>& lines);

}  // namespace pilotage
