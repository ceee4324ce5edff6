"use strict";
// JupyterLab and JupyterLite open a saved exploration as its picture. A widget's view means nothing
// without the kernel that made it: ipywidgets then writes "model not found", and never looks at the
// picture that was saved beside it. So the view is dropped when a notebook is opened, whoever
// saved it. (What a build tool makes of an extension comes to no more than this.)
(() => {
  const VIEW = "application/vnd.jupyter.widget-view+json";
  const STILL = "cvnotes-explore"; // as cvnotes/show/explorations/shell.py marks it

  function drop({ cells }) {
    for (const { outputs = [] } of cells)
      for (const { data } of outputs)
        if (data?.[VIEW] && [data["text/html"]].flat().join("").includes(STILL)) delete data[VIEW];
  }

  const plugin = {
    id: "cvnotes-stills:plugin",
    autoStart: true,
    activate(app) {
      const { contents } = app.serviceManager;
      const get = contents.get.bind(contents);
      contents.get = async (...asked) => {
        const model = await get(...asked);
        if (model.type === "notebook" && model.content) drop(model.content);
        return model;
      };
    },
  };

  (globalThis._JUPYTERLAB ??= {})["cvnotes-stills"] = {
    init() {},
    get: () => () => ({ __esModule: true, default: plugin }),
  };
})();
