// A flight predicted in the page: that of the report with other settings (page_what_if.js), or along a line that is drawn
// (page_sketch.js). The formulas of src/pilotage/select (route_error.cc, fix_attempts.cc, route_probability.cc, worst_loss.cc).
// Long work is done by generators, which yield so that the page stays alive.

function numbersOf(base64) {
  const text = atob(base64);
  const bytes = Uint8Array.from(text, (letter) => letter.charCodeAt(0));
  return new Float64Array(bytes.buffer);
}
function alongSamples(runs) {
  const values = [];
  for (const [count, value] of runs) for (let i = 0; i < count; ++i) values.push(value);
  return values;
}
// The flight of the report, of what what_if.cc says of it. Of each sample: distance, azimuth, leg, speed, way over which tries
// fare alike, P of the tile below (null: none is stored); `beside_line`: the step, then three shares. `chances`: what the P of a
// route is the mean over; null where the P of tiles are not known.
function readFlight(told) {
  const numbers = numbersOf(told.samples);
  const count = numbers.length / 2;
  return { count, distance_m: numbers.subarray(0, count), azimuth_deg: numbers.subarray(count), leg: alongSamples(told.leg_runs),
    speed_mps: alongSamples(told.speed_runs), apart_m: alongSamples(told.apart_runs), tile_runs: told.tile_runs,
    beside_line: numbersOf(told.beside_line), leg_lengths_m: told.leg_lengths_m, denied: told.denied, anywhere: told.anywhere,
    chances: told.min_route_probability === null ? null : told };
}
const pOnLine = (flight) => alongSamples(flight.tile_runs.map(([count, known]) => [count, known === null ? null : known[0]]));
// The first index from `first` up to `end` at which `values` reach `value`.
function lowerBound(values, value, first = 0, end = values.length) {
  let low = first, high = end;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (values[middle] < value) low = middle + 1; else high = middle;
  }
  return low;
}

// ---- GNSS (mission/gnss_availability.cc) ----
const gnssEverywhere = (count, had) => ({ at: Array(count).fill(had), over: Array(Math.max(0, count - 1)).fill(had) });
function gnssDenied(flight, stretches) {
  const gnss = gnssEverywhere(flight.count, true);
  for (const [from_m, to_m] of stretches) {
    for (let i = Math.max(0, lowerBound(flight.distance_m, from_m) - 1); i < flight.count && flight.distance_m[i] <= to_m; ++i) {
      const at_m = flight.distance_m[i];
      const last = i + 1 === flight.count;
      if (!last && at_m < to_m && flight.distance_m[i + 1] > from_m) gnss.over[i] = false;
      if (at_m >= from_m && (last || !gnss.over[i]) && (at_m < to_m || last)) gnss.at[i] = false;
    }
  }
  return gnss;
}
const plannedGnss = (flight) => (flight.denied.length ? gnssDenied(flight, flight.denied) : gnssEverywhere(flight.count, false));

// ---- What tries may give (select/fix_attempts.cc, ground/tile_chances.cc) ----
// Of a sample: what P is off the line by sigma_m, as a share of P on it.
function shareBesideLine(beside_line, sample, sigma_m) {
  const at = 4 * sample;
  const step_m = beside_line[at];
  if (step_m === 0) return 1;
  const [one, two, four] = [beside_line[at + 1], beside_line[at + 2], beside_line[at + 3]];
  const quarters = 4 * sigma_m / step_m;
  if (quarters <= 1) return 1 + quarters * (one - 1);
  if (quarters <= 2) return one + (quarters - 1) * (two - one);
  return two + Math.min(1, (quarters - 2) / 2) * (four - two);
}
// Those at each level of the place, which all tries share, with how much it counts.
const levelChances = (flight, interval_s) => flight.chances.level_weights.map((weight, level) =>
  ({ weight, chances: routeChances(flight, interval_s, level) }));
