"""Blocks of trials in the task block of a scene file."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta, field

from mimics_app.world.components.bounds import Figure, PositiveSeconds, Seconds
from mimics_app.world.components.registry import Component

__all__ = ["BlockSpec", "Order", "TrialSpec"]

_Values = Annotated[dict[str, Figure], Meta(max_length=1000)]

Order = Literal["listed", "shuffled", "latin"]


class TrialSpec(Component, frozen=True):
    """One trial of a block."""

    label: Annotated[str, Meta(description="Name of the condition, for the results.")] = ""
    values: Annotated[
        _Values,
        Meta(
            description="Parameter values set before the trial; others keep their default, or the value of an action."
        ),
    ] = field(default_factory=dict)
    time_limit_s: Annotated[PositiveSeconds | None, Meta(description="Longest travel, instead of the task's [s].")] = (
        None
    )
    rest_s: Annotated[Seconds | None, Meta(description="Rest after this trial, instead of the task's [s].")] = None


class BlockSpec(Component, frozen=True):
    """A block of trials."""

    name: Annotated[str, Meta(description="Name of the block, for the results.")] = ""
    trials: Annotated[
        Annotated[list[TrialSpec], Meta(min_length=1, max_length=1000)], Meta(description="The conditions.")
    ] = field(default_factory=lambda: [TrialSpec()])
    repetitions: Annotated[Annotated[int, Meta(ge=1, le=1000)], Meta(description="How often the trials are done.")] = 1
    order: Annotated[
        Order,
        Meta(
            description="'listed', 'shuffled' (separately in each repetition, by the session's seed) or 'latin' "
            "(repetition r takes row r of a Williams square: every condition follows every other equally often)."
        ),
    ] = "listed"
    practice: Annotated[
        bool, Meta(description="True: recorded, shown and learned from by a policy, but in neither score nor goal.")
    ] = False
