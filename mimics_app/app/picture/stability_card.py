"""The card of the haptic loop's stability monitor."""

from __future__ import annotations

from mimics_app.contracts.board import Card, Tone
from mimics_app.contracts.messages import HapticSnapshot

__all__ = ["stability_card"]

_MOST_SHOWN = 9.99
_NARROW = 0.25
"""Below this margin [-] a wall is near its limit: the rule itself may be off by as much."""
_SOFTENED = 0.995
"""A larger share of the authored stiffness is shown as all of it."""
_LEAK = 1e-4
"""Energy [J] a contact may give before it is shown as a fault: less cannot be felt."""


def stability_card(snapshot: HapticSnapshot) -> Card:
    """How much stiffer the wall might be before it may swing up, and the energy of the newest contact.

    Where the wall is softened to stay stable, the share of its stiffness that is left stands instead.
    """
    margin, energy, share = snapshot.margin, snapshot.energy, snapshot.stiffness_share
    text = f"{100.0 * min(margin, _MOST_SHOWN):+.0f} %" if margin < _MOST_SHOWN else f"> {100.0 * _MOST_SHOWN:.0f} %"
    tone = _tone(margin)
    if share < _SOFTENED:
        text, tone = f"soft {100.0 * share:.0f} %", Tone.WARN
    remark_tone = Tone.ALARM if energy < -_LEAK else Tone.FAINT
    remark = f"{round(1e3 * energy, 1) + 0.0:.1f} mJ"  # never -0.0
    return Card("Stability", text, tone, remark=remark, remark_tone=remark_tone, width=220.0)


def _tone(margin: float) -> Tone:
    if margin < 0.0:
        return Tone.ALARM
    return Tone.WARN if margin < _NARROW else Tone.CALM