function routeChances(flight, interval_s, level) {
  const flown = [0];
  for (let i = 1; i < flight.count; ++i) {
    const window_m = Math.max(flight.apart_m[i - 1], interval_s * flight.speed_mps[i - 1], 1);
    flown.push(flown[i - 1] + (flight.distance_m[i] - flight.distance_m[i - 1]) / window_m);
  }
  const chances = { p: Array(flight.count).fill(0), window: Array(flight.count).fill(0), interval_s };
  let first = 0;
  for (const [count, known] of flight.tile_runs) {
    const end = first + count;
    if (known !== null) {
      const p = known[1 + level];
      const from = first === 0 ? flown[0] : (flown[first - 1] + flown[first]) / 2;
      const to = end === flight.count ? flown[end - 1] : (flown[end - 1] + flown[end]) / 2;
      const parts = Math.max(1, Math.round(to - from));
      for (let part = 0; part < parts; ++part) {
        const middle = from + (to - from) * (part + 0.5) / parts;
        let nearest = lowerBound(flown, middle, first, end);
        if (nearest === end || (nearest !== first && middle - flown[nearest - 1] <= flown[nearest] - middle)) --nearest;
        chances.p[nearest] = p;
        chances.window[nearest] = Math.floor(middle);
      }
    }
    first = end;
  }
  return chances;
}

// ---- The flight whose every try comes (select/route_error.cc) ----
const step_s = (flight, i) => (flight.distance_m[i + 1] - flight.distance_m[i]) / flight.speed_mps[i];
const knownReaches = new Map();  // asked again for every line that is drawn
function reachOf_s(model, speed_mps, limit_m) {
  const key = model.text + ' ' + speed_mps + ' ' + limit_m;
  if (!knownReaches.has(key)) knownReaches.set(key, longestBridgeableGap_s(model, speed_mps, limit_m));
  return knownReaches.get(key);
}
function makePath(flight, model, limit_m, gnss) {
  const reach_s = reachOf_s(model, flight.speed_mps[0], limit_m);
  // Neighbours on a leg are flown alike but for the last digits.
  let last = null;
  const step = (i) => {
    const time_s = step_s(flight, i), azimuth_deg = flight.azimuth_deg[i], speed_mps = flight.speed_mps[i];
    if (!last || Math.abs(last.time_s - time_s) > 1e-7 || last.speed_mps !== speed_mps || Math.abs(turnBetween_deg(last.azimuth_deg, azimuth_deg)) > 1e-3) {
      last = { time_s, azimuth_deg, speed_mps, step: makeInsStep(time_s, azimuth_deg, speed_mps, model) };
    }
    return last.step;
  };
  return { flight, model, limit_m, gnss, horizon_s: Math.min(600, Math.max(1, reach_s)), step };
}
// ---- The route in a wind (select/flown_steps.cc) ----
function groundSpeed_mps(air_mps, azimuth_deg, [east_mps, north_mps]) {
  const s = Math.sin(azimuth_deg * insRadPerDeg), c = Math.cos(azimuth_deg * insRadPerDeg);
  const cross = east_mps * c - north_mps * s;
  const ahead = Math.sqrt(Math.max(0, air_mps * air_mps - cross * cross));
  return Math.max(0.3 * air_mps, ahead + east_mps * s + north_mps * c);
}
function flownSteps(path, wind_mps) {
  const { flight, model } = path;
  const way_m = (i) => flight.distance_m[i + 1] - flight.distance_m[i];
  const made = [];  // steps, each with its horizon
  const index = [];
  let first = 0;
  for (let i = 0; i + 1 < flight.count; ++i) {
    const alike = i > 0 && flight.leg[i] === flight.leg[first] && flight.speed_mps[i] === flight.speed_mps[first] &&
      Math.abs(way_m(i) - way_m(first)) < 1e-4 && Math.abs(turnBetween_deg(flight.azimuth_deg[first], flight.azimuth_deg[i])) < 0.1;
    if (!alike) {
      first = i;
      const speed_mps = groundSpeed_mps(flight.speed_mps[i], flight.azimuth_deg[i], wind_mps);
      const horizon = makeInsStep(path.horizon_s, flight.azimuth_deg[i], speed_mps, model);
      made.push({ step: makeInsStep(way_m(i) / speed_mps, flight.azimuth_deg[i], speed_mps, model), horizon, ahead: positionAhead(horizon) });
    }
    index.push(made.length - 1);
  }
  // The error of a covariance at sample i a horizon later, for those of `flights`.
  const errorAhead_m = (i, { span, instant }) => {
    const { horizon, ahead } = made[index.length ? index[i > 0 ? i - 1 : 0] : 0];
    if (!ahead) return (covariance) => positionError_m(insPropagate({ ...instant, covariance }, horizon), model);
    const form = spanForm(span, ahead.rows, ahead.added);
    return (covariance) => errorOf_m(formVariances(form, covariance), model);
  };
  return { count: index.length, step: (i) => made[index[i]].step, index: (i) => index[i], errorAhead_m };
}
function* flightCases(path) {
  const inWind = new Map();  // levels share what is flown in one wind
  const cases = [];
  for (const [level, weight, east_mps, north_mps] of path.flight.chances.cases) {
    const wind = east_mps + ' ' + north_mps;
    if (!inWind.has(wind)) inWind.set(wind, flownSteps(path, [east_mps, north_mps]));
    cases.push({ level, weight, steps: inWind.get(wind) });
    yield;
  }
  return cases;
}

