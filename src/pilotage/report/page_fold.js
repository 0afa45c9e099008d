// Sections that fold under their headings: all of them by a click; on a phone all but the map, the places to look at first, the
// chart and the warnings begin folded. On paper everything is open.
const narrowScreen = window.matchMedia('(max-width: 640px)');
const foldButtons = new Map();  // by what they fold
function setFolded(node, folded) {
  if (!foldButtons.has(node)) return;
  node.classList.toggle('folded', folded);
  foldButtons.get(node).setAttribute('aria-expanded', String(!folded));
  if (!folded) fitChart();
}
// A button with this inside that folds a node.
function foldButton(node, inside, folded) {
  const button = element('button', undefined, 'fold');
  button.type = 'button';
  button.append(...inside);
  button.addEventListener('click', () => setFolded(node, !node.classList.contains('folded')));
  foldButtons.set(node, button);
  setFolded(node, folded);
  return button;
}
// Of an element inside the section that is to be seen.
const unfold = (node) => setFolded(node.closest('main > section'), false);
// On a phone what the headline rests on and takes for granted stands below the map, so that both begin on the first screen.
function moveBecause() {
  const below = element('section', undefined, 'because-below');
  below.setAttribute('aria-label', 'What the headline rests on, and what it takes for granted');
  below.append(...document.querySelectorAll('.verdict .because, .verdict .said > .assumes, .verdict .said > .title-block'));
  document.querySelector('.map-section').after(below);
}
function makeFolds() {
  if (narrowScreen.matches) moveBecause();
  document.querySelectorAll('main > section:not(.map-section)').forEach((section) => {
    const heading = section.querySelector('h2');
    if (!heading) return;
    const stays = section.matches('.first, .along-route') || section.querySelector('#warnings-heading');
    heading.append(foldButton(section, heading.childNodes, narrowScreen.matches && !stays));
  });
  // The heat map's controls, which are longer than the map.
  $('panel').before(foldButton($('panel'), ['Heat map, layers, tiles'], narrowScreen.matches));
}
