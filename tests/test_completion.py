"""Shells complete the command: what they offer is asked of themselves."""

import os
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


ASKED = [
    ("cvnotes cal", ["calibrate"]),
    ("cvnotes --v", ["--version"]),
    ("cvnotes target --pap", ["--paper"]),
    ("cvnotes target --paper ", ["A3", "A4", "Letter"]),
    ("cvnotes undistort photos --cam", ["--camera"]),
]


@pytest.mark.skipif(shutil.which("fish") is None, reason="fish is not here")
@pytest.mark.parametrize(("line", "words"), ASKED)
def test_fish_offers_them(line, words, capsys, tmp_path):
    main(["completion", "fish"])
    (tmp_path / "script").write_text(capsys.readouterr().out)
    run = ["fish", "--no-config", "-c", f"source script; complete -C '{line}'"]
    done = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert [offer.split("\t")[0] for offer in done.stdout.splitlines()] == words
    assert done.stderr == ""


@pytest.mark.skipif(shutil.which("zsh") is None, reason="zsh is not here")
def test_zsh_offers_them(capsys, tmp_path):
    """On a terminal, as only there zsh completes: one word is written out, several are listed."""
    pexpect = pytest.importorskip("pexpect")
    main(["completion", "zsh"])
    (tmp_path / "script").write_text(capsys.readouterr().out)
    variables = {"TERM": "dumb", "PATH": os.environ["PATH"], "HOME": str(tmp_path)}
    shell = pexpect.spawn(
        "zsh", ["-f", "-i"], env=variables, cwd=tmp_path, encoding="utf-8", timeout=60
    )
    try:
        shell.sendline(
            "PS1='ready> '; autoload -Uz compinit; compinit -u -D; source ./script; echo read in"
        )
        shell.expect("read in\r\n.*ready> ")
        for line, words in ASKED:
            shell.send(line + "\t")
            if len(words) == 1:
                shell.expect_exact(f"{line[: line.rindex(' ')]} {words[0]} ")
            else:
                shell.expect(" +".join(words))
            shell.sendcontrol("u")  # away with the line
    finally:
        shell.close(force=True)