const heldAt = (path, i, state) => holdWithGnss(state, path.flight.azimuth_deg[i], path.flight.speed_mps[i], path.model);
const insAtStart = (path) => initialInsState(path.model, path.flight.azimuth_deg[0], path.flight.speed_mps[0]);

function flyOneSample(path, gnss, aircraft) {
  aircraft.state = insPropagate(aircraft.state, path.step(aircraft.sample));
  ++aircraft.sample;
  if (gnss.over[aircraft.sample - 1]) aircraft.state = heldAt(path, aircraft.sample, aircraft.state);
}
function takePosition(path, gnss, interval_s, aircraft) {
  if (gnss.at[aircraft.sample]) aircraft.state = heldAt(path, aircraft.sample, aircraft.state);
  if (!path.flight.stored[aircraft.sample] || !(aircraft.state.time_s - aircraft.lastFix_s >= interval_s)) return;
  aircraft.state = updateWithFix(aircraft.state, path.model);
  aircraft.lastFix_s = aircraft.state.time_s;
}
function* errorsAlong(path, interval_s) {
  const aircraft = { sample: 0, state: insAtStart(path), lastFix_s: -Infinity };
  const errors_m = [];
  for (;;) {
    errors_m.push(positionError_m(aircraft.state, path.model));
    takePosition(path, path.gnss, interval_s, aircraft);
    if (aircraft.sample + 1 === path.flight.count) return errors_m;
    flyOneSample(path, path.gnss, aircraft);
    yield;
  }
}
function gapsBetweenFixes(path, errors_m) {
  const { flight, gnss } = path;
  const known = (i) => flight.stored[i] || gnss.at[i];
  const gaps = [];
  for (let i = 0; i < flight.count;) {
    if (known(i)) { ++i; continue; }
    const first = i === 0 || gnss.over[i - 1] ? i : i - 1;
    while (i < flight.count && !known(i)) ++i;
    const last = Math.min(i, flight.count - 1);
    const gap = { leg: flight.leg[first], from_distance_m: flight.distance_m[first], to_distance_m: flight.distance_m[last],
      duration_s: 0, error_m: 0, p_first_excess: null };
    for (let k = first; k < last; ++k) gap.duration_s += step_s(flight, k);
    for (let k = first; k <= last; ++k) gap.error_m = Math.max(gap.error_m, errors_m[k]);
    gap.within_limit = gap.error_m <= path.limit_m;
    if (gap.to_distance_m > gap.from_distance_m) gaps.push(gap);
  }
  return gaps;
}
function legsOf(path, errors_m) {
  const legs = path.flight.leg_lengths_m.map((length_m, leg) => ({ leg, length_m, max_error_m: 0, p_within_limit: null }));
  errors_m.forEach((error_m, i) => {
    const leg = legs[path.flight.leg[i]];
    leg.max_error_m = Math.max(leg.max_error_m, error_m);
  });
  legs.forEach((leg) => { leg.within_limit = leg.max_error_m <= path.limit_m; });
  return legs;
}

