"""Shells complete the command: what bash offers is asked of bash itself."""

import shutil
import subprocess

import pytest

from cvnotes.commands.cli import main

pytestmark = pytest.mark.once


def offered(line, capsys, folder):
    """Give what bash offers for the last word of a line."""
    assert main(["completion", "bash"]) == 0
    words = line.split(" ")
    script = f"""{capsys.readouterr().out}
        COMP_WORDS=({" ".join(f"'{word}'" for word in words)})
        COMP_CWORD={len(words) - 1}
        _cvnotes
        printf '%s\\n' "${{COMPREPLY[@]}}"
    """
    run = ["bash", "-c", script]
    done = subprocess.run(run, cwd=folder, capture_output=True, text=True, check=True)
    assert done.stderr == ""
    return done.stdout.split()


@pytest.mark.skipif(shutil.which("bash") is None, reason="asks bash")
@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("cvnotes cal", ["calibrate"]),
        ("cvnotes --v", ["--version"]),
        ("cvnotes target --pap", ["--paper"]),
        ("cvnotes target --paper A", ["A4", "A3"]),
        ("cvnotes target --paper --ou", []),  # a value is wanted there
        ("cvnotes undistort photos --cam", ["--camera"]),
        ("cvnotes undistort photos", []),  # files are completed by bash itself
        ("cvnotes completion ", ["bash", "zsh", "fish", "-h", "--help"]),
    ],
)
def test_bash_offers_commands_options_and_choices(line, words, capsys, tmp_path):
    assert offered(line, capsys, tmp_path) == words


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_every_shell_knows_every_command_and_option(shell, capsys):
    main(["completion", shell])
    script = capsys.readouterr().out
    for word in ("lab", "calibrate", "undistort", "grade", "half-turn-symmetric", "Letter"):
        assert word in script


@pytest.mark.parametrize("shell", ["zsh", "fish"])
def test_what_is_printed_is_of_that_shells_grammar(shell, capsys, tmp_path):
    if shutil.which(shell) is None:
        pytest.skip(f"{shell} is not here")
    main(["completion", shell])
    (tmp_path / "script").write_text(capsys.readouterr().out)
    done = subprocess.run([shell, "-n", tmp_path / "script"], capture_output=True, check=False)
    assert (done.returncode, done.stderr) == (0, b"")
