"use strict";
// The page "Calibrate your camera": photographs go to a worker one by one, and what it says of each
// is shown at once. When the worker dies, another one takes over; the photographs stay here.
(() => {
  const COLOUR = "#D55E00"; // the course's, of what was measured
  const NOW = "#56B4E9"; // the course's, of what a picture shows
  const FRAME = 640; // px across: of the small copy in which the board is looked for
  const page = document.getElementById("camera-page");
  const $ = (selector) => page.querySelector(selector);
  const board = $("form.board");
  const said = $(".said");
  const bar = $("progress");
  const shots = new Map(); // name -> {file, item, state: new, looked at or lost}
  let counted = null; // the board's inner corners, once the photographs have told
  let worker = null;
  let waiting = null; // for the worker's answer
  let number = 0;
  let working = false;
  let again = false;

  page.hidden = false;
  const say = (text) => (said.textContent = text);

  // --- The worker ------------------------------------------------------------------------------

  function wake() {
    if (worker) return;
    worker = new Worker(new URL("_static/live/camera_worker.js", document.baseURI));
    worker.onmessage = ({ data }) => {
      if (data.say) return say(data.say);
      if (!waiting || data.id !== waiting.id) return;
      const { resolve } = waiting;
      waiting = null;
      resolve(data);
    };
    worker.onerror = (event) => end(event.message || "it could not be started");
  }

  function end(why, stale = false) {
    worker?.terminate();
    worker = null;
    for (const shot of shots.values()) shot.counted = false;
    const lost = waiting;
    waiting = null;
    lost?.resolve({ error: why, dead: true, stale });
  }

  // One question after the other, whoever asks.
  let last = Promise.resolve();
  function ask(...question) {
    return (last = last.then(() => asked(...question)));
  }

  async function asked(task, more = {}, moved = []) {
    if (!worker) {
      wake();
      if (task !== "board") {
        const answer = await asked("board");
        if (answer.error) return answer;
        for (const [name, shot] of shots) if (shot.state === "looked at" && name !== more.name) shot.state = "new";
      }
    }
    if (task === "board") more = boardAsked(); // of now, not of when it came into the queue
    const id = ++number;
    const answer = await new Promise((resolve) => {
      waiting = { id, resolve };
      worker.postMessage({ id, task, ...more }, moved);
    });
    if (answer.dead) end(answer.error);
    return answer;
  }

  // --- The board ---------------------------------------------------------------------------------

  const corners = () => (board.counted.checked ? counted : [+board.columns.value, +board.rows.value]);
  const boardAsked = () => ({ corners: corners(), square: +board.square.value });

  // Count the corners (no numbers), or ask for so many; `known` are those that were counted.
  function askFor(asked, known = null) {
    counted = known;
    board.counted.checked = !asked;
    for (const [i, field] of [board.columns, board.rows].entries()) {
      field.disabled = !asked;
      field.value = (asked ?? known)?.[i] ?? "";
    }
  }

  // With another board all photographs are looked at again; what is under way is not waited for.
  function another() {
    if (waiting) end("another board", true);
    else if (worker) ask("board");
    for (const shot of shots.values()) shot.state = "new";
    if (shots.size) work();
  }

  function know(found) {
    askFor(null, found);
    return ask("board");
  }

  // Count the corners, one photograph after the other until enough of them agree.
  async function count() {
    for (const [name, shot] of shots) {
      if (shot.counted || shot.state === "lost") continue;
      if (worker) say(`Counting the corners of the board: ${name}`);
      const answer = await askAbout("count", name, shot);
      if (answer.dead) return corners() ? null : count(); // what the others showed is lost with it
      shot.counted = true;
      shot.words = answer.error || answer.words;
      if (answer.corners) return know(answer.corners);
    }
    const most = await ask("most");
    if (most.corners) return know(most.corners);
    for (const shot of shots.values()) tell(shot);
    say(`No camera yet: ${most.error}.`);
  }

  // --- What is dropped ---------------------------------------------------------------------------

  function add(files) {
    for (const file of files) {
      let name = file.name.replaceAll("/", "_") || "photograph";
      const same = shots.get(name)?.file;
      if (same && same.size === file.size && same.lastModified === file.lastModified) continue;
      for (let n = 2; shots.has(name); n++) name = `${n} ${file.name}`;
      const item = document.createElement("li");
      item.innerHTML = "<canvas></canvas><strong></strong><span></span><p></p>";
      item.querySelector("strong").textContent = name;
      item.querySelector("span").textContent = "waits";
      const button = (text, told, onclick) => {
        const made = Object.assign(document.createElement("button"), { type: "button", textContent: text, onclick });
        made.setAttribute("aria-label", told);
        item.lastElementChild.append(made);
        return made;
      };
      button("Straighten", `Straighten ${name}, and keep it`, () => straighten(name)).className = "straighten";
      button("Leave out", `Leave ${name} out`, () => leaveOut(name));
      $(".shots").append(item);
      shots.set(name, { file, item, state: "new" });
    }
    $("h2.photographs").hidden = !shots.size;
    work();
  }

  // Take the lens out of a photograph, and hand it over.
  async function straighten(name) {
    say(`Straightening ${name} …`);
    const { error, png, words } = await askAbout("straighten", name, shots.get(name));
    if (error) return say(`${name} was not straightened: ${error}.`);
    const kept = `${name.replace(/\.[^.]*$/, "")}-straight.png`;
    handOver(kept, png);
    say(`${kept}: what a lens without distortion would have shown${words && `; ${words}`}.`);
  }

  async function leaveOut(name) {
    const shot = shots.get(name);
    shots.delete(name);
    shot.item.remove();
    if (!shots.size && counted) {
      askFor(null);
      if (worker) ask("board");
    }
    $(".files input, .drop input")?.focus();
    forgotten.push(name);
    work();
  }
  const forgotten = [];

  const next = () => [...shots].find(([, shot]) => shot.state === "new");

  // Do what is to be done, one thing after the other; what changes meanwhile is done after it.
  async function work() {
    again = true;
    if (working) return;
    working = true;
    while (again) {
      again = false;
      try {
        await workOnce();
      } catch (error) {
        say(`Something went wrong: ${error.message || error}`);
      }
    }
    working = false;
  }

  async function workOnce() {
    if (!board.reportValidity()) return;
    while (forgotten.length) if (worker) await ask("forget", { name: forgotten.pop() }); else forgotten.pop();
    if (!corners() && shots.size) await count();
    if (!corners()) {
      showCamera(false);
      return explain();
    }
    for (let found = next(); found; found = next()) {
      const [name, shot] = found;
      const all = [...shots.values()];
      const done = all.filter((each) => each.state !== "new").length;
      bar.hidden = false;
      bar.value = done / all.length;
      if (worker) say(`Photograph ${done + 1} of ${all.length}: ${name}`);
      await look(name, shot);
    }
    bar.hidden = true;
    if ([...shots.values()].some((shot) => shot.state === "looked at")) return calibrate();
    showCamera(false);
    explain();
    if (shots.size) say("None of the photographs could be looked at; each says why.");
  }

  // Ask about a photograph, which Python gets with the question.
  async function askAbout(task, name, shot) {
    let content;
    try {
      content = await shot.file.arrayBuffer();
    } catch {
      return { error: "the browser cannot read this file (was it moved or changed?)" };
    }
    const answer = await ask(task, { name, content }, [content]);
    if (answer.dead && !answer.stale) {
      shot.state = "lost";
      answer.error = `Python stopped at this photograph (${answer.error}); it is left out`;
    }
    return answer;
  }

  async function look(name, shot) {
    shot.state = "looked at";
    const answer = await askAbout("look", name, shot);
    show(shot, answer.error ? { words: answer.error } : answer);
  }

  function show(shot, { used = false, words, png, corners = [] }) {
    [shot.used, shot.words, shot.corners] = [used, words, corners];
    tell(shot, used ? "" : words);
    if (png) draw(shot.item.querySelector("canvas"), png, corners);
  }

  // Say below a photograph whether it is used, and how well it fits, or why it is not.
  function tell(shot, against = "", rms = "") {
    const used = shot.used && !against;
    shot.item.className = used ? "used" : "refused";
    const told = [used ? "✓ board found" : "✗ not used", against || shot.words, used && rms];
    const text = told.filter(Boolean).join(": ");
    shot.item.querySelector("span").textContent = text;
  }

  async function draw(canvas, png, corners) {
    const picture = await createImageBitmap(new Blob([png], { type: "image/png" }));
    [canvas.width, canvas.height] = [picture.width, picture.height];
    const pen = canvas.getContext("2d");
    pen.drawImage(picture, 0, 0);
    pen.strokeStyle = COLOUR;
    pen.lineWidth = 2;
    for (let i = 0; i < corners.length; i += 2) {
      pen.beginPath();
      pen.arc(corners[i] + 0.5, corners[i + 1] + 0.5, 4, 0, 7);
      pen.stroke();
    }
  }

  // --- The camera --------------------------------------------------------------------------------

  // What needs a camera is shown when there is one.
  function showCamera(known) {
    $(".result").hidden = !known;
    $(".shots").classList.toggle("of-a-camera", known);
  }

  async function calibrate() {
    const used = [...shots.values()].filter((shot) => shot.used).length;
    say(`Calibrating with ${used} photographs …`);
    const answer = await ask("calibrate", { lens: board.lens.value });
    again ||= Boolean(next()); // dropped meanwhile, or to be looked at again: it is done with these
    if (again) return;
    explain(answer);
    if (answer.error) {
      showCamera(false);
      if (answer.dead) {
        for (const shot of shots.values()) shot.state = "new";
        say(`Python stopped while it calibrated (${answer.error}). Change something to try again.`);
      } else say(`No camera yet: ${answer.error}.`.replace("..", "."));
      return;
    }
    say(`The camera is known from ${answer.used.length} of ${shots.size} photographs.`);
    for (const [name, shot] of shots)
      if (shot.used) tell(shot, answer.unlike[name], answer.rms[answer.used.indexOf(name)]);
    showCamera(true);
    $(".result h2").textContent = answer.title;
    $(".words").innerHTML = answer.words;
    $(".figures").innerHTML = answer.figures;
    keep(answer.files);
  }

  // Say once for all photographs with the same reason why they are not used, and offer the board
  // that they show instead.
  function explain({ reasons = [], instead } = {}) {
    const lines = reasons.map((sentence) => Object.assign(document.createElement("li"), { textContent: sentence }));
    $(".reasons").replaceChildren(...lines);
    const take = $(".take-count");
    take.hidden = !instead;
    if (!instead) return;
    take.textContent = `Take ${instead.join("×")}`;
    take.onclick = () => {
      take.hidden = true;
      said.focus();
      askFor(instead);
      another();
    };
  }

  const TYPES = { png: "image/png", pdf: "application/pdf", html: "text/html" };
  function linkTo(name, content) {
    const type = TYPES[name.split(".").at(-1)] ?? "text/plain";
    const href = URL.createObjectURL(new Blob([content], { type }));
    return Object.assign(document.createElement("a"), { href, download: name, textContent: name });
  }

  function handOver(name, content) {
    const link = linkTo(name, content);
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
  }

  let links = [];
  function keep(files) {
    links.forEach((link) => URL.revokeObjectURL(link.href));
    links = Object.entries(files).map(([name, content]) => linkTo(name, content));
    $(".files").replaceChildren("Keep: ", ...links.flatMap((link) => [link, " "]));
  }

  // --- The machine's own camera ------------------------------------------------------------------

  const live = $("section.live");
  const video = $("video");
  const webcam = $(".webcam");
  let stream = null;
  webcam.hidden = !navigator.mediaDevices?.getUserMedia;

  webcam.onclick = async () => {
    try {
      const wanted = { video: { facingMode: "environment", width: { ideal: 1920 } }, audio: false };
      stream = await navigator.mediaDevices.getUserMedia(wanted);
    } catch (error) {
      return say(`The machine's camera cannot be used: ${error.message || error.name}.`);
    }
    video.srcObject = stream;
    await video.play();
    live.hidden = false;
    webcam.hidden = true;
    cover();
    watch();
    $(".take").focus();
  };
  $(".stop").onclick = () => {
    stream?.getTracks().forEach((track) => track.stop());
    video.srcObject = stream = null;
    live.hidden = true;
    webcam.hidden = false;
    webcam.focus();
  };
  // The whole picture of now, as it would be kept.
  function picture() {
    const canvas = new OffscreenCanvas(video.videoWidth, video.videoHeight);
    canvas.getContext("2d").drawImage(video, 0, 0);
    return canvas;
  }

  async function take(canvas) {
    const blob = await canvas.convertToBlob({ type: "image/png" });
    const taken = [...shots.keys()].filter((name) => name.startsWith("camera ")).length + 1;
    add([new File([blob], `camera ${String(taken).padStart(2, "0")}.png`)]);
  }
  $(".take").onclick = () => take(picture());

  // A small grey copy, in which the board is looked for.
  function small(canvas) {
    const width = Math.min(FRAME, canvas.width);
    const height = Math.round((canvas.height * width) / canvas.width);
    const pen = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
    pen.drawImage(canvas, 0, 0, width, height);
    const { data } = pen.getImageData(0, 0, width, height);
    const grey = new Uint8Array(width * height);
    for (let i = 0; i < grey.length; i++)
      grey[i] = 0.299 * data[4 * i] + 0.587 * data[4 * i + 1] + 0.114 * data[4 * i + 2] + 0.5;
    return { grey: grey.buffer, size: [width, height], full: [canvas.width, canvas.height] };
  }

  // Frame after frame, as long as nothing else is done: Python says when a picture is taken.
  let seen = { corners: [], words: "", size: [1, 1] };
  async function watch() {
    const own = stream;
    while (own && stream === own) {
      await new Promise((resolve) => setTimeout(resolve, 100));
      if (stream !== own || working || !$(".by-itself").checked || !board.checkValidity()) continue;
      const canvas = picture();
      const frame = small(canvas);
      const answer = await ask("see", frame, [frame.grey]);
      if (answer.dead) return say(`Python stopped at the camera's picture (${answer.error}); take pictures by the button.`);
      if (answer.error || stream !== own) continue;
      seen = { ...answer, size: frame.size };
      if (answer.counted) await know(answer.counted);
      if (answer.take && !working) await take(canvas);
    }
  }

  // Over what the camera sees: the corners of all photographs so far, so that gaps are seen.
  function cover() {
    if (!stream) return;
    const canvas = $(".live canvas");
    [canvas.width, canvas.height] = [video.clientWidth, video.clientHeight];
    const pen = canvas.getContext("2d");
    pen.fillStyle = COLOUR;
    let count = 0;
    for (const { used, item, corners } of shots.values()) {
      if (!used) continue;
      count += 1;
      const small = item.querySelector("canvas");
      const scale = canvas.width / small.width;
      for (let i = 0; i < corners.length; i += 2) {
        pen.beginPath();
        pen.arc((corners[i] + 0.5) * scale, (corners[i + 1] + 0.5) * scale, 3, 0, 7);
        pen.fill();
      }
    }
    // and, as rings, where they are seen now
    const itself = $(".by-itself").checked;
    const scale = canvas.width / seen.size[0];
    pen.strokeStyle = NOW;
    pen.lineWidth = 2;
    for (let i = 0; itself && i < seen.corners.length; i += 2) {
      pen.beginPath();
      pen.arc((seen.corners[i] + 0.5) * scale, (seen.corners[i + 1] + 0.5) * scale, 4, 0, 7);
      pen.stroke();
    }
    const now = itself && seen.words ? ` Now: ${seen.words}.` : "";
    $(".live p").textContent = `${count} photographs with the board: dots are where corners were seen.${now}`;
    setTimeout(cover, 200);
  }

  // --- A board to print --------------------------------------------------------------------------

  $(".print").onclick = async () => {
    if (!board.reportValidity()) return;
    const [columns, rows] = corners() ?? [9, 6];
    say("Drawing the board …");
    const asked = { ...boardAsked(), corners: [columns, rows], paper: $("[name=paper]").value };
    const { error, content } = await ask("sheet", asked);
    if (error) return say(`No sheet: ${error}.`);
    const name = `board-${columns}x${rows}.pdf`;
    handOver(name, content);
    say(`${name}: print it at 100 %, check that both rulers are 100 mm, and glue it to something flat.`);
  };

  // --- Hands -------------------------------------------------------------------------------------

  $(".drop input").onchange = (event) => {
    add(event.target.files);
    event.target.value = "";
  };
  const area = $(".drop");
  for (const kind of ["dragenter", "dragover"])
    page.addEventListener(kind, (event) => {
      event.preventDefault();
      area.classList.add("over");
    });
  page.addEventListener("dragleave", () => area.classList.remove("over"));
  page.addEventListener("drop", (event) => {
    event.preventDefault();
    area.classList.remove("over");
    add(event.dataTransfer.files);
  });
  board.addEventListener("submit", (event) => event.preventDefault());
  board.addEventListener("change", async (event) => {
    if (event.target === board.counted) askFor(board.counted.checked ? null : counted ?? [9, 6]);
    if (event.target.name !== "lens") another();
    else if (shots.size) work();
  });
  // A page that shows a board on a screen leads here with its corners and squares.
  const given = new URLSearchParams(location.search);
  const [, ...named] = /^(\d+)x(\d+)$/.exec(given.get("corners")) ?? [];
  askFor(named.length ? named : null);
  board.square.value = given.get("square") ?? board.square.value;
  if (typeof WebAssembly !== "object" || typeof Worker !== "function" || !location.protocol.startsWith("http")) {
    say(
      location.protocol.startsWith("http")
        ? "This browser has no WebAssembly or no workers, which Python needs; cvnotes calibrate does the same."
        : "A page that is opened as a file may not run Python: serve the folder, python3 -m http.server, and open it from there.",
    );
    area.hidden = true;
  }
})();
