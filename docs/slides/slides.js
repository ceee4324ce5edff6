// Moves from slide to slide, by keys, buttons or a finger. The address remembers where.
"use strict";
const slides = [...document.querySelectorAll(".slide")];
let now = 0;

function go(to) {
  now = Math.max(0, Math.min(slides.length - 1, to));
  slides.forEach((slide, i) => slide.classList.toggle("now", i === now));
  document.getElementById("where").textContent = `${now + 1} / ${slides.length}`;
  history.replaceState(null, "", `#${now + 1}`);
  fit(slides[now]);
}

// A formula wider than the slide is made smaller until it fits.
function fit(slide) {
  for (const formula of slide.querySelectorAll('mjx-container[display="true"]')) {
    formula.style.fontSize = "";
    const wide = formula.querySelector("mjx-math").getBoundingClientRect().width;
    const ratio = formula.clientWidth / wide;
    if (ratio < 1) formula.style.fontSize = `${Math.floor(ratio * 97)}%`;
  }
}

const keys = {
  ArrowRight: () => go(now + 1), ArrowDown: () => go(now + 1), PageDown: () => go(now + 1), " ": () => go(now + 1),
  ArrowLeft: () => go(now - 1), ArrowUp: () => go(now - 1), PageUp: () => go(now - 1),
  Home: () => go(0), End: () => go(slides.length - 1),
  n: () => document.body.classList.toggle("notes-shown"),
  c: () => document.body.classList.toggle("code-shown"),
  f: () => (document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen()),
};
addEventListener("keydown", (event) => {
  const onButton = event.target.closest("button, a") && event.key === " ";
  if (event.target.closest(".explore") && event.key !== "PageDown" && event.key !== "PageUp") return;
  if (!(event.key in keys) || event.ctrlKey || event.metaKey || event.altKey || onButton) return;
  event.preventDefault();
  keys[event.key]();
});
document.getElementById("back").addEventListener("click", () => go(now - 1));
document.getElementById("on").addEventListener("click", () => go(now + 1));
let from = null;
addEventListener("touchstart", (event) => {
  from = event.target.closest(".explore") ? null : event.changedTouches[0];
}, { passive: true });
addEventListener("touchend", (event) => {
  if (!from) return;
  const to = event.changedTouches[0];
  const across = to.clientX - from.clientX;
  if (Math.abs(across) > 60 && Math.abs(across) > 2 * Math.abs(to.clientY - from.clientY)) go(now - Math.sign(across));
}, { passive: true });
addEventListener("resize", () => fit(slides[now]));
addEventListener("load", () => window.MathJax.startup.promise.then(() => fit(slides[now])));
// Where a server hands the slides out, explorations move, as on the site; a file shows their stills.
if (document.body.dataset.live && location.protocol.startsWith("http")) {
  const style = document.createElement("link");
  [style.rel, style.href] = ["stylesheet", "_static/live/live.css"];
  document.head.append(style);
  for (const name of ["page", "grips", "explore"]) {
    const script = document.createElement("script");
    [script.src, script.async] = [`_static/live/${name}.js`, false]; // in this order
    document.head.append(script);
  }
}
addEventListener("hashchange", () => go((parseInt(location.hash.slice(1), 10) || 1) - 1));
go((parseInt(location.hash.slice(1), 10) || 1) - 1);
