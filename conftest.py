"""What comes before all tests, also those in the package and in the notebooks."""

import os
import sys

# With it, whoever imports nbformat waits a second for the grammar of addresses in any letters. So
# does nbval, which pytest would load by itself before it reads this.
sys.modules.setdefault("rfc3987_syntax", None)
pytest_plugins = [] if "PYTEST_DISABLE_PLUGIN_AUTOLOAD" in os.environ else ["nbval.plugin"]
