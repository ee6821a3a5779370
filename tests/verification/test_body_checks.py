"""What `check_bodies` refuses is what does not keep still, and what it lets through does."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.contracts.loop.haptic_objects import ObjectIntegrator, ShapeKind
from mimics_app.rendering.haptic.body_checks import check_bodies, contact_modes
from tests.support.body_play import box_inertia, new_play

ROUGH = {"friction_static": 0.5, "friction_dynamic": 0.4}
K, B = 40_000.0, 40.0  # of the pair: half of each
UNIT = (1e-6 * K + 2e-3 * B) / 4.0
KINDS = {
    ShapeKind.SPHERE: (0.02,),
    ShapeKind.BOX: (0.04, 0.04, 0.04),
    ShapeKind.CYLINDER: (0.02, 0.05),
    ShapeKind.CAPSULE: (0.015, 0.04),
}


def pressed(kind, mass, rough=True, ticks=2000):
    """A body between floor and ceiling that overlap it by 1 mm each; how far it has moved when nudged by 1 nm."""
    surface = {"stiffness": 2.0 * K, "damping": 2.0 * B, **(ROUGH if rough else {})}
    size, play = KINDS[kind], new_play()
    half = 0.5 * size[1] if kind in (ShapeKind.BOX, ShapeKind.CYLINDER) else size[0]
    play.add_floor(0.001 - half, **surface)
    play.add_shape(
        ShapeKind.WALL, (), position=(0.0, half - 0.001, 0.0), orientation=(np.sqrt(0.5), 0, 0, np.sqrt(0.5)), **surface
    )
    # A capsule on its end would tip over: it lies.
    attitude = (0.0, 0.0, np.sqrt(0.5), np.sqrt(0.5)) if kind is ShapeKind.CAPSULE else (0.0, 0.0, 0.0, 1.0)
    fields = {"surface": surface, "position": (1e-9, 2e-9, 0.0), "omega": (1e-7, 2e-7, -1e-7), "orientation": attitude}
    if kind is ShapeKind.SPHERE:
        play.add_ball(size[0], mass, **fields)
    elif kind is ShapeKind.BOX:
        play.add_box(size, mass, **fields)
    else:
        play.add_rod(kind, *size, mass, **fields)
    faults = check_bodies(play.rows, play.counts[0], play.dt)
    play.run(ticks)
    return faults, float(np.abs(play.motions[0]["velocity"]).max() + 0.02 * np.abs(play.motions[0]["omega"]).max())


@pytest.mark.parametrize("kind", list(KINDS))
@pytest.mark.parametrize("rough", [True, False])
def test_bound_is_where_a_pressed_body_stops_keeping_still(kind, rough):
    """At 1.1 times the mass it keeps still and is let through; at 0.8 times it is refused, with the formula.

    The bound is that of the worst attitude: a body that is in a better one just now may keep still below it, so the
    lower side is tested for kinds whose worst attitude is the one that stands (box, ball).
    """
    tangential = 1.0 if rough else 0.0
    size = KINDS[kind]
    probe = new_play()
    if kind is ShapeKind.SPHERE:
        k = probe.add_ball(size[0], 1.0)
    elif kind is ShapeKind.BOX:
        k = probe.add_box(size, 1.0)
    else:
        k = probe.add_rod(kind, *size, 1.0)
    n = contact_modes(probe.rows.shapes[0], probe.rows.bodies[k], 2, tangential)
    faults, speed = pressed(kind, 1.1 * n * UNIT, rough)
    assert faults == []
    assert speed < 1e-7
    faults, speed = pressed(kind, 0.8 * n * UNIT, rough)
    assert [fault.body for fault in faults] == [0]
    assert "m > n (h^2 k + 2 h b)/4" in faults[0].what
    if kind in (ShapeKind.BOX, ShapeKind.SPHERE):
        assert not speed < 1e-4


def test_modes_of_simple_bodies_are_closed_forms():
    """A ball between two: 2, turned by friction 5. A cube: turned by its corners 3/2 a contact, by friction 3/2."""
    play = new_play()
    ball, cube = play.add_ball(), play.add_box()
    shapes, bodies = play.rows.shapes, play.rows.bodies
    assert contact_modes(shapes[0], bodies[ball], 1, 0.0) == pytest.approx(1.0)
    assert contact_modes(shapes[0], bodies[ball], 2, 0.0) == pytest.approx(2.0)
    assert contact_modes(shapes[0], bodies[ball], 2, 1.0) == pytest.approx(5.0)
    assert contact_modes(shapes[1], bodies[cube], 2, 0.0) == pytest.approx(3.0)
    assert contact_modes(shapes[1], bodies[cube], 2, 1.0) == pytest.approx(6.0)


def refused(**changes):
    play = new_play()
    play.add_floor()
    play.add_box()
    for name, value in changes.items():
        row = play.rows.bodies[0] if name in ("mass", "inertia", "integrator") else play.rows.shapes[1]
        row[name] = value
    return check_bodies(play.rows, play.counts[0], play.dt)


def test_sound_body_is_let_through():
    assert refused() == []


@pytest.mark.parametrize(
    "changes, word",
    [
        ({"size": (0.04, 0.0, 0.04)}, "size"),
        ({"size": (0.04, np.nan, 0.04)}, "size"),
        ({"mass": 0.0}, "mass"),
        ({"mass": np.nan}, "mass"),
        ({"stiffness": 0.0}, "stiffness"),
        ({"damping": -1.0}, "damping"),
        ({"inertia": np.diag([1e-5, 1e-5, 5e-5])}, "sum of the others"),
        ({"inertia": np.diag([-1e-5, 1e-5, 1e-5])}, "moments"),
        ({"mass": 0.0005, "inertia": box_inertia(0.0005, (0.04, 0.04, 0.04))}, "too light"),
    ],
)
def test_what_cannot_be_simulated_is_refused_by_name(changes, word):
    faults = refused(**changes)
    assert len(faults) == 1
    assert word in faults[0].what
    assert faults[0].fix


@pytest.mark.parametrize(
    "integrator, rule", [("EXPLICIT", "b > k h"), ("EXACT_DRAG", "b > k h/2"), ("IMPLICIT_MIDPOINT", "b > k h/2")]
)
def test_integrators_that_use_the_old_velocity_need_damping(integrator, rule):
    for damping, ok in ((0.0, False), (40.0, True)):
        play = new_play()
        play.add_floor(damping=damping)
        play.add_box(integrator=ObjectIntegrator[integrator], surface={"damping": damping})
        faults = check_bodies(play.rows, play.counts[0], play.dt)
        assert (faults == []) == ok
        assert ok or rule in faults[0].what


def test_heavy_partner_counts_less_than_an_equal_one():
    """Two equal bodies give way to each other: twice the mass of one against a fixed partner."""
    for mass, partner, ok in ((0.08, 100.0, True), (0.08, 0.08, False)):
        play = new_play()
        for m, y in ((mass, 0.0), (partner, 0.05)):
            play.add_ball(mass=m, surface={"stiffness": 2.0 * K, "damping": 4.0 * B}, position=(0.0, y, 0.0))
        found = [f.body for f in check_bodies(play.rows, play.counts[0], play.dt)]
        assert (0 not in found) == ok, (partner, found)
