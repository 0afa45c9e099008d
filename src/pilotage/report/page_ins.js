// The error model of the inertial system: the formulas of src/pilotage/ins (ins_state.cc, ins_span.cc, drift.cc) on the same numbers.
// A covariance is a row after row Float64Array of 18 × 18; the order of the states is that of ins_state.h.
const insSize = 18;
const insState = { position: 0, velocity: 2, tilt: 4, heading: 6, accelBias: 7, gyroBias: 9, gyroBiasZ: 11, accelScale: 12, gyroScale: 13, aid: 14,
  map: 16 };
const insGravity_mps2 = 9.80665, insEarthRadius_m = 6371000;
const insMaxStep_s = 10, insMaxStepOfCorrelation = 0.1, insAidStep_s = 0.5, insAidNoise = 0.1;
const insRadPerDeg = Math.PI / 180;
const insIndex = (row, column) => insSize * row + column;
const square = (x) => x * x;

function insProduct(a, b) {
  const product = new Float64Array(insSize * insSize);
  for (let i = 0; i < insSize; ++i) {
    for (let k = 0; k < insSize; ++k) {
      const factor = a[insSize * i + k];
      if (factor === 0) continue;
      for (let j = 0; j < insSize; ++j) product[insSize * i + j] += factor * b[insSize * k + j];
    }
  }
  return product;
}
function insIdentity() {
  const identity = new Float64Array(insSize * insSize);
  for (let i = 0; i < insSize; ++i) identity[insIndex(i, i)] = 1;
  return identity;
}
// Columns: forward and right of a heading, in east-north.
function enuFromBody(heading_deg) {
  const s = Math.sin(heading_deg * insRadPerDeg), c = Math.cos(heading_deg * insRadPerDeg);
  return [[s, c], [c, -s]];
}
const isOdometry = (model) => model.odometry_drift > 0;
const isAided = (model) => !isOdometry(model) && model.velocity_aid_sigma_mps > 0;

