"""What a calibration gives: a camera, its error bars, and what is doubtful about it."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from html import escape
from typing import Any

import numpy as np

from cvnotes.base import Array, CvnotesError
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.camera import Camera, Lens


@dataclass(frozen=True, eq=False)
class Calibration:
    """A calibrated camera, how well it is known, and whether to believe it.

    Attributes
    ----------
    A, lens, size
        Intrinsic matrix (3, 3) in pixels, the lens, and the picture's (width, height).
    poses : ndarray, shape (n_views, 4, 4)
        Pose of each view, CRF ← board.
    rms : float
        Root mean square distance between observed and predicted corners, in pixels: per point,
        not per coordinate (which would be √2 smaller).
    view_rms : ndarray, shape (n_views,)
        The same for each view.
    names : tuple of str
        Names of the estimated parameters, in the order of `covariance`.
    covariance : ndarray, shape (q, q)
        Their covariance, for noise as large as the residuals show.
    warnings : tuple of str
        What is doubtful, in sentences.
    reliable : bool
        False when the views do not determine the answer, however small the residuals are.
    converged : bool
        Whether the refinement reached its minimum.
    """

    A: Array
    lens: Lens
    size: tuple[int, int]
    poses: Array
    rms: float
    view_rms: Array
    names: tuple[str, ...]
    covariance: Array
    warnings: tuple[str, ...] = ()
    reliable: bool = True
    converged: bool = True
    _data: Correspondences | None = field(default=None, repr=False)
    _pose_covariance: Callable[[], Array] | None = field(default=None, repr=False)

    @property
    def parameters(self) -> dict[str, float]:
        """The estimated parameters by name."""
        A, lens = self.A, self.lens
        value = {"alpha_u": A[0, 0], "alpha_v": A[1, 1], "skew": A[0, 1], "u0": A[0, 2]}
        value |= {"v0": A[1, 2], "p1": lens.p[0], "p2": lens.p[1]}
        value |= {f"k{i}": k for i, k in enumerate(lens.k, start=1)}
        return {name: float(value[name]) for name in self.names}

    @property
    def std(self) -> dict[str, float]:
        """Standard deviation of each estimated parameter, by name."""
        return dict(zip(self.names, np.sqrt(np.diag(self.covariance)).tolist(), strict=True))

    @cached_property
    def pose_covariance(self) -> Array:
        """Covariance of each pose, (n_views, 6, 6): ω of R ← exp(ω) R, then T."""
        if self._pose_covariance is None:
            raise CvnotesError("the uncertainty of the poses is not kept in files")
        return self._pose_covariance()

    @property
    def camera(self) -> Camera:
        """The camera, with its own frame as the WRF."""
        return Camera(self.A, lens=self.lens, size=self.size)

    @property
    def cameras(self) -> tuple[Camera, ...]:
        """The camera of each view, with the board's frame as the WRF."""
        return tuple(Camera(self.A, G, self.lens, self.size) for G in self.poses)

    @cached_property
    def board_points(self) -> tuple[Array, ...]:
        """The corners on the board, (n_i, 3) for each view; empty when read from a file."""
        return tuple(W for W, _ in self._data.given()) if self._data else ()

    @cached_property
    def image_points(self) -> tuple[Array, ...]:
        """The corners in the pictures, (n_i, 2) for each view; empty when read from a file."""
        return tuple(m for _, m in self._data.given()) if self._data else ()

    @cached_property
    def residuals(self) -> tuple[Array, ...]:
        """Observed minus predicted pixels of each view, (n_i, 2)."""
        views = zip(self.cameras, self.board_points, self.image_points, strict=False)
        return tuple(m - camera.project(W) for camera, W, m in views)

    def save(self, path: Any) -> None:
        """Write the result to a JSON file, whole or not at all; see `files`."""
        from cvnotes.calibration.saving import write_calibration

        write_calibration(self, path)

    @staticmethod
    def load(path: Any) -> "Calibration":
        """Read a result that `save` wrote, with its corners if the file has them."""
        from cvnotes.calibration.saving import read_calibration

        return Calibration(**read_calibration(path))

    def table(self) -> list[tuple[str, float, float, str]]:
        """Give the rows of the result: name, value, standard deviation, unit."""
        unit = {"a": "px", "u": "px", "v": "px", "s": "px"}
        std = self.std
        return [(n, v, std[n], unit.get(n[0], "")) for n, v in self.parameters.items()]

    def __repr__(self) -> str:
        lines = [f"Calibration from {len(self.poses)} views, {self.size[0]}×{self.size[1]} px"]
        for name, value, std, unit in self.table():
            lines.append(
                f"  {name:<8}{_rounded(value, std):>14} ± {_rounded(std, std)} {unit}".rstrip()
            )
        worst = int(np.argmax(self.view_rms))
        lines.append(f"  RMS {self.rms:.4f} px per point; worst view {worst}: "
                     f"{self.view_rms[worst]:.4f} px")  # fmt: skip
        if not self.reliable:
            lines.append("  NOT RELIABLE:")
        return "\n".join(lines + [f"  ! {sentence}" for sentence in self.warnings])

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td style='text-align:left'>{n}</td><td>{_rounded(v, s)}</td>"
            f"<td>± {_rounded(s, s)}</td>"
            f"<td style='text-align:left'>{u}</td></tr>"
            for n, v, s, u in self.table()
        )
        notes = "".join(f"<li>{escape(sentence)}</li>" for sentence in self.warnings)
        verdict = "" if self.reliable else "<strong>Not reliable.</strong>"
        return (
            f"<table><caption>{len(self.poses)} views, RMS {self.rms:.4f} px per point"
            f"</caption>{rows}</table>{verdict}" + (f"<ul>{notes}</ul>" if notes else "")
        )


def _rounded(x: float, std: float) -> str:
    """Write x to two digits of its standard deviation; what comes after is noise."""
    digits = 2 if not std > 0 else min(max(1 - int(np.floor(np.log10(std))), 0), 9)
    return f"{round(x, digits) + 0.0:.{digits}f}"
