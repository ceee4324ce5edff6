// In a notebook: grips over the picture of the exploration whose output `element` is in. What is
// pulled goes to Python through a field that is not seen, and comes back through another.
// (no "use strict": this runs after grips.js, inside what the front end wraps around it)
(() => {
  const NOT_YET = 200; // times 50 ms: the parts of a widget are put into the page one by one
  const find = (tries) => {
    const box = element.closest(".cvnotes-explorer");
    const [image, field, told] = ["img.widget-image", ".cvnotes-pulled input", ".cvnotes-told"].map((part) =>
      box?.querySelector(part),
    );
    if (image && field && told) begin(box, image, field, told);
    else if (tries) setTimeout(find, 50, tries - 1);
  };

  function begin(box, image, field, told) {
    box.querySelector(":scope > .explore-stage")?.remove(); // of an earlier view
    const stage = document.createElement("div");
    stage.className = "explore-stage";
    stage.style.cssText = "position: absolute; pointer-events: none";
    box.style.position = "relative";
    box.append(stage);
    let sent = 0;
    const grips = new CvnotesGrips(stage, (wanted) => {
      field.value = JSON.stringify({ number: ++sent, ...wanted });
      field.dispatchEvent(new Event("input", { bubbles: true }));
    });

    const lay = () => {
      const [inner, outer] = [image.getBoundingClientRect(), box.getBoundingClientRect()];
      const place = {
        left: inner.left - outer.left + box.scrollLeft,
        top: inner.top - outer.top + box.scrollTop,
        width: inner.width,
        height: inner.height,
      };
      for (const [side, px] of Object.entries(place)) stage.style[side] = `${px}px`;
    };
    const hear = () => {
      const words = told.textContent.trim();
      if (!words) return;
      const shown = JSON.parse(words);
      grips.place(shown.grips, shown.size, shown.values);
      if (shown.number >= sent) grips.rest();
      lay();
    };
    new MutationObserver(hear).observe(told, { childList: true, subtree: true, characterData: true });
    const sizes = new ResizeObserver(lay);
    for (const part of [box, image]) sizes.observe(part);
    image.addEventListener("load", lay);
    hear();
  }

  find(NOT_YET);
})();