// d(error)/dt = F · error for constant heading and speed.
function insSystem(model, heading_deg, speed_mps) {
  const turn = enuFromBody(heading_deg);
  const f = new Float64Array(insSize * insSize);
  const set = (row, column, value) => { f[insIndex(row, column)] = value; };
  for (const i of [0, 1]) {
    if (isOdometry(model)) {
      for (const j of [0, 1]) set(insState.position + i, insState.aid + j, speed_mps * turn[i][j]);
      set(insState.position + i, insState.heading, speed_mps * turn[i][1]);
    } else {
      set(insState.position + i, insState.velocity + i, 1);
      set(insState.velocity + i, insState.tilt + i, insGravity_mps2);
      for (const j of [0, 1]) set(insState.velocity + i, insState.accelBias + j, turn[i][j]);
      set(insState.tilt + i, insState.velocity + i, -1 / insEarthRadius_m);
      if (model.velocity_aid_sigma_mps > 0) set(insState.aid + i, insState.aid + i, -1 / model.velocity_aid_correlation_s);
    }
    for (const j of [0, 1]) set(insState.tilt + i, insState.gyroBias + j, turn[i][j]);
  }
  set(insState.heading, insState.gyroBiasZ, 1);
  const decay = model.bias_correlation_s > 0 ? -1 / model.bias_correlation_s : 0;
  for (let i = insState.accelBias; i <= insState.gyroBiasZ; ++i) set(i, i, decay);
  return f;
}
// Spectral densities of the white noise that drives each state.
function insNoiseDensity(model) {
  const q = new Float64Array(insSize);
  if (!isOdometry(model)) {
    q.fill(square(model.velocity_random_walk_mps_rt_s), insState.velocity, insState.tilt);
    q.fill(2 * square(model.velocity_aid_sigma_mps) / model.velocity_aid_correlation_s, insState.aid, insState.map);
  }
  q.fill(square(model.angle_random_walk_rad_rt_s), insState.tilt, insState.accelBias);
  if (model.bias_correlation_s > 0) {
    q.fill(2 * square(model.accel_bias_mps2) / model.bias_correlation_s, insState.accelBias, insState.gyroBias);
    q.fill(2 * square(model.gyro_bias_radps) / model.bias_correlation_s, insState.gyroBias, insState.accelScale);
  }
  return q;
}
// exp(F t) by its series; `powers` are F, F², …
function insTransition(powers, time_s) {
  const phi = insIdentity();
  let factor = 1;
  powers.forEach((power, k) => {
    factor *= time_s / (k + 1);
    for (let n = 0; n < phi.length; ++n) phi[n] += factor * power[n];
  });
  return phi;
}
const gaussNodes = [0.06943184420297371, 0.33000947820757187, 0.6699905217924281, 0.9305681557970263];
const gaussWeights = [0.17392742256872692, 0.3260725774312731, 0.3260725774312731, 0.17392742256872692];
// ∫ Φ(s) Q Φ(s)ᵀ ds from 0 to `time_s`.
function insStepNoise(powers, q, time_s) {
  const sum = new Float64Array(insSize * insSize);
  gaussNodes.forEach((node, n) => {
    const partial = insTransition(powers, node * time_s);
    const weight = gaussWeights[n] * time_s;
    for (let i = 0; i < insSize; ++i) {
      for (let k = 0; k < insSize; ++k) {
        const factor = partial[insSize * i + k] * q[k];
        if (factor === 0) continue;
        for (let j = 0; j < insSize; ++j) sum[insSize * i + j] += weight * (factor * partial[insSize * j + k]);
      }
    }
  });
  return sum;
}
// What of a step's Φ is not 0, row after row: entries first[i] … first[i + 1] − 1 are those of row i.
function listTransition(step, phi) {
  const entries = phi.reduce((count, value) => count + (value !== 0), 0);
  Object.assign(step, { first: new Int32Array(insSize + 1), columns: new Int32Array(entries), factors: new Float64Array(entries),
    decay: Float64Array.from({ length: insSize }, (_, i) => phi[insIndex(i, i)]) });
  for (let n = 0, i = 0; i < insSize; ++i) {
    for (let k = 0; k < insSize; ++k) {
      if (phi[insIndex(i, k)] === 0) continue;
      step.columns[n] = k;
      step.factors[n++] = phi[insIndex(i, k)];
    }
    step.first[i + 1] = n;
  }
}
// A step of straight flight, worked out for the many states that fly it.
function makeInsStep(time_s, heading_deg, speed_mps, model) {
  const step = { time_s, heading_deg, speed_mps, odometry: isOdometry(model), aided: isAided(model), parts: 0 };
  if (time_s === 0) return step;
  let longest_s = step.aided ? insAidStep_s : insMaxStep_s;
  if (model.bias_correlation_s > 0) longest_s = Math.min(longest_s, insMaxStepOfCorrelation * model.bias_correlation_s);
  if (step.aided) longest_s = Math.min(longest_s, insMaxStepOfCorrelation * model.velocity_aid_correlation_s);
  step.parts = Math.ceil(time_s / longest_s);
  const part_s = time_s / step.parts;
  const powers = [insSystem(model, heading_deg, speed_mps)];
  while (powers.length < 8) powers.push(insProduct(powers[powers.length - 1], powers[0]));
  const phi = insTransition(powers, part_s);
  const mapDecay = model.map_sigma_m > 0 ? Math.exp(-speed_mps * part_s / model.map_correlation_m) : 1;
  for (const i of [insState.map, insState.map + 1]) phi[insIndex(i, i)] = mapDecay;
  listTransition(step, phi);
  step.noise = insStepNoise(powers, insNoiseDensity(model), part_s);
  for (const i of [insState.map, insState.map + 1]) step.noise[insIndex(i, i)] = (1 - mapDecay * mapDecay) * square(model.map_sigma_m);
  return step;
}

