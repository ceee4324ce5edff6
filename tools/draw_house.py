"""Draw the plan of docs/house.md: python tools/draw_house.py

`FLOORS` says who may lean on whom; ``tests/test_layers.py`` holds the imports to it, and the page.
Plain boxes with a fill of their own, so that the picture reads on a light page and on a dark one.
"""

from html import escape
from pathlib import Path

OUT = Path(__file__).resolve().parents[1] / "docs" / "figures" / "house.svg"
# Floors from the ground up; a wing leans on those below it. Beside each, what a reader looks for.
FLOORS = (
    (("base", "errors, guards"),),
    (("projective", "chapter 1"), ("tutor", "checks, marks")),
    (("camera", "chapters 2 to 4"), ("homography", "chapter 6")),
    (("targets", "chapter 5"), ("warping", "chapter 8"), ("files", "photographs, cameras")),
    (("calibration", "chapters 7, 9, 11"), ("pictures", "in all chapters")),
    (("stereo", "chapter 10"),),
    (("photographs", "chapter 9"),),
    (("show", "figures, sliders"), ("learn", "exercises")),
    (("commands", "cvnotes …"),),
)
WIDTH, HEIGHT, GAP, STEP, MARGIN = 170, 48, 30, 78, 16


def in_words() -> str:
    """Return the floors as a sentence, for those who do not see the picture."""
    floors = [[wing for wing, _ in floor] for floor in FLOORS]
    named = (
        " and ".join([", ".join(wings[:-1])] * (len(wings) > 1) + wings[-1:]) for wings in floors
    )
    return f"{len(FLOORS)} floors: {'; '.join(named)}"


def plan() -> str:
    """The floors as SVG, the ground at the bottom."""
    width = 3 * WIDTH + 2 * GAP + 2 * MARGIN
    height = len(FLOORS) * STEP - (STEP - HEIGHT) + 2 * MARGIN
    shapes = []
    for i, floor in enumerate(FLOORS):
        y = height - MARGIN - HEIGHT - i * STEP
        across = len(floor) * WIDTH + (len(floor) - 1) * GAP
        for j, (wing, what) in enumerate(floor):
            x = (width - across) / 2 + j * (WIDTH + GAP)
            middle = x + WIDTH / 2
            shapes += [
                f'<rect x="{x:g}" y="{y:g}" width="{WIDTH}" height="{HEIGHT}" rx="5" '
                'fill="#ffffff" stroke="#0072B2" stroke-width="1.5"/>',
                f'<text x="{middle:g}" y="{y + 20:g}" font-weight="bold">{escape(wing)}</text>',
                f'<text x="{middle:g}" y="{y + 37:g}" font-size="12">{escape(what)}</text>',
            ]
        if i:
            x, top = width / 2, y + HEIGHT + 4
            end = y + STEP - 4
            shapes.append(
                f'<path d="M{x:g} {top:g}V{end:g}m-5 -7l5 7l5 -7" fill="none" stroke="#808080" '
                'stroke-width="2"/>'
            )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}" height="{height:g}" '
        f'viewBox="0 0 {width:g} {height:g}" font-family="Helvetica, Arial, sans-serif" '
        'font-size="15" fill="#222222" text-anchor="middle">\n'
        "<title>Which wing of the package imports from which: only downwards</title>\n"
        + "\n".join(shapes)
        + "\n</svg>\n"
    )


if __name__ == "__main__":
    OUT.write_text(plan(), encoding="utf-8")
