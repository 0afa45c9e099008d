// "What if": limit, inertial system, speed and interval between tries changed here; verdict and chart of the map as it is
// built. The report's own verdict, map and tables stay, and so does what is printed.
const whatIfData = data.what_if;  // null: nothing tells when a flight tries to fix
const whatIf = { predicted: null, run: 0, trusted: null, plannedAbout: null, timer: 0, planned: whatIfData &&
  { limit_m: whatIfData.max_error_m, model: whatIfData.models[0], speed_mps: null, interval_s: whatIfData.fix_interval_s } };

// ---- Chart ----
const chartX = (distance_m) => axes.left + Math.min(1, Math.max(0, distance_m / axes.distanceM)) * (axes.right - axes.left);
const plannedChart = {};  // what is put back on reset and on paper
function keepPlannedChart() {
  plannedChart.plot = [...$('chart-plot').childNodes];
  plannedChart.loss = [...$('chart-loss').childNodes];
  plannedChart.errorM = axes.errorM;
  plannedChart.legs = [...chart.querySelectorAll('.leg')].map((leg) => ({ leg, type: leg.getAttribute('class'), title: leg.querySelector('title').textContent }));
}
function plotOf(predicted) {
  const profile = thinProfile(predicted.profile, 2000);
  axes.errorM = Math.max(predicted.max_error_m, 1, predicted.largest_error_m) * 1.08;
  const y = (error_m) => axes.bottom - Math.min(1, Math.max(0, error_m / axes.errorM)) * (axes.bottom - axes.top);
  const parts = [];
  for (const stretch of shownFlight.denied || []) {
    const words = predicted.loss ? 'GNSS lost for good: the worst point' : 'GNSS denied';
    const x1 = chartX(stretch.from_distance_m), x2 = chartX(stretch.to_distance_m);
    parts.push(chartBand('denied', x1, x2, axes.top, axes.bottom, words));
    parts.push(chartLine('denied-edge', x1, axes.top - 2, Math.max(x2, x1 + 1), axes.top - 2));
    if (x2 - x1 >= 7.5 * words.length) parts.push(chartWords('denied-label', (x1 + x2) / 2, axes.top - 5, words));
  }
  for (const gap of predicted.gaps) {
    const title = 'What if: gap of ' + lengthWords(gap.to_distance_m - gap.from_distance_m) + ', error at its end ' +
      comparisonWords(gap.error_m, predicted.max_error_m);
    const types = gap.status === 2 ? ['gap bad', 'hatch'] : ['gap ' + statusNames[gap.status]];
    for (const type of types) parts.push(chartBand(type, chartX(gap.from_distance_m), chartX(gap.to_distance_m), axes.top, axes.bottom, title));
  }
  const worst = predicted.probability && tooOftenLost(predicted) ? predicted.probability.worst : null;
  if (worst) parts.push(chartBand('lost', chartX(worst.from_distance_m), chartX(worst.to_distance_m), axes.top, axes.top + 10, 'What if: most flights are lost here'));
  const step_m = tickStep(axes.errorM, 5);
  for (let i = 0; i * step_m <= axes.errorM; ++i) {
    parts.push(chartLine('grid', axes.left, y(i * step_m), axes.right, y(i * step_m)));
    parts.push(chartWords('tick-y', axes.left - 8, y(i * step_m) + 5, String(Number((i * step_m).toPrecision(12)))));
  }
  const path = curvePath(profile.map((sample) => [chartX(sample.distance_m), y(sample.error_m)]));
  const ends = [profile[profile.length - 1], profile[0]].map((sample) => 'L' + chartNumber(chartX(sample.distance_m)) + ' ' + chartNumber(axes.bottom));
  parts.push(svgElement('path', { class: 'area', d: path + ends.join('') + 'Z' }), svgElement('path', { class: 'curve', d: path }));
  const planned = plannedFlight.rows.filter((row) => row[1] !== null).map((row) => [chartX(row[0]), y(row[1])]);
  parts.push(svgElement('path', { class: 'curve as-planned', d: curvePath(planned) }));
  const limit = y(predicted.max_error_m);
  parts.push(chartLine('limit', axes.left, limit, axes.right, limit));
  parts.push(chartWords('limit-label', axes.left + 8, limit < axes.top + 24 ? limit + 18 : limit - 6, 'what if: limit ' + errorWords(predicted.max_error_m)));
  for (const gap of predicted.gaps) {
    const x1 = chartX(gap.from_distance_m), x2 = chartX(gap.to_distance_m);
    if (x2 - x1 < 70) continue;
    parts.push(chartWords('gap-label', (x1 + x2) / 2, axes.bottom - 8, (gap.status === 2 ? '✕ ' : '') + lengthWords(gap.to_distance_m - gap.from_distance_m)));
  }
  return parts;
}
function drawWhatIf(predicted) {
  $('chart-plot').replaceChildren(...plotOf(predicted));
  $('chart-simulated').setAttribute('visibility', 'hidden');  // it is of the report's flight
  plannedChart.legs.forEach(({ leg }, i) => {
    const at = report.route.legs.filter((entry) => entry.from_distance_m !== null)[i].leg - 1;
    const status = predicted.legs[at];
    leg.setAttribute('class', 'leg ' + statusNames[status.status]);
    leg.querySelector('title').textContent = 'What if: leg ' + (at + 1) + ': largest error ' + comparisonWords(status.max_error_m, predicted.max_error_m) +
      (status.p_within_limit === null ? '' : ', within the limit with P = ' + probabilityWords(status.p_within_limit));
  });
  const loss = plannedChart.loss.find((node) => node instanceof Element && node.classList.contains('loss'));
  if (!predicted.loss || !loss) return;
  const [top, bottom] = [...chart.querySelectorAll('#chart-loss .grid')].map((line) => Number(line.getAttribute('y1'))).sort((a, b) => a - b);
  const again = svgElement('path', { class: 'curve loss', d: curvePath(predicted.loss.points.map((point) =>
    [chartX(point.distance_m), bottom - Math.min(1, Math.max(0, point.p_within_limit)) * (bottom - top)])) });
  $('chart-loss').replaceChildren(...plannedChart.loss.map((node) => (node === loss ? again : node)));
}
function drawPlanned() {
  axes.errorM = plannedChart.errorM;
  $('chart-plot').replaceChildren(...plannedChart.plot);
  $('chart-simulated').removeAttribute('visibility');
  $('chart-loss').replaceChildren(...plannedChart.loss);
  for (const { leg, type, title } of plannedChart.legs) {
    leg.setAttribute('class', type);
    leg.querySelector('title').textContent = title;
  }
}
// The chart of what is asked, or the report's; never the former on paper.
function showFlight() {
  const predicted = state.printing ? null : whatIf.predicted;
  if (predicted === null) {
    shownFlight = plannedFlight;
    drawPlanned();
  } else {
    const last_m = axes.distanceM;
    shownFlight = { whatIf: true, limit_m: predicted.max_error_m, rows: predicted.profile.map((sample) => [sample.distance_m, sample.error_m]),
      p: predicted.profile.map((sample) => [sample.p_correct_fix, sample.p_within_limit]),
      denied: predicted.loss ? [{ from_distance_m: predicted.loss.worst.distance_m, to_distance_m: last_m }] : plannedFlight.denied,
      losses: predicted.loss ? predicted.loss.points.map((point) => [point.distance_m, point.max_error_m, point.p_within_limit]) : [] };
    drawWhatIf(predicted);
  }
  const asked = predicted !== null;
  chart.parentElement.classList.toggle('asked', asked);
  $('what-if-on-chart').hidden = !asked;
  chart.setAttribute('aria-label', asked ? 'What if: predicted position error along the route. ' + predicted.text : plannedChart.label);
  if (state.along !== null) setAlong(state.along, 'what if');
}

