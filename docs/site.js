// The panels of a wide figure come one below the other where the page is narrow: data-cuts says in
// which columns of the stored picture they meet (tools/site_figures.py).
(() => {
  function stack(image) {
    if (image.previousElementSibling?.className === "panels") return;
    const { naturalWidth: width, naturalHeight: height } = image;
    const edges = [0, ...image.dataset.cuts.split(" ").map(Number), width];
    const panels = document.createElement("div");
    panels.className = "panels";
    panels.setAttribute("role", "img");
    panels.setAttribute("aria-label", image.alt);
    for (let i = 0; i + 1 < edges.length; i++) {
      const panel = document.createElement("canvas");
      [panel.width, panel.height] = [edges[i + 1] - edges[i], height];
      panel.getContext("2d").drawImage(image, -edges[i], 0);
      panels.append(panel);
    }
    image.before(panels);
  }

  // (a figure is fetched when it comes into sight)
  function stackAll() {
    for (const image of document.querySelectorAll("img[data-cuts]"))
      if (image.complete && image.naturalWidth) stack(image);
      else image.addEventListener("load", () => stack(image), { once: true });
  }

  const narrow = matchMedia("(max-width: 40rem)");
  addEventListener("DOMContentLoaded", () => narrow.matches && stackAll());
  narrow.addEventListener("change", () => narrow.matches && stackAll());
})();

// What the theme and docutils say of themselves, so that every reader program understands it.
addEventListener("load", () => {
  for (const button of document.querySelectorAll(".search-button-field")) button.removeAttribute("aria-label");
  for (const entry of document.querySelectorAll('[role="list"] > [role="doc-biblioentry"]'))
    entry.setAttribute("role", "listitem");
  // A formula that is wider than the page is scrolled by the keyboard too.
  for (const formula of document.querySelectorAll("div.math"))
    if (formula.scrollWidth > formula.clientWidth + 1) formula.tabIndex = 0;
});
