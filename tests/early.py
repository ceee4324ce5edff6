"""What pytest imports before its plug-ins; see `addopts` in pyproject.toml."""

import sys

# With it, each process that imports nbformat, as nbval does, waits a second for the grammar of
# addresses in any letters.
sys.modules.setdefault("rfc3987_syntax", None)
