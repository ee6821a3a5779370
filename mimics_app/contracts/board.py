"""What is laid over the picture for a person to read: a message, and cards with one figure each. It steers nothing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum

__all__ = ["Bar", "Board", "Card", "Tone"]


class Tone(StrEnum):
    """How urgent a figure is; the picture has a colour for each."""

    PLAIN = "plain"
    FAINT = "faint"
    ACCENT = "accent"
    CALM = "calm"
    WARN = "warn"
    ALARM = "alarm"
    LOAD = "load"  # calm, warn or alarm by how full the bar is


@dataclass(frozen=True, slots=True)
class Bar:
    """A bar on a card.

    Attributes:
        value: What fills it, in the unit of the figure.
        full: What fills all of it; None: the largest force of the scene's board (`hud.force_full`).
        tone: Of the filled part.
        right: Between which two values it is as it should be, drawn behind it, or None.
    """

    value: float
    full: float | None = 1.0
    tone: Tone = Tone.ACCENT
    right: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class Card:
    """One figure: a caption, a text, and a bar or a remark beside it.

    Attributes:
        label: Caption in words.
        text: The figure with its unit.
        tone: Of the text.
        bar: A bar below the caption, the text then small above its end; None: the text stands large.
        remark: A second, smaller text.
        remark_tone: Its tone.
        width: Of 1280 by 720 units of the canvas.
    """

    label: str
    text: str
    tone: Tone = Tone.PLAIN
    bar: Bar | None = None
    remark: str = ""
    remark_tone: Tone = Tone.FAINT
    width: float = 150.0


@dataclass(frozen=True, slots=True)
class Board:
    """Everything that may lie over one frame.

    Attributes:
        cards: By the name a scene's `hud.show` lists them under.
        message: In the middle, "" for none; a line break where another line begins.
        alarm: Whether the line is a warning.
        count: What is counted down, large in the middle; 0 for nothing.
    """

    cards: Mapping[str, Card] = field(default_factory=dict)
    message: str = ""
    alarm: bool = False
    count: int = 0

    def saying(self, message: str) -> Board:
        """The same cards under another line; the same board where there is none."""
        return replace(self, message=message) if message else self

    def with_cards(self, cards: Mapping[str, Card]) -> Board:
        """The same line over more cards."""
        return replace(self, cards={**self.cards, **cards})
