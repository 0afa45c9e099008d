// What a predicted flight means, in the words of the program (quality.cc, verdict.cc, wording.cc).

// As std::to_chars writes a number with fixed decimals: exact ties go to the even digit.
function fixedWords(number, decimals) {
  const exact = Math.abs(number).toFixed(100);
  const point = exact.indexOf('.');
  if (!/^50*$/.test(exact.slice(point + 1 + decimals))) return number.toFixed(decimals);
  const down = decimals === 0 ? exact.slice(0, point) : exact.slice(0, point + 1 + decimals);
  const up = Math.abs(number).toFixed(decimals);
  const even = Number(down[down.length - 1]) % 2 === 0 ? down : up;
  return number < 0 ? '-' + even : even;
}
function lengthWords(length_m) {
  return length_m >= 999.5 ? fixedWords(length_m / 1000, 1) + ' km' : fixedWords(length_m, 0) + ' m';
}
const errorDecimals = (error_m) => (Math.abs(error_m) < 9.95 ? 1 : 0);
const errorWords = (error_m) => fixedWords(error_m, errorDecimals(error_m)) + ' m';
function comparisonWords(error_m, limit_m) {
  const sign = error_m <= limit_m ? ' ≤ ' : ' > ';
  let decimals = errorDecimals(Math.min(error_m, limit_m));
  while (decimals < 6 && error_m !== limit_m && fixedWords(error_m, decimals) === fixedWords(limit_m, decimals)) ++decimals;
  return fixedWords(error_m, decimals) + ' m' + sign + fixedWords(limit_m, decimals) + ' m';
}
function durationWords(duration_s) {
  const whole_s = Math.round(duration_s);
  return whole_s < 600 ? whole_s + ' s' : Math.floor(whole_s / 60) + ' min ' + whole_s % 60 + ' s';
}
const probabilityWords = (p) => (p === null ? '–' : fixedWords(Math.floor(p * 1000 + 1e-6) / 1000, 3));
const probabilityComparison = (route) => probabilityWords(route.p_within_limit) +
  (route.p_within_limit >= route.min_p_within_limit ? ' ≥ ' : ' < ') + probabilityWords(route.min_p_within_limit) +
  (route.interval ? ', 80 % interval ' + probabilityWords(route.interval.low) + ' … ' + probabilityWords(route.interval.high) : '');

// ---- Statuses: 0 good, 1 marginal, 2 bad ----
const statusNames = ['good', 'marginal', 'bad'];
const verdictNames = ['GO', 'MARGINAL', 'NO-GO'];
function judgeError(error_m, limit_m) {
  if (error_m <= 0.8 * limit_m) return 0;
  return error_m <= limit_m ? 1 : 2;
}
function judgeProbability(p, predicted) {
  if (!predicted.probability) return 0;
  const asked = predicted.probability.min_p_within_limit;
  if (p === null) return 2;
  if (p >= (1 + asked) / 2) return 0;
  return p >= asked ? 1 : 2;
}
const tooOftenLost = (predicted) => predicted.probability !== null &&
  predicted.probability.p_within_limit < predicted.probability.min_p_within_limit;
function judgeRoute(route) {
  if (!(route.p_within_limit >= route.min_p_within_limit)) return 2;
  return route.interval && !(route.interval.low >= route.min_p_within_limit) ? 1 : 0;
}
function judgeLeg(leg, predicted) {
  if (!leg.within_limit) return 2;
  return Math.max(judgeError(leg.max_error_m, predicted.max_error_m), judgeProbability(leg.p_within_limit, predicted));
}
function judgeGap(gap, predicted) {
  if (!gap.within_limit) return 2;
  const status = judgeError(gap.error_m, predicted.max_error_m);
  if (!predicted.probability) return status;
  const worst = predicted.probability.worst;
  if (tooOftenLost(predicted) && worst && gap.from_distance_m < worst.to_distance_m && gap.to_distance_m > worst.from_distance_m) return 2;
  return Math.max(status, judgeProbability(1 - gap.p_first_excess, predicted));
}
function longestGap(predicted) {
  const length = (gap) => gap.to_distance_m - gap.from_distance_m;
  return predicted.gaps.reduce((longest, gap) => (longest === null || length(gap) > length(longest) ? gap : longest), null);
}
function gapWords(gap) {
  const length_m = gap.to_distance_m - gap.from_distance_m;
  if (!(gap.duration_s > 0)) return lengthWords(length_m);
  const speed_mps = length_m / gap.duration_s;
  return lengthWords(length_m) + ' = ' + durationWords(gap.duration_s) + ' at ' + fixedWords(speed_mps, speed_mps < 9.95 ? 1 : 0) + ' m/s';
}

