#pragma once

#include <memory>

#include "pilotage/raster/gray_source.h"
#include "pilotage/registration/warp_field.h"

namespace pilotage {

/// The second date drawn onto the reference: pixel p shows source(p + field.continued_m(p)), cubic interpolation, on
/// the same grid, which must be north-up in metres of the field's CRS. Not valid where the field is not known (unless
/// `everywhere`), or where a pixel that the interpolation needs is not. The field is evaluated every 16 px and
/// interpolated linearly between. Values do not depend on the windows that are read.
GraySource warped_source(const GraySource& source, const std::shared_ptr<const WarpField>& field,
                         bool everywhere = false);

}  // namespace pilotage
