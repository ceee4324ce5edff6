"""Draw the picture with which README and the site begin: python tools/draw_front.py."""

from front_page import EXPLORED, PICTURE

from cvnotes.show import explorations

if __name__ == "__main__":
    PICTURE.write_bytes(explorations.model(EXPLORED).still().data)
