import pytest

from cvnotes.commands.cli import main
from cvnotes.targets import Chessboard


def cvnotes(*arguments):
    """Run the command and give its exit code, as the command line would."""
    return main([str(argument) for argument in arguments])


def test_the_board_asked_for_is_written_and_the_user_told_to_check_the_ruler(tmp_path, capsys):
    out = tmp_path / "board.pdf"
    options = ["--corners", "7x4", "--square", "22.5", "--paper", "Letter", "--out", out]
    assert cvnotes("target", *options) == 0
    assert out.read_bytes() == Chessboard((7, 4), 22.5).sheet("Letter").pdf()
    said = capsys.readouterr()
    assert "both rulers are 100 mm" in said.out
    assert said.err == ""


@pytest.mark.parametrize(("said", "meant"), [("a4", "A4"), ("LETTER", "Letter"), ("a3", "A3")])
def test_a_paper_may_be_written_small(said, meant, tmp_path):
    assert cvnotes("target", "--paper", said, "--out", tmp_path / "board.svg") == 0
    assert (tmp_path / "board.svg").read_text() == Chessboard((9, 6), 25.0).sheet(meant).svg()


@pytest.mark.parametrize("name", ["thesis.pdf", "thesis.svg"])
def test_a_file_of_the_users_is_not_replaced_but_an_earlier_sheet_is(name, tmp_path, capsys):
    out = tmp_path / name
    out.write_text("five years of work")
    assert cvnotes("target", "--out", out) == 1
    assert out.read_text() == "five years of work"
    assert f"{name} was not made by cvnotes target" in capsys.readouterr().err
    out.unlink()
    assert cvnotes("target", "--corners", "7x4", "--out", out) == 0
    assert cvnotes("target", "--charuco", "--out", out) == 0
    assert cvnotes("target", "--out", out) == 0
    assert out.read_bytes() == Chessboard((9, 6), 25.0).sheet().encoded(out)


def test_the_default_is_the_board_of_the_course_on_a4(tmp_path):
    assert cvnotes("target", "--out", tmp_path / "new" / "board.svg") == 0
    assert (tmp_path / "new" / "board.svg").read_text() == Chessboard((9, 6), 25.0).sheet().svg()


@pytest.mark.parametrize(
    ("options", "code", "words"),
    [
        (["--square", "26"], 1, "does not fit on A4; squares of up to 25 mm do, or take A3"),
        (["--corners", "8x6"], 2, "looks the same after half a turn"),
        (["--corners", "8x6"], 2, "or say --half-turn-symmetric"),
        (["--corners", "9x1"], 2, "at least 2×2"),
    ],
)
def test_what_cannot_be_done_is_one_line_and_leaves_no_file(options, code, words, tmp_path, capsys):
    assert cvnotes("target", *options, "--out", tmp_path / "board.pdf") == code
    said = capsys.readouterr()
    assert words in said.err
    assert said.err.count("\n") == 1
    assert said.out == ""
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--corners", "9"], "expected inner corners such as 9x6, got '9'"),
        (["--corners", "9x-6"], "expected inner corners such as 9x6"),
        (["--corners", "99999x2"], "expected inner corners such as 9x6"),
        (["--square", "0"], "expected a length such as 25, got '0'"),
        (["--square", "nan"], "expected a length such as 25, got 'nan'"),
        (["--square", "0,025"], "write a point for the comma"),
        (["--paper", "A5"], "invalid choice: 'A5'"),
    ],
)
def test_wrong_usage_exits_with_2_and_says_what_was_expected(options, words, tmp_path, capsys):
    with pytest.raises(SystemExit) as ended:
        cvnotes("target", *options, "--out", tmp_path / "board.pdf")
    assert ended.value.code == 2
    assert words in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_file_name_without_a_known_suffix_is_refused(tmp_path, capsys):
    assert cvnotes("target", "--out", tmp_path / "board.png") == 1
    assert ".pdf or .svg" in capsys.readouterr().err


def test_a_symmetric_board_can_be_had_by_name(tmp_path):
    options = ["--corners", "8x6", "--half-turn-symmetric", "--out", tmp_path / "board.pdf"]
    assert cvnotes("target", *options) == 0


def test_a_target_that_cannot_be_written_is_said_in_words(tmp_path, capsys):
    (tmp_path / "taken.pdf").mkdir()
    assert cvnotes("target", "--out", tmp_path / "taken.pdf") == 1
    assert "it is a folder" in capsys.readouterr().err
