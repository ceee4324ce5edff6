"""JupyterLab as ``cvnotes lab`` starts it: ``python -m jupyterlab``, a second sooner.

Its settings' formats are checked by jsonschema, which compiles a grammar for addresses in the
letters of any language before it begins. None of Jupyter's settings holds one, and without that
package jsonschema goes on without that check.
"""

import sys
from importlib import import_module


def main() -> None:
    """Become JupyterLab."""
    sys.modules.setdefault("rfc3987_syntax", None)  # type: ignore[arg-type]
    import_module("jupyterlab.labapp").main()


if __name__ == "__main__":
    main()
