"""Parser of one command: what it refuses, and examples below its --help, in a block that is not wrapped."""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from difflib import get_close_matches
from functools import cache
from itertools import takewhile
from pathlib import Path
from typing import Any, NoReturn

from mimics_app.contracts.errors import UsageError

__all__ = ["CommandParser", "HelpFormatter", "examples", "examples_of"]


@cache
def examples() -> dict[str, dict[str, str]]:
    """Return the meaning of command lines, by command and line."""
    content: dict[str, dict[str, str]] = json.loads(Path(__file__).with_name("examples.json").read_bytes())
    return content


def examples_of(command: str) -> str:
    """Return the examples of a command as lines of text; "" where it has none."""
    rows = examples().get(command, {})
    if not rows:
        return ""
    wide = max(map(len, rows))
    return "\n".join(["examples:", *(f"  {typed:{wide}}  {what}" for typed, what in rows.items())])


class HelpFormatter(argparse.ArgumentDefaultsHelpFormatter):
    """Formatter that shows defaults other than None, False and "", and does not wrap the examples."""

    def _get_help_string(self, action: argparse.Action) -> str | None:
        return action.help if action.default in (None, False, "") else super()._get_help_string(action)

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        wrapped, _, block = text.partition("examples:\n")
        parts = [super()._fill_text(wrapped, width, indent)] if wrapped.strip() else []
        return "\n\n".join([*parts, *([f"examples:\n{block}"] if block else [])])


class CommandParser(argparse.ArgumentParser):
    """A parser that raises instead of printing two lines and exiting, and takes no abbreviated option."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings, allow_abbrev=False)

    def error(self, message: str) -> NoReturn:
        """Raise UsageError."""
        raise UsageError(message, f"see {self.prog} --help")

    def parse(self, words: Sequence[str]) -> argparse.Namespace:
        """Read the words of a command; options may come before, between or after its other words."""
        for word in takewhile(lambda word: word != "--", words):
            self._check_option(word)
        if "--" in words:  # which the first of the two passes of parse_intermixed_args would drop
            return self.parse_args(words)
        return self.parse_intermixed_args(words)

    def parse_first(self, words: Sequence[str]) -> argparse.Namespace:
        """Read an option in the place of a command, such as --version."""
        self._check_option(words[0])
        return self.parse_args(words)

    def _check_option(self, word: str) -> None:
        known = self._option_string_actions
        option, _, value = word.partition("=")
        if value == "--":  # argparse would give its command an empty list
            raise UsageError(f"{option} needs a value", f"see {self.prog} --help")
        if option.startswith("--") and " " not in option and option not in known:
            close = get_close_matches(option, known, n=1)
            hint = f'did you mean "{close[0]}"' if close else f"see {self.prog} --help"
            raise UsageError(f'there is no option "{option}"', hint)
