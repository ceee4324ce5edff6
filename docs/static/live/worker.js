"use strict";
// The course's own Python beside a page: explorations that follow the hand, exercises that answer.
// A question is {id, kind, …}; its answer {id, …} or {id, error}. page.js is the other end.
importScripts("python.js");

const LETTERS = "/letters.ttf"; // what explorations write with: matplotlib's type, without matplotlib
const LARGE = /\b(scipy|matplotlib)\b/g; // fetched only for who imports them
const loaded = new Set();
let python = null;

const ready = (async () => {
  const packages = ["numpy", "pillow"];
  python = await wakePython({ packages, say: (text) => postMessage({ say: text }) });
  const letters = await fetch(`${PYTHON}letters.ttf`);
  if (!letters.ok) throw new Error("this site has no Python: python/letters.ttf is missing");
  python.FS.writeFile(LETTERS, new Uint8Array(await letters.arrayBuffer()));
  python.runPython(`import os; os.environ["CVNOTES_FONT"] = "${LETTERS}"`);
})();

// Give a function of a module of the course.
const found = {};
function from(module, name) {
  return (found[`${module}.${name}`] ??= python.pyimport(module)[name]);
}

const answer = {
  wake() {
    from("cvnotes.show.explorations.page", "asked");
    return [{}];
  },
  explore({ question }) {
    const shown = from("cvnotes.show.explorations.page", "asked")(question);
    const proxy = shown.pixels;
    const pixels = proxy.toJs();
    const { rest } = shown;
    proxy.destroy();
    shown.destroy();
    return [{ pixels: pixels.buffer, rest }, [pixels.buffer]];
  },
  photograph({ id, cells, name, bytes }) {
    const photo = `/${id} ${name.replaceAll("/", "-")}`;
    python.FS.writeFile(photo, new Uint8Array(bytes));
    const given = python.toPy(cells);
    try {
      return [{ rest: from("cvnotes.show.explorations.page", "with_photograph")(given, photo), photo }];
    } catch (error) {
      error.message = error.message.replaceAll(photo, name); // as the reader knows it
      throw error;
    } finally {
      given.destroy();
    }
  },
  async check({ id, name, question, code, seconds }) {
    const wanted = [...new Set(code.match(LARGE) ?? [])].filter((one) => !loaded.has(one));
    if (wanted.length) {
      await python.loadPackage(wanted, { messageCallback() {}, errorCallback() {} });
      wanted.forEach((one) => loaded.add(one));
    }
    const late = from("cvnotes.learn.page", "late")(name, seconds);
    const run = from("cvnotes.learn.page", "answered");
    postMessage({ id, started: late });
    return [{ rest: run(question) }];
  },
  hint: ({ name, given }) => [{ html: from("cvnotes.learn.page", "helped")(name, given) }],
  solution: ({ name }) => [{ html: from("cvnotes.learn.page", "solved")(name) }],
};

onmessage = async ({ data }) => {
  try {
    await ready;
  } catch (error) {
    postMessage({ id: data.id, error: `Python could not be loaded: ${error.message ?? error}.`, lost: true });
    return;
  }
  try {
    const [message, transfer = []] = await answer[data.kind](data);
    postMessage({ id: data.id, ...message }, transfer);
  } catch (error) {
    // Of a traceback, the line with the error; after a fatal error nothing runs any more.
    const lines = String(error.message ?? error).trim().split("\n");
    const said = lines.findLast((line) => /^[\w.]+(Error|Exception): /.test(line)) ?? lines.at(-1);
    const lost = !(error instanceof python.ffi.PythonError);
    const [, ours] = /^cvnotes\.base\.errors\.\w+: (.*)$/.exec(said) ?? []; // a sentence of its own
    postMessage({ id: data.id, error: ours ?? `Python stopped: ${said}`, lost });
  }
};
