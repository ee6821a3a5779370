"""Arrows of forces and contacts: where they stand, how long they are, when they are gone."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from mimics_app.app.picture.force_arrows import ForceArrows
from mimics_app.app.picture.overlay_keys import OVERLAY_KEYS, toggle_overlay
from mimics_app.contracts.loop.haptic import EVENT, EventKind
from mimics_app.contracts.messages.window_input import InputEvent
from mimics_app.rendering.visual.overlay.layers import LAYERS

NONE = np.zeros(0, EVENT)
NS = 1_000_000_000


def snapshot(user=(0.0, 0.0, 0.0), measured=(0.0, 0.0, 0.0), grip=(0.0, 0.0, 0.0)):
    point = SimpleNamespace(
        hip_world=np.array([0.1, 1.0, 0.2]),
        ball_radius=0.02,
        f_user_world=np.array(user),
        f_meas_world=np.array(measured),
        f_grip=np.array(grip),
    )
    return SimpleNamespace(points=(point,))


def contact(kind: EventKind, **values) -> np.ndarray:
    event = np.zeros(1, EVENT)
    event["kind"], event["normal_world"], event["position_world"] = kind, (0.0, 1.0, 0.0), (0.5, 0.0, 0.0)
    for name, value in values.items():
        event[name] = value
    return event


def test_forces_stand_at_the_hand_and_grow_with_the_newton():
    one, two = ForceArrows().of(snapshot(user=(5.0, 0.0, 0.0), measured=(0.0, 0.0, -10.0)), NONE, 0)
    assert np.linalg.norm(one.origin - [0.1, 1.0, 0.2]) == pytest.approx(0.02), "on the surface of the ball"
    assert (one.origin - [0.1, 1.0, 0.2]) @ one.vector > 0.0
    assert two.vector[2] == pytest.approx(-2.0 * one.vector[0])
    assert one.tint != two.tint


@pytest.mark.parametrize("force", [0.0, 0.1, np.nan, np.inf])
def test_what_cannot_be_seen_or_is_no_number_is_left_out(force):
    assert ForceArrows().of(snapshot(user=(force, 0.0, 0.0)), NONE, 0) == []


def test_a_huge_force_is_cut_and_keeps_its_direction():
    (arrow,) = ForceArrows().of(snapshot(user=(300.0, 400.0, 0.0)), NONE, 0)
    assert np.linalg.norm(arrow.vector) == pytest.approx(0.35)
    assert arrow.vector / 0.35 == pytest.approx([0.6, 0.8, 0.0])


def test_contacts_fade_and_go_and_other_events_are_no_contacts():
    arrows = ForceArrows()
    events = np.concatenate(
        [contact(EventKind.IMPACT, force=8.0), contact(EventKind.CONTACT_END), contact(EventKind.PARAMETERS)]
    )
    (first,) = arrows.of(snapshot(), events, 0)
    assert first.origin == pytest.approx([0.5, 0.0, 0.0]) and first.vector[1] > 0.05
    (later,) = arrows.of(snapshot(), NONE, NS // 2)
    assert 0.0 < later.tint[3] < first.tint[3] == 1.0
    assert arrows.of(snapshot(), NONE, NS) == []


def test_a_rain_of_contacts_stays_bounded():
    arrows = ForceArrows()
    for tick in range(50):
        shown = arrows.of(snapshot(), np.concatenate([contact(EventKind.IMPACT)] * 40), tick)
    assert len(shown) == 60


def test_keys_put_layers_on_and_off_and_repeats_do_nothing():
    layers: set[str] = set()
    overlay = SimpleNamespace(toggle=lambda layer: layers.symmetric_difference_update({layer}))
    renderer = SimpleNamespace(overlay=overlay)
    press = InputEvent("key", "f3", True)
    toggle_overlay(renderer, [press, InputEvent("key", "f3", True, repeat=True), InputEvent("key", "f3", False)])
    assert layers == {"bounds"}
    toggle_overlay(renderer, [press])
    assert layers == set()
    assert list(OVERLAY_KEYS.values()) == list(LAYERS)

    class Untouched:
        @property
        def overlay(self):
            raise AssertionError("made though nobody requested it")

    toggle_overlay(Untouched(), [InputEvent("key", "f7", True), InputEvent("move")])
