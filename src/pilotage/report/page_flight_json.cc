#include "pilotage/report/page_flight_json.h"

#include "pilotage/ins/ins_error_model.h"
#include "pilotage/ins/ins_products.h"
#include "pilotage/mission/wind_cases.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

Json model_json(const InsOptions& options, const FlightConditions& conditions) {
  const InsErrorModel model = make_error_model(options, conditions);
  return {{"text", ins_text(options)},
          {"accel_bias_mps2", model.accel_bias_mps2},
          {"gyro_bias_radps", model.gyro_bias_radps},
          {"velocity_random_walk_mps_rt_s", model.velocity_random_walk_mps_rt_s},
          {"angle_random_walk_rad_rt_s", model.angle_random_walk_rad_rt_s},
          {"accel_scale", model.accel_scale},
          {"gyro_scale", model.gyro_scale},
          {"bias_correlation_s", model.bias_correlation_s},
          {"start_velocity_sigma_mps", model.start_velocity_sigma_mps},
          {"start_tilt_sigma_rad", model.start_tilt_sigma_rad},
          {"start_heading_sigma_rad", model.start_heading_sigma_rad},
          {"odometry_drift", model.odometry_drift},
          {"velocity_aid_sigma_mps", model.velocity_aid_sigma_mps},
          {"velocity_aid_correlation_s", model.velocity_aid_correlation_s},
          {"start_sigma_m", model.start_sigma_m},
          {"fix_sigma_m", model.fix_sigma_m},
          {"sigma_multiple", model.sigma_multiple},
          {"map_sigma_m", model.map_sigma_m},
          {"map_correlation_m", model.map_correlation_m}};
}

}  // namespace

Json ins_choices_json(const InsOptions& planned, const FlightConditions& conditions) {
  Json models = Json::array({model_json(planned, conditions)});
  models.back()["grade"] = nullptr;
  for (const auto& [grade, name] : enum_names(InsGrade{})) {
    if (grade == InsGrade::kCustom) continue;
    InsOptions options = planned;
    options.name.reset();
    options.grade = grade;
    models.push_back(model_json(options, conditions));
    models.back()["grade"] = name;
  }
  return models;
}

Json wind_cases_json(const FlightConditions& conditions, std::size_t levels) {
  Json json = Json::array();
  for (const WindCase& one : wind_cases(conditions.wind_sigma_mps, levels)) {
    json.push_back({one.level, one.node.weight, one.node.wind_mps.x(), one.node.wind_mps.y()});
  }
  return json;
}

}  // namespace pilotage
