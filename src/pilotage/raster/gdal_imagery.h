#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/base/options.h"
#include "pilotage/base/progress.h"
#include "pilotage/geo/bounds.h"
#include "pilotage/geo/geo_transform.h"
#include "pilotage/geo/geodetic_point.h"
#include "pilotage/raster/gdal_crs.h"
#include "pilotage/raster/licence.h"

namespace pilotage {
struct Collar;  // hidden
}

#pragma GCC visibility push(default)

namespace pilotage {

/// How imagery is brought onto a mission grid (docs/methods/imagery.md says why these).
enum class Resampling {
  kAuto,  ///< Average of the covered pixels where the grid is more than 1.5 times coarser, cubic otherwise.
  kNearest,
  kBilinear,
  kCubic,
  kAverage,
};

inline EnumNames<Resampling> enum_names(Resampling) {
  return {{Resampling::kAuto, "auto"},
          {Resampling::kNearest, "nearest"},
          {Resampling::kBilinear, "bilinear"},
          {Resampling::kCubic, "cubic"},
          {Resampling::kAverage, "average"}};
}

/// What becomes of black or white that reaches in from the edge of imagery that has neither no-data value nor mask.
enum class CollarRule {
  kMask,  ///< It is no data.
  kKeep,  ///< It is ground; nothing is looked for.
};

inline EnumNames<CollarRule> enum_names(CollarRule) {
  return {{CollarRule::kMask, "mask"}, {CollarRule::kKeep, "keep"}};
}

/// How imagery is read. Meant to be described in a group with FlagPrefix::kNone.
struct ImageryOptions {
  std::vector<double> bands;
  std::string imagery_crs;
  std::optional<double> nodata;
  CollarRule collar = CollarRule::kMask;
  Resampling resampling = Resampling::kAuto;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("bands", self.bands,
                 "Bands to make gray of, counted from 1: one band, or red, green, blue. Default: by colour "
                 "interpretation, else the first three, else the first.",
                 Range{1, 65535});
    fields.field("imagery_crs", self.imagery_crs, "CRS of imagery that states none, for instance EPSG:32633.");
    fields.field("nodata", self.nodata, "Value that means no data in imagery that does not say so itself.");
    fields.field("collar", self.collar,
                 "Black (0 in every band) or white (the largest value) that reaches in from the edge of imagery "
                 "without no-data value, alpha or mask: taken for no data, or kept as ground.");
    fields.field("resampling", self.resampling, "How imagery is brought onto the mission grid.");
  }
};

/// How a second date of imagery is read: by what it says itself, but collars are kept or masked in both alike.
ImageryOptions second_date_options(const ImageryOptions& reference);

/// Where a raster says which pixels are ground. Pixels that are NaN or infinite never are.
enum class MaskKind {
  kNone,      ///< All pixels are valid.
  kNoData,    ///< A no-data value.
  kMaskBand,  ///< A mask of the whole dataset.
  kAlpha,     ///< An alpha band (with or without a no-data value).
};

inline EnumNames<MaskKind> enum_names(MaskKind) {
  return {{MaskKind::kNone, "none"},
          {MaskKind::kNoData, "no-data value"},
          {MaskKind::kMaskBand, "mask band"},
          {MaskKind::kAlpha, "alpha band"}};
}

/// How ground control points place a raster that has nothing else to say where it lies.
struct ControlPointFit {
  int points = 0;
  int order = 0;         ///< Of the polynomial: 1 or 2.
  double rms_m = 0;      ///< By how much points miss their places that were left out of the fit: metres on the ground.
  double largest_m = 0;  ///< The same, the worst of them.
  Crs crs;               ///< Of the points.
};

