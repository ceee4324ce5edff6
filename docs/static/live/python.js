"use strict";
// Python in a worker. Whoever needs it begins its script with
//
//     importScripts("python.js");
//     const ready = wakePython({packages: ["numpy", "pillow"], say: (text) => postMessage({say: text})});
//
// and has, once `ready` is resolved, Pyodide with these packages and the course's own code. The
// folder python/ at the root of the site is the work of tools/browser_parts.py.

const PYTHON = new URL("../../python/", self.location.href).href;
const RUNTIME = ["pyodide.js", "pyodide.asm.js", "pyodide.asm.wasm", "python_stdlib.zip", "pyodide-lock.json", "letters.ttf"];

// Packages, and whatever they depend on.
function allOf(packages, lock) {
  const found = new Set();
  const todo = [...packages];
  while (todo.length) {
    const name = todo.pop().toLowerCase().replaceAll("_", "-");
    if (found.has(name) || !lock.packages[name]) continue;
    found.add(name);
    todo.push(...lock.packages[name].depends);
  }
  return found;
}

// Say how much of what is to come has come; what a script loads by itself is not seen on its way.
function countMegabytes(total, say) {
  const asked = self.fetch.bind(self);
  let come = 0;
  let told = -1;
  const tell = (bytes) => {
    come += bytes;
    const percent = Math.min(100, Math.floor((100 * come) / total));
    if (percent === told) return;
    told = percent;
    say(`loading Python: ${(come / 1e6).toFixed(1)} of ${(total / 1e6).toFixed(1)} MB, once`);
  };
  self.fetch = async (...request) => {
    const answer = await asked(...request);
    if (!answer.ok || !answer.body) return answer;
    const count = new TransformStream({
      transform(chunk, out) {
        tell(chunk.byteLength);
        out.enqueue(chunk);
      },
    });
    const { status, statusText, headers } = answer;
    return new Response(answer.body.pipeThrough(count), { status, statusText, headers });
  };
}

async function getJSON(name) {
  const answer = await fetch(PYTHON + name);
  if (!answer.ok) throw new Error(`this site has no Python: python/${name} is missing`);
  return answer.json();
}

// Give Pyodide with some packages and the course's code (with `data`, also what is in data/).
async function wakePython({ packages = ["numpy", "pillow"], data = false, say = () => {} } = {}) {
  if (typeof WebAssembly !== "object")
    throw new Error("this browser has no WebAssembly, which Python needs here");
  const [parts, lock] = await Promise.all([getJSON("parts.json"), getJSON("pyodide-lock.json")]);
  const wheels = data ? [parts.cvnotes, parts.data] : [parts.cvnotes];
  const files = [...allOf(packages, lock)].map((name) => lock.packages[name].file_name);
  const total = [...RUNTIME, ...files, ...wheels].reduce((sum, file) => sum + (parts.bytes[file] || 0), 0);
  countMegabytes(total, say);
  importScripts(PYTHON + "pyodide.js");
  // Switched on, as this version has it, it needs what Safari and Firefox do not have.
  const python = await loadPyodide({ indexURL: PYTHON, enableRunUntilComplete: false });
  const quiet = { messageCallback() {}, errorCallback() {} };
  // By its address a wheel comes without what it depends on.
  await python.loadPackage([...packages, ...wheels.map((wheel) => PYTHON + wheel)], quiet);
  // What could not be fetched is no error to loadPackage.
  const arrived = Object.keys(python.loadedPackages).map((name) => name.toLowerCase());
  for (const name of [...packages, "cvnotes"])
    if (!arrived.includes(name.toLowerCase())) throw new Error(`${name} did not arrive`);
  return python;
}