// ---- Flights whose tries come or do not (select/route_probability.cc) ----
const totalProbability = (branches) => branches.reduce((sum, branch) => sum + branch.probability, 0);
// Flights of one wind and level: their branches (covariances of the span's first sample), and what all of them share at a sample.
function firstFlights(path) {
  const { covariance, ...instant } = insAtStart(path);
  return { instant, branches: [{ fixSample: 0, probability: 1, covariance, fixTime_s: -Infinity, window: -1, low: 0, high: 1 }] };
}
const longestLeap_s = 10, rareShare = 0.001;
// At which of the samples behind the last one judged an error is first beyond the limit, as it is at the last of them.
function firstBeyond(path, covariance, { judged: { span, instant, leap }, count }) {
  let within = 0, beyond = count;
  while (beyond - within > 1) {
    const middle = (within + beyond) >> 1;
    const position = spanForm(flySpan(span, instant, leap(middle)), insPositionRows);  // with the manoeuvre there, if there is one
    if (errorOf_m(formVariances(position, covariance), path.model) <= path.limit_m) within = middle; else beyond = middle;
  }
  return beyond;
}
// Takes out the branches beyond the limit, and those that hold next to nothing; what is left at each sample behind the last judged.
function loseFlights(path, sample, stretch) {
  const { least_share = 1e-9 } = path.flight.chances;
  const least = least_share * totalProbability(stretch.branches);
  const position = spanForm(stretch.span, insPositionRows);
  const lost = [];
  stretch.branches = stretch.branches.filter((branch) => {
    branch.variances_m2 = formVariances(position, branch.covariance);
    const beyond = !(errorOf_m(branch.variances_m2, path.model) <= path.limit_m);
    if (beyond) {
      const lostAt = sample - stretch.count + (stretch.count && firstBeyond(path, branch.covariance, stretch));
      lost.push({ fixSample: branch.fixSample, lostAt, probability: branch.probability });
    }
    return !(beyond || branch.probability <= least);
  });
  const left = totalProbability(stretch.branches);
  for (let i = sample - Math.max(0, stretch.count - 1); i <= sample; ++i) {
    const within = lost.reduce((sum, loss) => sum + (loss.lostAt > i ? loss.probability : 0), left);
    const before = stretch.p_within_limit.length ? stretch.p_within_limit[stretch.p_within_limit.length - 1] : 1;
    stretch.p_within_limit.push(Math.min(before, within));
  }
  stretch.losses.push(...lost.sort((a, b) => a.lostAt - b.lostAt));
}
const sameDraw = (a, b) => a.low === b.low && a.high === b.high;
// Branches that had their last fix together and of which each holds next to none of the flights become one.
function joinRare(branches) {
  const rare = rareShare * totalProbability(branches);
  const joined = branches.slice(0, 1);
  for (const next of branches.slice(1)) {
    const last = joined[joined.length - 1];
    const together = last.fixSample === next.fixSample && last.fixTime_s === next.fixTime_s && last.window === next.window && sameDraw(last, next);
    if (!together || !(last.probability < rare && next.probability < rare)) {
      joined.push(next);
      continue;
    }
    last.probability += next.probability;
    const share = next.probability / last.probability;
    last.variances_m2 = last.variances_m2.map((value, n) => value + share * (next.variances_m2[n] - value));
    last.covariance = new Float64Array(last.covariance);  // other flights may have it, too
    for (let n = 0; n < last.covariance.length; ++n) last.covariance[n] += share * (next.covariance[n] - last.covariance[n]);
  }
  return joined;
}
function groupEnds(fixed, share) {
  const ends = [];
  for (let i = 0; i < fixed.length;) {
    const first = fixed[i];
    const most_m = first.error_m * (1 + share);
    for (++i; i < fixed.length && fixed[i].error_m <= most_m && sameDraw(fixed[i].branch, first.branch);) ++i;
    ends.push(i);
  }
  return ends;
}
function mergeAlike(errorAhead_m, branches, most = 8) {
  const fixed = branches.map((branch) => ({ branch, error_m: errorAhead_m(branch.covariance) }));
  fixed.sort((a, b) => a.branch.low - b.branch.low || a.branch.high - b.branch.high || a.error_m - b.error_m);
  let share = 0.02;
  let ends = groupEnds(fixed, share);
  while (ends.length > most && share < 1) ends = groupEnds(fixed, share *= 2);
  let first = 0;
  return ends.map((end) => {
    const members = fixed.slice(first, end).map((after) => after.branch);
    first = end;
    const probability = totalProbability(members);
    const covariance = new Float64Array(insSize * insSize);
    for (const member of members) {
      const weight = member.probability / probability;
      for (let n = 0; n < covariance.length; ++n) covariance[n] += weight * member.covariance[n];
    }
    return { ...members[0], probability, covariance };
  });
}
// How far flights are off the line: rms of an axis.
const offLine_m = ([a, , d]) => Math.sqrt((a + d) / 2);
// Share of the square of half side 1 that lies beyond a circle around its middle.
function shareBeyond(radius) {
  if (radius >= Math.SQRT2) return 0;
  if (radius <= 1) return 1 - Math.PI / 4 * radius * radius;
  return 1 - Math.sqrt(radius * radius - 1) - radius * radius * (Math.PI / 4 - Math.acos(1 / radius));
}
function takeFix(path, steps, chances, sample, stretch) {
  const { frames_that_come, false_fix_rate } = path.flight.chances;
  const p = frames_that_come * chances.p[sample];
  if (!(p > 0)) return;
  stretch.branches = joinRare(stretch.branches);
  const { time_s } = stretch.instant;
  const fixed = [];
  let form = null;
  for (const branch of stretch.branches) {
    if (time_s - branch.fixTime_s < chances.interval_s - 1e-9) continue;
    if (branch.window !== chances.window[sample]) Object.assign(branch, { window: chances.window[sample], low: 0, high: 1 });
    const drawn = Math.min(1, Math.max(0, (p - branch.low) / (branch.high - branch.low)));
    const share = Math.min(1, shareBesideLine(path.flight.beside_line, sample, offLine_m(branch.variances_m2)) * drawn);
    if (share > 0) {
      form = form || fixForm(stretch.span);
      fixed.push({ ...branch, fixSample: sample, fixTime_s: time_s, probability: branch.probability * share,
        high: Math.min(branch.high, p), covariance: fixedCovariance(form, branch.covariance, square(path.model.fix_sigma_m)) });
    }
    const searched_m = 3 / path.model.sigma_multiple *
      Math.hypot(errorOf_m(branch.variances_m2, path.model), path.model.sigma_multiple * path.model.map_sigma_m);
    branch.probability *= (1 - share) *
      (1 - frames_that_come * false_fix_rate * shareBeyond(path.limit_m / searched_m));
    if (1 - drawn >= drawn - share) branch.low = Math.max(branch.low, p);
  }
  stretch.branches = stretch.branches.filter((branch) => !(branch.probability <= 0));
  if (fixed.length) stretch.branches.push(...mergeAlike(steps.errorAhead_m(sample, stretch), fixed, path.flight.chances.most_branches));
}
// `stretch` is at a span's first sample.
function takeGnss(path, sample, stretch) {
  const position = spanForm(stretch.span, insPositionRows);
  for (const branch of stretch.branches) {
    const { covariance } = heldAt(path, sample, { ...stretch.instant, covariance: branch.covariance });
    Object.assign(branch, { fixSample: sample, covariance, variances_m2: formVariances(position, covariance) });
  }
  stretch.instant = { ...stretch.instant, heading_deg: path.flight.azimuth_deg[sample], speed_mps: path.flight.speed_mps[sample] };
}
// All flights `count` alike steps on, as one: the span grows, or ends there and another begins.
function flyOn(steps, i, count, lastOfSpan, stretch) {
  const { instant, span } = stretch;
  let step = steps.step(i);
  stretch.count = count;
  if (stretch.branches.length === 0) {
    step = { ...step, time_s: count * step.time_s };
  } else if ((span.atFirst && lastOfSpan) || step.aided) {
    for (const branch of stretch.branches) branch.covariance = insPropagate({ ...instant, covariance: branch.covariance }, step).covariance;
  } else {
    if (stretch.index !== steps.index(i)) Object.assign(stretch, { index: steps.index(i), leap: leapsOf(step) });
    step = stretch.leap(count);
    stretch.judged = { span, instant, leap: stretch.leap };
    stretch.span = flySpan(span, instant, step);
    if (lastOfSpan) endSpan(stretch);
  }
  stretch.instant = { heading_deg: step.heading_deg, speed_mps: step.speed_mps, time_s: instant.time_s + step.time_s };
}
function endSpan(stretch) {
  for (const branch of stretch.branches) branch.covariance = insAtSample(stretch.span, branch.covariance);
  stretch.span = newSpan();
}
// How many steps on from sample i the next thing happens: a try, a change of GNSS, another kind of step, the stretch's last sample.
function stepsToNext({ gnss }, steps, chances, i, end) {
  const had = (k) => gnss.over[k] || gnss.at[k + 1];
  const { aided, time_s } = steps.step(i);
  if (aided || had(i)) return 1;
  let count = 1;
  while (i + count + 1 < end && !(chances.p[i + count] > 0) && steps.index(i + count) === steps.index(i) && !had(i + count) &&
    (count + 1) * time_s <= longestLeap_s) ++count;
  return count;
}
// `count`: of samples behind the last one at which errors were held against the limit, where `judged` is.
function* flyStretch(path, steps, chances, begin, end, flights) {
  const { gnss } = path;
  const stretch = { p_within_limit: [], losses: [], branches: flights.branches.map((branch) => ({ ...branch })), instant: flights.instant,
    span: newSpan(), judged: null, count: 0, index: null, leap: null };
  for (let i = begin; i < end; i += stretch.count) {
    loseFlights(path, i, stretch);
    if (isLongSpan(stretch.span)) endSpan(stretch);
    if (gnss.at[i]) takeGnss(path, i, stretch);
    takeFix(path, steps, chances, i, stretch);
    if (i >= steps.count) break;
    const count = stepsToNext(path, steps, chances, i, end);
    flyOn(steps, i, count, i + 1 === end || gnss.over[i] || gnss.at[i + 1], stretch);
    yield i / path.flight.count;
    if (gnss.over[i]) takeGnss(path, i + 1, stretch);
  }
  return stretch;
}
function weightedQuantile(weighted, share) {
  weighted.sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  let rest = weighted.reduce((sum, [, weight]) => sum + share * weight, 0);
  for (const [value, weight] of weighted) {
    rest -= weight;
    if (rest <= 0) return value;
  }
  return weighted[weighted.length - 1][0];
}
// Where most flights are lost: on the leg with most, those whose ways since the last fix overlap.
function worstStretch(flight, losses) {
  if (!losses.length) return null;
  const onLeg = new Map();
  for (const loss of losses) onLeg.set(flight.leg[loss.lostAt], (onLeg.get(flight.leg[loss.lostAt]) || 0) + loss.probability);
  let worst = null;
  for (const [leg, p] of [...onLeg].sort((a, b) => a[0] - b[0])) if (worst === null || p > worst[1]) worst = [leg, p];
  const there = losses.filter((loss) => flight.leg[loss.lostAt] === worst[0]).sort((a, b) => a.fixSample - b.fixSample || a.lostAt - b.lostAt);
  let most = [], most_p = 0;
  for (let begin = 0; begin < there.length;) {
    let end = begin, reach = there[begin].lostAt, p = 0;
    for (; end < there.length && there[end].fixSample <= reach; ++end) {
      reach = Math.max(reach, there[end].lostAt);
      p += there[end].probability;
    }
    if (p > most_p) [most, most_p] = [there.slice(begin, end), p];
    begin = end;
  }
  return { leg: worst[0], p_first_excess: most_p,
    from_distance_m: flight.distance_m[weightedQuantile(most.map((loss) => [loss.fixSample, loss.probability]), 0.05)],
    to_distance_m: flight.distance_m[weightedQuantile(most.map((loss) => [loss.lostAt, loss.probability]), 0.95)] };
}
function* survivalAlong(path, cases, levels) {
  const { flight } = path;
  const survival = { p_within_limit: [], legs_p: Array(flight.leg_lengths_m.length).fill(null), at_level: [], worst: null };
  const losses = [];
  const flights = cases.map(() => firstFlights(path));
  let before = 1;
  for (let begin = 0; begin < flight.count;) {
    let end = begin;
    while (end < flight.count && flight.leg[end] === flight.leg[begin]) ++end;
    for (let i = begin; i < end; ++i) survival.p_within_limit.push(0);
    survival.at_level = levels.map(() => 0);
    for (let k = 0; k < cases.length; ++k) {
      const { level, steps } = cases[k];
      const stretch = yield* flyStretch(path, steps, levels[level].chances, begin, end, flights[k]);
      const weight = levels[level].weight * cases[k].weight;
      stretch.p_within_limit.forEach((p, i) => { survival.p_within_limit[begin + i] += weight * p; });
      survival.at_level[level] += cases[k].weight * Math.min(1, stretch.p_within_limit[stretch.p_within_limit.length - 1]);
      for (const loss of stretch.losses) losses.push({ ...loss, probability: weight * loss.probability });
      flights[k] = stretch;
    }
    for (let i = begin; i < end; ++i) survival.p_within_limit[i] = Math.min(1, survival.p_within_limit[i]);
    const after = survival.p_within_limit[survival.p_within_limit.length - 1];
    if (before > 0) survival.legs_p[flight.leg[begin]] = Math.min(1, after / before);
    before = after;
    begin = end;
  }
  survival.worst = worstStretch(flight, losses);
  return survival;
}

