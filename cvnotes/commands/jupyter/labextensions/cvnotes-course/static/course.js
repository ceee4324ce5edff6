"use strict";
// What JupyterLab and JupyterLite do for notebooks of the course, and for no others. (What a build
// tool makes of an extension comes to no more than this.)
(() => {
  const VIEW = "application/vnd.jupyter.widget-view+json";
  const STILL = "cvnotes-explore"; // as cvnotes/show/explorations/shell.py marks it
  const FACES = { Regular: {}, It: { style: "italic" }, Semibold: { weight: "600" } };
  const here = document.currentScript.src;
  const config = JSON.parse(document.getElementById("jupyter-config-data")?.textContent ?? "{}");

  const isOurs = ({ cells }) => cells.some(({ source }) => /^from cvnotes/m.test([source].flat().join("")));

  // A widget's view means nothing without the kernel that made it: ipywidgets then writes "model
  // not found", and never looks at the picture that was saved beside it. So the view is dropped
  // when a notebook is opened, whoever saved it.
  function drop({ cells }) {
    for (const { outputs = [] } of cells)
      for (const { data } of outputs)
        if (data?.[VIEW] && [data["text/html"]].flat().join("").includes(STILL)) delete data[VIEW];
  }

  // The type of the course's pages; where its files are is told by those who serve them.
  async function bring(family, places) {
    for (const [face, how] of Object.entries(FACES)) {
      const file = new URL(places.replace("*", face), here);
      document.fonts.add(await new FontFace(family, `url(${file})`, how).load());
    }
  }

  function dress() {
    const sheet = { rel: "stylesheet", href: new URL("course.css", here) };
    document.head.append(Object.assign(document.createElement("link"), sheet));
    const { cvnotesSerif, cvnotesSans } = config;
    if (cvnotesSerif) bring("cvnotes serif", cvnotesSerif).catch(console.info); // reads well without
    if (cvnotesSans) bring("cvnotes sans", cvnotesSans).catch(console.info);
  }

  const plugin = {
    id: "cvnotes-course:plugin",
    autoStart: true,
    activate(app) {
      const { contents } = app.serviceManager;
      const get = contents.get.bind(contents);
      contents.get = async (...asked) => {
        const model = await get(...asked);
        if (model.type === "notebook" && model.content) drop(model.content);
        return model;
      };
      dress();
      app.docRegistry?.addWidgetExtension("Notebook", {
        createNew(panel, context) {
          context.ready.then(() => {
            if (isOurs(context.model.toJSON())) panel.addClass("cvnotes");
          });
        },
      });
    },
  };

  (globalThis._JUPYTERLAB ??= {})["cvnotes-course"] = {
    init() {},
    get: () => () => ({ __esModule: true, default: plugin }),
  };
})();
