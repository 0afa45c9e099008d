#pragma once

#include <memory>
#include <string>

class GDALDataset;

// Private to raster/gdal_*.cc and route/ogr_*.cc: GDAL's errors, registration and handles.

namespace pilotage {

/// Catches what GDAL and PROJ report in this thread while it lives, instead of letting them print.
class GdalErrors {
 public:
  GdalErrors();  ///< Registers GDAL's drivers the first time.
  ~GdalErrors();
  GdalErrors(const GdalErrors&) = delete;
  GdalErrors& operator=(const GdalErrors&) = delete;

  /// The first failure, else the last warning, else "".
  const std::string& message() const { return failure_.empty() ? warning_ : failure_; }
  bool failed() const { return !failure_.empty(); }
  /// A read that GDAL calls done was not whole: libjpeg fills what is missing with gray, libtiff leaves what it could
  /// not read as it was, and both only warn.
  bool read_in_part() const { return failed() || !unread_.empty(); }
  /// DataError "`what`: cannot be read whole: …" where something was not: libtiff goes on without a tag, and the raster
  /// without its date or its place.
  void require_whole(const std::string& what) const;
  /// DataError "`what`: `message()`"; std::bad_alloc when memory has run out.
  [[noreturn]] void throw_data_error(const std::string& what) const;

  void add(bool is_failure, const char* text);  ///< For the callback.
  void add_out_of_memory() { out_of_memory_ = true; }

 private:
  bool out_of_memory_ = false;
  std::string failure_;
  std::string warning_;
  std::string unread_;  ///< The first warning of a read that was not whole.
};

struct DatasetCloser {
  void operator()(GDALDataset* dataset) const;
};
using DatasetPtr = std::unique_ptr<GDALDataset, DatasetCloser>;

/// Opens a raster, or a folder of tiles z/x/y (gdal_tile_folder.h), to read; throws DataError with the dataset's name.
/// A mask that lies beside it (.msk) and is not opened is an error, too: GDAL would take every pixel for ground.
DatasetPtr open_raster(const std::string& dataset);

}  // namespace pilotage
