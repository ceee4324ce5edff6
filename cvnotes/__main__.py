"""Run the command: ``python -m cvnotes``."""

import sys

from cvnotes.commands.cli import main

if __name__ == "__main__":
    sys.exit(main())
