"""What a calibration gives: a camera, its error bars, and what is doubtful about it."""

from collections.abc import Callable
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any
from warnings import warn

import numpy as np

from cvnotes.base import Array, CalibrationWarning, CvnotesError
from cvnotes.base.digits import with_deviation
from cvnotes.calibration.board_shape import BoardShape
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.calibration.refinement import Optimum, Problem, covariance, pose_covariance
from cvnotes.calibration.thresholds import TIED, TIMES_NOISE
from cvnotes.camera import AnyLens, Camera
from cvnotes.camera.model import SENSOR

if TYPE_CHECKING:
    from cvnotes.calibration.choice import Choice

_ROUNDED_RMS = 1e-6  # px; what is left of exact corners is rounding, whose deviations say nothing


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
        What is doubtful, in sentences; those of `calibrate` are `Doubt`, which know their views.
    reliable : bool
        False when the views do not determine the answer, however small the residuals are.
    converged : bool
        Whether the refinement reached its minimum.
    choice : Choice or None
        With "auto" for lens or board, how well each predicts views left out; not kept in files.
    shape : BoardShape or None
        The board as it was found, unless it was taken for flat; `board_points` then are on it.
    """

    A: Array
    lens: AnyLens
    size: tuple[int, int]
    poses: Array
    rms: float
    view_rms: Array
    names: tuple[str, ...]
    covariance: Array
    warnings: tuple[str, ...] = ()
    reliable: bool = True
    converged: bool = True
    choice: "Choice | None" = field(default=None, repr=False)
    shape: BoardShape | None = None
    _data: Correspondences | None = field(default=None, repr=False)
    _covariance_of_views: Array | None = field(default=None, repr=False)
    _pose_covariance: Callable[[], Array] | None = field(default=None, repr=False)

    @staticmethod
    def of(problem: Problem, data: Correspondences, best: Optimum, **also: Any) -> "Calibration":
        """Undo the scaling of the board, and add the error bars; not judged yet."""
        camera, q = problem.camera_of(best.x.shared), len(problem.names)
        # (what holds the board's corners belongs to no view)
        cost = best.cost - float(problem.held @ best.x.shared**2)
        variance = cost / problem.freedom
        unit = covariance(best.system)
        # The cost of each view is of the last step's beginning, and all together of its end.
        by_view = best.system.view_costs
        by_view = by_view * (cost / max(by_view.sum(), np.finfo(float).tiny))

        def of_poses() -> Array:
            J = data.pose_jacobian(best.x.R)
            return J @ (variance * pose_covariance(best.system, unit)) @ J.mT

        return Calibration(
            A=camera.A,
            lens=camera.lens,
            size=camera.size,
            poses=data.pose_in_given_units(best.x.R, best.x.T),
            rms=float(np.sqrt(cost / problem.n_seen)),
            view_rms=np.sqrt(by_view / problem.n_seen_by_view),
            names=problem.names,
            covariance=variance * unit[:q, :q],
            converged=best.converged,
            _data=data,
            _pose_covariance=of_poses,
            **also,
        )

    def judged(self, sentences: tuple[str, ...], reliable: bool) -> "Calibration":
        """Return the same with what is doubtful, and warn of it whoever called the caller."""
        for sentence in sentences:
            warn(sentence, CalibrationWarning, stacklevel=3)
        return replace(self, warnings=sentences, reliable=reliable)

    @property
    def parameters(self) -> dict[str, float]:
        """The estimated parameters by name."""
        value = self.camera.parameters
        return {name: value.get(name, 0.0) for name in self.names}

    @property
    def std(self) -> dict[str, float]:
        """Standard deviation of each estimated parameter, by name, if residuals are only noise."""
        return dict(zip(self.names, np.sqrt(np.diag(self.covariance)).tolist(), strict=True))

    @cached_property
    def covariance_of_views(self) -> Array:
        """Covariance (q, q) of the parameters from the scatter between views; see `jackknife`.

        It holds for bent boards and lenses that do not quite fit, too, as far as their effect
        differs from view to view: what moves all views alike, such as a board that is arched
        towards the camera, no comparison of views shows. Infinite on its diagonal where a view
        less would leave the camera undetermined. Where lens or board were chosen, it is no less
        than noise alone gives, and what fits about as well widens it; see `Choice`.
        """
        from cvnotes.calibration.jackknife import covariance_over_views

        if self._covariance_of_views is not None:
            return self._covariance_of_views
        if self._data is None:
            raise CvnotesError(
                "the scatter between views is not known: this result has neither its corners nor "
                "a covariance of views"
            )
        if self.choice is not None:
            return self.choice.covariance
        return covariance_over_views(self.camera, self.names, self._data, self.poses, self.shape)

    @property
    def std_of_views(self) -> dict[str, float]:
        """Standard deviation of each estimated parameter, by name, from the scatter of views."""
        variance = np.diag(self.covariance_of_views)
        return dict(zip(self.names, np.sqrt(variance).tolist(), strict=True))

    @property
    def honest_std(self) -> dict[str, float]:
        """The deviations that are printed: those of views, or of noise if these are not known."""
        if self._covariance_of_views is None and self._data is None:
            return self.std
        honest = self.std_of_views
        return honest if np.isfinite(list(honest.values())).all() else self.std

    @property
    def times_noise(self) -> float:
        """Typical deviation from the scatter between views over that of noise, of this model alone.

        Where it is well above 1 the residuals are no noise: something differs from view to view
        that the model does not know.
        """
        choice = self.choice  # (whose other models widen the bars, and are no scatter)
        scatter = self.covariance_of_views if choice is None else choice.chosen.covariance
        return float(np.median(np.sqrt(np.diag(scatter) / np.diag(self.covariance))))

    @property
    def notes_on_deviations(self) -> tuple[str, ...]:
        """Sentences on what the deviations contain: other models, and more than noise."""
        if self._covariance_of_views is None and self._data is None:
            return ()
        if not np.isfinite([*self.std_of_views.values()]).all():
            why = (
                "as without one view the others do not determine the camera"
                if len(self.poses) > 1
                else "as there is no other view"
            )
            return (f"±: from noise alone, {why}; the true error may be several times larger",)
        if self.rms < _ROUNDED_RMS:
            return ()
        notes = []
        if self.tied:
            notes.append(
                f"±: {', '.join(self.tied)} depend on each other so strongly that only together "
                "do they say something: another calibration may have others for the same lens"
            )
        if self.choice is not None and (close := self.choice.close_by()):
            other, name, off = close
            board = f" on a {other.board} board" * (other.board != self.choice.board)
            notes.append(
                f"±: wide enough for {other.lens}{board}, which fits as well; its {name} "
                f"differs by {float(f'{off:.2g}'):g} px"
            )
        if (times := self.times_noise) > TIMES_NOISE:
            note = (
                f"±: from the scatter between views, {times:.1f} times what noise alone would give"
            )
            if self.choice is None:  # else other boards and lenses were tried already
                board = "a board that is not quite as drawn"
                if self.shape is not None:
                    board = "a board that bends differently from picture to picture"
                note += (
                    f"; corners of a view miss their places together, as with {board} or a lens "
                    "that does not quite fit"
                )
            notes.append(note)
        return tuple(notes)

    @property
    def tied(self) -> tuple[str, ...]:
        """Names of parameters that hardly anything tells apart: others compensate each of them.

        Those with C_ii (C⁻¹)_ii > 10⁵, the variance inflation factor.
        """
        s = np.sqrt(np.diag(self.covariance))
        if not (s > 0).all():
            return ()
        inverse = np.linalg.pinv(self.covariance / np.outer(s, s), rcond=1e-15)
        factors = zip(self.names, np.diag(inverse), strict=True)
        return tuple(name for name, factor in factors if factor > TIED)

    @cached_property
    def pose_covariance(self) -> Array:
        """Covariance of each pose, (n_views, 6, 6): ω of R ← exp(ω) R, then T."""
        if self._pose_covariance is None:
            raise CvnotesError("the uncertainty of the poses is not kept in files")
        return self._pose_covariance()

    @cached_property
    def camera(self) -> Camera:
        """The camera, with its own frame as the WRF."""
        return Camera(self.A, lens=self.lens, size=self.size)

    @property
    def cameras(self) -> tuple[Camera, ...]:
        """The camera of each view, with the board's frame as the WRF."""
        return tuple(Camera(self.A, G, self.lens, self.size) for G in self.poses)

    @cached_property
    def board_points(self) -> tuple[Array, ...]:
        """The corners on the board, (n_i, 3) for each view, where they were found to be.

        Empty when the file that this was read from has no corners.
        """
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

    def as_mapping(self) -> dict[str, Any]:
        """Return all that makes this calibration, by name; `cvnotes.calibration.saving` writes it.

        ``Calibration(**mapping)`` makes it again, but for the uncertainty of its poses.
        """
        not_kept = ("_pose_covariance", "choice")
        kept = [f.name for f in fields(self) if f.name not in not_kept]
        mapping = {name: getattr(self, name) for name in kept}
        if self._data is not None:
            mapping["_covariance_of_views"] = self.covariance_of_views
        return mapping

    def save(self, path: Any) -> None:
        """Write the result to a JSON file, whole or not at all; see `files`."""
        from cvnotes.calibration.saving import write_calibration

        write_calibration(self.as_mapping(), path)

    @staticmethod
    def load(path: Any) -> "Calibration":
        """Read a result that `save` wrote, with its corners if the file has them."""
        from cvnotes.calibration.saving import read_calibration

        return Calibration(**read_calibration(path))

    def table(self) -> list[tuple[str, float, float, str]]:
        """Return the rows of the result: name, value, standard deviation, unit.

        The deviation is that of `std_of_views` where the views determine it, else of `std`.
        """
        std = self.honest_std
        return [(n, v, std[n], "px" if n in SENSOR else "") for n, v in self.parameters.items()]

    def __repr__(self) -> str:
        n = len(self.poses)
        lines = [f"Calibration from {n} view{'s' * (n > 1)}, {self.size[0]}×{self.size[1]} px"]
        for name, value, std, unit in self.table():
            number, error = with_deviation(value, std)
            lines.append(f"  {name:<8}{number:>14} ± {error} {unit}".rstrip())
        worst = int(np.argmax(self.view_rms))
        lines.append(f"  RMS {self.rms:.4f} px per point; worst view {worst}: "
                     f"{self.view_rms[worst]:.4f} px")  # fmt: skip
        lines += [f"  {self.shape}"] * (self.shape is not None)
        lines += [f"  {note}" for note in self.notes_on_deviations]
        return "\n".join([*lines, *doubts_as_text(self.warnings, self.reliable)])

    def _repr_html_(self) -> str:
        rows = ""
        for name, value, std, unit in self.table():
            cells = "<td>{}</td><td>± {}</td>".format(*with_deviation(value, std))
            rows += f"<tr>{left_cell(name)}{cells}{left_cell(unit)}</tr>"
        n = len(self.poses)
        caption = f"{n} view{'s' * (n > 1)}, RMS {self.rms:.4f} px per point"
        table = f"<table><caption>{caption}</caption>{rows}</table>"
        of_shape = (str(self.shape),) if self.shape is not None else ()
        table += "".join(f"<p>{note}</p>" for note in (*of_shape, *self.notes_on_deviations))
        return table + doubts_as_html(self.warnings, self.reliable)


def left_cell(text: str) -> str:
    """Return a cell of an HTML table, with its text to the left."""
    return f"<td style='text-align:left'>{text}</td>"


def doubts_as_text(sentences: tuple[str, ...], reliable: bool) -> list[str]:
    """Return the last lines of a result: the verdict, and a line for each sentence."""
    return ["  NOT RELIABLE:"] * (not reliable) + [f"  ! {sentence}" for sentence in sentences]


def doubts_as_html(sentences: tuple[str, ...], reliable: bool) -> str:
    """Return the same for a notebook."""
    from html import escape

    notes = "".join(f"<li>{escape(sentence)}</li>" for sentence in sentences)
    verdict = "" if reliable else "<strong>Not reliable.</strong>"
    return verdict + (f"<ul>{notes}</ul>" if notes else "")
