// Execute notebooks in WebAssembly under Node, as a browser would, and write what their cells give.
//
//     node run.mjs PYTHON_FOLDER RESULT.json notebooks/*.ipynb
//
// PYTHON_FOLDER is what tools/browser_parts.py lays out. The result has, for each notebook, a list
// of each code cell's outputs as nbformat has them: see execute.py.
import { readFileSync, writeFileSync } from "node:fs";
import { basename, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [folder, result, ...notebooks] = process.argv.slice(2);
const { loadPyodide } = await import(pathToFileURL(resolve(folder, "pyodide.mjs")).href);
const python = await loadPyodide({ indexURL: resolve(folder) + "/" });
const quiet = { messageCallback() {}, errorCallback() {} };
await python.loadPackagesFromImports("import IPython, cvnotes, cv2", quiet);
python.runPython("import matplotlib.font_manager"); // which says so when it is first imported
python.runPython(readFileSync(new URL("execute.py", import.meta.url), "utf8"));
const execute = python.globals.get("execute");
const told = {};
for (const path of notebooks) {
  const began = process.cpuUsage();
  const outputs = execute(readFileSync(path, "utf8"));
  const seconds = process.cpuUsage(began).user / 1e6;
  told[basename(path, ".ipynb")] = { seconds, outputs: JSON.parse(outputs) };
  console.log(`${basename(path)}: ${seconds.toFixed(1)} s`);
}
writeFileSync(result, JSON.stringify(told));
process.exit(0);
