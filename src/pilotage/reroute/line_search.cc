#include "pilotage/reroute/line_search.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <queue>

namespace pilotage {
namespace {

constexpr double kNoHeading = -1e9;  // before the first move, turning costs nothing
constexpr std::uint32_t kNoParent = static_cast<std::uint32_t>(-1);
constexpr double kSameCost_m = 1e-6;

struct Label {
  FixAges ages;
  double cost_m = 0;
  double heading_rad = kNoHeading;
  std::uint32_t place = 0;
  std::uint32_t stretch = 0;  ///< One behind the last: the line is whole.
  std::uint32_t parent = kNoParent;
};

/// What decides most tests of dominance against a settled label, side by side for each place: the labels themselves lie
/// far from each other in memory, and are read only where this does not decide.
struct Settled {
  double cost_m = 0;
  double heading_rad = 0;
  float share_within = 0;
  std::uint32_t label = 0;
};

struct QueueEntry {
  double least_cost_m = 0;  ///< Of any whole line that goes on from the label.
  std::uint32_t label = 0;
  bool operator<(const QueueEntry& other) const {  // the best is on top; of equals the one made first
    return least_cost_m != other.least_cost_m ? least_cost_m > other.least_cost_m : label > other.label;
  }
};

double cost_of_turn(double from_rad, double to_rad, double cost_of_90_deg_m) {
  if (from_rad == kNoHeading || to_rad == kNoHeading) return 0;
  return turn_cost_m(from_rad, to_rad, cost_of_90_deg_m);
}

class Searcher {
 public:
  Searcher(const LineGraph& graph, const FixAgeModel& model, const std::vector<KeptWay>& kept,
           const std::vector<SearchStretch>& stretches, const LineDemand& demand, const LabelLimits& limits)
      : graph_(graph), model_(model), kept_(kept), stretches_(stretches), demand_(demand), limits_(limits) {
    steps_.reserve(graph.steps.size());
    for (const FlownStep& step : graph.steps) steps_.push_back(age_step(model, step));
    settled_.resize(stretches.size() * graph.places_m.size());
    way_after_m_.assign(stretches.size() + 1, 0.0);
    for (std::size_t i = stretches.size(); i-- > 0;) {
      const double next_m = i + 1 < stretches.size() ? way_after_m_[i + 1] + straight_m(i + 1) : 0;
      way_after_m_[i] = kept[i + 1].length_m + next_m;
    }
  }

  std::optional<FoundLine> run(const Progress& progress) {
    Label first;
    first.ages = ages_at_start(model_);
    first.place = stretches_.front().from;
    if (fly_kept(0, first)) push(first);
    std::size_t looked_at = 0;
    while (!queue_.empty()) {
      const std::uint32_t index = queue_.top().label;
      queue_.pop();
      if (labels_[index].stretch == stretches_.size()) return line_of(index, looked_at);
      if (!settle(index)) continue;
      if (++looked_at % 4096 == 0) report_progress(progress, "searching for a line", 0, 0);
      expand(index);
      if (labels_.size() > limits_.most_in_all) return std::nullopt;
    }
    return std::nullopt;
  }

 private:
  double straight_m(std::size_t stretch) const {
    return (graph_.places_m[stretches_[stretch].to] - graph_.places_m[stretches_[stretch].from]).norm();
  }

  bool is_good_enough(const FixAges& ages) const {
    if (demand_.good_reach && ages.since_matchable_m > model_.good_reach_m) return false;
    return share_within(model_, ages) >= demand_.min_share_within && share_within(model_, ages) > 0;
  }

  bool fly(const AgeStep& step, FixAges& ages) const {
    take_step(model_, step, ages);
    return is_good_enough(ages);
  }

  bool fly_move(const LineMove& move, FixAges& ages) const {
    for (std::uint32_t i = 0; i < move.step_count; ++i) {
      if (!fly(steps_[move.first_step + i], ages)) return false;
    }
    return true;
  }

  bool fly_kept(std::size_t which, Label& label) const {
    const KeptWay& way = kept_[which];
    if (!(way.length_m > 0)) return true;
    label.cost_m += way.length_m + way.turn_rad / (std::numbers::pi / 2) * demand_.turn_cost_m +
                    cost_of_turn(label.heading_rad, way.first_heading_rad, demand_.turn_cost_m);
    label.heading_rad = way.last_heading_rad;
    return std::all_of(way.steps.begin(), way.steps.end(),
                       [&](const FlownStep& step) { return fly(age_step(model_, step), label.ages); });
  }

  void push(const Label& label) {
    double least_m = label.cost_m;
    if (label.stretch < stretches_.size()) {
      const Eigen::Vector2d to_m = graph_.places_m[stretches_[label.stretch].to];
      least_m += (to_m - graph_.places_m[label.place]).norm() + way_after_m_[label.stretch];
    }
    labels_.push_back(label);
    queue_.push({least_m, static_cast<std::uint32_t>(labels_.size() - 1)});
  }

