"""The thin shell around a model: a picture, and below it sliders that it follows."""

import json
from html import escape
from importlib.resources import files
from typing import Any

from ipywidgets.widgets.widget_bool import Checkbox, ToggleButton
from ipywidgets.widgets.widget_box import Box, GridBox, VBox
from ipywidgets.widgets.widget_button import Button
from ipywidgets.widgets.widget_float import FloatSlider
from ipywidgets.widgets.widget_int import IntSlider
from ipywidgets.widgets.widget_media import Image
from ipywidgets.widgets.widget_output import Output
from ipywidgets.widgets.widget_selection import Dropdown
from ipywidgets.widgets.widget_string import HTML, Text

from cvnotes.base import Array
from cvnotes.base.png import pack_png
from cvnotes.camera import Camera
from cvnotes.show.explorations.hand import points_of
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.page import page_data
from cvnotes.targets import Chessboard

_UNSEEN = "position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%)"
_TWO_LINES = "min-height: 2.8em; line-height: 1.4"  # so that the sliders stay where they are
_SCRIPTS = ("grips.js", "notebook.js")
_HIDDEN = {"display": "none"}
_NO_ROOM = {"height": "0", "overflow": "hidden", "margin": "0"}
_COLUMNS = "repeat(auto-fit, minmax({}px, 1fr))"


class Explorer(VBox):
    """Sliders of a model, its sentence and its picture, for a notebook.

    Every slider can be reached with Tab and moved with the arrow keys, and what the picture offers
    to a hand can be dragged, where the front end runs scripts. It sends the
    newest value only after the picture of the one before has arrived, so nothing piles up however
    quickly a slider is dragged. Where no kernel runs, on a page or in a file that was saved, the
    still of the same values stands in its place.

    Parameters
    ----------
    model : Model
        What is shown.
    camera, board : optional
        As they were given for the model: a page makes the same one of them.

    Examples
    --------
    >>> from cvnotes.show import explore
    >>> explorer = explore("lens")
    >>> explorer
    explore lens: run this cell to move its sliders
    >>> explorer.sliders["k1"].value = -0.3
    >>> explorer.values["k1"]
    -0.3
    """

    invites, folds = "move its sliders", "sliders"

    def __init__(
        self, model: Model, camera: Camera | None = None, board: Chessboard | None = None
    ) -> None:
        self.model = model
        self._given = camera, board
        self.sliders = {s.name: _control(s) for s in model.settings}
        what = "Move every slider back to where it started"
        self.reset_button = Button(description="Reset", icon="undo", tooltip=what)
        self.sentence, self.matrices = HTML(), HTML()
        self.image = Image(format="png")
        self._drawn: tuple[dict[str, float], Drawing] | None = None
        self._held = False
        self._pulled, self._told = Text(layout=_HIDDEN), HTML(layout=_HIDDEN)
        self._number = 0  # of the pull that the picture answers
        self.redraw()
        for slider in self.sliders.values():
            slider.observe(self.redraw, "value")
        self.reset_button.on_click(self.reset)
        beside = [self.matrices] if self.matrices.value else []
        hands = [self._hands()] if model.drags else []
        super().__init__([self.image, self.sentence, *beside, *self._controls(), *hands])  # type: ignore[no-untyped-call]
        self.add_class("cvnotes-explorer")  # type: ignore[no-untyped-call]

    def __repr__(self) -> str:
        return f"explore {self.model.name}: run this cell to {self.invites}"

    def _repr_mimebundle_(self, **kwargs: Any) -> dict[str, Any]:
        """Return the view of the widget, and the still for whoever cannot show that.

        With the still comes, as data, what a page needs to make it follow the hand.
        """
        bundle: dict[str, Any] = super()._repr_mimebundle_(**kwargs)  # type: ignore[no-untyped-call]
        drawing = self.model.drawing(**self.values)
        still = self.model.still(**self.values)._repr_html_()
        words = f"<p>{escape(drawing.sentence)} <em>Run this cell to {self.invites}.</em></p>"
        return bundle | {"text/html": still + words + self._for_page()}

    def _for_page(self) -> str:
        data = escape(page_data(self.model, *self._given, self.values))
        return f'<span class="cvnotes-explore" hidden data-explore="{data}"></span>'

    @property
    def values(self) -> dict[str, float]:
        """Where the sliders are, without what the browser adds in the sixteenth digit."""
        return {name: round(float(slider.value), 9) for name, slider in self.sliders.items()}

    def redraw(self, _: Any = None) -> None:
        """Show the picture of the present values, unless it is shown already."""
        values = self.values
        if self._held:
            return
        if self._drawn and self._drawn[0] == values:
            self._tell(self._drawn[1])
            return
        drawing = self.model.drawing(**values)
        self._drawn = values, drawing
        self.image.width = str(drawing.picture.shape[1])
        self.image.value = pack_png(drawing.picture)
        self.matrices.value = drawing.matrices
        self._tell(drawing)
        # An image widget has no alternative text; its description stands here, for the ear only.
        self.sentence.value = (
            f'<span style="{_UNSEEN}">{escape(self.model.about)}</span>'
            f'<div role="status" aria-live="polite" style="{_TWO_LINES}">'
            f"{escape(drawing.sentence)}</div>"
        )

    def reset(self, _: Any = None) -> None:
        """Move every slider back to where it started, and draw once."""
        self.move(self.model.values())

    def move(self, values: Values) -> None:
        """Move sliders, and draw once."""
        self._held = True
        try:
            for setting in self.model.settings:
                value = values[setting.name]
                self.sliders[setting.name].value = bool(value) if setting.is_choice else value
        finally:
            self._held = False
        self.redraw()

    def _controls(self) -> list[Box]:
        """Lay out what is moved below the picture: what can be pulled in it is folded at first."""
        folded, more = self.model.folded(), self._folded_too()
        shown = [slider for name, slider in self.sliders.items() if name not in folded]
        if not folded and not more:
            return [_grid([*shown, self.reset_button])]
        below = VBox([_grid([self.sliders[name] for name in folded]), *more])
        fold = ToggleButton(tooltip="Show the sliders of what can be pulled in the picture")

        def turn(_: Any = None) -> None:
            fold.description = f"{'▾' if fold.value else '▸'} {self.folds}"
            below.layout.display = None if fold.value else "none"

        fold.observe(turn, "value")
        turn()
        return [_grid([*shown, fold, self.reset_button]), below]

    def _folded_too(self) -> list[Any]:
        """Give what is folded below the sliders."""
        return []

    def _hands(self) -> Box:
        """Make what lets a hand take hold of the picture: a script, and its two ways to Python."""
        self._pulled.add_class("cvnotes-pulled")
        self._told.add_class("cvnotes-told")
        self._pulled.observe(self._pull, "value")
        here = files("cvnotes.show.explorations")
        script = "\n".join((here / name).read_text("utf-8") for name in _SCRIPTS)
        data = {"application/javascript": script}
        output = {"output_type": "display_data", "data": data, "metadata": {}}
        return Box([self._pulled, self._told, Output(outputs=(output,))], layout=_NO_ROOM)

    def _pull(self, change: dict[str, Any]) -> None:
        """Move the sliders to where a hand has pulled what it holds."""
        given = json.loads(change["new"])
        self._number = given["number"]
        self.move(self.model.dragged(given["grip"], tuple(given["at"]), **given["values"]))

    def _tell(self, drawing: Drawing) -> None:
        """Tell the script where a hand can take hold of the picture."""
        told = {"number": self._number, "values": self.values, **drawing.as_data()}
        self._told.value = escape(json.dumps(told))


