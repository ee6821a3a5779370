"""Sleeping of bodies at rest, with its cost and error.

Cost: one tick of boxes that were at rest on a floor for a second. Error: displacement of one in another second.
"""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.loop.haptic_objects import BodyFlag
from mimics_app.lab.haptic.body_worlds import BodyWorld, rest_on_floor
from mimics_app.lab.haptic.probe import SIZES, reference_us
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Growth, Probes, Rival, compare

__all__: list[str] = []


_SECOND, _TICKS = 1000, 20_000


def _rest(sleeps: bool, bodies: int) -> BodyWorld:
    """Return boxes after a second at rest on a floor."""
    world = rest_on_floor(bodies)
    if sleeps:
        world.rows.bodies["flags"][:bodies] |= int(BodyFlag.SLEEPS)
        world.change()
    world.run(_SECOND)
    return world


def _rest_us(sleeps: bool, bodies: int) -> float:
    """Return the cost of a tick of boxes that were at rest for a second [us]."""
    world, ticks = _rest(sleeps, bodies), max(20, _TICKS // bodies)
    return shortest_us(lambda: world.run(ticks), ticks)


def _rest_drift(sleeps: bool) -> float:
    """Return the displacement of a box at rest in another second [m]."""
    world = _rest(sleeps, 1)
    before = world.motions[0]["position"].copy()
    world.run(_SECOND)
    return float(np.linalg.norm(world.motions[0]["position"] - before))


compare(
    __name__,
    "a tick of boxes that lie on a floor; error: how far one moves in a second",
    "m",
    [
        Rival("asleep", "left out of the work until something touches it", "any", {"sleeps": True}, (True,)),
        Rival("awake", "contacts, friction and motion of every tick", "any", {"sleeps": False}, (False,)),
    ],
    Probes(_rest_us, _rest_drift, reference_us),
    default="asleep",
    growth=Growth(work="moving bodies", sizes=SIZES),
    few="a body at rest is worked on or it is not",
)
