"""Explorations: time in the kernel, and from a key on a slider to another picture on the screen.

Run ``python -m benchmarks.explorations``. In the kernel: the model's answer and its packing as
PNG. On the screen, where Chromium, Playwright and JupyterLab are installed: a headless browser,
whole frames of 1/60 s, beside two peers: a picture made in advance, which costs nothing but its
way, and a new figure of matplotlib in an Output widget for each value.
"""

import os
import time

import numpy as np

from benchmarks import screen
from cvnotes.base import Array
from cvnotes.base.png import pack_png
from cvnotes.show import explorations
from cvnotes.show.explorations.model import Model

READY = """import io
import numpy as np
import ipywidgets
from PIL import Image
from cvnotes.show.explorations import model
from cvnotes.base.png import pack_png
packed = [pack_png(model("camera").picture(T_x=x)) for x in (-87, 0)]
ready, slider = ipywidgets.Image(value=packed[0]), ipywidgets.IntSlider()
def follow(change):
    ready.value = packed[change.new % 2]
slider.observe(follow, "value")
ipywidgets.VBox([slider, ready])"""
FIGURE = """import matplotlib.pyplot as plt
def figure(x):
    _, axes = plt.subplots(1, 2, figsize=(8.6, 3.6))
    axes[0].plot([0, x])
    plt.show()
ipywidgets.interact(figure, x=(0.0, 10.0));"""
PEERS = {"(picture made in advance)": READY, "(new matplotlib figure)": FIGURE}


def kernel_times(model: Model, repeats: int = 25) -> Array:
    """Return milliseconds (repeats, 2) of answer and packing, for two values in turns."""
    first, spent = model.settings[0], np.empty((repeats + 3, 2))
    step = -first.step if first.value == first.high else first.step
    for i in range(len(spent)):
        begin = time.perf_counter()
        drawing = model.drawing(**{first.name: first.value + i % 2 * step})
        middle = time.perf_counter()
        pack_png(drawing.picture)
        spent[i] = middle - begin, time.perf_counter() - middle
    return 1e3 * spent[3:]


def main() -> None:
    load = (
        f", load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores" if os.name == "posix" else ""
    )
    print(f"From a slider to the picture: median and (least) milliseconds{load}")
    path = screen.chromium()
    on_screen = {}
    if path is None:
        print("Chromium, Playwright or JupyterLab is missing: no times on the screen")
    else:
        calls = {
            name: f"from cvnotes.show import explore\nexplore({name!r})"
            for name in explorations.NAMES
        }
        on_screen = screen.waited(calls | PEERS, path)
    print(f"{'':26}{'answer':>15}{'packing':>15}{'on the screen':>18}")
    for name in (*explorations.NAMES, *PEERS):
        columns = (
            kernel_times(explorations.model(name)).T if name in explorations.NAMES else ((), ())
        )
        cells = [_cell(times) for times in (*columns, on_screen.get(name, ()))]
        print(f"{name:26}{cells[0]:>15}{cells[1]:>15}{cells[2]:>18}")


def _cell(times: object) -> str:
    spent = np.asarray(times, dtype=float)
    return f"{np.median(spent):.1f} ({spent.min():.1f})" if spent.size else ""


if __name__ == "__main__":
    main()
