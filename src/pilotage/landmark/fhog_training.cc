#include "pilotage/landmark/fhog_training.h"

#include <algorithm>

// Without the bindings to BLAS and LAPACK results do not depend on which of these is installed; dlib's own code stands
// in its headers. Of dlib's library only its threads are linked (landmark/CMakeLists.txt).
#include <dlib/assert.h>
#undef DLIB_USE_BLAS
#undef DLIB_USE_LAPACK
#define DLIB_TEST_FOR_ODR_VIOLATIONS_H_
#include <dlib/image_processing.h>
#include <dlib/opencv/cv_image.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

using Scanner = dlib::scan_fhog_pyramid<dlib::pyramid_down<6>>;

/// Boxes agree when they cover each other by half; a hit that another covers so far is the same thing.
const dlib::test_box_overlap kOverlap(0.5, 1.0);

void configure(Scanner& scanner, const FhogWindow& window) {
  const auto side = static_cast<unsigned long>(window.side_px);
  scanner.set_cell_size(static_cast<unsigned long>(window.cell_px));
  scanner.set_padding(1);
  scanner.set_detection_window_size(side, side);
  scanner.set_max_pyramid_levels(static_cast<unsigned long>(window.levels));
  scanner.set_min_pyramid_layer_size(side, side);
}

dlib::rectangle rectangle_of(const cv::Rect& box) {
  return {box.x, box.y, box.x + box.width - 1, box.y + box.height - 1};
}

dlib::array2d<unsigned char> image_of(const cv::Mat& gray) {
  dlib::array2d<unsigned char> image;
  dlib::assign_image(image, dlib::cv_image<unsigned char>(gray));
  return image;
}

}  // namespace

TrainedFilter train_fhog(const std::vector<TrainingPicture>& pictures, const FhogWindow& window,
                         const TrainingOptions& options) {
  dlib::array<dlib::array2d<unsigned char>> images;
  std::vector<std::vector<dlib::rectangle>> boxes;
  std::vector<std::vector<dlib::rectangle>> ignored;
  for (const TrainingPicture& picture : pictures) {
    dlib::array2d<unsigned char> image = image_of(picture.gray);
    images.push_back(image);
    auto& of_picture = boxes.emplace_back();
    for (const cv::Rect& box : picture.boxes) of_picture.push_back(rectangle_of(box));
    auto& left_out = ignored.emplace_back();
    for (const cv::Rect& box : picture.ignored) left_out.push_back(rectangle_of(box));
  }
  Scanner scanner;
  configure(scanner, window);
  dlib::structural_object_detection_trainer<Scanner> trainer(scanner);
  trainer.set_num_threads(1);
  trainer.set_c(options.c);
  trainer.set_epsilon(options.epsilon);
  trainer.set_overlap_tester(kOverlap);
  TrainedFilter result;
  const auto removed = dlib::remove_unobtainable_rectangles(trainer, images, boxes);
  for (std::size_t i = 0; i < removed.size(); ++i) {
    result.unobtainable += static_cast<int>(removed[i].size());
    ignored[i].insert(ignored[i].end(), removed[i].begin(), removed[i].end());  // no background either
  }
  std::size_t left = 0;
  for (const auto& of_picture : boxes) left += of_picture.size();
  if (left == 0) throw DataError("no label fits the detector's window");
  const auto detector = trainer.train(images, boxes, ignored);
  for (const double weight : detector.get_w()) result.weights.push_back(static_cast<float>(weight));
  return result;
}

}  // namespace pilotage
