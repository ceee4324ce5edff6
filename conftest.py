"""What comes before all tests, also those in the package and in the notebooks."""

import os
import sys

# With it, whoever imports nbformat waits a second for the grammar of addresses in any letters. So
# does nbval, which pytest would load by itself before it reads this.
sys.modules.setdefault("rfc3987_syntax", None)
pytest_plugins = [] if "PYTEST_DISABLE_PLUGIN_AUTOLOAD" in os.environ else ["nbval.plugin"]

# Memory that a process has freed stays with it, in the workers and kernels that start from here: to
# give pages back and have them cleared anew is a twentieth of all that the tests compute.
os.environ.setdefault("MALLOC_TRIM_THRESHOLD_", str(1 << 28))
os.environ.setdefault("MALLOC_MMAP_THRESHOLD_", str(1 << 25))
