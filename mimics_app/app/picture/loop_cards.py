"""Cards of the loop on every board: stability of contacts, and the state of a walk in a gait orthosis."""

from __future__ import annotations

from collections.abc import Mapping

from mimics_app.app.picture.board import stability_card
from mimics_app.contracts.loop.gait_state import GaitState
from mimics_app.contracts.messages.board import Card, Tone
from mimics_app.contracts.messages.stage_messages import HapticSnapshot
from mimics_app.contracts.system.phrases import phrase

__all__ = ["gait_card", "loop_cards"]

_WIDTH = 880.0
"""Width of the card: a sentence has to be read whole, in every language, by somebody who walks."""

_WORDS: Mapping[GaitState, tuple[str, Tone]] = {
    GaitState.WALKING: (phrase("Walk"), Tone.CALM),
    GaitState.OBSTACLE_ENABLED: (
        phrase("An obstacle is ahead of the {free} foot. Walk until the belt stops"),
        Tone.WARN,
    ),
    GaitState.STOPPING: (phrase("Stop. Wait until the {free} leg is free"), Tone.WARN),
    GaitState.COLLISION_ENABLED: (phrase("Stand on the {other} leg. The obstacle can be felt now"), Tone.WARN),
    GaitState.LEG_RELEASED: (phrase("The {free} leg is being released. Stand on the {other} one"), Tone.ACCENT),
    GaitState.EXPLORING: (phrase("Explore the obstacle with the {free} foot"), Tone.ACCENT),
    GaitState.GUIDANCE_RESTORED: (phrase("Wait. The orthosis takes up both legs"), Tone.WARN),
    GaitState.TO_START: (phrase("Wait. The orthosis brings both legs to the start"), Tone.WARN),
    GaitState.RESUMING: (phrase("Walk on. The belt starts"), Tone.CALM),
    GaitState.STANDING: (phrase("Stand still. Brakes hold both legs"), Tone.ALARM),
}
"""Words to the person, and their urgency, by state; {free} is the leg that an obstacle frees, {other} the other."""

_LEGS = (phrase("left"), phrase("right"))


def loop_cards(snapshot: HapticSnapshot) -> dict[str, Card]:
    """Return the cards by their names: "margin", and "gait" during a walk in a gait orthosis."""
    gait = gait_card(snapshot.gait_state, snapshot.free_leg)
    return {"margin": stability_card(snapshot)} | ({} if gait is None else {"gait": gait})


def gait_card(state: int, free_leg: int) -> Card | None:
    """Return the card of a gait state and the leg that an obstacle frees, by their numbers in a snapshot.

    None for the state -1, no walk.
    """
    if state < 0:
        return None
    text, tone = _WORDS[GaitState(state)]
    words = {} if free_leg < 0 else {"free": _LEGS[free_leg], "other": _LEGS[1 - free_leg]}
    return Card(phrase("Walk in the orthosis"), text.format(**words), tone, width=_WIDTH)