// ---- Settings and words ----
const plannedSpeed = () => [...new Set(whatIfData.speed_runs.map((run) => run[1]))].join(', ') + ' m/s';
// What the form asks for; null where a number is not allowed.
function settingsAsked() {
  const fields = ['limit', 'speed', 'interval'].map((name) => $('what-if-' + name));
  if (!fields.every((field) => field.checkValidity())) return null;
  const [limit_m, speed_mps, interval_s] = fields.map((field) => (field.value === '' ? null : Number(field.value)));
  const planned = whatIf.planned;
  return { limit_m: limit_m === null ? planned.limit_m : limit_m, model: whatIfData.models[Number($('what-if-ins').value)], speed_mps,
    interval_s: interval_s === null ? planned.interval_s : interval_s };
}
function changesOf(settings) {
  const planned = whatIf.planned;
  const changes = [];
  if (settings.limit_m !== planned.limit_m) changes.push('limit ' + settings.limit_m + ' m instead of ' + planned.limit_m + ' m');
  if (settings.model.text !== planned.model.text) changes.push(settings.model.text + ' instead of ' + planned.model.text);
  if (settings.speed_mps !== null) changes.push('speed ' + settings.speed_mps + ' m/s instead of ' + plannedSpeed());
  if (settings.interval_s !== planned.interval_s) changes.push('a try every ' + settings.interval_s + ' s instead of every ' + planned.interval_s + ' s');
  return changes;
}
function sayWhatIf(predicted, settings) {
  const changes = changesOf(settings).join('; ');
  $('what-if-verdict').hidden = false;
  $('what-if-verdict').className = statusNames[predicted.verdict];
  $('what-if-word').textContent = 'What if: ' + (predicted.about ? 'about ' : '') + verdictNames[predicted.verdict];
  $('what-if-word').className = 'badge ' + statusNames[predicted.verdict];
  $('what-if-changes').textContent = changes;
  $('what-if-answer').textContent = (predicted.about ? 'About: ' : '') + headlineSentence(predicted);
  $('what-if-detail').textContent = predicted.detail;
  $('what-if-assumes').textContent = predicted.assumptions;
  const sun = settings.speed_mps !== null && whatIfData.others.some((row) => row.name === 'flight_sun');
  $('what-if-sun').hidden = !sun;
  $('what-if-chart-words').textContent = 'What if: ' + changes + '. ' + (predicted.about ? 'About ' : '') + verdictNames[predicted.verdict] + ', predicted in this page; the report itself says ' +
    document.querySelector('.verdict .word').textContent + '. Dotted: the report\'s prediction.';
}
function resetWhatIf() {
  ++whatIf.run;
  clearTimeout(whatIf.timer);
  const planned = whatIf.planned;
  $('what-if-limit').value = planned.limit_m;
  $('what-if-ins').value = '0';
  $('what-if-speed').value = '';
  $('what-if-interval').value = planned.interval_s;
  forgetWhatIf('');
}
function forgetWhatIf(words) {
  whatIf.predicted = null;
  $('what-if-verdict').hidden = true;
  $('what-if-state').textContent = words;
  $('what-if-progress').hidden = true;
  showFlight();
}

