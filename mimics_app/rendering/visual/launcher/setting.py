"""A setting of the launcher: what it is called, what it helps with, and the values it may have."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

__all__ = ["Choice", "Setting", "shown_settings"]


@dataclass(frozen=True, slots=True)
class Choice:
    """A value, and how a person reads it."""

    value: str
    words: str


@dataclass(frozen=True, slots=True)
class Setting:
    """One setting.

    Attributes:
        name: Of the setting, for programs.
        label: Caption.
        help: A line that says what it does.
        choices: Its values; the first is the default. What may be typed may have none.
        typed: Whether any text may be typed.
        empty: What stands there where nothing was typed.
        with_values: It is shown only while the first setting has one of these values; () for always.
    """

    name: str
    label: str
    help: str
    choices: Sequence[Choice] = ()
    typed: bool = False
    empty: str = ""
    with_values: Sequence[str] = ()

    @property
    def default(self) -> str:
        """Its value until somebody chooses."""
        return self.choices[0].value if self.choices and not self.typed else ""

    def words(self, value: str) -> str:
        """How a person reads a value."""
        if self.typed and not value:
            return self.empty
        return next((choice.words for choice in self.choices if choice.value == value), value)

    def allows(self, value: str) -> bool:
        """Whether it may have a value, such as one that was remembered."""
        return self.typed or any(choice.value == value for choice in self.choices)

    def stepped(self, value: str, step: int) -> str:
        """The value that follows, or that comes before; the same where there is no other."""
        values = [choice.value for choice in self.choices]
        if not values:
            return value
        if value not in values:
            return values[0 if step > 0 else -1]
        return values[(values.index(value) + step) % len(values)]


def shown_settings(settings: Sequence[Setting], values: Mapping[str, str]) -> list[Setting]:
    """The settings that matter now."""
    leading = values.get(settings[0].name, "") if settings else ""
    return [each for each in settings if not each.with_values or leading in each.with_values]
