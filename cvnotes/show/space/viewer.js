// In the frame of trimesh's viewer. The paper is that of the page around the frame, and changes when
// JupyterLab changes its theme; black lines turn light on a dark one, where nobody would see them.
(() => {
  const lit = c => Math.max(c.r, c.g, c.b);
  let before = "";
  const follow = () => {
    if (typeof scene === "undefined" || typeof camera === "undefined" || !camera) return;
    let paper = "rgb(255, 255, 255)";
    try {
      for (let e = window.frameElement; e; e = e.parentElement) {
        const its = e.ownerDocument.defaultView.getComputedStyle(e).backgroundColor;
        if (/^rgb\(/.test(its)) { paper = its; break; }
      }
    } catch (foreign) { /* a page that keeps to itself: white, as paper is */ }
    if (paper === before) return;
    before = paper;
    scene.background.set(paper);
    const dark = paper.match(/\d+/g).reduce((sum, n) => sum + +n, 0) < 384;
    scene.traverse(({material}) => {
      if (!material || !material.emissive || material.map) return;
      const own = material.userData;
      own.first ??= [material.color.clone(), material.emissive.clone()];
      const [colour, glow] = own.first;
      const black = dark && lit(colour) + lit(glow) < 0.1;
      material.color.copy(colour).addScalar(black ? 0.25 : 0);
      material.emissive.copy(glow).addScalar(black ? 0.55 : 0);
    });
    render();
  };
  setInterval(follow, 200);
})();
