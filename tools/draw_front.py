"""Draw the picture with which README and the site begin: python tools/draw_front.py."""

from front_page import PICTURE, drawn

if __name__ == "__main__":
    drawn().save(PICTURE, optimize=True)
