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
const surelyBetween = (p) => Math.min(1 - 1e-6, Math.max(1e-6, p));
const shifted = (p, shift) => (p <= 0 || p >= 1 ? p : sigmoidOf(logitOf(p) + shift));
function shiftBetween(about, full) {
  const shift = logitOf(surelyBetween(full)) - logitOf(surelyBetween(about));
  return Number.isFinite(shift) ? shift : 0;
}
// An answer at three levels as one over all that are told: between the three the logit of P is a parabola, beyond them straight.
function overAllLevels(predicted, told) {
  const route = predicted.probability;
  if (route.at_level.length !== 3) return predicted;
  const [low, middle, high] = route.at_level.map((p) => logitOf(surelyBetween(p)));
  const slope = (high - low) / 2, bend = (high + low) / 2 - middle;
  const [first, last] = told.level_interval;
  const atLevel = (level) => {
    const from = (2 * level - first - last) / (last - first), inside = Math.min(1, Math.max(-1, from));
    const there = middle + slope * inside + bend * square(inside);
    return sigmoidOf(there + Math.max(0, slope + 2 * bend * inside) * (from - inside));
  };
  const p = told.level_weights.reduce((sum, weight, level) => sum + weight * atLevel(level), 0);
  const shift = shiftBetween(route.p_within_limit, p);
  return shiftShares(predicted, { middle: shift, low: 0, high: 0 });
}

// What wind, and whatever else an answer at once leaves out, does: a shift of the logit of each share, by what both answers say of
// one flight.
const noShift = { middle: 0, low: 0, high: 0 };
// `about`, `full`: p_within_limit, and the interval if there is one.
function learnShift(about, full) {
  const ends = (name) => (about.interval && full.interval ? shiftBetween(about.interval[name], full.interval[name]) : 0);
  return { middle: shiftBetween(about.p_within_limit, full.p_within_limit), low: ends('low'), high: ends('high') };
}
function shiftShares(predicted, { middle, low, high }) {
  const route = predicted.probability;
  const p = shifted(route.p_within_limit, middle);
  const interval = route.interval && { low: Math.min(p, shifted(route.interval.low, low)), high: Math.max(p, shifted(route.interval.high, high)) };
  return { ...predicted, probability: { ...route, p_within_limit: p, interval },
    profile: predicted.profile.map((sample) => ({ ...sample, p_within_limit: shifted(sample.p_within_limit, middle) })) };
}
// Judged, but its interval is good to judge by, not to be read.
function judgeAbout(predicted, settings, told) {
  const judged = judgeFlight(predicted, settings, told);
  judged.probability.interval = null;
  judged.headline = headlineWords(judged);
  judged.about = true;
  return judged;
}
