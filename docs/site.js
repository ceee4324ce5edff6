// The panels of a wide figure come one below the other where the page is narrow: a figure is cut
// where nothing is drawn from top to bottom, near to where its two or three panels meet.
(() => {
  const GAP = 12; // px without ink, of the figure as stored, that part two panels

  function emptyColumns(pixels, width, height) {
    const empty = new Array(width).fill(true);
    for (let i = 0, n = width * height; i < n; i++)
      if (pixels[4 * i] < 250 || pixels[4 * i + 1] < 250 || pixels[4 * i + 2] < 250)
        empty[i % width] = false;
    return empty;
  }

  // The middle of the widest gap between two columns; null if there is none.
  function cut(empty, from, to) {
    let best = null;
    for (let i = from, start = null; i <= to; i++) {
      if (empty[i] && start === null) start = i;
      if ((!empty[i] || i === to) && start !== null) {
        if (i - start >= GAP && (!best || i - start > best[1] - best[0])) best = [start, i];
        start = null;
      }
    }
    return best && Math.round((best[0] + best[1]) / 2);
  }

  function cuts(empty, aspect) {
    const at = (from, to) => cut(empty, Math.round(from * empty.length), Math.round(to * empty.length));
    if (aspect > 2.6) {
      const thirds = [at(0.25, 0.42), at(0.58, 0.75)];
      if (!thirds.includes(null)) return thirds;
    }
    return [at(0.33, 0.67)].filter((x) => x !== null);
  }

  function stack(image) {
    const { naturalWidth: width, naturalHeight: height } = image;
    if (image.previousElementSibling?.className === "panels" || width < 1.8 * height) return;
    const whole = new OffscreenCanvas(width, height).getContext("2d");
    whole.drawImage(image, 0, 0);
    const empty = emptyColumns(whole.getImageData(0, 0, width, height).data, width, height);
    const edges = [0, ...cuts(empty, width / height), width];
    if (edges.length < 3) return;
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

  function stackAll() {
    for (const image of document.querySelectorAll('.cell_output img[src^="data:"]'))
      if (image.complete && image.naturalWidth) stack(image);
      else image.addEventListener("load", () => stack(image), { once: true });
  }

  const narrow = matchMedia("(max-width: 40rem)");
  addEventListener("load", () => narrow.matches && stackAll());
  narrow.addEventListener("change", () => narrow.matches && stackAll());
})();

// What the theme and docutils say of themselves, so that every reader program understands it.
addEventListener("load", () => {
  for (const button of document.querySelectorAll(".search-button-field")) button.removeAttribute("aria-label");
  for (const entry of document.querySelectorAll('[role="list"] > [role="doc-biblioentry"]'))
    entry.setAttribute("role", "listitem");
});
