#include "pilotage/landmark/training_chips.h"

#include <cmath>
#include <filesystem>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/landmark/label_landmarks.h"
#include "pilotage/raster/gdal_gray.h"

namespace pilotage {

TrainingChips read_training_chips(const std::vector<std::string>& folders, const Progress& progress) {
  constexpr double kAlike = 0.01;
  TrainingChips all;
  for (std::size_t number = 0; number < folders.size(); ++number) {
    std::error_code unknown;
    for (std::size_t other = 0; other < number; ++other) {
      if (std::filesystem::equivalent(folders[other], folders[number], unknown)) {
        throw UsageError(folders[number] + " is given twice: its labels would count twice");
      }
    }
    const std::filesystem::path annotations = std::filesystem::path(folders[number]) / kChipAnnotations;
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(annotations, ignored)) {
      throw DataError(folders[number] + ": has no " + std::string(kChipAnnotations) +
                      "; `pilotage landmark-label` writes it");
    }
    ImageryOptions keep;
    keep.collar = CollarRule::kKeep;
    std::vector<AnnotatedPicture> pictures = read_annotations(annotations);
    for (std::size_t i = 0; i < pictures.size(); ++i) {
      report_progress(progress, "reading chips", static_cast<std::int64_t>(i), std::ssize(pictures));
      AnnotatedPicture& picture = pictures[i];
      for (const PictureLabel& label : picture.labels) {
        if (label.class_name.empty()) throw DataError(label.name + ": has no class");
      }
      const std::string name = picture.picture.string();
      const ImageryInfo info = inspect_imagery(name, keep);
      const double gsd_m = info.map_from_pixel.x_per_col;
      if (all.crs.empty()) {
        all.crs = info.crs;
        all.gsd_m = gsd_m;
      }
      if (!info.crs.same_as(all.crs)) {
        throw DataError(name + ": is in " + info.crs.name() + ", other chips are in " + all.crs.name() +
                        "; label all of them with one --crs");
      }
      if (std::abs(gsd_m / all.gsd_m - 1) > kAlike) {
        throw DataError(name + ": has pixels of " + format_number(gsd_m) + " m, other chips of " +
                        format_number(all.gsd_m) + " m; label all of them with one --gsd-m");
      }
      TrainingChip& chip = all.chips.emplace_back();
      chip.gray = read_gray8_picture(name);
      chip.labels = std::move(picture.labels);
      chip.bounds_m.extend(info.map_from_pixel.map_from_pixel({0, 0}));
      chip.bounds_m.extend(info.map_from_pixel.map_from_pixel(
          {static_cast<double>(chip.gray.cols), static_cast<double>(chip.gray.rows)}));
    }
  }
  if (all.chips.empty()) throw DataError(join(folders, ", ") + ": hold no chip");
  return all;
}

}  // namespace pilotage
