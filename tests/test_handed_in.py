"""Hostile trees among what was handed in: each is told of, and nobody else's notebook is lost."""

import os
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from cvnotes.tutor.grader.handed_in import listed

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="files as on Unix")
GOOD = b'{"cells": []}'


def to_itself(hand):
    (hand / "loop").symlink_to(hand / "loop")


def notebook_to_itself(hand):
    (hand / "01.ipynb").symlink_to("01.ipynb")


def two_to_each_other(hand):
    (hand / "a").symlink_to("b")
    (hand / "b").symlink_to("a")


def to_the_parent(hand):
    (hand / "up").symlink_to("..")


def to_the_root(hand):
    (hand / "root").symlink_to("/")


def to_nowhere(hand):
    (hand / "01.ipynb").symlink_to("gone.ipynb")


def to_endless_zeros(hand):
    (hand / "01.ipynb").symlink_to("/dev/zero")


def to_a_terminal(hand):
    (hand / "01.ipynb").symlink_to("/dev/tty")


def to_processes(hand):
    (hand / "proc").symlink_to("/proc/self/fd")


def pipe(hand):
    os.mkfifo(hand / "01.ipynb")


def pipe_of_another_name(hand):
    os.mkfifo(hand / "notes.txt")


def listening(hand):
    here = Path.cwd()
    os.chdir(hand)  # the name of a socket has a hundred letters at most
    try:
        with socket.socket(socket.AF_UNIX) as server:
            server.bind("01.ipynb")
    finally:
        os.chdir(here)


def folder_as_notebook(hand):
    (hand / "01.ipynb").mkdir()


def notebook_in_folder_as_notebook(hand):
    (hand / "01.ipynb").mkdir()
    (hand / "01.ipynb" / "02.ipynb").write_bytes(GOOD)


def long_name(hand):
    (hand / ("n" * 244 + ".ipynb")).write_bytes(GOOD)


def odd_name(hand):
    (hand / "a\n\x1b[31m\u202e.ipynb").write_bytes(GOOD)


def bytes_as_name(hand):
    Path(os.fsdecode(os.fsencode(hand) + b"/\xff\xfe.ipynb")).write_bytes(GOOD)


def nested(hand):
    here = Path.cwd()
    os.chdir(hand)  # deeper than a path may be long, and than Python calls itself
    try:
        for _ in range(1500):
            Path("dddd").mkdir()
            os.chdir("dddd")
        Path("01.ipynb").write_bytes(GOOD)
    finally:
        os.chdir(here)


def no_permission_for_a_folder(hand):
    (hand / "closed").mkdir()
    (hand / "closed" / "01.ipynb").write_bytes(GOOD)
    (hand / "closed").chmod(0)


def no_permission_for_a_notebook(hand):
    (hand / "01.ipynb").write_bytes(GOOD)
    (hand / "01.ipynb").chmod(0)


def not_even_listed(hand):
    (hand / "01.ipynb").write_bytes(GOOD)
    hand.chmod(0o600)


def larger_than_all(hand):
    with (hand / "01.ipynb").open("wb") as file:
        file.truncate(2**40)


def thousand_files(hand):
    for i in range(1000):
        (hand / f"{i}.tmp").touch()


# What is said of each, by a part of the words; "" where there are notebooks.
HOSTILE = {
    to_itself: "wrong file type",
    notebook_to_itself: "not a regular file",
    two_to_each_other: "wrong file type",
    to_the_parent: "wrong file type",
    to_the_root: "wrong file type",
    to_nowhere: "not a regular file",
    to_endless_zeros: "not a regular file",
    to_a_terminal: "not a regular file",
    to_processes: "wrong file type",
    pipe: "not a regular file",
    pipe_of_another_name: "wrong file type",
    listening: "not a regular file",
    folder_as_notebook: "not a regular file",
    notebook_in_folder_as_notebook: "not a regular file",
    long_name: "",
    odd_name: "",
    bytes_as_name: "",
    nested: "cannot be read: File name too long",
    no_permission_for_a_folder: "cannot be read: Permission denied",
    no_permission_for_a_notebook: "cannot be read: Permission denied",
    not_even_listed: "cannot be read: Permission denied",
    larger_than_all: "larger than 100 MB",
    thousand_files: "wrong file type",
}


@pytest.fixture
def class_with(tmp_path):
    """A folder of hand-ins: ada's good one, and one made by a function."""

    def make(hostile):
        closed = "permission" in hostile.__name__ or hostile is not_even_listed
        if closed and os.geteuid() == 0:
            pytest.skip("root reads everything")
        for name in ("ada", "mallory"):
            (tmp_path / "class" / name).mkdir(parents=True)
        (tmp_path / "class" / "ada" / "01.ipynb").write_bytes(GOOD)
        hostile(tmp_path / "class" / "mallory")
        return tmp_path / "class"

    yield make
    for path in (tmp_path / "class" / "mallory", tmp_path / "class" / "mallory" / "closed"):
        if path.is_dir():
            path.chmod(0o700)
    # Python's own way to remove a tree calls itself for each folder, too deep for the nested one.
    subprocess.run(["rm", "-rf", str(tmp_path / "class")], check=True)


@pytest.mark.parametrize("hostile", HOSTILE, ids=lambda f: f.__name__)
def test_a_hostile_tree_is_told_of_and_the_others_are_read(hostile, class_with):
    found = listed(class_with(hostile), ours=[Path("outputs")])
    assert [one.content for one in found if one.student == "ada"] == [GOOD]
    theirs = [one for one in found if one.student.startswith("mallory")]
    assert theirs
    said = [one.content for one in theirs if isinstance(one.content, str)]
    if HOSTILE[hostile]:
        assert any(HOSTILE[hostile] in why for why in said), theirs
    else:
        assert [one.content for one in theirs] == [GOOD]
    for one in theirs:
        assert (one.student + one.notebook).isprintable()


@pytest.mark.parametrize("name", ["loop", "loop.ipynb", "loop.txt"])
def test_a_link_to_itself_beside_the_folders_is_no_end(name, tmp_path):
    (tmp_path / "ada").mkdir()
    (tmp_path / "ada" / "01.ipynb").write_bytes(GOOD)
    (tmp_path / name).symlink_to(tmp_path / name)
    found = listed(tmp_path, ours=[tmp_path / "grades.csv"])
    assert GOOD in [one.content for one in found]
