#include "pilotage/select/budget_tiles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/select/fix_chain.h"
#include "pilotage/select/select_tiles.h"
#include "pilotage/select/storage_count.h"

namespace pilotage {
namespace {

constexpr double kLeastGain = 1e-12;
constexpr int kMostTrials = 400;       // exchanges that are tried; each fills the budget again
constexpr int kMostFlownTrials = 100;  // of those that are judged by a flight, at most; fewer on
constexpr int kSamplesFlown = 60'000;  // long routes

// A set of tiles under the route that grows and shrinks, with its bytes and its worth.
class TileSet {
 public:
  TileSet(const FlightPath& path, const std::vector<FixAttempt>& attempts, const TileChances& chances,
          const FixChain& chain, const StoredSize& size, double budget)
      : mission_(path.mission),
        attempts_(&attempts),
        chances_(&chances),
        chain_(&chain),
        budget_(budget),
        count_(*path.mission, size),
        chosen_(chances.p.size(), false) {
    for (const FixAttempt& attempt : attempts) {
      if (chances.p[attempt.tile] > 0) candidates_.push_back(attempt.tile);
    }
    std::sort(candidates_.begin(), candidates_.end());
    candidates_.erase(std::unique(candidates_.begin(), candidates_.end()), candidates_.end());
  }

  const std::vector<std::size_t>& candidates() const { return candidates_; }
  const std::vector<bool>& chosen() const { return chosen_; }
  bool fits(std::size_t tile) const { return count_.bytes() + bytes_of(tile) <= budget_; }
  bool can_ever_fit(std::size_t tile, const StoredSize& size) const {
    return StorageCount(*mission_, size).bytes() +
               StorageCount(*mission_, size).bytes_of(mission_->ground.tiles[tile]) <=
           budget_;
  }
  double bytes_of(std::size_t tile) const { return count_.bytes_of(mission_->ground.tiles[tile]); }
  void add(std::size_t tile) {
    count_.add(mission_->ground.tiles[tile]);
    chosen_[tile] = true;
  }
  void remove(std::size_t tile) {
    count_.remove(mission_->ground.tiles[tile]);
    chosen_[tile] = false;
  }
  double value() const {
    double sum = 0;
    for (const TileChances::AtLevel& level : chances_->levels) {
      sum += level.weight * chain_value(*chain_, node_probabilities(level)).value;
    }
    return sum;
  }

  TileChances stored() const { return of_chosen(*chances_, chosen_); }

  // What each tile adds, or for a chosen one what it holds, in the order of the candidates: first order where it would
  // take the place of another attempt of its window.
  std::vector<double> gains() const {
    std::vector<double> gain(chosen_.size(), 0.0);
    for (const TileChances::AtLevel& level : chances_->levels) add_gains(level, gain);
    std::vector<double> of_candidates;
    for (const std::size_t tile : candidates_) of_candidates.push_back(gain[tile]);
    return of_candidates;
  }

  // Adds what each tile gains at a level, times its weight.
  void add_gains(const TileChances::AtLevel& level, std::vector<double>& gain) const {
    const std::vector<double> p = node_probabilities(level);
    const std::vector<double> slope = chain_value(*chain_, p).slope;
    for (std::size_t k = 0; k < attempts_->size();) {
      std::size_t next = k;
      double held = 0;
      for (; next < attempts_->size() && (*attempts_)[next].window == (*attempts_)[k].window; ++next) {
        held += p[next + 1] * slope[next + 1];  // one attempt of the window counts
      }
      for (; k < next; ++k) {
        const std::size_t tile = (*attempts_)[k].tile;
        const double own = level.p[tile] * slope[k + 1];
        if (p[k + 1] > 0) gain[tile] += level.weight * own;
        if (!chosen_[tile]) gain[tile] += level.weight * std::max(0.0, own - held);
      }
    }
  }

  // Adds the tile with the largest gain per byte, but for `barred`, while one fits.
  void fill(std::size_t barred) {
    while (true) {
      const std::vector<double> gain = gains();
      std::size_t best = candidates_.size();
      double best_rate = 0;
      for (std::size_t k = 0; k < candidates_.size(); ++k) {
        const std::size_t tile = candidates_[k];
        if (chosen_[tile] || tile == barred || gain[k] < kLeastGain || !fits(tile)) continue;
        const double rate = gain[k] / bytes_of(tile);
        if (rate > best_rate) {
          best_rate = rate;
          best = k;
        }
      }
      if (best == candidates_.size()) return;
      add(candidates_[best]);
    }
  }

  // The chosen candidates, least worth per byte first.
  std::vector<std::size_t> least_worth() const {
    const std::vector<double> gain = gains();
    std::vector<std::pair<double, std::size_t>> rated;
    StorageCount without = count_;
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
      if (!chosen_[candidates_[k]]) continue;
      const GroundTile& tile = mission_->ground.tiles[candidates_[k]];
      without.remove(tile);
      rated.emplace_back(gain[k] / without.bytes_of(tile), candidates_[k]);
      without.add(tile);
    }
    std::sort(rated.begin(), rated.end());
    std::vector<std::size_t> tiles;
    for (const auto& [rate, tile] : rated) tiles.push_back(tile);
    return tiles;
  }

