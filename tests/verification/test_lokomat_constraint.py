"""A rigid object under combined control: geometry by differences, dynamics against a stiff penalty, energy, release."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from mimics_app.rendering.haptic.control.lokomat.constrained_shafts import (
    SHAFTS,
    SURFACE_SETTINGS,
    SurfaceFriction,
    place_shafts,
    step_shafts,
)
from mimics_app.rendering.haptic.control.lokomat.foot_constraint import (
    FOOT_SURFACE,
    LEG_FRAME,
    find_surface,
    follow_surface,
)
from mimics_app.rendering.haptic.control.lokomat.mesh_cut import cut_mesh
from mimics_app.rendering.haptic.control.lokomat.sagittal_outline import (
    EDGES,
    OUTLINE,
    circle_outline,
    put_box,
    put_kerb,
    put_polygon,
    wall_outline,
)
from mimics_app.rendering.haptic.control.lokomat.shaft_admittance import SHAFT_SETTINGS

THIGH, SHANK, FOOT = 0.42, 0.45, 0.12
LINKS = ((0.35, 0.08, 1.5, 1.0), (0.35, 0.08, 1.9, -1.0))
MASSES = (180.0, 120.0)
DT = 1e-3

Array = NDArray[Any]


def _leg() -> Array:
    leg = np.zeros(1, LEG_FRAME)
    leg["geometry"], leg["links"] = (1.0, THIGH, SHANK, FOOT, 0.0), LINKS
    return leg


def _settings(**changes: Any) -> Array:
    settings = np.zeros(1, SHAFT_SETTINGS)
    settings["mass"], settings["speed_limit"], settings["force_limit"], settings["sensor_sign"] = MASSES, 1e3, 1e9, 1.0
    for name, value in changes.items():
        settings[name] = value
    return settings


def _rule(**changes: Any) -> Array:
    rule = np.zeros(1, SURFACE_SETTINGS)
    rule["anchor"] = 1e5
    for name, value in changes.items():
        rule[name] = value
    return rule


def _foot(theta: Array) -> Array:
    """The foot by the sums of the segments' vectors."""
    knee = THIGH * np.array([math.sin(theta[0]), -math.cos(theta[0])])
    psi = theta[0] - theta[1]
    shank = SHANK * np.array([math.sin(psi), -math.cos(psi)])
    return knee + shank + FOOT * np.array([math.cos(psi), math.sin(psi)])


def _eta(theta: Array) -> Array:
    """Distance of the pivots of both drives."""
    return np.array(
        [
            math.hypot(a - b * math.cos(phi), b * math.sin(phi))
            for (a, b, _, _), phi in zip(LINKS, (1.5 + theta[0], 1.9 - theta[1]), strict=True)
        ]
    )


def _theta(eta: Array) -> Array:
    phi = [math.acos((a * a + b * b - e * e) / (2.0 * a * b)) for (a, b, _, _), e in zip(LINKS, eta, strict=True)]
    return np.array([phi[0] - 1.5, 1.9 - phi[1]])


def _box_mesh() -> tuple[Array, Array]:
    """Corners and triangles of a box of 0.2 by 0.4 by 0.3 m in front of the leg."""
    corners = np.array([(x, y, z) for x in (0.3, 0.5) for y in (-0.2, 0.2) for z in (-0.95, -0.65)])
    quads = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    return corners, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


def _put(put: Any, *numbers: Any) -> Array:
    outline = np.zeros(1, OUTLINE)
    put(outline[0], *numbers)
    return outline


def _cut(y: float) -> Array:
    polygon = cut_mesh(*_box_mesh(), y)
    filled = np.vstack([polygon, np.repeat(polygon[-1:], EDGES - len(polygon), axis=0)])
    return _put(put_polygon, filled[:, 0].copy(), filled[:, 1].copy(), 0.0)


