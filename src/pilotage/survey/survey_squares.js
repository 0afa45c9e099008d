// The squares of the kilometre grid, over the heat map.
function drawSquares(context, view) {
  const path = new Path2D();
  display.squares.forEach((square) => { if (square.corners_m.length) tracePath(path, view, square.corners_m, true); });
  strokeTwice(context, path, ['#fff', 3], ['#000', 1.2]);
  context.font = '600 12px system-ui, sans-serif';
  context.textAlign = 'left';
  context.textBaseline = 'top';
  context.lineWidth = 3;
  context.strokeStyle = '#fff';
  context.fillStyle = '#000';
  display.squares.forEach((square) => {
    const p = square.corners_m;
    if (!p.length) return;
    const x = view.x(p[0]), y = view.y(p[1]);
    const text = square.name + ': ' + square.go + ' go';
    if (view.x(p[2]) - x < context.measureText(text).width + 12) return;  // what does not fit is told by the table
    context.strokeText(text, x + 6, y + 6);
    context.fillText(text, x + 6, y + 6);
  });
}
moreLayers.push(['squares', 'route', drawSquares]);

document.querySelectorAll('button.show-tile').forEach((button) => {
  button.addEventListener('click', () => {
    showTile(Number(button.dataset.tile), true);
    $('map').scrollIntoView({ block: 'center' });
    $('map').focus({ preventScroll: true });
  });
});
document.querySelectorAll('button.show-square').forEach((button) => {
  button.addEventListener('click', () => {
    const p = display.squares[Number(button.dataset.square)].corners_m;
    if (!map || !p.length) return;
    const bounds = L.latLngBounds([]);
    for (let k = 0; k < p.length; k += 2) bounds.extend(toLatLng(p[k], p[k + 1]));
    map.fitBounds(bounds);
    $('map').scrollIntoView({ block: 'center' });
    $('map').focus({ preventScroll: true });
  });
});