// ---- GNSS lost anywhere (select/worst_loss.cc) ----
function lossSamples(flight, cases) {
  const flown = (starts) => starts.reduce((sum, start) => sum + flight.count - start, 0);
  const within = (starts) => {
    const every = (step) => starts.filter((_, i) => i % step === 0);
    let step = 1;
    while (step < starts.length && cases * flown(every(step)) > 60000) ++step;
    return every(step);
  };
  const all = [...Array(flight.count).keys()];
  const at = new Map();
  for (const start of [...within(all), ...within(all.filter((i) => i === 0 || flight.leg[i] !== flight.leg[i - 1]))]) {
    let i = start;
    while (i + 1 < flight.count && flight.distance_m[i + 1] === flight.distance_m[i]) ++i;
    at.set(flight.distance_m[i], i);
  }
  if (at.size > 1) at.delete(flight.distance_m[flight.count - 1]);
  return [...at.values()].sort((a, b) => a - b);
}
function* loseAnywhere(path, cases, levels, interval_s) {
  const { flight } = path;
  const had = gnssEverywhere(flight.count, true), lost = gnssEverywhere(flight.count, false);
  const withGnss = { sample: 0, state: insAtStart(path), lastFix_s: -Infinity };
  let withGnss_m = positionError_m(withGnss.state, path.model);
  const paths = { had: { ...path, gnss: had }, lost: { ...path, gnss: lost } };
  const flights = levels ? cases.map(() => firstFlights(path)) : [];
  let at = 0;
  const points = [];
  for (const loss of lossSamples(flight, levels ? cases.length : 1)) {
    while (withGnss.sample < loss) {
      takePosition(path, had, interval_s, withGnss);
      flyOneSample(path, had, withGnss);
      withGnss_m = Math.max(withGnss_m, positionError_m(withGnss.state, path.model));
      yield;
    }
    const aircraft = { ...withGnss };
    let max_error_m = withGnss_m;
    while (aircraft.sample + 1 < flight.count) {
      takePosition(path, lost, interval_s, aircraft);
      flyOneSample(path, lost, aircraft);
      max_error_m = Math.max(max_error_m, positionError_m(aircraft.state, path.model));
      yield;
    }
    const point = { distance_m: flight.distance_m[loss], leg: flight.leg[loss], max_error_m, p_within_limit: null };
    if (levels) {
      point.p_within_limit = 0;
      for (let k = 0; k < cases.length; ++k) {
        const { level, steps } = cases[k];
        const { weight, chances } = levels[level];
        flights[k] = yield* flyStretch(paths.had, steps, chances, at, loss, flights[k]);
        const rest = yield* flyStretch(paths.lost, steps, chances, loss, flight.count, flights[k]);
        point.p_within_limit += weight * cases[k].weight * rest.p_within_limit[rest.p_within_limit.length - 1];
      }
      at = loss;
    }
    points.push(point);
  }
  let worst = points;
  const keep = (badness, alike) => {
    const most = Math.max(...worst.map(badness));
    worst = worst.filter((point) => !(badness(point) < most - alike));
  };
  keep((point) => (point.max_error_m > path.limit_m ? 1 : 0), 0);
  keep((point) => (point.p_within_limit === null ? 0 : -point.p_within_limit), 1e-3);
  keep((point) => point.max_error_m, 0.1);
  return { points, worst: worst[0] };
}

