"use strict";
// Finds boards and calibrates, in the worker of the page "Calibrate your camera": see camera.js.
importScripts("python.js");
const say = (text) => postMessage({ say: text });
const ready = wakePython({ packages: ["numpy", "scipy", "pillow", "tqdm"], say }).then((python) => {
  python.FS.mkdirTree("/photographs");
  python.runPython("from cvnotes.commands.dropped import Dropped, Unknown, sheet");
  python.runPython("from cvnotes.commands.watching import Watch");
  return python;
});
let unknown = null; // the board whose corners are to be counted,
let dropped = null; // or the photographs of one that is known,
let watch = null; // and what looks for it in the machine's camera

const tasks = {
  count: (python, { name, content }) => withFile(python, name, content, (path) => unknown.count(path)),
  most: () => ({ corners: plain(unknown.counting.most) }),
  board(python, { corners, square }) {
    for (const each of [unknown, dropped, watch]) each?.destroy();
    unknown = dropped = watch = null;
    if (corners) {
      dropped = python.globals.get("Dropped")(...corners, square);
      watch = python.globals.get("Watch")(dropped);
    } else unknown = python.globals.get("Unknown")();
    return {};
  },
  look: (python, { name, content }) => withFile(python, name, content, (path) => dropped.look(path)),
  straighten: (python, { name, content }) => withFile(python, name, content, (path) => dropped.straighten(path)),
  forget(_, { name }) {
    dropped?.forget(name);
    return {};
  },
  see(python, { grey, size, full }) {
    const given = [new Uint8Array(grey), size, full].map((each) => python.toPy(each));
    const seen = plain(watch ? watch.see(...given) : unknown.see(...given.slice(0, 2)));
    given.forEach((each) => each.destroy());
    return seen;
  },
  calibrate: (_, { lens }) => plain(dropped.calibrate(lens)),
  sheet(python, { corners: [columns, rows], square, paper }) {
    const pdf = python.globals.get("sheet")(columns, rows, square, paper);
    const content = pdf.toJs();
    pdf.destroy();
    return { content };
  },
};

// Do something with a file that Python can open as long as that takes.
function withFile(python, name, content, doing) {
  const path = `/photographs/${name}`;
  python.FS.writeFile(path, new Uint8Array(content));
  try {
    return plain(doing(path));
  } finally {
    python.FS.unlink(path);
  }
}

function plain(proxy) {
  const object = proxy.toJs({ dict_converter: Object.fromEntries });
  proxy.destroy();
  return object;
}

onmessage = async ({ data }) => {
  try {
    postMessage({ id: data.id, ...tasks[data.task](await ready, data) });
  } catch (error) {
    const words = String(error.message || error).trim().split("\n").at(-1);
    // An error of Python's own ends the task; anything else has ended Python.
    const taught = error.name === "PythonError";
    postMessage({ id: data.id, error: words.replace(/^[\w.]+(Error|NotFound|Warning): /, ""), dead: !taught });
  }
};