// Kalman update in Joseph form with two measurements of the same variance; a measurement is [state, factor] pairs.
function insUpdate(covariance, measured, variance) {
  const ph = measured.map((combination) => {
    const column = new Float64Array(insSize);
    for (const [state, factor] of combination) for (let i = 0; i < insSize; ++i) column[i] += factor * covariance[insSize * i + state];
    return column;
  });
  const along = (combination, column) => combination.reduce((sum, [state, factor]) => sum + factor * column[state], 0);
  const a = along(measured[0], ph[0]) + variance, b = along(measured[0], ph[1]), d = along(measured[1], ph[1]) + variance;
  const determinant = a * d - b * b;
  const gain = [new Float64Array(insSize), new Float64Array(insSize)];
  for (let i = 0; i < insSize; ++i) {
    gain[0][i] = (d * ph[0][i] - b * ph[1][i]) / determinant;
    gain[1][i] = (a * ph[1][i] - b * ph[0][i]) / determinant;
  }
  const kept = new Float64Array(insSize * insSize);
  for (let i = 0; i < insSize; ++i) {
    for (let j = 0; j < insSize; ++j) kept[insSize * i + j] = covariance[insSize * i + j] - gain[0][i] * ph[0][j] - gain[1][i] * ph[1][j];
  }
  const keptH = measured.map((combination) => {
    const column = new Float64Array(insSize);
    for (const [state, factor] of combination) for (let i = 0; i < insSize; ++i) column[i] += factor * kept[insSize * i + state];
    return column;
  });
  for (let i = 0; i < insSize; ++i) {
    for (let j = 0; j < insSize; ++j) {
      kept[insSize * i + j] += -keptH[0][i] * gain[0][j] - keptH[1][i] * gain[1][j] +
        variance * (gain[0][i] * gain[0][j] + gain[1][i] * gain[1][j]);
    }
  }
  symmetric(kept);
  return kept;
}
function symmetric(covariance) {
  for (let i = 0; i < insSize; ++i) {
    for (let j = 0; j < i; ++j) {
      const mean = 0.5 * (covariance[insSize * i + j] + covariance[insSize * j + i]);
      covariance[insSize * i + j] = covariance[insSize * j + i] = mean;
    }
  }
}
const fixMeasured = [0, 1].map((i) => [[insState.position + i, 1], [insState.map + i, -1]]);
const aidMeasured = [0, 1].map((i) => [[insState.velocity + i, 1], [insState.aid + i, -1]]);

