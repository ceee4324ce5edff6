"""What the ``cvnotes`` command does: a module for each of its sub-commands."""
