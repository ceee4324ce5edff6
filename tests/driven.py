"""What browsers that tests drive without Playwright have in common."""

import time

KEYS = {"ArrowLeft": "\ue012", "ArrowRight": "\ue014", "Tab": "\ue004", "Enter": "\ue007"}


class Driven:
    """A browser with one page, that runs JavaScript (`run`) and acts as devices do (`perform`)."""

    touch = True  # whether a thumb can be played
    errors = ()  # that the page has met, where the browser tells

    def wait(self, function, *given, seconds=120):
        """Wait until a function of JavaScript gives something; gives that."""
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            if found := self.run(function, *given):
                return found
            time.sleep(0.1)
        raise TimeoutError(f"not in {seconds} s: {function} {given}")

    def press(self, *keys):
        """Press keys one after the other."""
        strokes = []
        for key in keys:
            value = KEYS.get(key, key)
            strokes += [{"type": "keyDown", "value": value}, {"type": "keyUp", "value": value}]
        self.perform({"type": "key", "id": "keys", "actions": strokes})

    def drag(self, places, kind="mouse"):
        """Take hold at the first place, in px of the window, and let go at the last."""
        moves = [
            {"type": "pointerMove", "x": round(x), "y": round(y), "duration": 60} for x, y in places
        ]
        down, up = {"type": "pointerDown", "button": 0}, {"type": "pointerUp", "button": 0}
        actions = [moves[0], down, *moves[1:], up]
        parameters = {"pointerType": kind}
        self.perform({"type": "pointer", "id": kind, "parameters": parameters, "actions": actions})