// std::remainder(x, 360)
function turnBetween_deg(from_deg, to_deg) {
  const x = to_deg - from_deg;
  let turn = x % 360;
  if (turn > 180) turn -= 360; else if (turn < -180) turn += 360;
  return turn;
}
function addRow(covariance, to, from, factor) {
  for (let j = 0; j < insSize; ++j) covariance[insSize * to + j] += factor * covariance[insSize * from + j];
}
function addColumn(covariance, to, from, factor) {
  for (let j = 0; j < insSize; ++j) covariance[insSize * j + to] += factor * covariance[insSize * j + from];
}
// What a turn and an acceleration at one instant do to a covariance, which is changed; to a transition by `adds` of rows alone.
function insManoeuvre(matrix, before, heading_deg, speed_mps, odometry, adds = [addRow, addColumn]) {
  const turn_rad = turnBetween_deg(before.heading_deg, heading_deg) * insRadPerDeg;
  if (turn_rad === 0 && speed_mps === before.speed_mps) return;
  const forward = enuFromBody(heading_deg), forwardBefore = enuFromBody(before.heading_deg);
  const east_mps = forward[0][0] * speed_mps - forwardBefore[0][0] * before.speed_mps;
  const north_mps = forward[1][0] * speed_mps - forwardBefore[1][0] * before.speed_mps;
  for (const add of adds) {  // what is added is not changed before
    for (let i = 0; i < 2 && !odometry; ++i) {
      const turned = i === 0 ? north_mps : -east_mps;
      add(matrix, insState.velocity + i, insState.accelScale, i === 0 ? east_mps : north_mps);
      add(matrix, insState.velocity + i, insState.heading, turned);
      add(matrix, insState.velocity + i, insState.gyroScale, 0.5 * turn_rad * turned);
    }
    add(matrix, insState.heading, insState.gyroScale, turn_rad);
  }
}
const insBefore = new Float64Array(insSize * insSize), insHalf = new Float64Array(insSize * insSize);
// One part of a step: Φ P Φᵀ and what it adds, of `insBefore`. The states from `insState.accelBias` on drive the others
// and only decay themselves.
function insGrown(step) {
  const { first, columns, factors, decay } = step;
  const drivers = insState.accelBias;
  const grown = new Float64Array(step.noise);
  for (let i = 0; i < drivers; ++i) {
    const to = insSize * i;
    for (let j = 0; j < insSize; ++j) insHalf[to + j] = 0;
    for (let n = first[i]; n < first[i + 1]; ++n) {
      const factor = factors[n], from = insSize * columns[n];
      for (let j = 0; j < insSize; ++j) insHalf[to + j] += factor * insBefore[from + j];
    }
  }
  for (let j = 0; j < drivers; ++j) {
    for (let i = j; i < drivers; ++i) {
      const from = insSize * i;
      let sum = grown[from + j];
      for (let n = first[j]; n < first[j + 1]; ++n) sum += insHalf[from + columns[n]] * factors[n];
      grown[from + j] = sum;
      grown[insSize * j + i] = sum;
    }
  }
  for (let j = drivers; j < insSize; ++j) {
    for (let i = 0; i < drivers; ++i) {
      const value = grown[insSize * i + j] + insHalf[insSize * i + j] * decay[j];
      grown[insSize * i + j] = value;
      grown[insSize * j + i] = value;
    }
    for (let i = drivers; i <= j; ++i) {
      const value = grown[insSize * i + j] + decay[i] * insBefore[insSize * i + j] * decay[j];
      grown[insSize * i + j] = value;
      grown[insSize * j + i] = value;
    }
  }
  return grown;
}
function insPropagate(state, step) {
  insBefore.set(state.covariance);
  insManoeuvre(insBefore, state, step.heading_deg, step.speed_mps, step.odometry);
  let covariance = null;
  for (let part = 0; part < step.parts; ++part) {
    covariance = insGrown(step);
    if (step.aided) covariance = insUpdate(covariance, aidMeasured, insAidNoise * insAidNoise / (step.time_s / step.parts));
    if (part + 1 < step.parts) insBefore.set(covariance);
  }
  return { covariance: covariance || new Float64Array(insBefore), heading_deg: step.heading_deg, speed_mps: step.speed_mps,
    time_s: state.time_s + step.time_s };
}
function initialInsState(model, heading_deg, speed_mps) {
  const covariance = new Float64Array(insSize * insSize);
  const set = (first, count, sigma) => { for (let i = first; i < first + count; ++i) covariance[insIndex(i, i)] = square(sigma); };
  set(insState.position, 2, model.start_sigma_m);
  set(insState.tilt, 2, model.start_tilt_sigma_rad);
  set(insState.heading, 1, model.start_heading_sigma_rad);
  set(insState.gyroBias, 3, model.gyro_bias_radps);
  set(insState.gyroScale, 1, model.gyro_scale);
  set(insState.map, 2, model.map_sigma_m);
  if (isOdometry(model)) {
    for (const i of [0, 1]) covariance[insIndex(insState.aid + i, insState.aid + i)] = square(model.odometry_drift) / 2;
  } else {
    set(insState.velocity, 2, model.start_velocity_sigma_mps);
    set(insState.accelBias, 2, model.accel_bias_mps2);
    set(insState.accelScale, 1, model.accel_scale);
    set(insState.aid, 2, model.velocity_aid_sigma_mps);
  }
  return { covariance, heading_deg, speed_mps, time_s: 0 };
}
const updateWithFix = (state, model) => ({ ...state, covariance: insUpdate(state.covariance, fixMeasured, square(model.fix_sigma_m)) });

