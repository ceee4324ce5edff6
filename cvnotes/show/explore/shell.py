"""The thin shell around a model: sliders, a reset button, and a picture that follows."""

from html import escape
from typing import Any

from ipywidgets.widgets.widget_box import GridBox, VBox
from ipywidgets.widgets.widget_button import Button
from ipywidgets.widgets.widget_float import FloatSlider
from ipywidgets.widgets.widget_int import IntSlider
from ipywidgets.widgets.widget_media import Image
from ipywidgets.widgets.widget_string import HTML

from cvnotes.show.explore.model import Model, Setting, pack_png

_COLUMNS = "repeat(auto-fit, minmax(290px, 1fr))"


class Explorer(VBox):
    """Sliders of a model, its sentence and its picture, for a notebook.

    Every slider can be reached with Tab and moved with the arrow keys. The front end sends the
    newest value only after the picture of the one before has arrived, so nothing piles up however
    quickly a slider is dragged.

    Parameters
    ----------
    model : Model
        What is shown.

    Examples
    --------
    >>> from cvnotes.show.explore import explore_lens
    >>> explorer = explore_lens()
    >>> explorer.sliders["k1"].value = -0.3
    >>> explorer.values["k1"]
    -0.3
    """

    def __init__(self, model: Model) -> None:
        self.model = model
        self.sliders = {s.name: _slider(s) for s in model.settings}
        self.reset_button = Button(
            description="Reset", icon="undo", tooltip="Move every slider back to where it started"
        )
        self.sentence = HTML()
        self.image = Image(format="png", tooltip=model.about)
        self._drawn: dict[str, float] | None = None
        self._held = False
        self.redraw()
        for slider in self.sliders.values():
            slider.observe(self.redraw, "value")
        self.reset_button.on_click(self.reset)
        controls = GridBox(
            [*self.sliders.values(), self.reset_button],
            layout={"grid_template_columns": _COLUMNS, "width": "100%"},
        )
        super().__init__([controls, self.sentence, self.image])  # type: ignore[no-untyped-call]

    @property
    def values(self) -> dict[str, float]:
        """Where the sliders are."""
        return {name: slider.value for name, slider in self.sliders.items()}

    def redraw(self, _: Any = None) -> None:
        """Show the picture of the present values, unless it is shown already."""
        values = self.values
        if self._held or values == self._drawn:
            return
        self._drawn = values
        sight = self.model.sight(**values)
        self.image.width = str(sight.picture.shape[1])
        self.image.value = pack_png(sight.picture)
        self.sentence.value = (
            f'<div role="status" aria-live="polite">{escape(sight.sentence)}</div>'
        )

    def reset(self, _: Any = None) -> None:
        """Move every slider back to where it started, and draw once."""
        self._held = True
        try:
            for setting in self.model.settings:
                self.sliders[setting.name].value = setting.value
        finally:
            self._held = False
        self.redraw()


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
        description=setting.label,
        tooltip=setting.help,
        readout_format="d" if whole else f".{digits}f",
        layout={"width": "auto"},
        style={"description_width": "95px"},
    )