OUTLINES: dict[str, Array] = {
    "wall": wall_outline((0.2, 0.0), (-1.0, 0.0)),
    "ramp": wall_outline((0.3, -0.8), (-0.5, 0.8)),
    "sphere": circle_outline((0.5, -0.8), math.sqrt(0.15**2 - 0.05**2)),
    "cylinder": circle_outline((0.45, -0.75), 0.1),
    "box": _put(put_box, 0.45, -0.8, 0.2, 0.3, 0.02),
    "kerb": _put(put_kerb, 0.3, -0.72, 0.02),
    "mesh": _cut(0.03),
}


def _surface(outline: Array, theta: Array) -> Array:
    surface = np.zeros(1, FOOT_SURFACE)
    find_surface(_leg()[0], outline[0], np.array(theta), surface[0])
    return surface[0]


@pytest.mark.parametrize("name", OUTLINES)
def test_derivatives_of_the_distance_are_its_differences(name: str) -> None:
    outline, h = OUTLINES[name], 1e-5
    for theta in np.random.default_rng(1).uniform((-0.1, 0.2), (0.7, 1.1), (60, 2)):
        eta = _eta(theta)

        def distance(a: float, b: float, at: Array = eta) -> float:
            return float(_surface(outline, _theta(at + (a, b)))["distance"])

        surface = _surface(outline, theta)
        bends = [
            (distance(h, 0) - 2 * distance(0, 0) + distance(-h, 0)) / h**2,
            (distance(h, h) - distance(h, -h) - distance(-h, h) + distance(-h, -h)) / (4 * h**2),
            (distance(0, h) - 2 * distance(0, 0) + distance(0, -h)) / h**2,
        ]
        slopes = [(distance(h, 0) - distance(-h, 0)) / (2 * h), (distance(0, h) - distance(0, -h)) / (2 * h)]
        near = [_surface(outline, _theta(eta + (a, b)))["normal"] for a in (-h, h) for b in (-h, h)]
        if np.ptp(near, axis=0).max() > 1e-2:
            continue  # another feature within the differences
        assert surface["slope"] == pytest.approx(slopes, rel=1e-4, abs=1e-6)
        if np.abs(np.diff([_surface(outline, _theta(eta + (a, 0)))["slope"] for a in (-h, h)], axis=0)).max() < 0.1:
            assert surface["bend"] == pytest.approx(bends, rel=2e-3, abs=0.05)


def test_the_distance_is_that_of_the_shapes() -> None:
    """Against closed forms and a signed distance of a rounded box written another way."""
    rng = np.random.default_rng(2)
    for theta in rng.uniform((-0.1, 0.1), (0.8, 1.3), (300, 2)):
        x, z = _foot(theta)
        assert _surface(OUTLINES["wall"], theta)["distance"] == pytest.approx(0.2 - x, abs=1e-12)
        sphere = math.hypot(x - 0.5, z + 0.8) - math.sqrt(0.15**2 - 0.05**2)
        assert _surface(OUTLINES["sphere"], theta)["distance"] == pytest.approx(sphere, abs=1e-12)
        q = np.abs([x - 0.45, z + 0.8]) - (0.08, 0.13)
        box = math.hypot(*np.maximum(q, 0.0)) + min(max(q), 0.0) - 0.02
        assert _surface(OUTLINES["box"], theta)["distance"] == pytest.approx(box, abs=1e-12)
        p = np.abs([x - 0.4, z + 0.8]) - (0.1, 0.15)
        mesh = math.hypot(*np.maximum(p, 0.0)) + min(max(p), 0.0)
        assert _surface(OUTLINES["mesh"], theta)["distance"] == pytest.approx(mesh, abs=1e-12)


