// The panels of a wide figure come one below the other where the page is narrow: data-panels has
// the rectangle of each in the stored picture (tools/site_figures.py).
(() => {
  function stack(image) {
    if (image.previousElementSibling?.className === "panels") return;
    const panels = document.createElement("div");
    panels.className = "panels";
    panels.setAttribute("role", "img");
    panels.setAttribute("aria-label", image.alt);
    const rectangles = image.dataset.panels.split(";").map((one) => one.split(" ").map(Number));
    const widest = Math.max(...rectangles.map(([, , width]) => width));
    for (const [left, top, width, height] of rectangles) {
      const panel = document.createElement("canvas");
      [panel.width, panel.height] = [width, height];
      panel.getContext("2d").drawImage(image, -left, -top);
      panel.style.width = `${(100 * width) / widest}%`; // all to one scale
      panels.append(panel);
    }
    image.before(panels);
  }

  // (a figure is fetched when it comes into sight)
  function stackAll() {
    for (const image of document.querySelectorAll("img[data-panels]"))
      if (image.complete && image.naturalWidth) stack(image);
      else image.addEventListener("load", () => stack(image), { once: true });
  }

  const narrow = matchMedia("(max-width: 40rem)");
  addEventListener("DOMContentLoaded", () => narrow.matches && stackAll());
  narrow.addEventListener("change", () => narrow.matches && stackAll());
})();

// A line may break between a formula and the full stop behind it, or the bracket before it: browsers
// ask no word joiner there, so the two are held together.
addEventListener("DOMContentLoaded", () => {
  for (const formula of document.querySelectorAll("span.math")) {
    const [before, behind] = [formula.previousSibling, formula.nextSibling];
    const opens = /[(“‘]$/.test(before?.data);
    const closing = /^[.,;:!?)’”]+/.exec(behind?.data);
    if (!opens && !closing) continue;
    const held = document.createElement("span");
    held.style.whiteSpace = "nowrap";
    formula.before(held);
    if (opens) held.append(before.splitText(before.length - 1));
    held.append(formula);
    if (closing) behind.splitText(closing[0].length);
    if (closing) held.append(behind);
  }
});

// What a paragraph is for, its first words say: they have a colour (site.css).
addEventListener("DOMContentLoaded", () => {
  const kinds = {
    Careful: "careful", Verify: "verify", Change: "try", From: "try", Guess: "try",
    Time: "meta", You: "meta", Notes: "meta", // at the head of a chapter
  };
  for (const first of document.querySelectorAll(".bd-article:has(.cell) p > strong:first-child")) {
    const kind = first.previousSibling ? null : kinds[/^\w+/.exec(first.textContent)?.[0]];
    if (kind) first.classList.add("aim", kind);
  }
});

// What the theme and docutils say of themselves, so that every reader program understands it.
addEventListener("load", () => {
  for (const button of document.querySelectorAll(".search-button-field")) button.removeAttribute("aria-label");
  for (const fold of document.querySelectorAll(".bd-links summary"))
    fold.ariaLabel = `Pages of ${fold.closest("li").querySelector("a").textContent.trim()}`;
  for (const entry of document.querySelectorAll('[role="list"] > [role="doc-biblioentry"]'))
    entry.setAttribute("role", "listitem");
  // A formula that is wider than the page is scrolled by the keyboard too.
  for (const formula of document.querySelectorAll("div.math"))
    if (formula.scrollWidth > formula.clientWidth + 1) formula.tabIndex = 0;
});