 private:
  // P of the chosen tiles at the chain's nodes.
  std::vector<double> node_probabilities(const TileChances::AtLevel& level) const {
    std::vector<double> p(attempts_->size() + 2, 0.0);
    std::vector<double> stored(chosen_.size(), 0.0);
    for (std::size_t i = 0; i < stored.size(); ++i) stored[i] = chosen_[i] ? level.p[i] : 0;
    for (const std::size_t k : counted_attempts(*attempts_, stored)) p[k + 1] = stored[(*attempts_)[k].tile];
    return p;
  }

  const Mission* mission_;
  const std::vector<FixAttempt>* attempts_;
  const TileChances* chances_;
  const FixChain* chain_;
  double budget_;
  StorageCount count_;
  std::vector<bool> chosen_;
  std::vector<std::size_t> candidates_;
};

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

// Takes each chosen tile out, and forces each other one in, and fills again: keeps what has the larger worth.
template <class Worth>
void exchange(TileSet& set, const StoredSize& size, int most_trials, Worth worth) {
  int trials = 0;
  bool better = true;
  double best = worth(set);
  const auto keep_if_better = [&](TileSet& trial) {
    ++trials;
    const double value = worth(trial);
    if (value <= best + kLeastGain) return;
    set = trial;
    best = value;
    better = true;
  };
  while (better) {
    better = false;
    for (const std::size_t out : set.least_worth()) {
      if (trials >= most_trials) return;
      if (!set.chosen()[out]) continue;
      TileSet trial = set;
      trial.remove(out);
      trial.fill(out);
      keep_if_better(trial);
    }
    for (const std::size_t in : set.candidates()) {
      if (trials >= most_trials) return;
      if (set.chosen()[in] || !set.can_ever_fit(in, size)) continue;
      TileSet trial = set;
      for (const std::size_t out : set.least_worth()) {
        if (trial.fits(in)) break;
        trial.remove(out);
      }
      trial.add(in);
      trial.fill(kNone);
      keep_if_better(trial);
    }
  }
}

}  // namespace

double flight_worth(const std::vector<double>& p_within_limit) {
  const double sum = std::accumulate(p_within_limit.begin(), p_within_limit.end(), 0.0);
  return p_within_limit.back() + 1e-3 * sum / static_cast<double>(p_within_limit.size());
}

std::vector<bool> tiles_in_order(const Mission& mission, const std::vector<TileScores>& scores,
                                 const std::vector<bool>& wanted, const std::vector<bool>& sparse,
                                 const std::vector<bool>& first, const StoredSize& size, std::int64_t budget) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (wanted[i]) order.push_back(i);
  }
  const auto rank = [&](std::size_t i) {
    const double stride_m = mission.ground.level_of(mission.ground.tiles[i]).matrix.stride_px *
                            mission.ground.level_of(mission.ground.tiles[i]).gsd_m;
    const double offset_m = mission.flight.places[i].offset_m;
    const double ring = sparse[i] ? offset_m : std::floor(offset_m / (stride_m / 2));
    return std::tuple(!first[i], !sparse[i], ring, -judged_margin(scores[i]), i);
  };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
  StorageCount count(mission, size);
  if (count.bytes() > static_cast<double>(budget)) {
    throw UsageError("budget = " + std::to_string(budget) + " bytes cannot hold even an empty map, which has " +
                     format_fixed(count.bytes(), 0));
  }
  std::vector<bool> kept(wanted.size(), false);
  for (const std::size_t i : order) {
    if (count.bytes() + count.bytes_of(mission.ground.tiles[i]) > static_cast<double>(budget)) continue;
    count.add(mission.ground.tiles[i]);
    kept[i] = true;
  }
  return kept;
}

std::vector<bool> most_probable_tiles(const FlightPath& path, const std::vector<FixAttempt>& attempts,
                                      const TileChances& tile_chances, const std::vector<bool>& start,
                                      const std::vector<bool>& history, const StoredSize& size, std::int64_t budget,
                                      const FixTries& tries, bool flown, int threads) {
  const FixChain chain = make_fix_chain(path, attempts, of_chosen(tile_chances, history).p);
  TileSet set(path, attempts, tile_chances, chain, size, static_cast<double>(budget));
  for (const std::size_t tile : set.candidates()) {
    if (start[tile] && set.fits(tile)) set.add(tile);
  }
  set.fill(kNone);
  exchange(set, size, kMostTrials, [](const TileSet& trial) { return trial.value(); });
  if (!flown) return set.chosen();
  const std::size_t sample_count = path.mission->flight.samples.size();
  const std::size_t flown_samples = sample_count * path.cases.size();
  const int flown_trials = std::min(kMostFlownTrials, kSamplesFlown / static_cast<int>(flown_samples));
  exchange(set, size, flown_trials, [&](const TileSet& trial) {
    const auto levels = level_chances(*path.mission, path.mission->flight.samples, attempts, trial.stored(), tries);
    return flight_worth(predict_survival(path, levels, threads).p_within_limit);
  });
  return set.chosen();
}

}  // namespace pilotage
