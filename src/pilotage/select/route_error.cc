#include "pilotage/select/route_error.h"

#include <algorithm>
#include <limits>

#include "pilotage/ins/ins_error.h"

namespace pilotage {
namespace {

// Flies along the samples of a plan and knows the error at the current one.
class Flight {
 public:
  Flight(const TilePlan& plan, const RouteErrorModel& model)
      : plan_(plan), model_(model), ins_(make_ins_error_model(plan.ins)), state_(initial_ins_state(ins_, model.fix_sigma_m)) {}

  std::size_t at() const { return at_; }
  double time_s() const { return time_s_; }
  double error_m() const { return position_error_m(state_, plan_.ins.sigma_multiple); }

  void advance() {
    const PlanSample& from = plan_.route_samples[at_];
    const PlanSample& to = plan_.route_samples[++at_];
    const double duration_s = (to.distance_m - from.distance_m) / from.speed_mps;
    state_ = propagate(state_, duration_s, from.azimuth_deg, from.speed_mps, ins_);
    time_s_ += duration_s;
  }

  void fix() {
    state_ = update_with_fix(state_, model_.fix_sigma_m);
    last_fix_time_s_ = time_s_;
  }

  bool fix_is_due() const { return time_s_ - last_fix_time_s_ >= model_.fix_interval_s; }

 private:
  const TilePlan& plan_;
  const RouteErrorModel& model_;
  InsErrorModel ins_;
  InsState state_;
  std::size_t at_ = 0;
  double time_s_ = 0;
  double last_fix_time_s_ = -std::numeric_limits<double>::infinity();
};
