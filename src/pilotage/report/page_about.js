// An answer at once, from few flights, and what it leaves out: learnt from an answer in full.

// Calm, and three levels of the place in the proportion that keeps the mean and the spread of all; the ends of the 80 % interval
// are two of them. `levels`: which of all those told they are. What the flight's P is over all levels says overAllLevels().
function aboutChances(told) {
  const calm = (levels) => levels.map((_, i) => [i, 1, 0, 0]);
  const coarse = { most_branches: 3, least_share: 1e-5 };  // of flights that fixed at one place, 8 else; that are followed, 1e-9 else
  if (told.level_weights.length === 1) return { ...told, levels: [0], cases: calm([0]), ...coarse };
  const [low, high] = told.level_interval;
  const middle = (low + high) / 2;
  const spread = told.level_weights.reduce((sum, weight, level) => sum + weight * square(level - middle), 0);
  const outer = spread / (2 * square(high - middle));
  const levels = [low, middle, high];
  return { ...told, levels, level_weights: [outer, 1 - 2 * outer, outer], level_interval: [0, 2], cases: calm(levels), ...coarse };
}
// A flight of readFlight() as such an answer wants it.
function aboutFlight(flight) {
  const chances = aboutChances(flight.chances);
  const atLevels = (known) => known && [known[0], ...chances.levels.map((level) => known[1 + level])];
  return { ...flight, chances, tile_runs: flight.tile_runs.map(([count, known]) => [count, atLevels(known)]) };
}

const logitOf = (p) => Math.log(p / (1 - p));
const sigmoidOf = (logit) => 1 / (1 + Math.exp(-logit));
const notSure = (p, sure) => Math.min(1 - sure, Math.max(sure, p));
const shifted = (p, shift) => (p <= 0 || p >= 1 ? p : sigmoidOf(logitOf(p) + shift));
// An answer at three levels as one over all that are told: between the three the logit of P is a parabola, beyond them straight.
function overAllLevels(predicted, told) {
  const route = predicted.probability;
  if (route.at_level.length !== 3) return predicted;
  const [low, middle, high] = route.at_level.map((p) => logitOf(notSure(p, 1e-6)));
  const slope = (high - low) / 2, bend = (high + low) / 2 - middle;
  const [first, last] = told.level_interval;
  const atLevel = (level) => {
    const from = (2 * level - first - last) / (last - first), inside = Math.min(1, Math.max(-1, from));
    const there = middle + slope * inside + bend * square(inside);
    return sigmoidOf(there + Math.max(0, slope + 2 * bend * inside) * (from - inside));
  };
  const p = told.level_weights.reduce((sum, weight, level) => sum + weight * atLevel(level), 0);
  return shiftShares(predicted, { ...noShift, middle: logitOf(notSure(p, 1e-6)) - logitOf(notSure(route.p_within_limit, 1e-6)) });
}

// What wind, and whatever else an answer at once leaves out, does: a shift of the logit of each share, by what both answers say of
// one flight. Where that is nearly sure its logits say nothing of other flights'.
const noShift = { middle: 0, low: 0, high: 0 };
const shiftBetween = (about, full) => logitOf(notSure(full, 0.01)) - logitOf(notSure(about, 0.01));
// `about`, `full`: p_within_limit, and the interval if there is one.
function learnShift(about, full) {
  const ends = (name) => (about.interval && full.interval ? shiftBetween(about.interval[name], full.interval[name]) : 0);
  return { middle: shiftBetween(about.p_within_limit, full.p_within_limit), low: ends('low'), high: ends('high') };
}
function shiftShares(predicted, { middle, low, high }) {
  const route = predicted.probability;
  const p = shifted(route.p_within_limit, middle);
  const interval = route.interval && { low: Math.min(p, shifted(route.interval.low, low)), high: Math.max(p, shifted(route.interval.high, high)) };
  // Legs multiply to the route; where flights are lost, all that is lost is in proportion.
  const power = p > 0 && p < 1 && route.p_within_limit > 0 && route.p_within_limit < 1 ? Math.log(p) / Math.log(route.p_within_limit) : 1;
  const lost = (share) => (share === null || route.p_within_limit === 1 ? share : Math.min(1, share * (1 - p) / (1 - route.p_within_limit)));
  const losing = (stretch) => stretch && { ...stretch, p_first_excess: lost(stretch.p_first_excess) };
  return { ...predicted, probability: { ...route, p_within_limit: p, interval, worst: losing(route.worst) }, gaps: predicted.gaps.map(losing),
    legs: predicted.legs.map((leg) => ({ ...leg, p_within_limit: leg.p_within_limit && leg.p_within_limit ** power })),
    profile: predicted.profile.map((sample) => ({ ...sample, p_within_limit: shifted(sample.p_within_limit, middle) })) };
}
// Judged, but its interval is good to judge by, not to be read.
function judgeAbout(predicted, settings, told) {
  const judged = judgeFlight(predicted, settings, told);
  judged.probability.interval = null;
  judged.about = true;
  sayVerdict(judged);
  return judged;
}
