"""What an automated checker of WCAG 2.2 AA has to say of a page: axe, in light and in dark."""

from pathlib import Path

import pytest

RULES = {"type": "tag", "values": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"]}
CHECK = """async ([within, options]) => {
    const {violations, passes} = await axe.run(within, options);
    if (passes.length < 10) throw new Error(`axe tried ${passes.length} rules only`);
    return violations.flatMap(({id, nodes}) => nodes.map(node => `${id}: ${node.html}`));
}"""


def violations(page, *, within="html", colours=True):
    """List what breaks a rule in parts of a page, as it stands and in both colour schemes.

    Nine tenths of the time go into the contrast of colours, which is the same at any width.
    """
    axe = pytest.importorskip("axe_playwright_python", reason="axe is not installed")
    page.evaluate((Path(axe.__file__).parent / "axe.min.js").read_text(encoding="utf-8"))
    options = {
        "preload": False,
        "runOnly": RULES,
        "rules": {"color-contrast": {"enabled": colours}},
    }
    found = []
    for scheme in ("light", "dark") if colours else ("light",):
        page.emulate_media(color_scheme=scheme)
        page.wait_for_selector(
            f"html:is([data-theme={scheme}], :not([data-theme]))", state="attached"
        )
        page.wait_for_timeout(300)  # colours change slowly
        found += [f"{scheme}, {words}" for words in page.evaluate(CHECK, [within, options])]
    page.emulate_media(color_scheme="light")
    return found
