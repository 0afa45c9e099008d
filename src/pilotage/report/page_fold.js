// Sections that fold under their headings: all of them by a click; on a phone all but the map, the places to look at first, the
// chart and the warnings begin folded. On paper everything is open.
const narrowScreen = window.matchMedia('(max-width: 640px)');
const foldButtons = new Map();  // by section
function setFolded(section, folded) {
  if (!foldButtons.has(section)) return;
  section.classList.toggle('folded', folded);
  foldButtons.get(section).setAttribute('aria-expanded', String(!folded));
  if (!folded) fitChart();
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
    const button = element('button', undefined, 'fold');
    button.type = 'button';
    button.append(...heading.childNodes);
    heading.append(button);
    foldButtons.set(section, button);
    button.addEventListener('click', () => setFolded(section, !section.classList.contains('folded')));
    const stays = section.matches('.first, .along-route') || section.querySelector('#warnings-heading');
    setFolded(section, narrowScreen.matches && !stays);
  });
  // The heat map's controls, which are longer than the map.
  const panel = $('panel');
  const button = element('button', 'Heat map, layers, tiles', 'fold');
  button.type = 'button';
  panel.before(button);
  button.addEventListener('click', () => {
    panel.classList.toggle('folded');
    button.setAttribute('aria-expanded', String(!panel.classList.contains('folded')));
  });
  panel.classList.toggle('folded', narrowScreen.matches);
  button.setAttribute('aria-expanded', String(!narrowScreen.matches));
}
