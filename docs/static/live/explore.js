"use strict";
// The page's explorations follow the hand: sliders, and what can be taken hold of in the picture.
// In place of the output of a cell come native controls around its still. While one picture is drawn,
// of all that is wanted meanwhile only the newest is kept.
(() => {
  const NARROW = 600; // px of the page: narrower, and panels come below each other
  const REST = 250; // ms without a touch, after which the picture is drawn as sharp as the screen
  let count = 0;

  function digits({ step }) {
    return (String(step).split(".")[1] ?? "").length;
  }

  function written(setting, value) {
    return setting.choice || setting.names?.length ? "" : value.toFixed(digits(setting)).replace("-", "−");
  }

  function cellsUpTo(output) {
    const cells = [...document.querySelectorAll("div.cell")];
    const here = cells.indexOf(output.closest("div.cell"));
    return cells.slice(0, here + 1).map((cell) => cell.querySelector(".cell_input pre")?.textContent ?? "");
  }

  class Exploration {
    constructor(told, output, still) {
      this.told = told;
      this.place = { output, still };
      // Points that are pulled ask a function of the page's cells: these are told, too.
      if (told.name === "pull_points") this.cells = told.cells ?? cellsUpTo(output);
      this.values = { ...told.values };
      this.busy = false;
      this.next = null;
      this.number = ++count;
      this.state = make("p", { className: "explore-state", role: "status" });
      this.sentence = make("p", { className: "explore-sentence", role: "status", textContent: told.sentence });
      this.matrices = make("div", { className: "explore-matrices", innerHTML: told.matrices });
      this.canvas = make("canvas", { hidden: true, role: "img" });
      const picture = still.closest("picture");
      const at = picture && matchMedia(picture.querySelector("source").media).matches ? told.narrow : told;
      this.stage = make("div", { className: "explore-stage" }, picture ?? still, this.canvas);
      this.stage.classList.toggle("of-this-width", !!picture);
      this.stage.style.setProperty("--width", `${at.size[0]}px`);
      this.grips = new CvnotesGrips(this.stage, (wanted) => this.want(wanted));
      this.inputs = new Map();
      const controls = make("div", { className: "explore-controls" });
      // What can be pulled in the picture is folded; a still of before says nothing of that.
      const folded = make("div", { className: "explore-folded" });
      for (const setting of told.settings)
        (told.folded?.includes(setting.name) ? folded : controls).append(this.control(setting));
      if (folded.children.length)
        controls.append(make("details", {}, make("summary", { textContent: "sliders" }), folded));
      const reset = make("button", { type: "button", textContent: "Reset", className: "live-button" });
      reset.addEventListener("click", () => this.reset());
      // Where the notebook has a place for a photograph of one's own, the page has a button.
      controls.append(reset, ...(this.cells?.at(-1)?.includes("my_photo") ? this.ownPhotograph() : []));
      const name = `Exploration: ${told.name}`;
      const parts = [this.stage, this.sentence, this.state, this.matrices, controls];
      output.replaceChildren(make("div", { className: "explore", role: "group", ariaLabel: name }, ...parts));
      this.grips.place(at.grips, at.size, this.values);
      // Rooms and boards are computed once: the first pull shall find them.
      live.whenSeen(this.stage, () => live.ask(this.cells ? { kind: "wake" } : this.question(this.wanted({}))));
    }

    control(setting) {
      const id = `explore-${this.number}-${setting.name}`;
      const label = make("label", { htmlFor: id, textContent: setting.label, title: setting.help });
      if (setting.tint) label.style.cssText = `background: ${setting.tint}; color: #000`;
      const value = this.values[setting.name];
      const number = make("output", { textContent: written(setting, value) });
      number.setAttribute("for", id);
      const { low: min, high: max, step, names = [] } = setting; // a still of before has no names
      const kind = setting.choice ? { type: "checkbox", checked: !!value } : { type: "range", min, max, step };
      const options = names.map((name, k) => make("option", { value: min + k, textContent: name }));
      const input = names.length
        ? make("select", { id, title: setting.help }, ...options)
        : make("input", { id, title: setting.help, ...kind });
      if (!setting.choice) input.value = value;
      input.addEventListener("input", () => {
        this.values[setting.name] = setting.choice ? Number(input.checked) : Number(input.value);
        number.textContent = written(setting, this.values[setting.name]);
        this.want({});
      });
      this.inputs.set(setting.name, { setting, input, number });
      return make("div", { className: "explore-control" }, label, input, number);
    }

    // A photograph of the reader's own takes the place of the picture. It stays on this machine.
    ownPhotograph() {
      const file = make("input", { type: "file", accept: "image/*", hidden: true });
      const what = { textContent: "Your own photograph", title: "It stays on this machine" };
      const button = make("button", { type: "button", className: "live-button", ...what });
      button.addEventListener("click", () => file.click());
      file.addEventListener("change", async () => {
        const [given] = file.files;
        if (!given) return;
        try {
          const bytes = await given.arrayBuffer();
          const question = { kind: "photograph", cells: this.cells, name: given.name, bytes };
          const { rest, photo } = await live.ask(question, { say: (text) => this.say(text) });
          const { output, still } = this.place;
          new Exploration({ ...JSON.parse(rest), cells: this.cells, photo }, output, still).want({});
        } catch (error) {
          this.say(error.message);
        }
      });
      return [button, file];
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

    wanted(change) {
      const { name, camera, board, photo } = this.told;
      return { name, camera, board, photo, cells: this.cells, values: { ...this.values }, narrow: this.narrow, sharpness: 1, ...change };
    }

    question(wanted) {
      return { kind: "explore", question: JSON.stringify(wanted) };
    }

    want(change) {
      clearTimeout(this.rest);
      const wanted = this.wanted(change);
      if (this.busy) this.next = wanted;
      else this.draw(wanted);
    }

    async draw(wanted) {
      this.busy = true;
      try {
        const say = (text) => this.say(text);
        const { pixels, rest } = await live.ask(this.question(wanted), { say });
        this.paint(pixels, JSON.parse(rest), wanted);
        this.say("");
      } catch (error) {
        this.say(error.message);
      }
      this.busy = false;
      const next = this.next;
      this.next = null;
      if (next) this.draw(next);
      else if (wanted.sharpness < devicePixelRatio) {
        this.grips.rest();
        this.rest = setTimeout(() => this.want({ sharpness: Math.min(Math.ceil(devicePixelRatio), 2) }), REST);
      } else this.grips.rest();
    }

    say(text) {
      if (this.state.textContent !== text) this.state.textContent = text;
    }

    paint(pixels, shown, wanted) {
      const [width, height] = shown.size;
      // A low picture leaves room for sliders: it stays in sight while they pass below it.
      this.stage.classList.toggle("low", this.stage.clientWidth * height < 0.5 * innerHeight * width);
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
      this.grips.place(shown.grips, [width / shown.sharpness, height / shown.sharpness], this.values);
    }
  }

  for (const span of document.querySelectorAll(".cvnotes-explore[data-explore]")) {
    const output = span.parentElement;
    const still = output.querySelector("img");
    if (still) new Exploration(JSON.parse(span.dataset.explore), output, still);
  }
})();
