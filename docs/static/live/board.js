"use strict";
// The page "A board on a screen": how large a pixel is comes from a card held to the screen, and the
// boards are the library's own drawings, in which a unit is a square.
(() => {
  const [LONG, SHORT, ROUND] = [85.6, 53.98, 3.18]; // mm: a card of ISO/IEC 7810, ID-1, and its corners
  const [LEAST, MOST] = [1.2, 10]; // CSS pixels per mm, of a large television and of a small telephone
  const KEPT = "cvnotes pixels per mm";
  const page = document.getElementById("screen-page");
  const $ = (selector) => page.querySelector(selector);
  const [slider, card, dialog, choice, said] = ["input", ".card", "dialog", "select", ".said"].map($);
  const boards = [...dialog.querySelectorAll("svg")];
  const squares = ({ viewBox: { baseVal: box } }) => [box.width, box.height];
  const cornersOf = (svg) => squares(svg).map((n) => n - 1);

  page.hidden = false;
  for (const svg of boards) {
    const [columns, rows] = cornersOf(svg);
    if (columns > rows) choice.add(new Option(`${columns}×${rows}`));
  }

  // Of the screen, along a CSS pixel: enlarging the page changes it, what is kept is the screen's.
  const pixels = () => devicePixelRatio * (visualViewport?.scale ?? 1);
  let perMM = (96 / 25.4) * devicePixelRatio; // what CSS believes; true of hardly any screen
  try {
    perMM = Number(localStorage.getItem(KEPT)) || perMM;
  } catch {} // nothing is kept here

  // The card lies, or stands where the page is too narrow; its size is told in pixels of the screen.
  function lay() {
    const room = page.clientWidth;
    const upright = room < 520;
    slider.min = Math.ceil(LEAST * LONG * pixels());
    slider.max = Math.floor(Math.min(MOST * LONG, (room * LONG) / (upright ? SHORT : LONG)) * pixels());
    slider.value = perMM * LONG;
    slider.setAttribute("aria-valuetext", `${perMM.toFixed(2)} pixels per millimetre`);
    const [long, short, round] = [LONG, SHORT, ROUND].map((mm) => `${(mm * perMM) / pixels()}px`);
    [card.style.width, card.style.height] = upright ? [short, long] : [long, short];
    card.style.borderRadius = round;
  }
  slider.oninput = () => {
    perMM = slider.value / LONG;
    try {
      localStorage.setItem(KEPT, perMM);
    } catch {}
    lay();
  };
  lay();
  addEventListener("resize", lay);

  // --- The board ---------------------------------------------------------------------------------

  // As large as the screen has room for, with half a square of white around it.
  function fit() {
    const bar = dialog.querySelector("p");
    const scale = devicePixelRatio;
    const [width, height] = [innerWidth * scale, (innerHeight - bar.offsetHeight) * scale];
    const wanted = choice.value.split("×").map(Number);
    if (height > width) wanted.reverse();
    for (const svg of boards) {
      const corners = cornersOf(svg);
      svg.style.display = String(corners) === String(wanted) ? "block" : "none";
      if (svg.style.display === "none") continue;
      const [columns, rows] = squares(svg);
      const side = Math.floor(Math.min(width / (columns + 1), height / (rows + 1)));
      svg.style.width = `${(side * columns) / scale}px`;
      svg.style.height = `${(side * rows) / scale}px`;
      svg.style.left = `${Math.floor((width - side * columns) / 2) / scale}px`;
      svg.style.top = `${Math.floor((height - side * rows) / 2) / scale}px`;
      tell((side / perMM).toFixed(2));
    }
  }

  function tell(mm) {
    const words = `${choice.value} inner corners, squares of ${mm} mm`;
    dialog.querySelector("span").textContent = words;
    const link = document.createElement("a");
    link.href = `your_camera.html?corners=${choice.value.replace("×", "x")}&square=${mm}`;
    link.textContent = "calibrate with it";
    said.replaceChildren(`The board had ${words}: `, link, ".");
  }

  let awake = null; // what keeps the screen from going dark
  $(".show").onclick = async () => {
    // First the full screen: of what lies above the page, the last to come is on top.
    const wishes = await Promise.allSettled([
      document.documentElement.requestFullscreen?.({ navigationUI: "hide" }),
      navigator.wakeLock?.request("screen"),
    ]); // not every browser can: without, the board is as large as the window
    dialog.showModal();
    fit();
    awake = wishes[1].value;
  };
  addEventListener("resize", () => dialog.open && fit());
  dialog.querySelector("button").onclick = () => dialog.close();
  dialog.onclose = () => {
    awake?.release();
    awake = null;
    if (document.fullscreenElement) document.exitFullscreen();
  };
  // Escape leaves the full screen, and so the board.
  document.addEventListener("fullscreenchange", () => {
    if (!document.fullscreenElement) dialog.close();
    else if (dialog.open) fit();
  });
})();
