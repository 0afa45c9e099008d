#pragma once

#include <string>
#include <vector>

#include "pilotage/base/output_file.h"
#include "pilotage/capture/capture.h"
#include "pilotage/capture/ortho_mosaic.h"
#include "pilotage/raster/gdal_imagery.h"

namespace pilotage {

/// The map of CaptureOptions::align. Throws DataError when it shows no ground below the `frames`, or cannot be read:
/// before any picture is.
ImageryInfo inspect_reference(const CaptureOptions& options, const std::vector<GeodeticPoint>& frames,
                              const Progress& progress);

/// Ties `block` to the map of CaptureOptions::align, as inspected (Block::reference_ties). `mosaic`, of the block as it
/// was adjusted without, is drawn at least twice as finely as pictures are correlated, inside `output`'s hidden folder
/// where it does not stay, and held against that map (audit_map). Of the ties at the finest resolution that agree with
/// the field around them those are taken of which no two look at the same ground. Their standard deviation is half a
/// pixel that was correlated, or as much as ties that were left out of the fit miss, whichever is more.
/// MapAlignment::after is left empty. Throws DataError when too little could be compared, or the other map lies farther
/// off than three times what both may miss on each axis.
MapAlignment tie_to_reference(const OrthoMosaic& mosaic, const CaptureOptions& options, const ImageryInfo& reference,
                              const OutputFile& output, int threads, const Progress& progress, Block& block);

/// Whether ties miss by more than was said once the block is adjusted with them, as they do where the other map is
/// bent: then all of them get what they miss for their standard deviation, and so does what the other map misses
/// alike, for its bends may be as wide as the block. To be adjusted again with these.
bool loosen_ties(const AdjustedBlock& adjusted, MapAlignment& alignment, Block& block);

/// The map at `output`'s temporary path against that of CaptureOptions::align.
MapAudit audit_against_reference(const OutputFile& output, const CaptureOptions& options, int threads,
                                 const Progress& progress);

}  // namespace pilotage
