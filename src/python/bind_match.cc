#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "onboard_module.h"
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/geo/position_covariance.h"
#include "pilotage/match/match.h"

namespace py = pybind11;

namespace pilotage::python {
namespace {

using Matrix = py::array_t<double, py::array::c_style | py::array::forcecast>;

MatchPrior make_prior(double lon_deg, double lat_deg, double height_agl_m, std::optional<double> sigma_m,
                      const std::optional<Matrix>& covariance_en_m2, double yaw_deg, double pitch_deg,
                      double roll_deg) {
  if (sigma_m.has_value() == covariance_en_m2.has_value()) {
    throw UsageError("sigma_m or covariance_en_m2, one of the two, says how sure the position is");
  }
  if (sigma_m && !(*sigma_m >= 0 && std::isfinite(*sigma_m))) {
    throw UsageError("sigma_m = " + format_number(*sigma_m) + " is no standard deviation: a finite number, 0 or above");
  }
  Eigen::Matrix2d covariance_m2;
  if (sigma_m) {
    covariance_m2 = isotropic_covariance_m2(*sigma_m);
  } else {
    if (covariance_en_m2->ndim() != 2 || covariance_en_m2->shape(0) != 2 || covariance_en_m2->shape(1) != 2) {
      throw UsageError("covariance_en_m2 is no 2 x 2 matrix");
    }
    const auto at = covariance_en_m2->unchecked<2>();
    covariance_m2 << at(0, 0), at(0, 1), at(1, 0), at(1, 1);
  }
  return {{lon_deg, lat_deg}, covariance_m2, height_agl_m, {yaw_deg, pitch_deg, roll_deg}};
}

/// The pixels of a frame where they lie.
cv::Mat pixels_of_frame(const py::array& frame) {
  const bool bytes = frame.dtype().kind() == 'u' && frame.dtype().itemsize() == 1;
  if (!bytes || frame.ndim() != 2) {
    throw py::type_error("frame must be uint8[height, width], a gray picture, not " +
                         std::string(py::str(frame.dtype())) + " with " + std::to_string(frame.ndim()) + " dimensions");
  }
  if (frame.size() == 0) return {};
  if ((frame.shape(1) > 1 && frame.strides(1) != 1) || (frame.shape(0) > 1 && frame.strides(0) < frame.shape(1))) {
    throw py::type_error("frame must have its rows in one piece each: numpy.ascontiguousarray(frame) copies it so");
  }
  constexpr py::ssize_t kMostPx = 1'000'000;
  if (frame.shape(0) > kMostPx || frame.shape(1) > kMostPx)
    throw py::value_error("frame has more than 1,000,000 rows or columns");
  // cv::Mat knows no constant pixels; match() does not write to them.
  return {static_cast<int>(frame.shape(0)), static_cast<int>(frame.shape(1)), CV_8UC1, const_cast<void*>(frame.data()),
          static_cast<std::size_t>(frame.shape(0) > 1 ? frame.strides(0) : frame.shape(1))};
}

/// The map's camera for a frame of this size. A frame of another shape gets it as it is, for match() to refuse.
Camera own_camera(const SharedMap& map, const cv::Mat& frame) {
  const std::optional<Camera>& camera = map.reader().camera();
  if (!camera) throw UsageError("camera: the map names none; give one");
  if (frame.empty()) return *camera;
  try {
    return camera_for_size("frame", *camera, frame.cols, frame.rows);
  } catch (const DataError&) {
    return *camera;
  }
}

/// The map and those beside it. Throws UsageError where one stands there twice, TypeError for None.
std::vector<SharedMap*> maps_of_call(SharedMap& map, const std::vector<std::shared_ptr<SharedMap>>& also) {
  std::vector<SharedMap*> maps{&map};
  for (const std::shared_ptr<SharedMap>& one : also) {
    if (!one) throw py::type_error("also_maps: None is no Map");
    if (std::find(maps.begin(), maps.end(), one.get()) != maps.end()) {
      throw UsageError("also_maps: " + one->reader().name() + " stands there twice");
    }
    maps.push_back(one.get());
  }
  return maps;
}

MatchResult match_frame(SharedMap& map, const py::array& frame, const MatchPrior& prior,
                        const std::optional<Camera>& camera, const std::vector<std::shared_ptr<SharedMap>>& also_maps,
                        const py::kwargs& given) {
  const std::vector<SharedMap*> maps = maps_of_call(map, also_maps);
  MatchOptions options;
  set_options(list_options(options), given, "match");
  const cv::Mat pixels = pixels_of_frame(frame);
  const Camera lens = camera ? *camera : own_camera(map, pixels);
  // Signals are asked for now and then: each time the interpreter's lock is waited for.
  constexpr auto kBetween = std::chrono::milliseconds(50);
  auto asked = std::chrono::steady_clock::now();
  const auto go_on = [&asked, kBetween] {
    const auto now = std::chrono::steady_clock::now();
    if (now - asked < kBetween) return true;
    const py::gil_scoped_acquire acquired;
    asked = std::chrono::steady_clock::now();
    return PyErr_CheckSignals() == 0;
  };
  return SharedMap::use_all(
      maps, [&](std::span<MapReader* const> readers) { return match(pixels, prior, lens, readers, options, go_on); });
}

/// Reads the attributes that `names` lists, for tables.
py::dict to_dict(const py::object& self) {
  py::dict result;
  for (const py::handle name : self.attr("_fields")) result[name] = self.attr(py::reinterpret_borrow<py::str>(name));
  return result;
}

/// Binds plain members one by one and lists them for to_dict().
template <class Class>
class Fields {
 public:
  explicit Fields(py::class_<Class>& bound) : bound_(bound) {}