// A measurement of the combination [state, factor]… that leaves it with the variance `most`; nothing where it has no more.
function insHold(covariance, combination, most) {
  const ph = new Float64Array(insSize);
  for (const [state, factor] of combination) for (let i = 0; i < insSize; ++i) ph[i] += factor * covariance[insSize * i + state];
  const variance = combination.reduce((sum, [state, factor]) => sum + factor * ph[state], 0);
  if (!(variance > most)) return;
  const gain = ph.map((value) => (variance - most) / (variance * variance) * value);
  for (let i = 0; i < insSize; ++i) for (let j = 0; j < insSize; ++j) covariance[insSize * i + j] -= gain[i] * ph[j];
  const nextH = new Float64Array(insSize);
  for (const [state, factor] of combination) for (let i = 0; i < insSize; ++i) nextH[i] += factor * covariance[insSize * i + state];
  const weight = most * variance / (variance - most);
  for (let i = 0; i < insSize; ++i) {
    for (let j = 0; j < insSize; ++j) covariance[insSize * i + j] += -nextH[i] * gain[j] + weight * gain[i] * gain[j];
  }
  symmetric(covariance);
}
function insHoldEllipse(covariance, first, most) {
  const a = covariance[insIndex(first, first)], b = covariance[insIndex(first, first + 1)], d = covariance[insIndex(first + 1, first + 1)];
  const angle_rad = 0.5 * Math.atan2(2 * b, a - d);
  const c = Math.cos(angle_rad), s = Math.sin(angle_rad);
  for (const axis of [[c, s], [-s, c]]) insHold(covariance, [[first, axis[0]], [first + 1, axis[1]]], most);
}
// What GNSS does to the errors while it is had.
function holdWithGnss(state, heading_deg, speed_mps, model) {
  const next = { ...state, covariance: new Float64Array(state.covariance) };
  insManoeuvre(next.covariance, state, heading_deg, speed_mps, isOdometry(model));
  Object.assign(next, { heading_deg, speed_mps });
  insHoldEllipse(next.covariance, insState.position, square(model.start_sigma_m));
  if (model.start_velocity_sigma_mps > 0) insHoldEllipse(next.covariance, insState.velocity, square(model.start_velocity_sigma_mps));
  if (model.start_tilt_sigma_rad > 0) insHoldEllipse(next.covariance, insState.tilt, square(model.start_tilt_sigma_rad));
  if (model.start_heading_sigma_rad > 0) insHold(next.covariance, [[insState.heading, 1]], square(model.start_heading_sigma_rad));
  return next;
}
// Position a step later, for the many states that it is asked of: two rows, and the variances that the step adds; null with an
// aiding velocity.
function positionAhead(step) {
  if (step.aided) return null;
  let rows = insPositionRows;
  let added = [0, 0, 0];
  for (let part = 0; part < step.parts; ++part) {
    added = insAddedBy(rows, step.noise).map((value, n) => added[n] + value);
    rows = rows.map((row) => {
      const next = new Float64Array(insSize);
      for (let k = 0; k < insSize; ++k) for (let n = step.first[k]; n < step.first[k + 1]; ++n) next[step.columns[n]] += row[k] * step.factors[n];
      return next;
    });
  }
  return { rows, added };
}

// ---- Many states that fly alike (ins/ins_span.h) ----
// Where errors only grow (no GNSS, no aiding velocity), a state is not flown step by step: its covariance C stays as it was at
// the span's first sample. With Ψ the transition from there and Q what was added on the way, that at the sample is Ψ C Ψᵀ + Q,
// of which a position asks for two rows. A fix changes C as if it were measured with h Ψ, where Ψ⁻¹ Q hᵀ joins its C Ψᵀ hᵀ.
const insPositionRows = [0, 1].map((i) => Float64Array.from({ length: insSize }, (_, k) => (k === insState.position + i ? 1 : 0)));
const insFixRows = [0, 1].map((i) => Float64Array.from({ length: insSize }, (_, k) => (k === insState.position + i) - (k === insState.map + i)));
const insLongestSpan_s = 60, insLeastDecay = 1e-3;  // beyond which digits are lost

const newSpan = () => ({ atFirst: true, time_s: 0, transition: insIdentity(), noise: new Float64Array(insSize * insSize) });
function isLongSpan({ time_s, transition }) {
  let least = 1;
  for (let i = insState.accelBias; i < insSize; ++i) least = Math.min(least, transition[insIndex(i, i)]);
  return time_s > insLongestSpan_s || least < insLeastDecay;
}

