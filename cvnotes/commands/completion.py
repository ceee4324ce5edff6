"""``cvnotes completion``: let a shell complete the command's words."""

import argparse

from cvnotes.commands.console import say

_HOW = {
    "bash": 'eval "$(cvnotes completion bash)"   in ~/.bashrc',
    "zsh": 'eval "$(cvnotes completion zsh)"   in ~/.zshrc, after compinit',
    "fish": "cvnotes completion fish > ~/.config/fish/completions/cvnotes.fish",
}
_TOP = ("-h", "--help", "-V", "--version")


def add_parser(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describe the command's arguments."""
    parser = subparsers.add_parser(
        "completion",
        help="let your shell complete this command",
        description="Print what lets a shell complete commands, options and files after cvnotes.",
        epilog="\n".join(_HOW.values()),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("shell", choices=list(_HOW), help="the shell")


def run(args: argparse.Namespace) -> int:
    """Print a shell's completion of all commands; gives the exit code."""
    commands: argparse._SubParsersAction[argparse.ArgumentParser] = args.commands
    arguments = {
        name: [action for action in parser._actions if action.help != argparse.SUPPRESS]
        for name, parser in commands.choices.items()
    }
    helps = {choice.dest: choice.help or "" for choice in commands._choices_actions}
    write = {"bash": _bash, "zsh": _zsh, "fish": _fish}
    say(write[args.shell](arguments, helps))
    return 0


def _choices(actions: list[argparse.Action]) -> list[str]:
    """Return the words that an argument without an option may be."""
    return [str(c) for a in actions if not a.option_strings for c in a.choices or ()]


def _bash(arguments: dict[str, list[argparse.Action]], helps: dict[str, str]) -> str:
    """Complete options and fixed words; everything else are files."""
    valued = [
        f'        "{name} {option}") words="{" ".join(map(str, action.choices or ()))}" ;;'
        for name in helps
        for action in arguments[name]
        for option in action.option_strings
        if action.nargs != 0
    ]
    plain = []
    for name in helps:
        options = [option for action in arguments[name] for option in action.option_strings]
        words = " ".join(_choices(arguments[name]) + options)
        plain.append(f'            {name}) words="{words}" ;;')
    top = " ".join([*helps, *_TOP])
    return "\n".join(
        [
            "_cvnotes() {",
            '    local word="${COMP_WORDS[COMP_CWORD]}" words=',
            '    local before="${COMP_WORDS[COMP_CWORD-1]}"',
            "    if [ $COMP_CWORD -eq 1 ]; then",
            f'        words="{top}"',
            "    else",
            '        case "${COMP_WORDS[1]} $before" in',
            *valued,
            '        *) case "${COMP_WORDS[1]}" in',
            *plain,
            "        esac ;;",
            "        esac",
            "    fi",
            '    COMPREPLY=($(compgen -W "$words" -- "$word"))',
            "}",
            "complete -o default -F _cvnotes cvnotes",
        ]
    )


def _zsh(arguments: dict[str, list[argparse.Action]], helps: dict[str, str]) -> str:
    """Zsh reads bash's."""
    return "autoload -U +X bashcompinit && bashcompinit\n" + _bash(arguments, helps)


def _fish(arguments: dict[str, list[argparse.Action]], helps: dict[str, str]) -> str:
    """Complete with the help beside each word."""
    lines = []
    for name, actions in arguments.items():
        when = f"__fish_seen_subcommand_from {name}"
        for action in actions:
            said = _quoted((action.help or "").replace("%%", "%"))
            for option in action.option_strings:
                kind = "-l" if option.startswith("--") else "-s"
                values = (
                    f" -a {_quoted(' '.join(map(str, action.choices)))}" if action.choices else ""
                )
                takes = "" if action.nargs == 0 else " -x" if action.choices else " -r"
                flag = f"{kind} {option.lstrip('-')}"
                lines.append(f"complete -c cvnotes -n '{when}' {flag}{takes}{values} -d {said}")
        if words := _choices(actions):
            lines.append(f"complete -c cvnotes -f -n '{when}' -a {_quoted(' '.join(words))}")
    before = "complete -c cvnotes -f -n __fish_use_subcommand"
    lines += [f"{before} -s h -l help", f"{before} -s V -l version"]
    for name, said in helps.items():
        lines.append(f"{before} -a {name} -d {_quoted(said)}")
    return "\n".join(lines)


def _quoted(text: str) -> str:
    """Quote for fish."""
    escaped = text.replace("\\", "\\\\").replace("'", "\\'")
    return f"'{escaped}'"
