"use strict";
// What a hand can take hold of in a picture, on the site's pages and in a notebook alike: buttons
// over it that follow mouse, thumb and arrow keys. Whoever draws is told where they were pulled to.
globalThis.CvnotesGrips = class {
  static ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

  // stage: an element that lies over the picture; pull({grip, at, values}): where it is wanted.
  constructor(stage, pull) {
    this.stage = stage;
    this.tell = pull;
    this.own = new Map();
    this.held = null; // by keys that came before their picture
    this.left = null; // of keys whose picture has come: what its sliders rounded away
  }

  // Put what can be taken hold of where the picture of this size, drawn for these values, has it.
  place(grips, size, values) {
    [this.size, this.values] = [size, values];
    const here = new Set(grips.map(({ name }) => name));
    for (const [name, { button }] of this.own) button.hidden = !here.has(name);
    for (const grip of grips) {
      if (!this.own.has(grip.name)) this.own.set(grip.name, this.make(grip));
      const own = this.own.get(grip.name);
      own.grip = grip;
      own.button.ariaLabel = `${grip.label}: drag it, or move it with the arrow keys`;
      own.button.title = grip.label;
      own.button.style.left = `${(100 * grip.place[0]) / size[0]}%`;
      own.button.style.top = `${(100 * grip.place[1]) / size[1]}%`;
    }
  }

  // The newest picture is there: the next key goes on from it, whether keys come fast or slowly.
  rest() {
    if (!this.held) return;
    const { name, grip, x, y } = this.held;
    const { at, unit, step } = this.own.get(name).grip;
    const left = [x, y].map((by, k) => (unit[k] ? (grip.at[k] + by * grip.unit[k] - at[k]) / unit[k] : 0));
    this.left = left.every((by) => Math.abs(by) < step) ? { name, at: `${at}`, by: left } : null;
    this.held = null;
  }

  make({ name }) {
    const button = document.createElement("button");
    button.type = "button";
    button.className = "explore-grip";
    button.dataset.lmSuppressShortcuts = "true"; // its arrows are not JupyterLab's
    const own = { button };
    let from = null; // where the hand took hold
    button.addEventListener("pointerdown", (event) => {
      if (event.button) return;
      event.preventDefault();
      button.focus({ preventScroll: true });
      button.setPointerCapture(event.pointerId);
      from = { x: event.clientX, y: event.clientY, grip: own.grip, values: { ...this.values } };
    });
    button.addEventListener("pointermove", (event) => {
      if (!from) return;
      const page = this.size[0] / this.stage.getBoundingClientRect().width;
      this.pull(from, (event.clientX - from.x) * page, (event.clientY - from.y) * page);
    });
    for (const over of ["pointerup", "pointercancel"]) button.addEventListener(over, () => (from = null));
    button.addEventListener("keydown", (event) => {
      const way = CvnotesGrips.ARROWS[event.key];
      if (!way || event.altKey || event.ctrlKey || event.metaKey) return;
      event.preventDefault();
      // Keys that come before the picture add up from where the first one found it.
      if (this.held?.name !== name) {
        const goesOn = this.left?.name === name && this.left.at === `${own.grip.at}`;
        const [x, y] = goesOn ? this.left.by : [0, 0];
        this.held = { name, grip: own.grip, values: { ...this.values }, x, y };
      }
      const step = own.grip.step * (event.shiftKey ? 5 : 1);
      this.held.x += way[0] * step;
      this.held.y += way[1] * step;
      this.pull(this.held, this.held.x, this.held.y);
    });
    this.stage.append(button);
    return own;
  }

  pull({ grip, values }, x, y) {
    const at = [grip.at[0] + x * grip.unit[0], grip.at[1] + y * grip.unit[1]];
    this.tell({ grip: grip.name, at, values });
  }
};

// Large for a thumb. What can be pulled has its ring in the picture; here it answers to the hand.
document.getElementById("explore-grips")?.remove();
document.head.append(
  Object.assign(document.createElement("style"), {
    id: "explore-grips",
    textContent: `
.explore-stage > button.explore-grip {
  position: absolute;
  width: 1.9rem;
  height: 1.9rem;
  transform: translate(-50%, -50%);
  padding: 0;
  border: 2px solid transparent;
  border-radius: 50%;
  background: none;
  cursor: grab;
  touch-action: none;
  pointer-events: auto;
}
.explore-stage > button.explore-grip:is(:hover, :focus-visible) {
  border: 2px solid #0072b2;
  background: rgb(0 114 178 / 0.12);
}
.explore-stage > button.explore-grip:focus-visible { outline: 3px solid #0072b2; outline-offset: 2px; }
.explore-stage > button.explore-grip:active { cursor: grabbing; }
.explore-stage > button.explore-grip[hidden] { display: none; }
@media (max-width: 40rem) { .cvnotes-explorer > .widget-image { order: -1; } } /* above its sliders */
@media (pointer: coarse) { .explore-stage > button.explore-grip { width: 2.75rem; height: 2.75rem; } }`,
  }),
);