/// What a raster is.
struct ImageryInfo {
  std::string dataset;  ///< As given: a GDAL dataset string.
  std::string driver;   ///< GDAL's short name: "GTiff".
  int width_px = 0;
  int height_px = 0;
  GeoTransform map_from_pixel;
  Crs crs;
  int depth = 0;                         ///< OpenCV depth of the gray values: CV_8U, CV_16U or CV_64F.
  std::string band_type;                 ///< GDAL's name of the first used band's type: "Byte", "UInt16", "CFloat32".
  std::vector<std::string> band_colors;  ///< Colour interpretation of every band, as GDAL names it: "Red", "Alpha".
  std::vector<int> gray_bands;           ///< Bands (from 1) that gray is made of: one, or red, green, blue.
  bool palette = false;                  ///< The one gray band holds indices of colours.
  bool min_is_white = false;  ///< Its 0 is white (photometric interpretation MinIsWhite): inverted when read.
  MaskKind mask = MaskKind::kNone;
  /// Black or white around the ground of a raster without a mask, taken for no data as ImageryOptions::collar asks for;
  /// null where there is none.
  std::shared_ptr<const Collar> collar;
  /// Where ground control points that are no affine transform place the raster: it is read warped by them, and the
  /// size and place above are those of the warped raster.
  std::optional<ControlPointFit> control_points;
  /// How well its CRS is brought to WGS 84, where that is known to DatumShift's kDatumAccuracySaid_m or worse; 0 else.
  double datum_accuracy_m = 0;
  int overviews = 0;
  int block_width_px = 1;  ///< Of the blocks in which the file holds the first used band.
  int block_height_px = 1;
  /// Ground distance between neighbouring pixels at the centre of the raster, along a row and along a column: metres on
  /// the ellipsoid, whatever the CRS (degrees, feet, the stretched metres of EPSG:3857). Good to 1e-6 relative.
  double gsd_x_m = 0;
  double gsd_y_m = 0;
  GeodeticPoint center;
  /// "YYYY-MM-DD", with the time as "YYYY-MM-DDThh:mm:ssZ" where the metadata tell it in UTC; "" when they say nothing.
  std::string acquired;
  Licence licence;  ///< As its metadata say it (read_licence).
  /// Raster of its own error, where a tag names one (raster/map_sigma.h), whether it is there or not; else "".
  std::string map_sigma;
  double scale = 1;  ///< Value = stored · scale + offset, as the first used band states it; gray values leave it out.
  double offset = 0;
  std::string unit;  ///< Of the first used band's values: "m", "ft", or "".
  std::vector<std::string> warnings;
};

/// Opens a raster and says what it is. `dataset` is what GDAL opens by the drivers that are allowed (a file, a
/// part of one, a VRT; gdal_access.h), or a folder of tiles z/x/y. A raster whose only georeference is ground control
/// points is warped by them (docs/methods/imagery.md), unless they are one affine transform exactly. Throws DataError,
/// naming the dataset, when it cannot be opened, has no georeference (or points that do not place it well), no CRS (and
/// none is given), no bands, bands of a kind that cannot be made gray, or pixels at its edge that cannot be read;
/// UsageError when `options` do not fit it. Where black or white at its edge asks for it, all of the raster is read
/// (docs/decisions/collars.md), and `progress` may interrupt that.
ImageryInfo inspect_imagery(const std::string& dataset, const ImageryOptions& options = {},
                            const Progress& progress = {});

/// The same of a picture whose place, if it has one, does not matter, such as a frame of a camera: map_from_pixel, crs,
/// center and the ground sample distances keep their defaults. Throws DataError, naming the dataset, when it cannot be
/// opened, has no bands, or bands of a kind that cannot be made gray.
ImageryInfo inspect_picture(const std::string& dataset);

/// Whether its values are of a kind in which heights are delivered and pictures hardly ever: one band of floating-point
/// or signed numbers.
bool looks_like_heights(const ImageryInfo& info);

/// How far the ground control points and the change of datum that place a raster may put it, both axes together, in
/// metres; 0 where it has neither.
double placement_rms_m(const ImageryInfo& info);

/// The rectangle around a raster in another CRS; its edges are followed point by point because they may curve. Empty
/// when no point of it has an image there.
Bounds imagery_bounds(const ImageryInfo& info, const Crs& crs);

/// The rectangle around all of them that have an image there.
Bounds imagery_bounds(const std::vector<ImageryInfo>& infos, const Crs& crs);

/// What a planner should know before these rasters are used together, as sentences: what inspect_imagery said of each;
/// parts whose ground sample distance differs by more than 1 % (with a scale error of s, features a footprint w apart
/// no longer agree by s·w); parts with differing depths; imagery coarser than the ground sample distance that the
/// camera could use, `camera_gsd_m` (0 = not known).
std::vector<std::string> imagery_warnings(const std::vector<ImageryInfo>& infos, double camera_gsd_m);

}  // namespace pilotage

#pragma GCC visibility pop