// What is folded: plumbing (the tag hide-input) and answers. A button opens all of it, paper shows
// all of it, and on a narrow page the rest of the code is folded too, but for exercises.
(() => {
  const all = () => [...document.querySelectorAll(".bd-article details:not(.explore details)")];

  function fold(input) {
    if (input.closest("details") || /^check\(/m.test(input.textContent)) return;
    const folded = document.createElement("details");
    folded.className = "admonition hide above-input";
    folded.innerHTML =
      '<summary><p class="collapsed admonition-title">Show the code</p>' +
      '<p class="expanded admonition-title">Hide the code</p></summary>';
    input.replaceWith(folded);
    folded.append(input);
  }

  function offer() {
    const button = document.createElement("button");
    const say = (open) => (button.textContent = open ? "Close them again" : "Open all answers and code");
    button.type = "button";
    button.className = "open-all";
    button.addEventListener("click", () => {
      const open = all().some((folded) => !folded.open);
      for (const folded of all()) folded.open = open;
      say(open);
    });
    say(false);
    let line = document.querySelector(".bd-article p.run");
    if (!line) {
      line = document.createElement("p");
      (document.querySelector(".bd-article h1 + blockquote") ?? document.querySelector(".bd-article h1")).after(line);
    }
    line.append(button);
  }

  addEventListener("DOMContentLoaded", () => {
    const cells = document.querySelectorAll(".bd-article div.cell div.cell_input");
    if (matchMedia("(max-width: 40rem)").matches) cells.forEach(fold);
    if (cells.length && all().length) offer();
  });
  let closed = [];
  addEventListener("beforeprint", () => {
    closed = all().filter((folded) => !folded.open);
    for (const folded of closed) folded.open = true;
  });
  addEventListener("afterprint", () => closed.forEach((folded) => (folded.open = false)));
})();

// Figures are fetched when they come into sight; on paper all are: so, where the screen is wide and
// nobody saves data, the others follow when there is nothing else to do.
addEventListener("load", () => {
  const fetchAll = () => {
    for (const image of document.querySelectorAll("img[loading=lazy]")) image.loading = "eager";
  };
  addEventListener("beforeprint", fetchAll);
  if (!navigator.connection?.saveData && matchMedia("(min-width: 60rem)").matches) setTimeout(fetchAll, 1500);
});

// A guess is written where it is asked, kept in this browser, and stands beside the answer below.
addEventListener("DOMContentLoaded", () => {
  const PREFIX = `cvnotes ${new URL(document.documentElement.dataset.content_root, location).pathname} guess `;
  const ASKED = /^guess\("([^"]+)", \.\.\., "((?:[^"\\]|\\.)*)"/m;
  const TOLD = /It is (.*)\. \(You had not guessed\.\)/;
  const answers = {}; // by name: the text, and what it says as long as nobody has guessed

  function kept(name, guess) {
    try {
      if (guess !== undefined) localStorage.setItem(PREFIX + name, guess);
      return localStorage.getItem(PREFIX + name);
    } catch {
      return guess ?? null; // this page alone knows it
    }
  }

  function verdict(guess, truth) {
    const [, number, unit] = /^([-−\d.,]*\d)?(.*)$/.exec(truth);
    const off = Number(guess.replace(",", ".")) - Number(number?.replace("−", "-").replace(",", ""));
    const mine = Number.isNaN(off) ? guess : guess + unit;
    const far = off ? `Off by ${Number(Math.abs(off).toPrecision(3))}${unit}.` : "Exactly.";
    const same = guess.trim().toLowerCase() === truth.toLowerCase();
    return `You guessed ${mine}; it is ${truth}. ${Number.isNaN(off) ? (same ? "Right." : "Now you know.") : far}`;
  }

  function tell(name, guess) {
    if (!guess || !answers[name]) return;
    const { text, before } = answers[name];
    text.data = before.replace(TOLD, (_, truth) => verdict(guess, truth));
  }

  function ask(cell, name, question) {
    const form = document.createElement("form");
    form.className = "guess";
    const label = form.appendChild(document.createElement("label"));
    label.textContent = `Your guess: ${question} `;
    const field = label.appendChild(document.createElement("input"));
    Object.assign(field, { maxLength: 40, autocomplete: "off", value: kept(name) ?? "" });
    const button = form.appendChild(document.createElement("button"));
    button.textContent = "Keep it";
    const said = form.appendChild(document.createElement("output"));
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      const guess = field.value.trim();
      said.textContent = guess ? "Kept. The answer comes further down." : "Write a number, or a word.";
      if (guess) tell(name, kept(name, guess));
    });
    const dots = [...cell.querySelectorAll(".cell_output em")].find((em) => em.textContent.startsWith("Your guess?"));
    if (dots) dots.closest("p").replaceWith(form);
    else cell.append(form);
    const alone = /^guess\(.*\)$/.test(cell.querySelector(".cell_input").textContent.trim());
    cell.querySelector(".cell_input").hidden = alone;
  }

  for (const cell of document.querySelectorAll("div.cell")) {
    const code = cell.querySelector(".cell_input")?.textContent ?? "";
    const [, asked, question] = ASKED.exec(code) ?? [];
    const told = /\banswer\("([^"]+)"/.exec(code)?.[1];
    if (asked) ask(cell, asked, question.replaceAll("\\", ""));
    const words = told && document.createTreeWalker(cell, NodeFilter.SHOW_TEXT);
    while (words?.nextNode())
      if (TOLD.test(words.currentNode.data)) answers[told] = { text: words.currentNode, before: words.currentNode.data };
  }
  for (const name of Object.keys(answers)) tell(name, kept(name));
});
