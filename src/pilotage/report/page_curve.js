// What a chart is drawn of, in the units of its drawing.
const chartNumber = (value) => Math.round(value * 10) / 10;
const chartLine = (type, x1, y1, x2, y2) => svgElement('line', { class: type, x1: chartNumber(x1), y1: chartNumber(y1), x2: chartNumber(x2), y2: chartNumber(y2) });
function chartWords(type, x, y, words) {
  const text = svgElement('text', { class: type, x: chartNumber(x), y: chartNumber(y) });
  text.textContent = words;
  return text;
}
function chartBand(type, x1, x2, top, bottom, title) {
  const band = svgElement('rect', { class: type, x: chartNumber(x1), y: chartNumber(top), width: chartNumber(Math.max(x2 - x1, 1)),
    height: chartNumber(bottom - top) });
  const words = svgElement('title', {});
  words.textContent = title;
  band.append(words);
  return band;
}
// 1, 2 or 5 times a power of ten (tick_step).
function tickStep(extent, most) {
  const power = Math.pow(10, Math.floor(Math.log10(extent / most)));
  return ([1, 2, 5].find((factor) => extent / (factor * power) <= most) || 10) * power;
}
// At most `most` samples that draw the same curve (thin_profile).
function thinProfile(profile, most) {
  if (profile.length <= most) return profile;
  const stretches = Math.floor(most / 4);
  const kept = [];
  for (let i = 0; i < stretches; ++i) {
    const first = Math.floor(profile.length * i / stretches), last = Math.floor(profile.length * (i + 1) / stretches);
    let least = first, largest = first;
    for (let k = first; k < last; ++k) {
      if (profile[k].error_m < profile[least].error_m) least = k;
      if (profile[k].error_m >= profile[largest].error_m) largest = k;
    }
    [...new Set([first, least, largest, last - 1])].sort((a, b) => a - b).forEach((k) => kept.push(profile[k]));
  }
  return kept;
}
const curvePath = (points) => points.map(([x, y], i) => (i ? 'L' : 'M') + chartNumber(x) + ' ' + chartNumber(y)).join('');
// On a narrow screen the chart is higher than its width asks for; by how much its letters are to be widened again.
function fitChart() {
  for (const drawing of document.querySelectorAll('.chart svg')) {
    const box = drawing.getBoundingClientRect();
    const view = drawing.viewBox.baseVal;
    if (box.width > 0) drawing.style.setProperty('--chart-stretch', String(box.height / view.height / (box.width / view.width)));
  }
}
