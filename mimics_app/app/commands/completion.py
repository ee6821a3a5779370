"""`mimics completion SHELL`: print the script by which a shell completes commands, options, values and scene names.

The script calls `mimics completion words` with one word on each line of stdin; the last one is under the cursor.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

from mimics_app.app.terminal.output import answer

__all__ = ["add_arguments", "run"]

_SCRIPTS = Path(__file__).parents[1] / "terminal" / "completions"
_SHELLS = ("bash", "zsh", "fish")
_SCENES = ("scene", "scenes", "file")
"""Positional arguments that take the name of a shipped scene."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = (
        'bash: eval "$(mimics completion bash)" in ~/.bashrc; zsh: the same after compinit in ~/.zshrc; '
        "fish: mimics completion fish > ~/.config/fish/completions/mimics.fish"
    )
    parser.add_argument(
        "shell",
        choices=(*_SHELLS, "words"),
        help="shell to print the script for; words: print the completions of the words on stdin",
    )


def run(args: argparse.Namespace) -> int:
    """Print the script, or the completions."""
    if args.shell == "words":
        words = sys.stdin.read().removesuffix("\n").split("\n")
        found = _suggest(words, args.known_commands, args.parser_of)
        answer(args, {"words": found}, found)
        return 0
    sys.stdout.write((_SCRIPTS / f"mimics.{args.shell}").read_text(encoding="utf-8"))
    return 0


def _suggest(words: Sequence[str], commands: Iterable[str], parser_of: object) -> list[str]:
    """Return the completions of the last word.

    Args:
        words: Words after the program's name; the last one may be "".
        commands: Names of the commands.
        parser_of: Function that returns the parser of a command by its name.
    """
    last = words[-1]
    if len(words) == 1:
        return [name for name in commands if name.startswith(last)]
    if words[0] not in commands or not callable(parser_of):
        return []
    parser: argparse.ArgumentParser = parser_of(words[0])
    return sorted(word for word in _possible(parser, words[1:-1], last) if word.startswith(last))


def _possible(parser: argparse.ArgumentParser, before: Sequence[str], last: str) -> list[str]:
    options = {name: action for action in parser._actions for name in action.option_strings}
    option = options.get(before[-1]) if before else None
    if option is not None and option.nargs != 0:
        return [str(value) for value in option.choices or ()]
    if last.startswith("-"):
        return [name for name in options if name.startswith("--") and options[name].help != argparse.SUPPRESS]
    places = [action for action in parser._actions if not action.option_strings]
    place = places[min(_given(options, before), len(places) - 1)] if places else None
    if place is None:
        return []
    return _scene_names() if place.dest in _SCENES else [str(value) for value in place.choices or ()]


def _given(options: dict[str, argparse.Action], before: Sequence[str]) -> int:
    """Return the number of words that are neither options nor their values."""
    count, skip = 0, False
    for word in before:
        action = options.get(word)
        if action is None and not skip:
            count += 1
        skip = action is not None and action.nargs != 0
    return count


def _scene_names() -> list[str]:
    from mimics_app.app.scenes.shipped import shipped_scenes

    return [scene.name for scene in shipped_scenes()]