  template <class Member>
  Fields& add(const char* name, Member Class::*member, const char* help = "") {
    bound_.def_readonly(name, member, help);
    names_.append(name);
    return *this;
  }
  template <class Get>
  Fields& add_property(const char* name, const Get& get, const char* help = "") {
    bound_.def_property_readonly(name, get, help);
    names_.append(name);
    return *this;
  }
  void finish() {
    bound_.attr("_fields") = py::tuple(names_);
    bound_.def("to_dict", &to_dict, "All of it as a dict, for tables.");
    bound_.def("__repr__", [](const py::object& self) {
      return std::string(py::str(py::type::of(self).attr("__name__"))) + "(" + std::string(py::str(to_dict(self))) +
             ")";
    });
  }

 private:
  py::class_<Class>& bound_;
  py::list names_;
};

void bind_prior(py::module_& module) {
  py::class_<MatchPrior> prior(module, "Prior", "What the aircraft knows when the frame is taken.");
  prior.def(py::init(&make_prior), py::kw_only(), py::arg("lon_deg"), py::arg("lat_deg"), py::arg("height_agl_m"),
            py::arg("sigma_m") = py::none(), py::arg("covariance_en_m2") = py::none(), py::arg("yaw_deg") = 0.0,
            py::arg("pitch_deg") = 0.0, py::arg("roll_deg") = 0.0,
            "Position in WGS 84, and how sure it is: `sigma_m` along each axis, or `covariance_en_m2`, the 2 x 2 "
            "covariance of east and\n"
            "north. Height above the ground under the aircraft. Yaw clockwise from true north, pitch > 0 raises the "
            "nose, roll > 0 lowers\n"
            "the right wing.");
  Fields<MatchPrior>(prior)
      .add_property("lon_deg", [](const MatchPrior& self) { return self.position.lon_deg; })
      .add_property("lat_deg", [](const MatchPrior& self) { return self.position.lat_deg; })
      .add("covariance_en_m2", &MatchPrior::covariance_en_m2)
      .add("height_agl_m", &MatchPrior::height_agl_m)
      .add_property("yaw_deg", [](const MatchPrior& self) { return self.attitude.yaw_deg; })
      .add_property("pitch_deg", [](const MatchPrior& self) { return self.attitude.pitch_deg; })
      .add_property("roll_deg", [](const MatchPrior& self) { return self.attitude.roll_deg; })
      .finish();
}

void bind_fix(py::module_& module) {
  py::class_<Fix> fix(module, "Fix", "Where the aircraft is. East and north are those of the fix's own place.");
  Fields<Fix>(fix)
      .add_property(
          "lon_deg", [](const Fix& self) { return self.position.lon_deg; },
          "Of the aircraft: the point straight below it.")
      .add_property("lat_deg", [](const Fix& self) { return self.position.lat_deg; })
      .add("covariance_en_m2", &Fix::covariance_en_m2,
           "float64[2, 2]: variances of east and north and their covariance.")
      .add_property(
          "center_lon_deg", [](const Fix& self) { return self.center.lon_deg; },
          "Of the ground that the principal point shows.")
      .add_property("center_lat_deg", [](const Fix& self) { return self.center.lat_deg; })
      .add("center_covariance_en_m2", &Fix::center_covariance_en_m2)
      .add("yaw_deg", &Fix::yaw_deg, "Refined; so are pitch, roll and height.")
      .add("pitch_deg", &Fix::pitch_deg)
      .add("roll_deg", &Fix::roll_deg)
      .add("yaw_sigma_deg", &Fix::yaw_sigma_deg)
      .add("height_agl_m", &Fix::height_agl_m)
      .add("height_sigma_m", &Fix::height_sigma_m)
      .add("scale", &Fix::scale, "height_agl_m over the prior's.")
      .add("map_sigma_m", &Fix::map_sigma_m, "Of the map's own georeference, each axis; part of both covariances.")
      .add("tile_id", &Fix::tile_id,
           "Of the tile under the principal point, or the nearest; None for a fix by landmarks alone.")
      .finish();
}

void bind_stats(py::module_& module) {
  py::class_<MatchStats> stats(module, "MatchStats",
                               "How the answer came about (pilotage/match/match.h); 0 where it did not get that far.");
  Fields<MatchStats>(stats)
      .add("level", &MatchStats::level)
      .add("gsd_m", &MatchStats::gsd_m)
      .add("frame_features", &MatchStats::frame_features)
      .add("map_features", &MatchStats::map_features)
      .add("support", &MatchStats::support)
      .add("expected_features", &MatchStats::expected_features)
      .add("vote_peak", &MatchStats::vote_peak)
      .add("vote_rival", &MatchStats::vote_rival)
      .add("inliers", &MatchStats::inliers)
      .add("residual_m", &MatchStats::residual_m)
      .add("ncc", &MatchStats::ncc)
      .add("ncc_rival", &MatchStats::ncc_rival)
      .add("chip_pixels", &MatchStats::chip_pixels)
      .add("agreement", &MatchStats::agreement)
      .add("confidence", &MatchStats::confidence)
      .add("search_half_width_m", &MatchStats::search_half_width_m)
      .add("landmarks_seen", &MatchStats::landmarks_seen)
      .add("landmarks_expected", &MatchStats::landmarks_expected)
      .add("landmarks_matched", &MatchStats::landmarks_matched)
      .finish();
}

void bind_result(py::module_& module) {
  py::class_<MatchResult>(module, "MatchResult", "A fix, or why there is none. True exactly when there is a fix.")
      .def_property_readonly(
          "status", [](const MatchResult& self) { return std::string(match_status_name(self.status)); },
          "\"fix\", \"no_map\", \"ambiguous\" …: the word in files (docs/methods/match.md).")
      .def_property_readonly(
          "text", [](const MatchResult& self) { return std::string(match_status_text(self.status)); },
          "The same as a sentence.")
      .def_readonly("fix", &MatchResult::fix, "The Fix; None unless the status is \"fix\".")
      .def_readonly(
          "candidate", &MatchResult::candidate,
          "The best place even when it is refused, for people and statistics; never to be used for navigation.")
      .def_readonly("stats", &MatchResult::stats)
      .def_readonly("map_index", &MatchResult::map_index,
                    "Of the maps that were asked, in their order: the one whose answer this is.")
      .def_property_readonly(
          "map_statuses",
          [](const MatchResult& self) {
            py::list names;
            for (const MatchStatus status : self.map_statuses) names.append(std::string(match_status_name(status)));
            return names;
          },
          "What each of them said by itself.")
      .def("__bool__", [](const MatchResult& self) { return self.fix.has_value(); })
      .def("__repr__", [](const MatchResult& self) {
        return "MatchResult('" + std::string(match_status_name(self.status)) + "')";
      });
}

}  // namespace

void bind_match(py::module_& module) {
  bind_prior(module);
  bind_fix(module);
  bind_stats(module);
  bind_result(module);

  MatchOptions defaults;
  static const std::string help =
      "Finds the aircraft: where `frame`, uint8[height, width], was taken, by what `prior` knows and the map holds. "
      "`camera` is the\n"
      "lens that took it, by default the map's own, scaled to the frame. Pixels are used where they lie; nothing else "
      "may write to\n"
      "them meanwhile. The interpreter's lock is let go. `also_maps` are further maps of the ground, such as those of "
      "imagery of other\n"
      "dates: each is asked, at its share of the rate of false fixes; MatchResult.map_index says which answers.\n\n"
      "Returns a MatchResult for any frame, prior and camera. Throws TypeError for what is no gray picture or no "
      "option, UsageError for\n"
      "an option outside its range, or where neither the map nor the call names a camera.\n\n"
      "Options:\n" +
      options_docstring(list_options(defaults));
  auto map = py::reinterpret_borrow<py::class_<SharedMap, std::shared_ptr<SharedMap>>>(module.attr("Map"));
  map.def("match", &match_frame, py::arg("frame"), py::arg("prior"), py::arg("camera") = py::none(), py::kw_only(),
          py::arg("also_maps") = std::vector<std::shared_ptr<SharedMap>>{}, help.c_str());
}

}  // namespace pilotage::python
