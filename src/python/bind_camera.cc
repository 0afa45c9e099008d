#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "onboard_module.h"
#include <pybind11/operators.h>
#include <pybind11/stl.h>

#include "pilotage/base/error.h"
#include "pilotage/camera/camera.h"
#include "pilotage/camera/camera_text.h"

namespace py = pybind11;

namespace pilotage::python {
namespace {

Camera make_camera(int width_px, int height_px, double fx_px, double fy_px, double cx_px, double cy_px,
                   const std::string& distortion_model, const std::vector<double>& distortion, double mount_yaw_deg,
                   double mount_pitch_deg, double mount_roll_deg) {
  Camera camera{width_px, height_px, fx_px, fy_px, cx_px, cy_px};
  const std::optional<DistortionModel> model = distortion_model_named(distortion_model);
  if (!model)
    throw UsageError("distortion_model = \"" + distortion_model + "\" is not one of: none, brown_conrady, fisheye");
  camera.distortion_model = *model;
  if (distortion.size() > camera.distortion.size()) {
    throw UsageError("distortion has " + std::to_string(distortion.size()) + " numbers, 5 at most are allowed");
  }
  std::copy(distortion.begin(), distortion.end(), camera.distortion.begin());
  camera.mount = {mount_yaw_deg, mount_pitch_deg, mount_roll_deg};
  if (const std::string problem = camera_problem(camera); !problem.empty()) throw UsageError("camera: " + problem);
  return camera;
}

/// As it is made.
std::string camera_repr(const py::object& self) {
  std::string text;
  for (const char* name : {"width_px", "height_px", "fx_px", "fy_px", "cx_px", "cy_px", "distortion_model",
                           "distortion", "mount_yaw_deg", "mount_pitch_deg", "mount_roll_deg"}) {
    text += (text.empty() ? "" : ", ") + std::string(name) + "=" + std::string(py::repr(self.attr(name)));
  }
  return "Camera(" + text + ")";
}

}  // namespace

void bind_camera(py::module_& module) {
  py::class_<Camera>(module, "Camera",
                     "A pinhole camera with distortion, and how it sits on the aircraft (pilotage/camera/camera.h).\n\n"
                     "Pixel centres lie at +0.5: the centre of the first pixel is (0.5, 0.5).")
      .def(py::init(&make_camera), py::kw_only(), py::arg("width_px"), py::arg("height_px"), py::arg("fx_px"),
           py::arg("fy_px"), py::arg("cx_px"), py::arg("cy_px"), py::arg("distortion_model") = "none",
           py::arg("distortion") = std::vector<double>{}, py::arg("mount_yaw_deg") = 0.0,
           py::arg("mount_pitch_deg") = 0.0, py::arg("mount_roll_deg") = 0.0,
           "Throws UsageError when a value is not one of a camera.\n\n"
           "distortion: k1, k2, p1, p2, k3 of \"brown_conrady\" (OpenCV), k1 … k4 of \"fisheye\"; what is missing is "
           "0.\n"
           "mount: 0, 0, 0 looks straight down, the top of the image to the nose.")
      .def_readonly("width_px", &Camera::width_px)
      .def_readonly("height_px", &Camera::height_px)
      .def_readonly("fx_px", &Camera::fx_px)
      .def_readonly("fy_px", &Camera::fy_px)
      .def_readonly("cx_px", &Camera::cx_px)
      .def_readonly("cy_px", &Camera::cy_px)
      .def_property_readonly("distortion_model",
                             [](const Camera& camera) { return distortion_model_name(camera.distortion_model); })
      .def_property_readonly("distortion", [](const Camera& camera) { return py::tuple(py::cast(camera.distortion)); })
      .def_property_readonly("mount_yaw_deg", [](const Camera& camera) { return camera.mount.yaw_deg; })
      .def_property_readonly("mount_pitch_deg", [](const Camera& camera) { return camera.mount.pitch_deg; })
      .def_property_readonly("mount_roll_deg", [](const Camera& camera) { return camera.mount.roll_deg; })
      .def(
          "for_size",
          [](const Camera& camera, int width_px, int height_px) {
            return camera_for_size("camera", camera, width_px, height_px);
          },
          py::arg("width_px"), py::arg("height_px"),
          "The camera for pictures of another size and the same shape. Throws DataError for another shape.")
      .def(py::self == py::self)
      .def("__repr__", &camera_repr);
}

}  // namespace pilotage::python
