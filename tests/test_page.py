import re
from xml.etree import ElementTree

import pytest

from cvnotes.targets.page import Area, Line, Page, Text, rectangle

PAGE = Page(
    "A (test) & more",
    (120.0, 80.0),
    (
        Area((rectangle(10, 20, 30, 5.5), ((1, 1), (2, 1), (1, 2))), 0.5),
        Line(((0, 0), (12.345678, 80))),
        Text(5, 6, "50 % (not 2 × 25)", 3.0, "Helvetica-Bold"),
    ),
)


def test_the_pdf_says_where_each_of_its_objects_begins():
    file = PAGE.pdf()
    start = int(re.search(rb"startxref\n(\d+)\n%%EOF\n$", file)[1])
    assert file[start:].startswith(b"xref\n0 9\n")
    entries = re.findall(rb"(\d{10}) 00000 n \n", file[start:])
    assert len(entries) == 8
    for i, entry in enumerate(entries, start=1):
        assert file[int(entry) :].startswith(b"%d 0 obj\n" % i)


def test_the_pdf_stream_is_as_long_as_it_says():
    length, stream = re.search(
        rb"/Length (\d+) >>\nstream\n(.*)\nendstream", PAGE.pdf(), re.S
    ).groups()
    assert int(length) == len(stream)


def test_the_pdf_page_has_the_papers_size_in_points_and_is_drawn_in_millimetres():
    file = PAGE.pdf().decode("cp1252")
    width, height = map(float, re.search(r"/MediaBox \[0 0 (\S+) (\S+)\]", file).groups())
    assert width == pytest.approx(120 / 25.4 * 72, abs=1e-5)
    assert height == pytest.approx(80 / 25.4 * 72, abs=1e-5)
    matrix = [float(x) for x in re.search(r"stream\n(.*) cm\n", file)[1].split()]
    # (x, y) millimetres from the top left, to points from the bottom left.
    assert 10 * matrix[0] + 20 * matrix[2] + matrix[4] == pytest.approx(10 / 25.4 * 72, abs=1e-5)
    assert 10 * matrix[1] + 20 * matrix[3] + matrix[5] == pytest.approx(60 / 25.4 * 72, abs=1e-5)
    assert "0.5 g 10 20 m 40 20 l 40 25.5 l 10 25.5 l h 1 1 m 2 1 l 1 2 l h f" in file
    assert "0 0 m 12.345678 80 l S" in file


def test_the_pdf_asks_to_be_printed_unscaled_and_carries_no_date():
    file = PAGE.pdf()
    assert b"/PrintScaling /None" in file
    assert b"Date" not in file
    assert file == PAGE.pdf()


def test_brackets_and_signs_survive_in_pdf_text():
    assert "(50 % \\(not 2 × 25\\)) Tj" in PAGE.pdf().decode("cp1252")


def test_the_svg_is_well_formed_and_a_user_unit_is_a_millimetre():
    root = ElementTree.fromstring(PAGE.svg())
    assert (root.get("width"), root.get("height")) == ("120mm", "80mm")
    assert root.get("viewBox") == "0 0 120 80"
    name = "{http://www.w3.org/2000/svg}"
    assert root.find(f"{name}title").text == "A (test) & more"
    area = root.find(f"{name}path")
    assert area.get("d") == "M10 20 40 20 40 25.5 10 25.5Z M1 1 2 1 1 2Z"
    assert area.get("fill") == "#808080"
    assert root.find(f"{name}polyline").get("points") == "0 0 12.345678 80"
    assert root.find(f"{name}text").text == "50 % (not 2 × 25)"


def test_lengths_are_written_without_exponents():
    page = Page("tiny", (1e7, 1.0), (Line(((1e-9, -1e-9), (1e7, 0.1 + 0.2))),))
    assert "0 0 m 10000000 0.3 l S" in page.pdf().decode("cp1252")