// ---- The verdict ----
// Rows of the quality table that decide: [name, label, value, status].
// `told`: what is known of the flight besides what is predicted: disagreement, others, matchable_fraction, interval_below,
// max_error_m, assumes.
function decidingRows(predicted, model, told) {
  const limit_m = predicted.max_error_m;
  const rows = [['largest_error', '', '', predicted.within_limit ? judgeError(predicted.largest_error_m, limit_m) : 2]];
  const gap = longestGap(predicted);
  rows.push(['longest_gap', '', '', gap === null ? 0 : gap.within_limit ? judgeError(gap.error_m, limit_m) : 2]);
  if (predicted.probability) rows.push(['route_probability', '', '', judgeRoute(predicted.probability)]);
  const apart = told.disagreement;
  if (apart) {
    const together_m = predicted.largest_error_m + apart.largest_m;
    const status = apart.largest_m <= model.sigma_multiple * model.fix_sigma_m ? 0 : together_m <= limit_m ? 1 : 2;
    rows.push(['georeference_disagreement', 'Second date: georeferences apart', 'up to ' + errorWords(apart.largest_m) + ', median ' +
      errorWords(apart.median_m) + '; largest error with it ' + comparisonWords(together_m, limit_m), status]);
  }
  return rows.concat(told.others.map((row) => [row.name, row.label, row.value, statusNames.indexOf(row.status)]));
}
function headlineWords(predicted) {
  const limit_m = predicted.max_error_m;
  if (!predicted.probability) {
    return 'the error is predicted up to ' + comparisonWords(predicted.largest_error_m, limit_m) +
      ', if what is assumed holds and every fix comes; how often fixes come is not known';
  }
  const ofHundred = Math.floor(predicted.probability.p_within_limit * 100 + 1e-9);
  const flights = ofHundred >= 1 ? ofHundred + ' of 100 flights ' + (ofHundred === 1 ? 'stays' : 'stay') : 'fewer than 1 of 100 flights stay';
  return flights + ' within ' + errorWords(limit_m) + ' all the way, ' + (tooOftenLost(predicted) ? 'even ' : '') +
    'if what is assumed holds (P = ' + probabilityComparison(predicted.probability) + ')';
}
const headlineSentence = (predicted) => {
  const words = predicted.headline + '.';
  return words[0].toUpperCase() + words.slice(1);
};
function detailWords(predicted, rows, verdict, told) {
  const limit_m = predicted.max_error_m;
  const lost = tooOftenLost(predicted);
  let text = '';
  if (lost && predicted.probability.worst) {
    const worst = predicted.probability.worst;
    text = 'most are lost from ' + lengthWords(worst.from_distance_m) + ' to ' + lengthWords(worst.to_distance_m) + ' (leg ' + (worst.leg + 1) +
      '), where fixes fail too often; ';
  }
  text += 'matchable on ' + percentWords(told.matchable_fraction) + ' of its length';
  const gap = longestGap(predicted);
  const where = lost ? 'if every fix came, ' : '';
  text += gap === null ? '; no gap' : '; longest gap ' + gapWords(gap) + '; ' + where + 'drift there ' + comparisonWords(gap.error_m, limit_m);
  if (gap === null || errorWords(gap.error_m) !== errorWords(predicted.largest_error_m)) {
    text += '; ' + where + 'largest error ' + comparisonWords(predicted.largest_error_m, limit_m);
  }
  for (const [name, label, value, status] of rows) {
    if (verdict === 0 || status !== verdict || name === 'largest_error' || name === 'longest_gap') continue;
    if (name === 'route_probability') {
      if (verdict === 1) text += '; ' + told.interval_below;
      continue;
    }
    text += '; ' + label + ': ' + value;
  }
  return text;
}
function assumptionWords(predicted, settings, told) {
  let gnss = told.assumes.gnss;
  if (predicted.loss) {
    const worst = predicted.loss.worst;
    gnss = 'GNSS lost for good at the worst point, ' + lengthWords(worst.distance_m) + ' (leg ' + (worst.leg + 1) + ')' +
      (worst.distance_m > 0 ? ', fixes taken where it is had, too' : '');
  }
  const limit_default = told.assumes.limit_default && settings.limit_m === told.max_error_m;
  return 'assumes: ' + settings.model.text + ', ' + gnss + ', limit ' + errorWords(settings.limit_m) + (limit_default ? ' (default)' : '') +
    told.assumes.further;
}
function sayVerdict(predicted) {
  predicted.headline = headlineWords(predicted);
  predicted.text = (predicted.about ? 'about ' : '') + verdictNames[predicted.verdict] + ': ' +
    (predicted.probability ? predicted.headline + '; ' : '') + predicted.detail;
}
// Adds statuses, verdict and words to a prediction.
function judgeFlight(predicted, settings, told) {
  predicted.largest_error_m = Math.max(...[predicted.profile, predicted.gaps].map((all) => all.reduce((most, one) => Math.max(most, one.error_m), 0)));
  predicted.legs.forEach((leg) => { leg.status = judgeLeg(leg, predicted); });
  predicted.gaps.forEach((gap) => { gap.status = judgeGap(gap, predicted); });
  const rows = decidingRows(predicted, settings.model, told);
  const verdict = Math.max(...rows.map((row) => row[3]));
  predicted.verdict = verdict;
  predicted.detail = detailWords(predicted, rows, verdict, told);
  sayVerdict(predicted);
  predicted.assumptions = assumptionWords(predicted, settings, told);
  return predicted;
}
