"""The corners of a board in a picture: found, refined, put in order and doubted (notes 2b.4)."""

from cvnotes.corners.finding import find_corners

__all__ = ["find_corners"]
