#include "pilotage/mission/flight_conditions.h"

namespace pilotage {

InsErrorModel make_error_model(const InsOptions& ins, const FlightConditions& conditions) {
  check_options(conditions);
  InsErrorModel model = make_ins_error_model(ins);
  model.map_sigma_m = conditions.map_sigma_m.value_or(kUnknownMapSigma_m);
  model.map_correlation_m = conditions.map_correlation_m.value_or(kMapCorrelation_m);
  return model;
}

}  // namespace pilotage
