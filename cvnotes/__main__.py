"""Run the command: ``python -m cvnotes``."""

import sys

from cvnotes.cli import main

if __name__ == "__main__":
    sys.exit(main())
