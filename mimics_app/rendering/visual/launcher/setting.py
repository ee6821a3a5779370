"""Settings of the launcher: label, help, and allowed values."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from mimics_app.contracts.system.language import translated

__all__ = ["Setting", "SettingChoice", "shown_settings"]


@dataclass(frozen=True, slots=True)
class SettingChoice:
    """A value and its text."""

    value: str
    words: str


@dataclass(frozen=True, slots=True)
class Setting:
    """One setting.

    Attributes:
        name: Identifier.
        label: Caption.
        help: Explanation in one line.
        choices: Its values; the first is the default. May be empty if `typed`.
        typed: Whether any text may be typed.
        empty: Placeholder while nothing is typed.
        with_values: Values of the first setting for which this one is shown; () for all.
        refuse: Returns why a typed value is refused, in words; "" where it is not.
    """

    name: str
    label: str
    help: str
    choices: Sequence[SettingChoice] = ()
    typed: bool = False
    empty: str = ""
    with_values: Sequence[str] = ()
    refuse: Callable[[str], str] | None = None

    @property
    def default(self) -> str:
        """Its default value."""
        return self.choices[0].value if self.choices and not self.typed else ""

    def words(self, value: str) -> str:
        """Return the text of a value in the present language; what is typed stays as it is."""
        if self.typed and not value:
            return translated(self.empty)
        return next((translated(choice.words) for choice in self.choices if choice.value == value), value)

    def allows(self, value: str) -> bool:
        """Whether a value is valid, such as a saved one."""
        return self.typed or any(choice.value == value for choice in self.choices)

    def stepped(self, value: str, step: int) -> str:
        """Return the next (1) or previous (-1) value, cyclically; the same without choices."""
        values = [choice.value for choice in self.choices]
        if not values:
            return value
        if value not in values:
            return values[0 if step > 0 else -1]
        return values[(values.index(value) + step) % len(values)]


def shown_settings(settings: Sequence[Setting], values: Mapping[str, str]) -> list[Setting]:
    """Return the settings that apply at present."""
    leading = values.get(settings[0].name, "") if settings else ""
    return [each for each in settings if not each.with_values or leading in each.with_values]