function insTimes(matrix, vector) {
  const product = new Float64Array(insSize);
  for (let i = 0; i < insSize; ++i) for (let k = 0; k < insSize; ++k) product[i] += matrix[insSize * i + k] * vector[k];
  return product;
}
function rowTimes(row, matrix) {
  const product = new Float64Array(insSize);
  for (let k = 0; k < insSize; ++k) {
    if (row[k] === 0) continue;
    for (let j = 0; j < insSize; ++j) product[j] += row[k] * matrix[insSize * k + j];
  }
  return product;
}
// Variances and covariance of two combinations of what is added.
function insAddedBy([x, y], noise) {
  const byX = rowTimes(x, noise), byY = rowTimes(y, noise);
  let a = 0, b = 0, d = 0;
  for (let k = 0; k < insSize; ++k) {
    a += byX[k] * x[k];
    b += byX[k] * y[k];
    d += byY[k] * y[k];
  }
  return [a, b, d];
}
// The span, as it would be one step longer; `before` has heading and speed of the step before.
function flySpan(span, before, step) {
  let { transition, noise } = span;
  if (step.heading_deg !== before.heading_deg || step.speed_mps !== before.speed_mps) {
    transition = new Float64Array(transition);
    noise = new Float64Array(noise);
    insManoeuvre(transition, before, step.heading_deg, step.speed_mps, step.odometry, [addRow]);
    insManoeuvre(noise, before, step.heading_deg, step.speed_mps, step.odometry);
  }
  for (let part = 0; part < step.parts; ++part) {
    const next = new Float64Array(insSize * insSize);
    for (let i = 0; i < insSize; ++i) {
      for (let n = step.first[i]; n < step.first[i + 1]; ++n) {
        const factor = step.factors[n], from = insSize * step.columns[n];
        for (let j = 0; j < insSize; ++j) next[insSize * i + j] += factor * transition[from + j];
      }
    }
    transition = next;
    insBefore.set(noise);
    noise = insGrown(step);
  }
  return { atFirst: false, time_s: span.time_s + step.time_s, transition, noise };
}
// A step flown so many times as one.
function leapsOf(step) {
  const made = [step];
  let span = null;
  return (count) => {
    while (made.length < count) {
      span = flySpan(span || flySpan(newSpan(), step, step), step, step);
      const leap = { ...step, time_s: span.time_s, parts: 1, noise: span.noise };
      listTransition(leap, span.transition);
      made.push(leap);
    }
    return made[count - 1];
  };
}
// The covariance at the span's sample.
function insAtSample(span, covariance) {
  if (span.atFirst) return covariance;
  const { transition } = span;
  const half = insProduct(transition, covariance);
  const sum = new Float64Array(span.noise);
  for (let i = 0; i < insSize; ++i) {
    for (let j = 0; j <= i; ++j) {
      let product = sum[insSize * i + j];
      for (let k = 0; k < insSize; ++k) product += half[insSize * i + k] * transition[insSize * j + k];
      sum[insSize * i + j] = sum[insSize * j + i] = product;
    }
  }
  return sum;
}
// Two combinations of the states at the span's sample: rows for the covariances of its first, those not 0, and what is added.
function spanForm(span, rows, more = [0, 0, 0]) {
  const [x, y] = span.atFirst ? rows : rows.map((row) => rowTimes(row, span.transition));
  const used = [];
  for (let k = 0; k < insSize; ++k) if (x[k] !== 0 || y[k] !== 0) used.push(k);
  if (span.atFirst) return { rows: [x, y], used, added: more };
  return { rows: [x, y], used, added: insAddedBy(rows, span.noise).map((value, n) => more[n] + value) };
}
// The variances and the covariance of the two combinations.
function formVariances({ rows: [x, y], used, added }, covariance) {
  let [a, b, d] = added;
  for (let n = 0; n < used.length; ++n) {
    const k = used[n], from = insSize * k, own = covariance[from + k];
    let alongX = 0, alongY = 0;
    for (let m = n + 1; m < used.length; ++m) {
      const j = used[m], value = covariance[from + j];
      alongX += value * x[j];
      alongY += value * y[j];
    }
    a += x[k] * (x[k] * own + 2 * alongX);
    b += x[k] * y[k] * own + x[k] * alongY + y[k] * alongX;
    d += y[k] * (y[k] * own + 2 * alongY);
  }
  return [a, b, d];
}
// Solutions of matrix · u = column for each column: elimination, the largest pivot of each column first.
function solveColumns(matrix, columns) {
  const left = new Float64Array(matrix);
  const solved = columns.map((column) => new Float64Array(column));
  for (let k = 0; k < insSize; ++k) {
    let pivot = k;
    for (let i = k + 1; i < insSize; ++i) if (Math.abs(left[insSize * i + k]) > Math.abs(left[insSize * pivot + k])) pivot = i;
    for (let j = 0; j < insSize && pivot !== k; ++j) {
      [left[insSize * k + j], left[insSize * pivot + j]] = [left[insSize * pivot + j], left[insSize * k + j]];
    }
    for (const column of solved) [column[k], column[pivot]] = [column[pivot], column[k]];
    for (let i = k + 1; i < insSize; ++i) {
      const factor = left[insSize * i + k] / left[insSize * k + k];
      if (factor === 0) continue;
      for (let j = k; j < insSize; ++j) left[insSize * i + j] -= factor * left[insSize * k + j];
      for (const column of solved) column[i] -= factor * column[k];
    }
  }
  for (const column of solved) {
    for (let k = insSize - 1; k >= 0; --k) {
      for (let j = k + 1; j < insSize; ++j) column[k] -= left[insSize * k + j] * column[j];
      column[k] /= left[insSize * k + k];
    }
  }
  return solved;
}
// What a fix at the span's sample asks of a covariance.
function fixForm(span) {
  const form = spanForm(span, insFixRows);
  form.joined = insFixRows.map((row) => insTimes(span.noise, row));
  if (!span.atFirst) form.joined = solveColumns(span.transition, form.joined);
  return form;
}
const insPh = new Float64Array(insSize), insQh = new Float64Array(insSize);
function fixedCovariance({ rows: [x, y], used, joined: [first, second] }, covariance, variance) {
  const ph = insPh, qh = insQh;
  ph.set(first);
  qh.set(second);
  for (let n = 0; n < used.length; ++n) {
    const k = used[n], from = insSize * k, xk = x[k], yk = y[k];
    for (let j = 0; j < insSize; ++j) {
      const value = covariance[from + j];
      ph[j] += xk * value;
      qh[j] += yk * value;
    }
  }
  let a = variance, b = 0, d = variance;
  for (let n = 0; n < used.length; ++n) {
    const k = used[n];
    a += x[k] * ph[k];
    b += x[k] * qh[k];
    d += y[k] * qh[k];
  }
  // With L Lᵀ the innovation's covariance, what is learnt is W Wᵀ, W = P hᵀ L⁻ᵀ: symmetric to the bit.
  const root = Math.sqrt(a), beside = b / root, rootOther = Math.sqrt(d - beside * beside);
  for (let j = 0; j < insSize; ++j) {
    ph[j] /= root;
    qh[j] = (qh[j] - beside * ph[j]) / rootOther;
  }
  const after = new Float64Array(insSize * insSize);
  for (let n = 0, i = 0; i < insSize; ++i) {
    const learnt = ph[i], learntOther = qh[i];
    for (let j = 0; j < insSize; ++j, ++n) after[n] = covariance[n] - (learnt * ph[j] + learntOther * qh[j]);
  }
  return after;
}
// k·σ of position along the worst direction.
const positionError_m = (state, model) => errorOf_m([state.covariance[0], state.covariance[1], state.covariance[insSize + 1]], model);
function errorOf_m([a, b, d], model) {
  return model.sigma_multiple * Math.sqrt(0.5 * (a + d) + Math.hypot(0.5 * (a - d), b));
}
// How long k·σ stays within the limit in straight flight after a fix: the first crossing.
function longestBridgeableGap_s(model, speed_mps, limit_m) {
  const resolution_s = 1e-3, longest_s = 86400;
  let inside = initialInsState({ ...model, start_sigma_m: Math.hypot(model.fix_sigma_m, model.map_sigma_m) }, 0, speed_mps);
  if (positionError_m(inside, model) > limit_m) return 0;
  let step_s = 1;
  while (inside.time_s < longest_s) {
    const time_s = Math.min(step_s, longest_s - inside.time_s);
    const next = insPropagate(inside, makeInsStep(time_s, 0, speed_mps, model));
    if (positionError_m(next, model) <= limit_m) {
      inside = next;
      step_s = Math.min(step_s * 1.25, 60);
    } else if (time_s > resolution_s) {
      step_s = time_s / 2;
      if (step_s < resolution_s) return inside.time_s;
    } else {
      return inside.time_s;
    }
  }
  return longest_s;
}
