"""Draw the README's picture: python tools/draw_overview.py."""

import io
from pathlib import Path

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure
from PIL import Image

from cvnotes.calibration import calibrate
from cvnotes.pictures import course
from cvnotes.show import camera_shapes, draw_corners, draw_error_bars, draw_scene, target_shapes
from cvnotes.show.picture import figure_of

HEIGHT = 2.5  # inches of 100 px: the README shows it 850 px wide
TEXT = 9  # points, to be read at that width
OUT = Path(__file__).resolve().parents[1] / "docs" / "figures" / "overview.png"


def panel(figure: Figure, height: int) -> npt.NDArray[np.uint8]:
    """Render a figure at a height in pixels."""
    stream = io.BytesIO()
    figure.savefig(stream, dpi=height / figure.get_figheight(), facecolor="white")
    picture = Image.open(stream).convert("RGB")
    return np.asarray(picture.resize((round(picture.width * height / picture.height), height)))


def main() -> None:
    board, measured = course.board(), course.measured_corners()
    found = calibrate(board.points, measured, course.camera().size)
    first = draw_corners(course.photos()[6], measured[6], board)
    first.set_title("corners, found in a picture", fontsize=TEXT)
    boards = [shape for G in found.poses[::2] for shape in target_shapes(board, G)]
    scene = draw_scene(*camera_shapes(found.camera, 120, name=""), *boards, view=(25, -75))
    scene.figure.suptitle("the camera they determine", fontsize=TEXT)
    scene.set_axis_off()
    rng = np.random.default_rng(7)
    exact = course.exact_corners()
    runs = [
        calibrate(board.points, exact + rng.normal(scale=0.1, size=exact.shape), found.size)
        for _ in range(200)
    ]
    names = ["alpha_u"]
    bars = draw_error_bars(
        np.array([[run.parameters[n] for n in names] for run in runs]),
        [800],
        np.mean([[run.std[n] for n in names] for run in runs], axis=0),
        names=names,
    )
    figures = [figure_of(drawn) for drawn in (first, scene, bars)]
    for legend in list(figures[2].legends):  # wider than the panel, which would cut it off
        legend.remove()
    for ax in figures[2].axes:
        ax.set_title("how well it is known", fontsize=TEXT)
        ax.tick_params(labelsize=TEXT - 1)
        ax.xaxis.label.set_fontsize(TEXT)
    for figure, width in zip(figures, (3.1, 2.7, 2.7), strict=True):
        figure.set_size_inches(width, HEIGHT)
    pictures = [panel(figure, round(2 * 100 * HEIGHT)) for figure in figures]
    Image.fromarray(np.hstack(pictures)).quantize(256).save(OUT, optimize=True)


if __name__ == "__main__":
    main()
