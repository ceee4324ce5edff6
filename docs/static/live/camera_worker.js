"use strict";
// Finds boards and calibrates, in the worker of the page "Calibrate your camera": see camera.js.
importScripts("python.js");
const say = (text) => postMessage({ say: text });
const ready = wakePython({ packages: ["numpy", "scipy", "pillow", "tqdm"], say }).then((python) => {
  python.FS.mkdirTree("/photographs");
  python.runPython("from cvnotes.commands.dropped import Dropped");
  python.runPython("from cvnotes.commands.watching import Watch");
  return python;
});
let dropped = null;
let watch = null;

const tasks = {
  board(python, { columns, rows, square }) {
    dropped?.destroy();
    watch?.destroy();
    dropped = python.globals.get("Dropped")(columns, rows, square);
    watch = python.globals.get("Watch")(dropped);
    return {};
  },
  look(python, { name, content }) {
    const path = `/photographs/${name}`;
    python.FS.writeFile(path, new Uint8Array(content));
    try {
      return plain(dropped.look(path));
    } finally {
      python.FS.unlink(path);
    }
  },
  forget(_, { name }) {
    dropped.forget(name);
    return {};
  },
  see(python, { grey, size, full }) {
    const given = [new Uint8Array(grey), size, full].map((each) => python.toPy(each));
    const seen = plain(watch.see(...given));
    given.forEach((each) => each.destroy());
    return seen;
  },
  calibrate: (_, { lens }) => plain(dropped.calibrate(lens)),
};

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