def test_a_vertical_wall_has_the_closed_form_of_equation_4() -> None:
    """psi + delta = asin((X - l1 sin t1) / L), delta the angle of the foot seen from the knee."""
    length, delta, leg, outline = math.hypot(SHANK, FOOT), math.atan2(FOOT, SHANK), _leg(), OUTLINES["wall"]
    surface = np.zeros(1, FOOT_SURFACE)
    theta, eta = np.array([0.2, 0.5]), np.zeros(2)
    for t1 in np.linspace(0.2, 0.7, 40):
        eta[:] = _eta(np.array([t1, theta[1]]))
        assert follow_surface(leg[0], outline[0], 0, eta, theta, surface[0])
        t2 = t1 - (math.asin((0.2 - THIGH * math.sin(t1)) / length) - delta)
        assert theta[1] == pytest.approx(t2, abs=1e-10)
        assert eta[1] == pytest.approx(_eta(np.array([t1, t2]))[1], abs=1e-11)
    eta[0] = _eta(np.array([-0.9, 0.0]))[0]
    assert not follow_surface(leg[0], outline[0], 0, eta, theta, surface[0]), "the wall is out of the leg's reach"


def _on_surface(outline: Array, theta: Array, rate: float, **changes: Any) -> tuple[Array, Array]:
    """A virtual leg in contact, its leader moving at a rate, and its settings."""
    leg, shafts, settings = _leg(), np.zeros(1, SHAFTS), _settings(**changes)
    place_shafts(shafts[0], leg[0], _eta(theta))
    state = shafts[0]
    find_surface(leg[0], outline[0], state["theta"], state["surface"])
    state["leader"] = 0 if abs(state["surface"]["slope"][1]) >= abs(state["surface"]["slope"][0]) else 1
    assert follow_surface(leg[0], outline[0], int(state["leader"]), state["eta"], state["theta"], state["surface"])
    leader, slope = int(state["leader"]), state["surface"]["slope"]
    shafts["touching"] = 1
    shafts["rate"][0, leader] = rate
    shafts["rate"][0, 1 - leader] = -slope[leader] / slope[1 - leader] * rate
    return shafts, settings


def _run(
    shafts: Array, settings: Array, outline: Array, force: Any, ticks: int, rule: Array | None = None
) -> list[Array]:
    leg, rows, rule = _leg(), [], _rule() if rule is None else rule
    for _ in range(ticks):
        solid = bool(outline["count"][0])
        step_shafts(shafts[0], leg[0], outline[0], settings[0], rule[0], solid, np.array(force, np.float64), DT)
        rows.append(shafts[0].copy())
    return rows


STARTS = {"wall": (0.3, 0.4, 0.02), "cylinder": (0.35, 0.6, 0.015), "kerb": (0.3, 0.5, -0.01)}
"""Outline -> hip and knee angle near it, and a rate of the leader [m/s]."""


@pytest.mark.parametrize("name", STARTS)
def test_a_free_leg_keeps_its_energy_on_a_surface(name: str) -> None:
    t1, t2, rate = STARTS[name]
    shafts, settings = _on_surface(OUTLINES[name], np.array([t1, t2]), rate)
    settings["as_printed"] = 0
    rows = _run(shafts, settings, OUTLINES[name], (0.0, 0.0), 300, _rule(hold=1e9))
    energies = [0.5 * float(np.dot(MASSES, row["rate"] ** 2)) for row in rows]
    assert all(row["touching"] for row in rows)
    assert max(energies) / min(energies) - 1.0 < 1e-9
    drift = max(abs(float(_surface(OUTLINES[name], _theta(row["eta"]))["distance"])) for row in rows)
    assert drift <= 1e-9, "constraint drift"


