"""Content of the heads-up display: a message, and cards with one figure each. For display only."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum

import msgspec

__all__ = ["Bar", "Board", "Card", "Tone"]


class Tone(StrEnum):
    """Urgency of a figure; each has its colour."""

    PLAIN = "plain"
    FAINT = "faint"
    ACCENT = "accent"
    CALM = "calm"
    WARN = "warn"
    ALARM = "alarm"
    LOAD = "load"  # calm, warn or alarm by how full the bar is


class Bar(msgspec.Struct, frozen=True):
    """A bar on a card.

    Attributes:
        value: Present value, in the unit of the figure.
        full: Value of a full bar; None: the largest force of the scene's board (`hud.force_full`).
        tone: Tone of the filled part.
        right: Target range (low, high), drawn behind the bar, or None.
    """

    value: float
    full: float | None = 1.0
    tone: Tone = Tone.ACCENT
    right: tuple[float, float] | None = None


class Card(msgspec.Struct, frozen=True):
    """One figure: a caption, a text, and a bar or a remark.

    Attributes:
        label: Caption.
        text: The figure with its unit.
        tone: Tone of the text.
        bar: A bar below the caption, with the text small above its end; None: the text is large.
        remark: A second, smaller text.
        remark_tone: Tone of the remark.
        width: Width in units of a canvas of 1280 by 720.
    """

    label: str
    text: str
    tone: Tone = Tone.PLAIN
    bar: Bar | None = None
    remark: str = ""
    remark_tone: Tone = Tone.FAINT
    width: float = 150.0


class Board(msgspec.Struct, frozen=True):
    """Heads-up display of one frame.

    Attributes:
        cards: Cards by their name in a scene's `hud.show`.
        message: Text in the centre, possibly of several lines; "" for none.
        alarm: True if the message is a warning.
        neutral: Place of the middle of the hand's lever in the window, each coordinate -1 to 1; None: no lever.
        count: Countdown figure, large in the centre; 0 for none.
        asks: Whether the message is a question that the person answers; it stands at the top, off what it asks about.
    """

    cards: Mapping[str, Card] = msgspec.field(default_factory=dict)
    message: str = ""
    alarm: bool = False
    count: int = 0
    neutral: tuple[float, float] | None = None
    asks: bool = False

    def saying(self, message: str) -> Board:
        """Return the board with another message; unchanged for an empty one."""
        return msgspec.structs.replace(self, message=message, asks=False) if message else self

    def for_wearer(self) -> Board:
        """Return what the wearer of a headset sees: a countdown, a question, a warning; all else is the operator's."""
        return Board(
            message=self.message if self.asks or self.alarm else "", alarm=self.alarm, count=self.count, asks=self.asks
        )

    def with_cards(self, cards: Mapping[str, Card]) -> Board:
        """Return the board with more cards."""
        return msgspec.structs.replace(self, cards={**self.cards, **cards})