  std::vector<Settled>& settled_at(const Label& label) {
    return settled_[label.stretch * graph_.places_m.size() + label.place];
  }

  bool dominates(const Settled& settled, const Label& b) const {
    const auto tolerance = static_cast<float>(limits_.tolerance);
    if (settled.share_within + tolerance < share_within(model_, b.ages)) return false;
    const double turn_m = cost_of_turn(settled.heading_rad, b.heading_rad, demand_.turn_cost_m);
    if (settled.cost_m + turn_m > b.cost_m + kSameCost_m) return false;
    const Label& a = labels_[settled.label];
    if (demand_.good_reach && a.ages.since_matchable_m > b.ages.since_matchable_m) return false;
    for (std::size_t bin = model_.bins; bin-- > 0;) {
      if (a.ages.within[bin] + tolerance < b.ages.within[bin]) return false;
    }
    return true;
  }

  bool is_dominated(const Label& label, const std::vector<Settled>& settled) const {
    return std::any_of(settled.begin(), settled.end(), [&](const Settled& other) { return dominates(other, label); });
  }

  bool settle(std::uint32_t index) {
    const Label& label = labels_[index];
    std::vector<Settled>& settled = settled_at(label);
    if (settled.size() >= limits_.most_labels || is_dominated(label, settled)) return false;
    settled.push_back({label.cost_m, label.heading_rad, share_within(model_, label.ages), index});
    return true;
  }

  void arrive(Label& label) {
    // At the end of a stretch the kept way follows, and the next stretch.
    if (label.place == stretches_[label.stretch].to) {
      Label next = label;
      if (fly_kept(label.stretch + 1, next)) {
        ++next.stretch;
        if (next.stretch < stretches_.size()) next.place = stretches_[next.stretch].from;
        push(next);
      }
      return;
    }
    const auto& settled = settled_at(label);
    if (settled.size() < limits_.most_labels && !is_dominated(label, settled)) push(label);
  }

  void expand(std::uint32_t index) {
    const std::uint32_t place = labels_[index].place;
    for (std::uint32_t i = graph_.first_move[place]; i < graph_.first_move[place + 1]; ++i) {
      const LineMove& move = graph_.moves[i];
      Label next = labels_[index];
      next.parent = index;
      next.place = move.to;
      next.cost_m += move.length_m + cost_of_turn(next.heading_rad, move.heading_rad, demand_.turn_cost_m);
      next.heading_rad = move.heading_rad;
      if (fly_move(move, next.ages)) arrive(next);
    }
  }

  FoundLine line_of(std::uint32_t index, std::size_t looked_at) const {
    FoundLine line;
    line.cost_m = labels_[index].cost_m;
    line.share_within = share_within(model_, labels_[index].ages);
    line.labels = looked_at;
    line.places.resize(stretches_.size());
    // A label that has just come to a new stretch stands at that one's first place; its parent, a move before the last
    // place of the stretch before.
    for (std::uint32_t at = index; at != kNoParent; at = labels_[at].parent) {
      const std::size_t stretch = labels_[at].stretch;
      if (stretch < stretches_.size()) line.places[stretch].push_back(labels_[at].place);
      const std::uint32_t parent = labels_[at].parent;
      if (parent != kNoParent && labels_[parent].stretch != stretch) {
        line.places[labels_[parent].stretch].push_back(stretches_[labels_[parent].stretch].to);
      }
    }
    for (auto& places : line.places) std::reverse(places.begin(), places.end());
    return line;
  }

  const LineGraph& graph_;
  const FixAgeModel& model_;
  const std::vector<KeptWay>& kept_;
  const std::vector<SearchStretch>& stretches_;
  const LineDemand& demand_;
  const LabelLimits& limits_;
  std::vector<AgeStep> steps_;       ///< The graph's.
  std::vector<double> way_after_m_;  ///< Least way behind the end of each stretch.
  std::vector<Label> labels_;
  std::vector<std::vector<Settled>> settled_;  ///< Of each stretch and place.
  std::priority_queue<QueueEntry> queue_;
};

}  // namespace

double turn_cost_m(double from_rad, double to_rad, double cost_of_90_deg_m) {
  double turn_rad = std::abs(to_rad - from_rad);
  if (turn_rad > std::numbers::pi) turn_rad = std::abs(std::remainder(turn_rad, 2 * std::numbers::pi));
  return turn_rad / (std::numbers::pi / 2) * cost_of_90_deg_m;
}

std::optional<FoundLine> search_line(const LineGraph& graph, const FixAgeModel& model, const std::vector<KeptWay>& kept,
                                     const std::vector<SearchStretch>& stretches, const LineDemand& demand,
                                     const LabelLimits& limits, const Progress& progress) {
  return Searcher(graph, model, kept, stretches, demand, limits).run(progress);
}

}  // namespace pilotage