@pytest.mark.parametrize("name", ["wall", "cylinder"])
def test_the_constrained_form_is_that_of_a_penalty_of_1e7_n_per_m(name: str) -> None:
    """Same virtual masses and shaft forces on an object of 1e7 N/m: foot within 1e-6 m of it less N/k, force 1 %."""
    stiffness, outline = 1e7, OUTLINES[name]
    t1, t2, _ = STARTS[name]
    leg = _leg()
    probe = np.zeros(1, FOOT_SURFACE)
    theta, eta = np.array([t1, t2]), _eta(np.array([t1, t2]))
    assert follow_surface(leg[0], outline[0], 0, eta, theta, probe[0])
    force = np.array([300.0, 200.0])
    if float(probe["slope"][0] @ force) > 0.0:
        force = -force
    rows = _run(*_on_surface(outline, theta, 0.0), outline, force, 80)

    def distance(x: Array) -> tuple[float, Array]:
        if name == "wall":
            return 0.2 - x[0], np.array([-1.0, 0.0])
        away = x - (0.45, -0.75)
        return math.hypot(*away) - 0.1, away / math.hypot(*away)

    def slopes(at: Array) -> Array:
        h = 1e-6
        return np.array(
            [
                (distance(_foot(_theta(at + d)))[0] - distance(_foot(_theta(at - d)))[0]) / (2 * h)
                for d in (np.array([h, 0.0]), np.array([0.0, h]))
            ]
        )

    def rate(_: float, state: Array) -> Array:
        g, h = distance(_foot(_theta(state[:2])))[0], slopes(state[:2])
        push = max(0.0, -stiffness * g - 2e4 * float(h @ state[2:]))
        return np.concatenate([state[2:], (force + push * h) / MASSES])

    normal_0 = float(rows[0]["normal_force"])
    start = eta - normal_0 / stiffness / float(probe["slope"][0] @ probe["slope"][0]) * probe["slope"][0]
    times = DT * np.arange(1, len(rows) + 1)
    found = solve_ivp(rate, (0.0, times[-1]), [*start, 0.0, 0.0], "Radau", times, rtol=1e-8, atol=1e-11)
    assert found.success
    for row, state in list(zip(rows, found.y.T, strict=True))[30:]:
        g, normal = distance(_foot(_theta(state[:2])))
        assert -stiffness * g == pytest.approx(float(row["normal_force"]), rel=0.01)
        foot = _foot(_theta(state[:2])) - g * normal
        assert np.abs(foot - _foot(_theta(row["eta"]))).max() <= 1e-6


def test_an_impact_loses_what_an_inelastic_one_loses() -> None:
    """Loss (eta2' - f' eta1')^2 / (2 (1/m2 + f'^2/m1)), and none of the motion along the surface."""
    outline, theta = OUTLINES["wall"], np.array([0.3, 0.45])
    for rates in ((0.2, -0.1), (0.05, 0.3), (0.4, 0.1)):
        leg, shafts, settings = _leg(), np.zeros(1, SHAFTS), _settings()
        start = _eta(theta)
        place_shafts(shafts[0], leg[0], start)
        shafts["rate"] = rates
        row = before = shafts[0].copy()
        for _ in range(2000):
            before = row
            row = _run(shafts, settings, outline, (0.0, 0.0), 1)[0]
            if row["touching"]:
                break
        assert row["touching"]
        slope = row["surface"]["slope"]
        first = -slope[0] / slope[1]
        gap = before["rate"][1] - first * before["rate"][0]
        loss = gap**2 / (2.0 * (1.0 / MASSES[1] + first**2 / MASSES[0]))
        energies = [0.5 * float(np.dot(MASSES, each["rate"] ** 2)) for each in (before, row)]
        assert energies[0] - energies[1] == pytest.approx(loss, rel=1e-9)


def test_the_printed_entry_adds_energy_where_the_right_one_loses_some() -> None:
    energies = {}
    for printed in (0, 1):
        leg, shafts, settings = _leg(), np.zeros(1, SHAFTS), _settings(as_printed=printed)
        place_shafts(shafts[0], leg[0], _eta(np.array([0.35, 0.45])))
        shafts["rate"] = 0.3, 0.2
        before = 0.5 * float(np.dot(MASSES, shafts["rate"][0] ** 2))
        row = shafts[0]
        for _ in range(2000):
            row = _run(shafts, settings, OUTLINES["wall"], (0.0, 0.0), 1)[0]
            if row["touching"]:
                break
        assert row["touching"]
        energies[printed] = 0.5 * float(np.dot(MASSES, row["rate"] ** 2)) / before
    assert energies[0] < 1.0 < energies[1]


