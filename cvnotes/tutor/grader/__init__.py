"""The class: notebooks run each in its own process, and marked."""
