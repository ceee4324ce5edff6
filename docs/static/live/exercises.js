"use strict";
// Each exercise of the page has a box to write in. What is written stays in this browser's storage
// and is run, when asked, by Python in the worker; a cell that never ends is ended with it.
(() => {
  const SECONDS = 10; // for one check, after Python is awake
  const CALL = /\n*^(check\("(\w+)",.*\))[ \t]*\n*$/m;
  const PREFIX = `cvnotes ${live.ROOT.pathname} `;
  const page = location.pathname.split("/").at(-1).replace(/\.html$/, "");
  const boxes = [];
  let hints = {};

  // --- What is kept -----------------------------------------------------------------------------

  const kept = (() => {
    try {
      localStorage.setItem(`${PREFIX}?`, "");
      localStorage.removeItem(`${PREFIX}?`);
      return localStorage;
    } catch {
      return null;
    }
  })();

  // Keep a text, or forget it; tell whether that was possible.
  function keep(name, text) {
    try {
      if (text === null) kept.removeItem(PREFIX + name);
      else kept.setItem(PREFIX + name, text);
      return true;
    } catch {
      return false;
    }
  }

  function solved() {
    try {
      const names = JSON.parse(kept?.getItem(`${PREFIX}solved`) ?? "[]");
      return Array.isArray(names) ? names.map(String) : [];
    } catch {
      return [];
    }
  }

  // --- Writing ----------------------------------------------------------------------------------

  function insert(area, text) {
    // The one way that undo knows of; where it is missing, without undo.
    if (!document.execCommand("insertText", false, text)) {
      area.setRangeText(text, area.selectionStart, area.selectionEnd, "end");
      area.dispatchEvent(new Event("input", { bubbles: true }));
    }
  }

  // Tab indents, Shift+Tab takes back, Enter keeps the indentation; after Escape, Tab goes on.
  function typing(area) {
    let leaving = false;
    area.addEventListener("blur", () => (leaving = false));
    area.addEventListener("keydown", (event) => {
      const { selectionStart: start, selectionEnd: end, value } = area;
      const first = value.lastIndexOf("\n", start - 1) + 1;
      if (event.key === "Escape") leaving = true;
      else if (event.key === "Tab" && !leaving && !event.ctrlKey && !event.altKey) {
        event.preventDefault();
        if (start === end && !event.shiftKey) return insert(area, " ".repeat(4 - ((start - first) % 4)));
        const lines = value.slice(first, end).split("\n");
        const moved = lines.map((line) => (event.shiftKey ? line.replace(/^ {1,4}/, "") : line && `    ${line}`));
        area.setSelectionRange(first, end);
        insert(area, moved.join("\n"));
        if (start !== end) area.setSelectionRange(first, first + moved.join("\n").length);
      } else if (event.key === "Enter" && !event.ctrlKey && !event.shiftKey && !event.isComposing) {
        event.preventDefault();
        const line = value.slice(first, start);
        insert(area, `\n${line.match(/^ */)[0]}${/:\s*$/.test(line) ? "    " : ""}`);
      } else if (!["Shift", "Control", "Alt"].includes(event.key)) leaving = false;
    });
  }

  // --- A box ------------------------------------------------------------------------------------

  class Box {
    constructor(cell, source) {
      const [, call, name] = source.match(CALL);
      this.name = name;
      // A call with the student's id is the student's to change.
      this.call = call.includes("student=") ? "" : call;
      this.stub = this.call ? source.replace(CALL, "") : source.trimEnd();
      this.key = `${page} ${name}`;
      this.area = make("textarea", {
        id: `answer-${name}`, className: "exercise-answer", spellcheck: false, autocapitalize: "off",
        autocomplete: "off", wrap: "off", value: kept?.getItem(PREFIX + this.key) ?? this.stub,
      });
      this.area.setAttribute("aria-describedby", `keys-${name}`);
      this.area.addEventListener("input", () => this.written());
      typing(this.area);
      this.area.addEventListener("keydown", (event) => {
        if (event.key !== "Enter" || !(event.ctrlKey || event.shiftKey || event.metaKey)) return;
        event.preventDefault();
        this.check();
      });
      this.state = make("p", { className: "exercise-state", role: "status" });
      this.report = make("div", { className: "exercise-report", role: "status" });
      this.help = make("div", { className: "exercise-help", role: "status" });
      this.buttons = [
        this.button("Check", () => this.check(), "primary"),
        this.button("Hint", () => this.hint()),
        this.button("Solution", () => this.solution()),
        this.button("Start again", () => this.startAgain()),
        this.button("Save as a notebook", () => save(this)),
      ];
      const label = make("label", { htmlFor: this.area.id, textContent: `Your answer: ${name} ` });
      this.mark = make("span", { className: "exercise-mark" });
      label.append(this.mark);
      const keys = make("p", {
        id: `keys-${name}`, className: "exercise-keys",
        textContent: "Ctrl+Enter checks. Tab indents; Esc, then Tab, leaves the box.",
      });
      const paper = make("pre", { className: "exercise-call", textContent: this.call });
      const parts = [label, this.area, paper, keys, make("div", { className: "exercise-buttons" }, ...this.buttons)];
      const group = make("div", { className: "exercise", role: "group", ariaLabel: `Exercise ${name}` });
      group.append(...parts, this.state, this.report, this.help);
      cell.querySelector(".cell_input").replaceWith(group);
      // The pictures of the cell stay; that nothing is solved yet is said here from now on.
      for (const output of cell.querySelectorAll(".cell_output > *"))
        if (!output.querySelector("img, canvas")) output.remove();
      this.fit();
      live.whenSeen(this.area, () => live.ask({ kind: "wake" }));
    }

    button(text, act, kind = "") {
      const button = make("button", { type: "button", textContent: text, className: `live-button ${kind}` });
      button.addEventListener("click", act);
      return button;
    }

    get source() {
      return this.call ? `${this.area.value.trimEnd()}\n\n\n${this.call}` : this.area.value;
    }

    fit() {
      this.area.rows = Math.min(Math.max(this.area.value.split("\n").length + 1, 4), 30);
      this.mark.textContent = solved().includes(this.name) ? "✓ solved" : "";
    }

    written() {
      this.fit();
      const changed = this.area.value !== this.stub;
      if (!keep(this.key, changed ? this.area.value : null))
        this.say("This browser keeps nothing of what you write: save it as a notebook before you leave the page.");
    }

    // Take what another tab wrote, unless somebody writes here.
    elsewhere(text) {
      if (document.activeElement !== this.area) {
        this.area.value = text ?? this.stub;
        this.fit();
      } else this.say("Another tab has written into this box too; what is kept is what was written last.");
    }

    say(text) {
      this.state.textContent = text;
    }

    // Ask Python, with the buttons at rest meanwhile; gives nothing if that fails, and says why.
    async ask(question, heard = {}) {
      for (const button of this.buttons.slice(0, 3)) button.disabled = true;
      try {
        const answer = await live.ask({ name: this.name, ...question }, { say: (text) => this.say(text), ...heard });
        this.say("");
        return answer;
      } catch (error) {
        this.say(error.message);
        return null;
      } finally {
        for (const button of this.buttons) button.disabled = false;
      }
    }

    async check() {
      if (this.buttons[0].disabled) return;
      let late = "";
      let clock = 0;
      const before = boxes.slice(0, boxes.indexOf(this)).map((box) => box.area.value);
      const question = { exercise: this.name, cell: this.source, before, cells: imports, solved: solved() };
      const code = [question.cell, ...before].join("\n");
      const started = (words) => {
        this.say("checking …");
        late = words;
        clock = setTimeout(() => live.end(""), 1000 * SECONDS);
      };
      const asked = { kind: "check", question: JSON.stringify(question), code, seconds: SECONDS };
      const answer = await this.ask(asked, { started });
      clearTimeout(clock);
      if (answer) {
        const { html, solved: now } = JSON.parse(answer.rest);
        this.report.innerHTML = html;
        keep("solved", JSON.stringify([...new Set([...solved(), ...now])].sort()));
        for (const box of boxes) box.fit();
      } else if (late && !this.state.textContent) this.report.innerHTML = late;
    }

    async hint() {
      const given = hints[this.name] ?? 0;
      const answer = await this.ask({ kind: "hint", given });
      if (!answer) return;
      hints = { ...hints, [this.name]: given + 1 };
      this.help.innerHTML = answer.html;
    }

    async solution() {
      const answer = await this.ask({ kind: "solution" });
      if (answer) this.help.innerHTML = answer.html;
    }

    startAgain() {
      this.area.focus();
      this.area.select();
      insert(this.area, this.stub); // undo brings back what was there
      for (const part of [this.report, this.help, this.state]) part.replaceChildren();
    }
  }

  // --- As a notebook ----------------------------------------------------------------------------

  function lines(text) {
    return text.split(/(?<=\n)/);
  }

  // The page's own notebook, with what was written in its cells; `cvnotes grade` takes it.
  async function save(box) {
    try {
      const answer = await fetch(new URL(`_sources/notebooks/${page}.ipynb`, live.ROOT));
      if (!answer.ok) throw new Error(`the site has no ${page}.ipynb`);
      const notebook = await answer.json();
      for (const cell of notebook.cells) {
        const own = [].concat(cell.source).join("").match(CALL);
        const written = own && boxes.find(({ name }) => name === own[2]);
        if (cell.cell_type !== "code" || !written) continue;
        cell.source = lines(written.source);
        [cell.outputs, cell.execution_count] = [[], null];
      }
      const text = JSON.stringify(notebook, null, 1);
      const href = URL.createObjectURL(new Blob([`${text}\n`], { type: "application/x-ipynb+json" }));
      make("a", { href, download: `${page}.ipynb` }).click();
      setTimeout(() => URL.revokeObjectURL(href), 10_000);
      box.say(`Saved as ${page}.ipynb, with all that is written on this page.`);
    } catch (error) {
      box.say(`The notebook could not be saved: ${error.message}.`);
    }
  }

  // --- The page ---------------------------------------------------------------------------------

  const cells = [...document.querySelectorAll("div.cell, div.front-answer")];
  const sources = cells.map((cell) => cell.querySelector(".cell_input pre")?.textContent ?? "");
  const imports = sources.filter((source) => /^(from|import) /m.test(source));
  cells.forEach((cell, i) => CALL.test(sources[i]) && boxes.push(new Box(cell, sources[i])));
  if (!kept && boxes.length)
    boxes[0].say("This browser keeps nothing of what you write: save it as a notebook before you leave the page.");
  // A link may lead to an exercise: one can write at once.
  const write = () =>
    boxes.find(({ area }) => area.closest(".cell:target"))?.area.focus({ preventScroll: true });
  if (document.readyState === "complete") write();
  else addEventListener("load", write); // the browser has gone there, and taken the focus along
  addEventListener("storage", ({ key, newValue }) => {
    for (const box of boxes) {
      if (key === PREFIX + box.key) box.elsewhere(newValue);
      if (key === `${PREFIX}solved`) box.fit();
    }
  });
})();
