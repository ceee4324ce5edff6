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
  const shots = new Map(); // name -> {file, item, state}
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

  function end(why) {
    worker?.terminate();
    worker = null;
    const lost = waiting;
    waiting = null;
    lost?.resolve({ error: why, dead: true });
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
        const answer = await asked("board", size());
        if (answer.error) return answer;
        for (const [name, shot] of shots) if (shot.state === "looked at" && name !== more.name) shot.state = "new";
      }
    }
    const id = ++number;
    const answer = await new Promise((resolve) => {
      waiting = { id, resolve };
      worker.postMessage({ id, task, ...more }, moved);
    });
    if (answer.dead) end(answer.error);
    return answer;
  }

  const size = () => ({
    columns: +board.columns.value,
    rows: +board.rows.value,
    square: +board.square.value,
  });

  // --- What is dropped ---------------------------------------------------------------------------

  function add(files) {
    for (const file of files) {
      let name = file.name.replaceAll("/", "_") || "photograph";
      const same = shots.get(name)?.file;
      if (same && same.size === file.size && same.lastModified === file.lastModified) continue;
      for (let n = 2; shots.has(name); n++) name = `${n} ${file.name}`;
      const item = document.createElement("li");
      item.innerHTML = "<canvas></canvas><strong></strong><span></span>";
      item.querySelector("strong").textContent = name;
      item.querySelector("span").textContent = "waits";
      const remove = document.createElement("button");
      remove.type = "button";
      remove.textContent = "Leave out";
      remove.setAttribute("aria-label", `Leave ${name} out`);
      remove.onclick = () => leaveOut(name);
      item.append(remove);
      $(".shots").append(item);
      shots.set(name, { file, item, state: "new" });
    }
    $("h2.photographs").hidden = !shots.size;
    work();
  }

  async function leaveOut(name) {
    const shot = shots.get(name);
    shots.delete(name);
    shot.item.remove();
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
    for (let found = next(); found; found = next()) {
      const [name, shot] = found;
      const all = [...shots.values()];
      const done = all.filter((each) => each.state !== "new").length;
      bar.hidden = false;
      bar.value = done / all.length;
      if (worker) say(`Photograph ${done + 1} of ${all.length}: ${name}`);
      shot.state = "looked at";
      await look(name, shot);
    }
    bar.hidden = true;
    const used = [...shots.values()].filter((shot) => shot.used).length;
    if (used) await calibrate(used);
    else {
      $(".result").hidden = true;
      if (shots.size) say("The board was found in none of the photographs; each says why.");
    }
  }

  async function look(name, shot) {
    let content;
    try {
      content = await shot.file.arrayBuffer();
    } catch {
      return show(shot, { words: "the browser cannot read this file (was it moved or changed?)" });
    }
    const answer = await ask("look", { name, content }, [content]);
    if (answer.dead)
      return show(shot, { words: `Python stopped at this photograph (${answer.error}); it is left out` });
    show(shot, answer.error ? { words: answer.error } : answer);
  }

  function show(shot, { used = false, words, png, corners = [] }) {
    [shot.used, shot.words, shot.corners] = [used, words, corners];
    tell(shot, used ? "" : words);
    if (png) draw(shot.item.querySelector("canvas"), png, corners);
  }

  // Say below a photograph whether it is used, or why it is not.
  function tell(shot, against = "") {
    const used = shot.used && !against;
    shot.item.className = used ? "used" : "refused";
    const text = [used ? "✓ board found" : "✗ not used", against || shot.words].filter(Boolean).join(": ");
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

  async function calibrate(used) {
    say(`Calibrating with ${used} photographs …`);
    const answer = await ask("calibrate", { lens: board.lens.value });
    if (next()) return; // dropped meanwhile: it is done again with these
    if (answer.error) {
      $(".result").hidden = true;
      if (answer.dead) {
        for (const shot of shots.values()) shot.state = "new";
        say(`Python stopped while it calibrated (${answer.error}). Change something to try again.`);
      } else say(`No camera yet: ${answer.error}.`.replace("..", "."));
      return;
    }
    say(`The camera is known from ${answer.used.length} of ${shots.size} photographs.`);
    for (const [name, shot] of shots) if (shot.used) tell(shot, answer.unlike[name]);
    $(".result").hidden = false;
    const verdict = $(".verdict");
    verdict.textContent = answer.reliable
      ? "✓ The photographs determine this camera."
      : "✗ Not reliable: the photographs do not determine this camera. The sentences say what to do.";
    verdict.className = `verdict ${answer.reliable ? "good" : "bad"}`;
    $(".doubts").replaceChildren(
      ...answer.doubts.map((sentence) => Object.assign(document.createElement("li"), { textContent: sentence })),
    );
    $(".next").textContent = answer.next ? `Next photograph: ${answer.next}` : "";
    $(".result pre").textContent = answer.report;
    $(".table").textContent = answer.table;
    keep(answer.files);
  }

  let addresses = [];
  function keep(files) {
    addresses.forEach((address) => URL.revokeObjectURL(address));
    addresses = [];
    const links = Object.entries(files).map(([name, content]) => {
      const link = document.createElement("a");
      const type = name.endsWith(".png") ? "image/png" : "text/plain";
      link.href = URL.createObjectURL(new Blob([content], { type }));
      addresses.push(link.href);
      link.download = link.textContent = name;
      if (name === "coverage.png") $(".coverage").src = link.href;
      if (name === "residuals.png") $(".residuals").src = link.href;
      return link;
    });
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
    if (event.target.name !== "lens") {
      // another board: all photographs are looked at again, by a worker that knows it
      end("another board");
      for (const shot of shots.values()) shot.state = "new";
    }
    if (shots.size) work();
  });
  if (typeof WebAssembly !== "object" || typeof Worker !== "function" || !location.protocol.startsWith("http")) {
    say(
      location.protocol.startsWith("http")
        ? "This browser has no WebAssembly or no workers, which Python needs; cvnotes calibrate does the same."
        : "A page that is opened as a file may not run Python: serve the folder, python3 -m http.server, and open it from there.",
    );
    area.hidden = true;
  }
})();
