"""The thin shell around a model: sliders, a reset button, and a picture that follows."""

from html import escape
from typing import Any

from ipywidgets.widgets.widget_bool import Checkbox
from ipywidgets.widgets.widget_box import GridBox, VBox
from ipywidgets.widgets.widget_button import Button
from ipywidgets.widgets.widget_float import FloatSlider
from ipywidgets.widgets.widget_int import IntSlider
from ipywidgets.widgets.widget_media import Image
from ipywidgets.widgets.widget_string import HTML

from cvnotes.base.png import pack_png
from cvnotes.camera import Camera
from cvnotes.show.explore.model import Model, Setting
from cvnotes.show.explore.page import told
from cvnotes.targets import Chessboard

_UNSEEN = "position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%)"
_TWO_LINES = "min-height: 2.8em; line-height: 1.4"  # so that the picture stays where it is
_COLUMNS = "repeat(auto-fit, minmax({}px, 1fr))"


class Explorer(VBox):
    """Sliders of a model, its sentence and its picture, for a notebook.

    Every slider can be reached with Tab and moved with the arrow keys. The front end sends the
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
    >>> from cvnotes.show import explore_lens
    >>> explorer = explore_lens()
    >>> explorer
    explore lens: run this cell to move its sliders
    >>> explorer.sliders["k1"].value = -0.3
    >>> explorer.values["k1"]
    -0.3
    """

    def __init__(
        self, model: Model, camera: Camera | None = None, board: Chessboard | None = None
    ) -> None:
        self.model = model
        self._given = camera, board
        self.sliders = {s.name: _control(s) for s in model.settings}
        self.reset_button = Button(
            description="Reset", icon="undo", tooltip="Move every slider back to where it started"
        )
        self.sentence, self.matrices = HTML(), HTML()
        self.image = Image(format="png")
        self._drawn: dict[str, float] | None = None
        self._held = False
        self.redraw()
        for slider in self.sliders.values():
            slider.observe(self.redraw, "value")
        self.reset_button.on_click(self.reset)
        many = len(self.sliders) > 6
        controls = GridBox(
            [*self.sliders.values(), self.reset_button],
            layout={
                "grid_template_columns": _COLUMNS.format(250 if many else 290),
                "width": "100%",
            },
        )
        beside = [self.matrices] if self.matrices.value else []
        super().__init__([controls, self.sentence, self.image, *beside])  # type: ignore[no-untyped-call]

    def __repr__(self) -> str:
        return f"explore {self.model.name}: run this cell to move its sliders"

    def _repr_mimebundle_(self, **kwargs: Any) -> dict[str, Any]:
        """Return the view of the widget, and the still for whoever cannot show that.

        With the still comes, as data, what a page needs to make it follow the hand.
        """
        bundle: dict[str, Any] = super()._repr_mimebundle_(**kwargs)  # type: ignore[no-untyped-call]
        sight = self.model.sight(**self.values)
        data = escape(told(self.model, *self._given, self.values))
        still = self.model.still(**self.values)._repr_html_()
        words = f"<p>{escape(sight.sentence)} <em>Run this cell to move its sliders.</em></p>"
        for_page = f'<span class="cvnotes-explore" hidden data-explore="{data}"></span>'
        return bundle | {"text/html": still + words + for_page}

    @property
    def values(self) -> dict[str, float]:
        """Where the sliders are, without what the browser adds in the sixteenth digit."""
        return {name: round(float(slider.value), 9) for name, slider in self.sliders.items()}

    def redraw(self, _: Any = None) -> None:
        """Show the picture of the present values, unless it is shown already."""
        values = self.values
        if self._held or values == self._drawn:
            return
        self._drawn = values
        sight = self.model.sight(**values)
        self.image.width = str(sight.picture.shape[1])
        self.image.value = pack_png(sight.picture)
        self.matrices.value = sight.matrices
        # An image widget has no alternative text; its description stands here, for the ear only.
        self.sentence.value = (
            f'<span style="{_UNSEEN}">{escape(self.model.about)}</span>'
            f'<div role="status" aria-live="polite" style="{_TWO_LINES}">'
            f"{escape(sight.sentence)}</div>"
        )

    def reset(self, _: Any = None) -> None:
        """Move every slider back to where it started, and draw once."""
        self._held = True
        try:
            for setting in self.model.settings:
                started = bool(setting.value) if setting.is_choice else setting.value
                self.sliders[setting.name].value = started
        finally:
            self._held = False
        self.redraw()


def _control(setting: Setting) -> Any:
    """Make what a setting is moved by: a switch for a choice, else a slider."""
    if not setting.is_choice:
        return _slider(setting)
    return Checkbox(
        value=bool(setting.value),
        description=_label(setting),
        description_allow_html=bool(setting.tint),
        tooltip=setting.help,
        layout={"width": "auto"},
        style={"description_width": "85px"},
    )


def _slider(setting: Setting) -> Any:
    """Make the slider of a setting; whole numbers where step and start are whole."""
    whole = all(float(x).is_integer() for x in (setting.low, setting.step, setting.value))
    kind = IntSlider if whole else FloatSlider
    number = int if whole else float
    digits = len(f"{setting.step:g}".partition(".")[2])
    return kind(
        value=number(setting.value),
        min=number(setting.low),
        max=number(setting.high),
        step=number(setting.step),
        description=_label(setting),
        description_allow_html=bool(setting.tint),
        tooltip=setting.help,
        readout_format="d" if whole else f".{digits}f",
        layout={"width": "auto"},
        style={"description_width": "85px"},
    )


def _label(setting: Setting) -> str:
    """Write the label, on the colour that its entries of a matrix have."""
    if not setting.tint:
        return setting.label
    style = f"background:{setting.tint};color:#000;padding:1px 4px;border-radius:3px;"
    style += "font-weight:normal"
    # The front end lets a <b> pass with its style, and no <span>.
    return f'<b style="{style}">{escape(setting.label)}</b>'
