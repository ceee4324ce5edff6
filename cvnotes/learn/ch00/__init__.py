"""Exercise of the first page: how much a row of corners bends."""
