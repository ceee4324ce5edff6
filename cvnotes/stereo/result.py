"""What a stereo calibration gives: two cameras on one rig, with error bars."""

from dataclasses import dataclass
from html import escape

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera
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

    def table(self) -> list[tuple[str, float, float, float, float]]:
        """Give name, left value and deviation, right value and deviation of what was estimated."""
        std, rows = self.std, []
        of_cameras = [name.removeprefix("left.") for name in self.names if name.startswith("left.")]
        for name in of_cameras:
            values = [_parameters(camera)[name] for camera in self.cameras]
            rows.append((name, values[0], std[f"left.{name}"], values[1], std[f"right.{name}"]))
        return rows

    def __repr__(self) -> str:
        w, h = self.left.size
        lines = [f"StereoCalibration from {len(self.poses)} pairs of views, {w}×{h} px"]
        for name, a, da, b, db in self.table():
            lines.append(f"  {name:<8}{a:>11.4f} ± {da:.4f}{b:>14.4f} ± {db:.4f}")
        lines += [f"  {line}" for line in self._relative()]
        lines.append(f"  RMS {self.rms:.4f} px per point")
        if not self.reliable:
            lines.append("  NOT RELIABLE:")
        return "\n".join(lines + [f"  ! {sentence}" for sentence in self.warnings])

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td style='text-align:left'>{name}</td><td>{a:.4f}</td><td>± {da:.4f}</td>"
            f"<td>{b:.4f}</td><td>± {db:.4f}</td></tr>"
            for name, a, da, b, db in self.table()
        )
        head = "<tr><th></th><th colspan=2>left</th><th colspan=2>right</th></tr>"
        pose = "".join(f"<p>{line}</p>" for line in self._relative())
        notes = "".join(f"<li>{escape(sentence)}</li>" for sentence in self.warnings)
        verdict = "" if self.reliable else "<strong>Not reliable.</strong>"
        return (
            f"<table><caption>{len(self.poses)} pairs of views, RMS {self.rms:.4f} px per point"
            f"</caption>{head}{rows}</table>{pose}{verdict}"
            + (f"<ul>{notes}</ul>" if notes else "")
        )

    def _relative(self) -> list[str]:
        """Say the relative pose in two lines."""
        from cvnotes.camera import vector_from_rotation

        std = self.std
        omega = ", ".join(
            f"{np.degrees(w):.4f} ± {np.degrees(std[f'omega_{axis}']):.4f}"
            for axis, w in zip("xyz", vector_from_rotation(self.R), strict=True)
        )
        T = ", ".join(
            f"{t:.3f} ± {std[f'T_{axis}']:.3f}" for axis, t in zip("xyz", self.T, strict=True)
        )
        return [f"rotation right ← left, degrees: {omega}", f"T right ← left: {T}"]


def _parameters(camera: Camera) -> dict[str, float]:
    A, lens = camera.A, camera.lens
    value = {"alpha_u": A[0, 0], "alpha_v": A[1, 1], "skew": A[0, 1], "u0": A[0, 2]}
    value |= {"v0": A[1, 2], "p1": lens.p[0], "p2": lens.p[1]}
    return value | {f"k{i}": k for i, k in enumerate(lens.k, start=1)}
