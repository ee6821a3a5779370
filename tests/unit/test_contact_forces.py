"""The loop follows the contacts that its events name, and sends the sound their force in every tick after them."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.contracts.loop.contact_force import CONTACT_FORCE, FOLLOWED, FOLLOWED_AT_ONCE
from mimics_app.contracts.loop.haptic import SCENE
from mimics_app.contracts.loop.object_rows import ObjectCapacities
from mimics_app.contracts.shared_memory import ring
from mimics_app.contracts.shared_memory.session_memory import Capacities, SessionMemory
from mimics_app.rendering.haptic.channels import channels_of, new_work
from mimics_app.rendering.haptic.kernels.state import CONTACT_BEGAN, CONTACT_UNCHANGED
from mimics_app.rendering.haptic.objects import new_object_work
from mimics_app.rendering.haptic.struck import publish_forces

MS = 1_000_000


class Loop:
    """What the loop leaves behind after a tick, set by hand, and the ring that it publishes forces into."""

    def __init__(self) -> None:
        objects = ObjectCapacities()
        self.memory, self.work = SessionMemory(Capacities(objects)), new_work(new_object_work(objects))
        self.scene = np.zeros(1, SCENE)
        self.scene["contacts"] = 2
        self.scene["objects"]["bodies"], self.scene["objects"]["shapes"] = 4, 5
        self.tick = 0

    def step(self) -> np.ndarray:
        """One tick; what was published in it."""
        self.tick += 1
        publish_forces(channels_of(self.memory), self.work, self.scene[0], self.tick * MS)
        out = np.zeros(64, CONTACT_FORCE)
        raised = out[: ring.drain(self.memory.audio_force_words, self.memory.audio_forces, out)]
        self.work.state[0]["contact_change"] = CONTACT_UNCHANGED
        self.work.objects.touches["change"] = CONTACT_UNCHANGED
        self.work.objects.totals[0]["impact"] = 0.0
        return raised


def test_a_touched_body_is_followed_for_a_quarter_of_a_second():
    loop = Loop()
    loop.work.objects.touches[0, 3]["change"] = CONTACT_BEGAN
    loop.work.objects.motions[2]["force_user"] = (3.0, 4.0, 0.0)
    assert len(loop.step()) == 0, "the event itself has the first force"
    (row,) = loop.step()
    assert (int(row["t_ns"]), int(row["body_a"]), int(row["body_b"])) == (2 * MS, 0, 3)
    assert row["force"] == pytest.approx(5.0)
    assert sum(len(loop.step()) for _ in range(2 * FOLLOWED)) == FOLLOWED - 1


def test_wall_tunnel_and_two_bodies_have_their_own_force():
    loop = Loop()
    objects, totals = loop.work.objects, loop.work.objects.totals[0]
    objects.touches[0, 0]["change"] = CONTACT_BEGAN
    totals["impact"], totals["impact_a"], totals["impact_b"] = 0.5, 1, -1
    objects.sweep[0]["pairs"] = 3
    for row, (a, b, force, touching) in enumerate(((1, -1, 2.0, 1), (-1, 1, 0.5, 1), (1, -1, 9.0, 0))):
        pair = objects.pairs[row]
        pair["body_a"], pair["body_b"], pair["force"], pair["touching"] = a, b, force, touching
    loop.step()
    totals["shape_force"], totals["static_touching"] = (0.0, 1.5, 0.0), 1
    loop.work.state[0]["own_tunnel"]["force_tnb"] = (0.0, 0.0, 0.25)
    raised = {(int(row["body_a"]), int(row["body_b"])): float(row["force"]) for row in loop.step()}
    assert raised == {(0, -1): pytest.approx(1.75), (2, -1): pytest.approx(2.5)}


def test_of_too_many_contacts_the_newest_are_followed_and_one_that_begins_again_anew():
    loop = Loop()
    totals = loop.work.objects.totals[0]
    for k in range(FOLLOWED_AT_ONCE + 2):
        totals["impact"], totals["impact_a"], totals["impact_b"] = 0.5, k, -1
        loop.step()
    followed = [int(row["body_a"]) for row in loop.step()]
    assert sorted(followed) == list(range(3, FOLLOWED_AT_ONCE + 3))
    totals["impact"], totals["impact_a"], totals["impact_b"] = 0.5, FOLLOWED_AT_ONCE, -1
    loop.step()
    assert len(loop.step()) == FOLLOWED_AT_ONCE
