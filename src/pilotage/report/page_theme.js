// Light and dark. The style sheet knows light (no attribute), dark and sun; "as the system" becomes one of the first two here.
const $ = (id) => document.getElementById(id);
const darkSystem = window.matchMedia('(prefers-color-scheme: dark)');
function applyTheme() {
  const wanted = $('theme').value || (darkSystem.matches ? 'dark' : '');
  if (wanted) document.documentElement.dataset.theme = wanted; else delete document.documentElement.dataset.theme;
}
$('theme').addEventListener('change', applyTheme);
darkSystem.addEventListener('change', applyTheme);
applyTheme();
