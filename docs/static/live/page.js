"use strict";
// Python for a page, in a worker. `live.ask(question)` promises the answer; what goes wrong comes as an
// Error whose message is a sentence for the page. The first question wakes Python, and what has been
// in view for a moment asks one by itself: its megabytes come while one reads, not while one pulls.
const live = (() => {
  const HERE = document.currentScript.src;
  const ROOT = new URL("../../", HERE);
  const MOMENT = 1000; // ms in view
  const waiting = new Map(); // questions that have no answer yet, by number
  let worker = null;
  let number = 0;
  let come = ""; // how much of Python has come

  function wake() {
    if (typeof WebAssembly !== "object")
      throw new Error("This browser has no WebAssembly, which Python needs here: what follows can only be read.");
    if (location.protocol === "file:")
      throw new Error(
        "Python runs only on pages that a server hands out: python -m http.server, in the site's folder, is one."
      );
    come = "waking Python …";
    worker = new Worker(new URL("worker.js", HERE));
    worker.onmessage = ({ data }) => {
      if (data.say !== undefined) {
        come = data.say;
        for (const { say } of waiting.values()) say(come);
        return;
      }
      const asked = waiting.get(data.id);
      if (!asked) return;
      come = ""; // all of it: to be told so at each picture would move the page
      if (data.started !== undefined) return asked.started(data.started);
      waiting.delete(data.id);
      if (data.error === undefined) asked.resolve(data);
      else asked.reject(new Error(data.error));
      if (data.lost) end("Python was lost. Touch again, and it starts anew.");
    };
    worker.onerror = (event) => {
      event.preventDefault();
      end(`Python ended (${event.message ?? "the browser does not say why"}). Touch again, and it starts anew.`);
    };
  }

  // End the worker, whatever it does; whoever waits is told why.
  function end(why) {
    worker?.terminate();
    worker = null;
    const lost = [...waiting.values()];
    waiting.clear();
    for (const { reject } of lost) reject(new Error(why));
  }

  function ask(question, { say = () => {}, started = () => {} } = {}) {
    return new Promise((resolve, reject) => {
      try {
        if (!worker) wake();
      } catch (error) {
        worker = null;
        reject(error);
        return;
      }
      const id = ++number;
      waiting.set(id, { resolve, reject, say, started });
      say(come);
      worker.postMessage({ id, ...question });
    });
  }

  // Act once an element has been in view for a moment, where nobody pays for megabytes. (Safari and
  // Firefox do not say what a line costs.)
  function whenSeen(element, act) {
    const { saveData, type } = navigator.connection ?? {};
    if (saveData || type === "cellular") return;
    let timer;
    new IntersectionObserver((entries, seen) => {
      clearTimeout(timer);
      if (entries.at(-1).isIntersecting)
        timer = setTimeout(() => {
          seen.disconnect();
          act().catch(() => {}); // the next question says why
        }, MOMENT);
    }).observe(element);
  }

  return { ask, end, whenSeen, ROOT };
})();

// A new element with attributes, properties and children.
function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes))
    if (name in element && name !== "style") element[name] = value;
    else element.setAttribute(name, value);
  element.append(...children);
  return element;
}
