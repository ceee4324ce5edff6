"use strict";
// The service worker of the site: pages come from the network and, without one, as they were last
// seen; what has its version in its name (Python, scripts) comes from the cache once it is there.
const BUILD = "@BUILD@";
const RUNTIME = "@RUNTIME@";
const ROOT = new URL(".", self.location.href).pathname.replace(/lite\/$/, "");
const NAME = `cvnotes ${ROOT} `;
const LASTING = /\/python\/(?!cvnotes|parts|pyodide-lock)/; // the same in every build of one runtime
const FIXED = /\/(python|_static|lite\/(build|extensions))\//;

const cacheOf = (path) => caches.open(NAME + (LASTING.test(path) ? RUNTIME : BUILD));

async function keep(request) {
  const answer = await fetch(request);
  if (answer.status === 200) (await cacheOf(new URL(request.url).pathname)).put(request, answer.clone());
  return answer;
}

async function answerTo(request) {
  const { pathname } = new URL(request.url);
  const cache = await cacheOf(pathname);
  const kept = () => cache.match(request, { ignoreSearch: request.mode === "navigate" });
  if (FIXED.test(pathname)) return (await kept()) || keep(request);
  try {
    return await keep(request);
  } catch (error) {
    const found = await kept();
    if (found) return found;
    if (request.mode !== "navigate") throw error;
    const words = "<!doctype html><meta charset=utf-8><title>Not here yet</title>" +
      "<p>There is no network, and this page has not been visited before.</p>";
    return new Response(words, { status: 503, headers: { "Content-Type": "text/html" } });
  }
}

self.addEventListener("install", () => self.skipWaiting());
self.addEventListener("activate", (event) => {
  const wanted = [NAME + BUILD, NAME + RUNTIME];
  const old = (name) => name.startsWith(NAME) && !wanted.includes(name);
  const tidy = caches.keys().then((names) => Promise.all(names.filter(old).map((name) => caches.delete(name))));
  event.waitUntil(tidy.then(() => self.clients.claim()));
});
self.addEventListener("message", (event) => {
  const all = (event.data.keep || []).map((url) => new Request(url));
  const missing = async (request) => {
    const cache = await cacheOf(new URL(request.url).pathname);
    if (!(await cache.match(request))) await keep(request).catch(() => {});
  };
  event.waitUntil(Promise.all(all.map(missing)));
});
self.addEventListener("fetch", (event) => {
  const { origin, pathname } = new URL(event.request.url);
  const ours = event.request.method === "GET" && origin === self.location.origin;
  // JupyterLite's files of notebooks are asked of the page itself.
  if (!ours || !pathname.startsWith(ROOT) || pathname.includes("/api/drive") || /\/api\/s/.test(pathname)) return;
  event.stopImmediatePropagation();
  event.respondWith(answerTo(event.request));
});
