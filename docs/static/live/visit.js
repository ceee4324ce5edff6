// What has been visited is there again without a network: see offline.js, which keeps it.
(() => {
  if (!("serviceWorker" in navigator) || !location.protocol.startsWith("http")) return;
  const root = new URL(document.documentElement.dataset.content_root || "./", location.href);
  const workers = navigator.serviceWorker;
  // The second is JupyterLite's own, under the address by which it asks for it.
  const own = workers.register(new URL("offline.js", root));
  const lite = new URL("lite/service-worker.js?enableCache=false", root);
  if (document.querySelector('a[href*="lite/"]')) workers.register(lite).catch(() => {});
  own
    .then(() => workers.ready)
    .then((registration) => {
      // What came before the worker was there did not pass through its hands.
      const here = (url) => url.startsWith(root.href);
      const loaded = performance.getEntriesByType("resource").map((entry) => entry.name);
      const keep = [location.href.split("#")[0], ...loaded].filter(here);
      registration.active.postMessage({ keep: [...new Set(keep)] });
    })
    .catch(() => {}); // private windows have none: the pages work, with a network
})();
