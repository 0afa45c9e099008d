// Beside the map: which measure, its scale with the threshold, which layers.
function levelRadio(level) {
  const label = element('label');
  const input = element('input');
  input.type = 'radio';
  input.name = 'level';
  input.value = String(level);
  input.checked = level === state.level;
  input.addEventListener('change', () => setLevel(level));
  label.append(input, ' Level ' + level);
  return label;
}
// The classes with their colours, and how many tiles of the level are of each.
function showClasses() {
  const ofLevel = tiles.map((row, i) => i).filter((i) => valueOf(tiles[i], 'level') === state.level);
  $('scale-classes').replaceChildren(...display.class_names.map((name, k) => {
    const line = element('li');
    const swatch = element('span', undefined, 'swatch');
    swatch.style.background = display.class_colors[k];
    const count = ofLevel.filter((i) => display.classes[i] === k).length;
    line.append(swatch, ' ' + name + ': ' + count + (count === 1 ? ' tile' : ' tiles'));
    return line;
  }));
}
// How many tiles lie where on the scale: bars above the colours.
function showCounts() {
  if (isDecision()) { showClasses(); return; }
  const bars = 32;
  const counts = new Array(bars).fill(0);
  tiles.forEach((row, i) => {
    const index = shadeOf(i);
    if (valueOf(row, 'level') === state.level && index >= 0) ++counts[Math.min(bars - 1, Math.floor(index * bars / 256))];
  });
  const most = Math.max(1, ...counts);
  const svg = svgElement('svg', { viewBox: '0 0 ' + bars + ' 10', preserveAspectRatio: 'none' });
  counts.forEach((count, k) => {
    const height = count > 0 ? Math.max(0.6, 10 * Math.sqrt(count / most)) : 0;
    svg.append(svgElement('rect', { x: k + 0.08, width: 0.84, y: 10 - height, height: height }));
  });
  $('scale-counts').replaceChildren(svg);
}
function showScale() {
  const scale = scaleNow();
  const range = rangeNow();
  $('scale').classList.toggle('classed', isDecision());
  $('whole-box').hidden = !ranksNow();
  $('scale-untested').hidden = !isUntested.size || !(isDecision() || ranksNow());
  $('scale-name').textContent = scale.label;
  $('scale-meaning').textContent = '· ' + scale.meaning;
  showCounts();
  if (isDecision()) return;
  const colors = display.colors[display.color_maps[state.measure]];
  const stops = [];
  for (let i = 0; i < 256; i += 15) stops.push(colors[i]);
  $('scale-bar').style.background = 'linear-gradient(to right,' + stops.join(',') + ')';
  const decimals = decimalsNow();
  $('scale-low').textContent = (scale.least !== null && scale.least < range.low ? '≤ ' : '') + formatted(range.low, decimals);
  $('scale-high').textContent = (scale.most !== null && scale.most > range.high ? '≥ ' : '') + formatted(range.high, decimals);
  $('scale-unit').textContent = scale.unit === '1' ? '(no unit)' : scale.unit;
}
function routeShare() {
  if (!flown) return null;
  const under = tilesUnderRoute();
  if (under.length < 2) return null;
  return under.filter((i) => i >= 0 && passes(i)).length / under.length;
}
function countThreshold() {
  if (state.threshold === null) {
    $('threshold-text').textContent = 'off';
    $('threshold-count').textContent = '';
    return;
  }
  let all = 0, above = 0, selectedBelow = 0;
  tiles.forEach((row, i) => {
    if (valueOf(row, 'level') !== state.level) return;
    ++all;
    if (passes(i)) ++above; else if (valueOf(row, 'selected')) ++selectedBelow;
  });
  const share = routeShare();
  const value = withUnit(formatted(state.threshold, decimalsNow()), scaleNow().unit);
  $('threshold-text').textContent = value;
  $('threshold-count').textContent = above + ' of ' + all + ' tiles at or above ' + value + (flown ? '; ' + selectedBelow + ' chosen tiles below' : '') +
    (share === null ? '' : '; ' + percentWords(share) + ' of the route over tiles at or above');
}
function thresholdValue() {
  const range = rangeNow();
  const value = range.low + (range.high - range.low) * Number($('threshold').value) / 200;
  return ranksNow() ? Math.round(100 * value) / 100 : value;  // so that 0.50 is 0.5, where classes part
}
function updateThreshold() {
  if (isDecision()) {
    state.threshold = null;
    recolor();
    countThreshold();
    return;
  }
  const scale = scaleNow();
  const value = thresholdValue();
  state.threshold = $('threshold-on').checked ? value : null;
  $('threshold').setAttribute('aria-valuetext', withUnit(formatted(value, decimalsNow()), scale.unit));
  recolor();
  countThreshold();
}
function setLevel(level) {
  state.level = level;
  document.querySelectorAll('input[name="level"]').forEach((input) => { input.checked = Number(input.value) === level; });
  ['heat', 'untested', 'detail', 'classes', 'selected', 'refused'].forEach((name) => { if (layers[name]) layers[name].redraw(); });
  showCounts();
  countThreshold();
}
function addMeasure(label, value) {
  const option = element('option', label);
  option.value = String(value);
  option.selected = value === state.measure;
  $('measure').append(option);
}
function makePanel() {
  if (hasClasses) addMeasure(decision.label, -1);
  report.measures.forEach((measure, i) => {
    if (measure.least === null && i !== state.measure) return;  // was not computed
    addMeasure(measure.label, i);
  });
  $('measure').addEventListener('change', () => {
    state.measure = Number($('measure').value);
    showScale();
    updateThreshold();
    showMeasure();
  });
  if (levels.length > 1) levels.forEach((level) => $('levels').append(levelRadio(level)));
  $('tested-on').textContent = ' (' + display.tested_on + ')';
  state.whole = $('whole').checked;  // a page that is loaded again keeps its boxes
  showScale();
  updateThreshold();
  $('whole').addEventListener('change', () => {
    const value = thresholdValue();
    state.whole = $('whole').checked;
    const range = rangeNow();  // the threshold stays where it was
    $('threshold').value = String(Math.round(200 * (value - range.low) / (range.high - range.low)));
    showScale();
    updateThreshold();
  });
  $('opacity').addEventListener('input', setOpacity);
  $('threshold').addEventListener('input', () => { $('threshold-on').checked = true; updateThreshold(); });
  $('threshold-on').addEventListener('change', updateThreshold);
  document.querySelectorAll('.checks input').forEach((box) => {
    const name = box.id.slice('show-'.length);
    box.addEventListener('change', () => {
      const shown = box.checked;
      const names = name === 'imagery' ? ['imagery', 'detail'] : name === 'heat' ? ['heat', 'untested'] : [name];
      names.filter((layer) => map && layers[layer]).forEach((layer) => { if (shown) layers[layer].addTo(map); else layers[layer].remove(); });
    });
  });
}
