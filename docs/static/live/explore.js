"use strict";
// The page's explorations follow the hand: sliders, and what can be taken hold of in the picture.
// In place of the output of a cell come native controls around its still; the first touch wakes
// Python. While one picture is drawn, of all that is wanted meanwhile only the newest is kept.
(() => {
  const NARROW = 600; // px of the page: narrower, and panels come below each other
  const REST = 250; // ms without a touch, after which the picture is drawn as sharp as the screen
  const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  let count = 0;

  function digits({ step }) {
    return (String(step).split(".")[1] ?? "").length;
  }

  function written(setting, value) {
    return setting.choice ? "" : value.toFixed(digits(setting)).replace("-", "−");
  }

  class Exploration {
    constructor(told, output, still) {
      this.told = told;
      this.values = { ...told.values };
      this.busy = false;
      this.next = null;
      this.number = ++count;
      this.state = make("p", { className: "explore-state", role: "status" });
      this.sentence = make("p", { className: "explore-sentence", role: "status", textContent: told.sentence });
      this.matrices = make("div", { className: "explore-matrices", innerHTML: told.matrices });
      this.canvas = make("canvas", { hidden: true, role: "img" });
      this.stage = make("div", { className: "explore-stage" }, still, this.canvas);
      this.stage.style.setProperty("--width", `${told.size[0]}px`);
      this.grips = new Map();
      this.inputs = new Map();
      const controls = make("div", { className: "explore-controls" });
      for (const setting of told.settings) controls.append(this.control(setting));
      const reset = make("button", { type: "button", textContent: "Reset", className: "live-button" });
      reset.addEventListener("click", () => this.reset());
      controls.append(reset);
      const name = `Exploration: ${told.name}`;
      const parts = [controls, this.state, this.sentence, this.stage, this.matrices];
      output.replaceChildren(make("div", { className: "explore", role: "group", ariaLabel: name }, ...parts));
      this.place(told.grips, told.size);
    }

    control(setting) {
      const id = `explore-${this.number}-${setting.name}`;
      const label = make("label", { htmlFor: id, textContent: setting.label, title: setting.help });
      if (setting.tint) label.style.cssText = `background: ${setting.tint}; color: #000`;
      const value = this.values[setting.name];
      const number = make("output", { textContent: written(setting, value) });
      number.setAttribute("for", id);
      const { low: min, high: max, step } = setting;
      const kind = setting.choice ? { type: "checkbox", checked: !!value } : { type: "range", min, max, step };
      const input = make("input", { id, title: setting.help, ...kind });
      if (!setting.choice) input.value = value;
      input.addEventListener("input", () => {
        this.values[setting.name] = setting.choice ? Number(input.checked) : Number(input.value);
        number.textContent = written(setting, this.values[setting.name]);
        this.want({});
      });
      this.inputs.set(setting.name, { setting, input, number });
      return make("div", { className: "explore-control" }, label, input, number);
    }

    reset() {
      this.show(Object.fromEntries(this.told.settings.map(({ name, value }) => [name, value])));
      this.want({});
    }

    // Let the sliders stand where the values are.
    show(values) {
      this.values = { ...values };
      for (const [name, { setting, input, number }] of this.inputs) {
        if (setting.choice) input.checked = !!values[name];
        else input.value = values[name];
        number.textContent = written(setting, values[name]);
      }
    }

    get narrow() {
      return this.stage.clientWidth < NARROW;
    }

    want(change) {
      clearTimeout(this.rest);
      const { name, camera, board } = this.told;
      const wanted = { name, camera, board, values: { ...this.values }, narrow: this.narrow, sharpness: 1, ...change };
      if (this.busy) this.next = wanted;
      else this.draw(wanted);
    }

    async draw(wanted) {
      this.busy = true;
      const started = performance.now();
      try {
        const say = (text) => this.say(text);
        const { pixels, rest } = await live.ask({ kind: "explore", question: JSON.stringify(wanted) }, { say });
        this.paint(pixels, JSON.parse(rest), wanted);
        this.stage.dataset.took = performance.now() - started;
        this.say("");
      } catch (error) {
        this.say(error.message);
      }
      this.busy = false;
      const next = this.next;
      this.next = null;
      if (next) this.draw(next);
      else if (wanted.sharpness < devicePixelRatio) {
        this.held = null;
        this.rest = setTimeout(() => this.want({ sharpness: Math.min(Math.ceil(devicePixelRatio), 2) }), REST);
      } else this.held = null;
    }

    say(text) {
      if (this.state.textContent !== text) this.state.textContent = text;
    }

    paint(pixels, shown, wanted) {
      const [width, height] = shown.size;
      if (this.canvas.width !== width || this.canvas.height !== height)
        [this.canvas.width, this.canvas.height] = [width, height];
      const image = new ImageData(new Uint8ClampedArray(pixels), width, height);
      this.canvas.getContext("2d").putImageData(image, 0, 0);
      this.canvas.hidden = false;
      this.canvas.setAttribute("aria-label", `${this.told.about} ${shown.sentence}`);
      this.stage.classList.add("live");
      this.stage.style.setProperty("--width", `${width / shown.sharpness}px`);
      this.sentence.textContent = shown.sentence;
      if (this.matrices.innerHTML !== shown.matrices) this.matrices.innerHTML = shown.matrices;
      if (wanted.grip && !this.next) this.show(shown.values);
      this.place(shown.grips, [width / shown.sharpness, height / shown.sharpness]);
    }

    // Put what can be taken hold of where the picture has it.
    place(grips, size) {
      this.size = size;
      const here = new Set(grips.map(({ name }) => name));
      for (const [name, { button }] of this.grips) button.hidden = !here.has(name);
      for (const grip of grips) {
        if (!this.grips.has(grip.name)) this.grips.set(grip.name, this.grip(grip));
        const own = this.grips.get(grip.name);
        own.grip = grip;
        own.button.style.left = `${(100 * grip.place[0]) / size[0]}%`;
        own.button.style.top = `${(100 * grip.place[1]) / size[1]}%`;
      }
    }

    grip({ name, label }) {
      const button = make("button", { type: "button", className: "explore-grip" });
      button.ariaLabel = `${label}: drag it, or move it with the arrow keys`;
      button.title = label;
      const own = { button };
      let from = null; // where the hand took hold
      button.addEventListener("pointerdown", (event) => {
        if (event.button) return;
        event.preventDefault();
        button.focus();
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
        const way = ARROWS[event.key];
        if (!way || event.altKey || event.ctrlKey || event.metaKey) return;
        event.preventDefault();
        // Keys that come before the picture add up from where the first one found it.
        if (this.held?.name !== name) this.held = { name, grip: own.grip, values: { ...this.values }, x: 0, y: 0 };
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
      this.want({ grip: grip.name, at, values });
    }
  }

  for (const span of document.querySelectorAll(".cvnotes-explore[data-explore]")) {
    const output = span.parentElement;
    const still = output.querySelector("img");
    if (still) new Exploration(JSON.parse(span.dataset.explore), output, still);
  }
})();
