"""Cards of the loop on every board: stability of contacts, and the state of a walk in a gait orthosis."""

from __future__ import annotations

from collections.abc import Mapping

from mimics_app.app.picture.board import stability_card
from mimics_app.contracts.loop.gait_state import GaitState
from mimics_app.contracts.messages.board import Card, Tone
from mimics_app.contracts.messages.stage_messages import HapticSnapshot

__all__ = ["gait_card", "loop_cards"]

_WIDTH = 560.0

_WORDS: Mapping[GaitState, tuple[str, Tone]] = {
    GaitState.WALKING: ("Walk", Tone.CALM),
    GaitState.OBSTACLE_ENABLED: ("An obstacle is ahead. Walk until the belt stops", Tone.WARN),
    GaitState.STOPPING: ("Stop. Wait until one leg is free", Tone.WARN),
    GaitState.COLLISION_ENABLED: ("Stand. The obstacle can be felt now", Tone.WARN),
    GaitState.LEG_RELEASED: ("One leg is being released. Stand on the other", Tone.ACCENT),
    GaitState.EXPLORING: ("Explore the obstacle with the free foot", Tone.ACCENT),
    GaitState.GUIDANCE_RESTORED: ("Wait. The orthosis takes up both legs", Tone.WARN),
    GaitState.TO_START: ("Wait. The orthosis brings both legs to the start", Tone.WARN),
    GaitState.RESUMING: ("Walk on. The belt starts", Tone.CALM),
    GaitState.STANDING: ("Stand still. Brakes hold both legs", Tone.ALARM),
}
"""What the person is told, and how urgently, by state."""


def loop_cards(snapshot: HapticSnapshot) -> dict[str, Card]:
    """Return the cards by their names: "margin", and "gait" during a walk in a gait orthosis."""
    gait = gait_card(snapshot.gait_state)
    return {"margin": stability_card(snapshot)} | ({} if gait is None else {"gait": gait})


def gait_card(state: int) -> Card | None:
    """Return the card of a gait state, by its number in a snapshot; None for -1, no walk."""
    if state < 0:
        return None
    text, tone = _WORDS[GaitState(state)]
    return Card("Walk in the orthosis", text, tone, width=_WIDTH)