class PulledPoints(Explorer):
    """Points that are pulled over a picture; their sliders and numbers are folded below it.

    Examples
    --------
    >>> from cvnotes.show import pull_points
    >>> pull_points([[0.0, 1]], [[1, 0]], lambda picture, points: ("One point.", [])).points
    array([[1., 0.]])
    """

    invites, folds = "pull its points", "numbers"

    def __init__(self, model: Model) -> None:
        self._numbers = HTML()
        super().__init__(model)

    @property
    def points(self) -> Array:
        """Where the points are, (n, 2): pixels (u, v)."""
        return points_of(self.values)

    def redraw(self, change: Any = None) -> None:
        """Show the picture of the present points, and their numbers."""
        super().redraw(change)
        self._numbers.value = f"<code>{self.points.tolist()}</code>"

    def _folded_too(self) -> list[Any]:
        return [self._numbers]


def _grid(parts: list[Any]) -> GridBox:
    columns = _COLUMNS.format(250 if len(parts) > 7 else 290)
    return GridBox(parts, layout={"grid_template_columns": columns, "width": "100%"})


def _control(setting: Setting) -> Any:
    """Make what a setting is moved by: a switch, a list of its names, or a slider.

    Its numbers are whole where step and start are.
    """
    look = {
        "description": _label(setting),
        "description_allow_html": bool(setting.tint),
        "tooltip": setting.help,
        "layout": {"width": "auto"},
        "style": {"description_width": "85px"},
    }
    if setting.is_choice:
        return Checkbox(value=bool(setting.value), **look)
    if setting.names:
        options = [(name, setting.low + k) for k, name in enumerate(setting.names)]
        return Dropdown(value=setting.value, options=options, **look)
    whole = all(float(x).is_integer() for x in (setting.low, setting.step, setting.value))
    kind, number = (IntSlider, int) if whole else (FloatSlider, float)
    value, low, high, step = map(number, (setting.value, setting.low, setting.high, setting.step))
    digits = len(f"{setting.step:g}".partition(".")[2])
    shown = "d" if whole else f".{digits}f"
    return kind(value=value, min=low, max=high, step=step, readout_format=shown, **look)


def _label(setting: Setting) -> str:
    """Write the label, on the colour that its entries of a matrix have."""
    if not setting.tint:
        return setting.label
    style = f"background:{setting.tint};color:#000;padding:1px 4px;border-radius:3px;"
    style += "font-weight:normal"
    # The front end lets a <b> pass with its style, and no <span>.
    return f'<b style="{style}">{escape(setting.label)}</b>'