// The flight with `settings` { limit_m, model, speed_mps (null: as planned), interval_s }, as a selection has it.
function* predictFlight(planned, settings) {
  const p_on_line = pOnLine(planned);
  const flight = { ...planned, stored: p_on_line.map((p) => p !== null) };
  if (settings.speed_mps !== null) flight.speed_mps = planned.speed_mps.map(() => settings.speed_mps);
  const path = makePath(flight, settings.model, settings.limit_m, plannedGnss(flight));
  const chances = flight.chances && levelChances(flight, settings.interval_s);
  const cases = chances && (yield* flightCases(path));
  const predicted = { max_error_m: settings.limit_m, probability: null, loss: null };
  if (flight.anywhere) {
    predicted.loss = yield* loseAnywhere(path, cases, chances, settings.interval_s);
    path.gnss = gnssDenied(flight, [[predicted.loss.worst.distance_m, Infinity]]);
  }
  const errors_m = yield* errorsAlong(path, settings.interval_s);
  predicted.gaps = gapsBetweenFixes(path, errors_m);
  predicted.legs = legsOf(path, errors_m);
  predicted.within_limit = errors_m.every((error_m) => error_m <= settings.limit_m);
  predicted.profile = errors_m.map((error_m, i) => ({ distance_m: flight.distance_m[i], error_m, p_correct_fix: chances ? p_on_line[i] || 0 : null,
    p_within_limit: null }));
  if (!chances) return predicted;
  const survival = yield* survivalAlong(path, cases, chances);
  const p = survival.p_within_limit;
  predicted.probability = { p_within_limit: p[p.length - 1], min_p_within_limit: flight.chances.min_route_probability, worst: survival.worst,
    at_level: survival.at_level, interval: null };
  if (chances.length > 1) {
    const ends = flight.chances.level_interval.map((level) => survival.at_level[level]);
    const mean = predicted.probability.p_within_limit;
    predicted.probability.interval = { low: Math.min(...ends, mean), high: Math.max(...ends, mean) };
  }
  predicted.profile.forEach((sample, i) => { sample.p_within_limit = p[i]; });
  predicted.legs.forEach((leg) => { leg.p_within_limit = survival.legs_p[leg.leg]; });
  for (const gap of predicted.gaps) {
    const before = gap.from_distance_m > 0 ? p[lowerBound(flight.distance_m, gap.from_distance_m)] : 1;
    gap.p_first_excess = before - p[lowerBound(flight.distance_m, gap.to_distance_m)];
  }
  return predicted;
}

// Runs a generator in slices of 30 ms, so that the page stays alive, and tells how far it is; null once `isStale`. The next slice
// comes by a message: browsers hold timers back.
async function inSlices(work, isStale, tell) {
  const comeBack = () => new Promise((go) => {
    const { port1, port2 } = new MessageChannel();
    port1.onmessage = () => { port1.close(); go(); };
    port2.postMessage(null);
  });
  for (;;) {
    const end = performance.now() + 30;
    let told;
    while (performance.now() < end) {
      const step = work.next();
      if (step.done) return step.value;
      if (step.value !== undefined) told = step.value;
    }
    if (told !== undefined) tell(told);
    await comeBack();
    if (isStale()) return null;
  }
}