def test_a_leg_that_is_pulled_away_leaves_within_a_tick_and_the_printed_one_never() -> None:
    outline, theta = OUTLINES["wall"], np.array([0.3, 0.45])
    for printed in (0, 1):
        shafts, settings = _on_surface(outline, theta, 0.0, as_printed=printed)
        slope = shafts["surface"]["slope"][0]
        into = -200.0 * slope / np.abs(slope).max()
        assert all(row["touching"] for row in _run(shafts, settings, outline, into, 50))
        rows = _run(shafts, settings, outline, -into, 50)
        touching = [int(row["touching"]) for row in rows]
        assert touching == [printed] * 50
        away = float(_surface(outline, _theta(rows[-1]["eta"]))["distance"])
        assert (away > 1e-4) is (printed == 0)


def test_no_object_is_free_space() -> None:
    shafts, settings = _on_surface(OUTLINES["wall"], np.array([0.3, 0.45]), 0.0)
    rows = _run(shafts, settings, np.zeros(1, OUTLINE), (50.0, 0.0), 100)
    assert not rows[0]["touching"]
    assert rows[-1]["eta"][0] - rows[0]["eta"][0] == pytest.approx(
        0.5 * 50.0 / MASSES[0] * (0.1**2 - 0.001**2), rel=1e-9
    )


def _slide_along(rule: Array, speed: float, ticks: int, **changes: Any) -> list[Array]:
    """Rows of a leg that is pressed against the wall with constant force and slides along it."""
    shafts, settings = _on_surface(OUTLINES["wall"], np.array([0.6, 0.95]), 0.0, **changes)
    path, leader = shafts["surface"]["path"][0], int(shafts["leader"][0])
    slope = shafts["surface"]["slope"][0]
    along = path[leader] - slope[leader] / slope[1 - leader] * path[1 - leader]
    shafts["rate"][0, leader] = speed / along
    shafts["rate"][0, 1 - leader] = -slope[leader] / slope[1 - leader] * speed / along
    into = -400.0 * slope / np.abs(slope).max()
    return _run(shafts, settings, OUTLINES["wall"], into, ticks, rule)


def test_coulomb_friction_is_mu_n_at_every_speed_and_holds_at_rest() -> None:
    rule = _rule(friction=SurfaceFriction.COULOMB, mu=0.3)
    for speed in (0.05, 0.5, -0.5):
        for before, row in zip((rows := _slide_along(rule, speed, 40))[9:], rows[10:], strict=False):
            assert float(row["drag"][0]) == pytest.approx(-math.copysign(0.3, speed) * before["normal_force"], rel=1e-6)
    still = _slide_along(rule, 0.0, 2000)
    feet = [_foot(_theta(row["eta"])) for row in still[500:]]
    assert np.ptp(feet, axis=0).max() < 1e-4, "no creep"


def test_the_printed_coulomb_friction_grows_with_speed_and_the_right_one_not() -> None:
    for printed, expected in ((0, 1.0), (1, 10.0)):
        rule, drags = _rule(friction=SurfaceFriction.COULOMB, mu=0.05 if printed else 0.3), []
        for speed in (0.02, 0.2):
            row = _slide_along(rule, speed, 3 if printed else 12, as_printed=printed)[-1]
            drags.append(abs(float(row["drag"][0])) / float(row["normal_force"]))
        assert drags[1] / drags[0] == pytest.approx(expected, rel=0.35 if printed else 0.02)


def test_viscous_friction_takes_mu_times_the_square_of_the_foots_speed() -> None:
    rows = _slide_along(_rule(friction=SurfaceFriction.VISCOUS, mu=200.0), 0.2, 200, force_limit=1e9)
    feet = np.array([_foot(_theta(row["eta"])) for row in rows])
    speeds = np.linalg.norm(np.diff(feet, axis=0), axis=1) / DT
    drags = np.array([abs(float(row["drag"][0])) for row in rows[1:]])
    assert drags == pytest.approx(200.0 * speeds, rel=0.02)