// ---- Work ----
// Whether the page's prediction of what is planned is the report's: but for the last digits, else nothing is offered; by an answer at
// once but for what that leaves out, else it is not shown before all flights are held against the report.
function sameAsReport(predicted, most_p_apart) {
  const near = (a, b, apart) => Math.abs(a - b) <= apart * Math.max(1, Math.abs(b));
  const judged = judgeFlight(predicted, whatIf.planned, whatIfData);
  const route = report.route.probability;
  return near(judged.largest_error_m, report.route.largest_error_m, 1e-5) && (route === null) === (judged.probability === null) &&
    (route === null || near(judged.probability.p_within_limit, route.p_within_limit, most_p_apart));
}
async function askWhatIf() {
  const run = ++whatIf.run;
  const isStale = () => run !== whatIf.run;
  const tell = (share) => { if (!whatIfData.anywhere) $('what-if-progress').value = share; };
  const settings = settingsAsked();
  if (settings === null) return forgetWhatIf('A number lies outside what is allowed: limit 1 to 10000 m, speed 0.1 to 1000 m/s, interval 0.01 to 3600 s.');
  if (!changesOf(settings).length) return forgetWhatIf('');
  $('what-if-state').textContent = 'Computing …';
  $('what-if-progress').hidden = false;
  const flight = readFlight(whatIfData);
  if (isLongWork(flight) && whatIf.trusted !== false) {
    const work = aboutFlight(flight);
    const answer = async (asked) => {
      const about = await inSlices(predictFlight(work, asked), isStale, tell);
      return about && overAllLevels(about, whatIfData);
    };
    whatIf.plannedAbout = whatIf.plannedAbout || await answer(whatIf.planned);
    const about = whatIf.plannedAbout && await answer(settings);
    if (about === null) return null;
    if (sameAsReport(whatIf.plannedAbout, 0.25)) {
      const shift = learnShift(whatIf.plannedAbout.probability, report.route.probability);
      showAnswer(judgeAbout(shiftShares(about, shift), settings, whatIfData), settings);
      $('what-if-state').textContent = 'About, by few of the winds and levels of the place: P may be off by 0.15. Computing all ' +
        flight.chances.cases.length + ' …';
    }
  }
  if (whatIf.trusted === null) {
    const planned = await inSlices(predictFlight(flight, whatIf.planned), isStale, tell);
    if (planned === null) return null;
    whatIf.trusted = sameAsReport(planned, 1e-5);
  }
  if (!whatIf.trusted) return forgetWhatIf('Not offered: for the settings of the report this page computes other numbers than the report has.');
  const predicted = await inSlices(predictFlight(flight, settings), isStale, tell);
  if (predicted === null) return null;
  $('what-if-state').textContent = '';
  $('what-if-progress').hidden = true;
  showAnswer(judgeFlight(predicted, settings, whatIfData), settings);
  return null;
}
function showAnswer(predicted, settings) {
  whatIf.predicted = predicted;
  sayWhatIf(predicted, settings);
  showFlight();
}
// Where all flights take so long that one waits: samples times cases, of which a second does some 30,000.
const isLongWork = (flight) => flight.chances !== null && !flight.anywhere && flight.count * flight.chances.cases.length > 60000;
// Better inertial systems than what is planned, by the error that a minute in straight flight leaves.
function betterSystems() {
  const drift_m = (model) => positionError_m(insPropagate(initialInsState(model, 0, plannedMps()), makeInsStep(60, 0, plannedMps(), model)), model);
  const planned_m = drift_m(whatIfData.models[0]);
  return whatIfData.models.map((model, i) => [i, model]).filter(([i, model]) => i > 0 && drift_m(model) < 0.9 * planned_m);
}
const plannedMps = () => whatIfData.speed_runs[0][1];
function offerCures() {
  const box = $('cure-ins');
  if (!box) return;
  const better = betterSystems();
  box.append(...better.flatMap(([i, model]) => {
    const button = element('button', 'P with ' + model.text);
    button.type = 'button';
    button.addEventListener('click', () => {
      $('what-if-ins').value = String(i);
      askWhatIf();
      unfold($('what-if'));
      $('what-if').scrollIntoView();
    });
    return [button, ' '];
  }));
  if (!better.length) box.textContent = 'none of the grades drifts less.';
}
function makeWhatIf() {
  keepPlannedChart();
  plannedChart.label = chart.getAttribute('aria-label');
  if (whatIfData === null) return;
  offerCures();
  whatIfData.models.forEach((model, i) => {
    const option = element('option', i === 0 ? 'as planned: ' + model.text : model.text);
    option.value = String(i);
    $('what-if-ins').append(option);
  });
  $('what-if-speed').placeholder = plannedSpeed();
  resetWhatIf();
  $('what-if').hidden = false;
  const later = () => {
    clearTimeout(whatIf.timer);
    whatIf.timer = setTimeout(askWhatIf, 300);
  };
  for (const name of ['limit', 'ins', 'speed', 'interval']) $('what-if-' + name).addEventListener('input', later);
  $('what-if-form').addEventListener('submit', (event) => { event.preventDefault(); askWhatIf(); });
  document.querySelectorAll('button.what-if-reset').forEach((button) => {
    button.addEventListener('click', () => {
      resetWhatIf();
      $('what-if-limit').focus({ preventScroll: button.closest('#what-if') !== null });
    });
  });
}
