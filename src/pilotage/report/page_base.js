// What every page has: elements by their id, light and dark, paper.
const $ = (id) => document.getElementById(id);

// The style sheet knows light (no attribute), dark and sun; "as the system" becomes one of the first two here.
const darkSystem = window.matchMedia('(prefers-color-scheme: dark)');
function applyTheme() {
  const wanted = $('theme').value || (darkSystem.matches ? 'dark' : '');
  if (wanted) document.documentElement.dataset.theme = wanted; else delete document.documentElement.dataset.theme;
}
$('theme').addEventListener('change', applyTheme);
darkSystem.addEventListener('change', applyTheme);
applyTheme();

// On paper what is folded in the text is open.
let openedForPaper = [];
window.addEventListener('beforeprint', () => {
  openedForPaper.push(...document.querySelectorAll('details:not([open])'));
  openedForPaper.forEach((details) => { details.open = true; });
});
window.addEventListener('afterprint', () => {
  openedForPaper.forEach((details) => { details.open = false; });
  openedForPaper = [];
});
