"""What a stereo calibration gives: two cameras on one rig, with error bars."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from cvnotes.base import Array, CvnotesError
from cvnotes.base.digits import with_deviation
from cvnotes.calibration import Calibration
from cvnotes.calibration.result import doubts_as_html, doubts_as_text, left_cell
from cvnotes.camera import Camera, vector_from_rotation
from cvnotes.stereo.epipolar import relative_pose


@dataclass(frozen=True, eq=False)
class StereoCalibration:
    """Two calibrated cameras, how they stand to each other, and how well that is known.

    Attributes
    ----------
    left, right : Camera
        The cameras; the WRF is the left camera's frame.
    poses : ndarray, shape (n_views, 4, 4)
        Pose of the board in each pair of pictures, left CRF ← board.
    rms : float
        Root mean square distance between observed and predicted corners in both pictures, px.
    view_rms : ndarray, shape (n_views, 2)
        The same for each picture: left, right.
    names : tuple of str
        Names of the estimated parameters, in the order of `covariance`: those of the cameras
        (``left.alpha_u``, …), then ``omega_x`` … ``T_z``.
    covariance : ndarray, shape (q, q)
        Their covariance, for noise as large as the residuals show. ω is the small rotation in
        R ← exp(ω) R, in radians.
    warnings : tuple of str
        What is doubtful, in sentences.
    reliable : bool
        False when the answer may be wrong by more than its error bars say.
    converged : bool
        Whether the refinement reached its minimum.
    """

    left: Camera
    right: Camera
    poses: Array
    rms: float
    view_rms: Array
    names: tuple[str, ...]
    covariance: Array
    warnings: tuple[str, ...] = ()
    reliable: bool = True
    converged: bool = True
    _covariance_of_pairs: Callable[[], Array] | None = field(default=None, repr=False)

    @property
    def cameras(self) -> tuple[Camera, Camera]:
        """Left and right camera, for `rectify` and `triangulate`."""
        return self.left, self.right

    @property
    def G(self) -> Array:
        """The relative pose (4, 4), right CRF ← left CRF."""
        return relative_pose(self.left, self.right)

    @property
    def R(self) -> Array:
        """Rotation right ← left, (3, 3)."""
        return self.right.R

    @property
    def T(self) -> Array:
        """Where the left camera's centre lies in the right camera's frame, (3,)."""
        return self.right.T

    @property
    def std(self) -> dict[str, float]:
        """Standard deviation of each estimated parameter, by name."""
        return dict(zip(self.names, np.sqrt(np.diag(self.covariance)).tolist(), strict=True))

    @cached_property
    def covariance_of_pairs(self) -> Array:
        """Their covariance from the scatter between pairs; see `cvnotes.stereo.jackknife`.

        Infinite on its diagonal where a pair less would leave the rig undetermined.
        """
        if self._covariance_of_pairs is None:
            raise CvnotesError("the scatter between pairs is not kept in files")
        return self._covariance_of_pairs()

    @property
    def honest_std(self) -> dict[str, float]:
        """Standard deviations by name, and that of the distance between the cameras, ``baseline``.

        From the scatter between pairs, or for noise alone where that is not known.
        """
        C = self.covariance_of_pairs
        C = C if np.isfinite(C).all() else self.covariance
        b = self.T / np.linalg.norm(self.T)
        std = np.sqrt([*np.diag(C), b @ C[-3:, -3:] @ b])
        return dict(zip((*self.names, "baseline"), std.tolist(), strict=True))

    def of_camera(self, i: int) -> Calibration:
        """Return what was found out about the left camera (0), or about the right one (1)."""
        camera, side = self.cameras[i], ("left.", "right.")[i]
        own = [at for at, name in enumerate(self.names) if name.startswith(side)]
        return Calibration(
            A=camera.A,
            lens=camera.lens,
            size=camera.size,
            poses=camera.G @ self.poses,
            rms=float(np.sqrt(np.mean(self.view_rms[:, i] ** 2))),
            view_rms=self.view_rms[:, i],
            names=tuple(self.names[at].removeprefix(side) for at in own),
            covariance=self.covariance[np.ix_(own, own)],
            converged=self.converged,
        )

    def table(self) -> list[tuple[str, float, float, float, float]]:
        """Return name, left value and deviation, right value and deviation of each parameter.

        NaN where only the other lens has it.
        """
        left, right = (
            {name: (value, std) for name, value, std, _ in self.of_camera(i).table()}
            for i in (0, 1)
        )
        none = np.nan, np.nan
        return [(n, *left.get(n, none), *right.get(n, none)) for n in left | right]

    def __repr__(self) -> str:
        w, h = self.left.size
        lines = [f"StereoCalibration from {len(self.poses)} pairs of views, {w}×{h} px"]
        for name, *numbers in self.table():
            a, da, b, db = _both(*numbers)
            lines.append(f"  {name:<8}{a:>11} ± {da}{b:>14} ± {db}")
        lines += [f"  {line}" for line in self._relative()]
        lines.append(f"  RMS {self.rms:.4f} px per point")
        return "\n".join([*lines, *doubts_as_text(self.warnings, self.reliable)])

    def _repr_html_(self) -> str:
        head = "<tr><th></th><th colspan=2>left</th><th colspan=2>right</th></tr>"
        rows = ""
        for name, *numbers in self.table():
            cells = "<td>{}</td><td>± {}</td><td>{}</td><td>± {}</td>".format(*_both(*numbers))
            rows += f"<tr>{left_cell(name)}{cells}</tr>"
        caption = f"{len(self.poses)} pairs of views, RMS {self.rms:.4f} px per point"
        table = f"<table><caption>{caption}</caption>{head}{rows}</table>"
        pose = "".join(f"<p>{line}</p>" for line in self._relative())
        return table + pose + doubts_as_html(self.warnings, self.reliable)

    def _relative(self) -> list[str]:
        """Say the relative pose in two lines."""
        std = self.std
        turn = np.degrees(vector_from_rotation(self.R))
        turn_std = [np.degrees(std[f"omega_{axis}"]) for axis in "xyz"]
        omega = map(with_deviation, turn, turn_std)
        T = map(with_deviation, self.T, [std[f"T_{axis}"] for axis in "xyz"])
        return [
            f"rotation right ← left, degrees: {', '.join(map(' ± '.join, omega))}",
            f"T right ← left: {', '.join(map(' ± '.join, T))}",
        ]


def _both(left: float, left_std: float, right: float, right_std: float) -> tuple[str, ...]:
    cells = with_deviation(left, left_std) + with_deviation(right, right_std)
    return tuple(cell.replace("nan", "–") for cell in cells)
