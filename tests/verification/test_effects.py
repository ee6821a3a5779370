"""Laws of the effects: closed forms, energy on closed ways, bounds, one side, and the opposite on bodies."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.loop.haptic_objects import TUNNEL, BodyFlag, EffectKind
from mimics_app.contracts.loop.loop_ports import FIELD
from mimics_app.maths.quat import about_axis, to_matrix
from mimics_app.rendering.haptic.standard_fields import curl, saddle, well
from mimics_app.rendering.haptic.tunnel_geometry import build_tunnel
from tests.support.effect_bench import ALL, Bench, effect

PLACE = (0.1, 0.2, -0.3)
DT = 1e-3


def path_record(points) -> np.ndarray:
    record = np.zeros(1, TUNNEL)
    build_tunnel(np.array(points, float), 0.0).fill(record[0])
    return record


STRAIGHT = [(0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.2, 0.0, 0.0), (0.3, 0.0, 0.0)]
BENT = [(0.0, 0.0, 0.0), (0.1, 0.1, 0.0), (0.2, -0.1, 0.05), (0.3, 0.0, 0.0), (0.35, 0.1, 0.0)]


def energy_gained(bench: Bench, way: np.ndarray, dt: float = DT) -> float:
    """Energy [J] an effect gives to a hand that is led along positions, shape [n, 3]; trapezoidal in the force."""
    v = np.gradient(way, dt, axis=0)
    forces = np.array([bench.force(p, w, k * dt) for k, (p, w) in enumerate(zip(way, v, strict=True))])
    return float((0.5 * (forces[1:] + forces[:-1]) * np.diff(way, axis=0)).sum())


def loop(centre, radius: float, n: int = 1000) -> np.ndarray:
    """A closed way, out of any plane of symmetry, through the inside and the outside of what is about the centre."""
    s = np.linspace(0.0, 2.0 * math.pi, n)
    way = np.stack([np.cos(s), np.sin(2.0 * s + 0.3), np.sin(3.0 * s) + 0.2], axis=1)
    return np.asarray(centre) + radius * way


class TestSpring:
    def test_force_is_k_beyond_the_dead_band(self):
        bench = Bench(effect(EffectKind.SPRING, stiffness=300.0, slip=0.01, position=PLACE))
        direction = np.array([2.0, -1.0, 2.0]) / 3.0
        assert bench.force(PLACE + 0.03 * direction) == pytest.approx(-300.0 * 0.02 * direction)
        assert not bench.force(PLACE + 0.009 * direction).any()
        assert not bench.force(PLACE).any(), "at its place there is no direction"

    def test_bounded_with_its_damper_and_never_the_wrong_way(self):
        """The spring keeps its bound, and the damper what is left of it: no energy comes out of the bound."""
        bench = Bench(effect(EffectKind.SPRING, stiffness=1000.0, damping=40.0, force=6.0))
        rng = np.random.default_rng(2)
        for p, v in zip(rng.normal(size=(100, 3)) * 0.02, rng.normal(size=(100, 3)), strict=True):
            f = bench.force(p, v)
            assert np.linalg.norm(f) <= 6.0 * (1 + 1e-12)
            alone = -p * min(1000.0, 6.0 / np.linalg.norm(p))
            assert (f - alone) @ v <= 1e-12

    def test_damping_alone_takes_energy_while_it_pulls(self):
        bench = Bench(effect(EffectKind.SPRING, stiffness=200.0, damping=5.0))
        assert bench.force((0.1, 0, 0), (0.0, 2.0, 0.0)) == pytest.approx([-20.0, -10.0, 0.0])

    def test_outside_of_its_bound_there_is_nothing(self):
        bench = Bench(effect(EffectKind.SPRING, stiffness=200.0, radius=0.05))
        assert bench.force((0.05, 0, 0)) == pytest.approx([-10.0, 0, 0])
        assert not bench.force((0.0501, 0, 0)).any()

    def test_counts_towards_the_stability_limit_while_it_is_drawn(self):
        bench = Bench(effect(EffectKind.SPRING, stiffness=250.0, damping=3.0, slip=0.01))
        bench.force((0.02, 0, 0))
        assert (bench.totals["even_stiffness"], bench.totals["even_damping"]) == (250.0, 3.0)
        assert bench.totals["stiffness"] == 250.0
        bench.force((0.002, 0, 0))
        assert (bench.totals["even_stiffness"], bench.totals["even_damping"]) == (0.0, 0.0)


MAGNET = {"stiffness": 800.0, "force": 8.0, "radius": 0.1, "position": PLACE}


class TestMagnet:
    def test_closed_form_and_continuity(self):
        bench = Bench(effect(EffectKind.MAGNET, **MAGNET))
        peak = 8.0 / (800.0 + 8.0 / 0.1)
        for r in (1e-6, 0.5 * peak, peak, 0.03, 0.07, 0.0999):
            expected = min(800.0 * r, 8.0 * (1.0 - r / 0.1))
            assert bench.force(PLACE + np.array([0.0, r, 0.0])) == pytest.approx([0.0, -expected, 0.0])
        assert np.linalg.norm(bench.force(PLACE + np.array([0.1 - 1e-9, 0, 0]))) < 1e-6
        assert not bench.force(PLACE + np.array([0.1, 0, 0])).any()
        assert not bench.force(PLACE).any()

    def test_work_from_outside_to_its_place_is_the_area_under_the_curve(self):
        bench = Bench(effect(EffectKind.MAGNET, **MAGNET))
        peak = 8.0 / (800.0 + 8.0 / 0.1)
        area = 0.5 * 800.0 * peak**2 + 8.0 * (0.1 - peak) ** 2 / 0.2
        way = np.array(PLACE) + np.linspace([0.12, 0, 0], [0.0, 0, 0], 2001)
        assert energy_gained(bench, way) == pytest.approx(area, rel=1e-4)


@pytest.mark.parametrize(
    "row",
    [
        effect(EffectKind.SPRING, stiffness=300.0, slip=0.02, force=4.0),
        effect(EffectKind.SPRING, stiffness=300.0, radius=0.08),
        effect(EffectKind.MAGNET, stiffness=600.0, force=5.0, radius=0.06),
        effect(EffectKind.WORKSPACE, stiffness=500.0, radius=0.05),
        effect(EffectKind.WORKSPACE, stiffness=500.0, direction=(0.04, 0.05, 0.06)),
        effect(EffectKind.CONSTANT, force=3.0, direction=(0.6, 0.8, 0.0)),
        effect(EffectKind.PATH_SPRING, stiffness=300.0, slip=0.01, path=0),
        effect(EffectKind.FIELD, field=0, parameters=(100.0, -50.0, 30.0, 0, 0, 0, 0, 0)),
        effect(EffectKind.FIELD, field=1, parameters=(4.0, 0.05, 0, 0, 0, 0, 0, 0)),
    ],
    ids=["spring", "spring_bounded", "magnet", "ball", "box", "constant", "path", "saddle", "well"],
)
def test_closed_way_gives_no_energy(row):
    """Every spring is a gradient: what a loop of 0.6 m gives is the error of the quadrature.

    Beside O(step^2), a step of the force of at most 24 N at an edge is met half a step of 0.4 mm early or late.
    """
    bench = Bench(row, paths=[path_record(BENT)], fields=(saddle, well))
    assert abs(energy_gained(bench, loop((0.02, 0.01, 0.0), 0.05, 1500))) < 24.0 * 0.5 * 0.4e-3


@pytest.mark.parametrize(
    "row",
    [
        effect(EffectKind.SPRING, stiffness=300.0, damping=9.0, force=4.0),
        effect(EffectKind.VISCOSITY, damping=12.0, force=1.0),
        effect(EffectKind.MAGNET, stiffness=600.0, force=5.0, radius=0.06, damping=9.0),
        effect(EffectKind.WORKSPACE, stiffness=500.0, damping=9.0, direction=(0.01, 0.02, 0.03)),
        effect(EffectKind.PATH_SPRING, stiffness=300.0, damping=9.0, force=5.0, path=0),
        effect(EffectKind.STICK_SLIP, stiffness=300.0, slip=0.01),
    ],
    ids=["spring", "viscosity", "magnet", "workspace", "path", "stick_slip"],
)
def test_dampers_take_energy_on_a_closed_way(row):
    bench = Bench(row, paths=[path_record(BENT)])
    assert energy_gained(bench, loop((0.02, 0.01, 0.0), 0.05)) < -1e-3


def test_workspace_pushes_and_never_pulls():
    """The damper alone would pull a hand that comes back faster than k d / b."""
    bench = Bench(effect(EffectKind.WORKSPACE, stiffness=100.0, damping=50.0, direction=(0.1, 0.1, 0.1)))
    assert bench.force((0.12, -0.15, 0.0)) == pytest.approx([-2.0, 5.0, 0.0])
    assert not bench.force((0.12, 0.0, 0.0), (-1.0, 0.0, 0.0)).any()
    assert not bench.force((0.09, 0.09, 0.09), (1.0, 1.0, 1.0)).any()
    assert bench.force((0.12, 0, 0), (0.5, 0, 0)) == pytest.approx([-27.0, 0, 0])
    ball = Bench(effect(EffectKind.WORKSPACE, stiffness=100.0, damping=50.0, radius=0.1, force=3.0))
    assert not ball.force((0.0, 0.0, 0.12), (0.0, 0.0, -1.0)).any()
    assert ball.force((0.0, 0.0, 0.2)) == pytest.approx([0.0, 0.0, -3.0]), "bounded"


def test_constant_and_vibration():
    bench = Bench(
        effect(EffectKind.CONSTANT, force=2.0, direction=(0.0, -1.0, 0.0)),
        effect(EffectKind.VIBRATION, force=1.5, frequency=50.0, direction=(1.0, 0.0, 0.0)),
    )
    assert bench.force(t=0.005) == pytest.approx([1.5, -2.0, 0.0])
    assert bench.force(t=0.015) == pytest.approx([-1.5, -2.0, 0.0])
    late = 3600.0 * 24.0  # a day: the phase must not have been lost to rounding
    assert bench.force(t=late + 0.005) == pytest.approx([1.5, -2.0, 0.0], abs=1e-6)


def test_stick_slip_saw():
    """A slow pull: force rises to k slip, then drops to nothing; each drop costs k slip^2 / 2."""
    k, slip = 400.0, 0.004
    bench = Bench(effect(EffectKind.STICK_SLIP, stiffness=k, slip=slip))
    way = np.linspace([0.0, 0, 0], [5.05 * slip, 0, 0], 3000)
    forces = np.array([bench.force(p)[0] for p in way])
    assert forces.min() == pytest.approx(-k * slip, rel=3e-3)
    assert forces.max() == 0.0
    drops = np.flatnonzero(np.diff(forces) > 0.5 * k * slip)
    assert len(drops) == 5
    work = float((0.5 * (forces[1:] + forces[:-1]) * np.diff(way[:, 0])).sum())
    rest = 0.5 * k * (0.05 * slip) ** 2
    assert -work == pytest.approx(5 * 0.5 * k * slip**2 + rest, rel=2e-2)


class TestPath:
    def test_straight_path_is_the_closed_form(self):
        bench = Bench(
            effect(EffectKind.PATH_SPRING, stiffness=200.0, damping=4.0, path=0), paths=[path_record(STRAIGHT)]
        )
        assert bench.force((0.15, 0.03, -0.04)) == pytest.approx([0.0, -6.0, 8.0])
        assert bench.force((0.15, 0.03, 0.0), (5.0, 1.0, 0.0)) == pytest.approx([0.0, -10.0, 0.0]), "along it is free"
        assert bench.force((0.34, 0.0, 0.03), (1.0, 0.0, 0.0)) == pytest.approx([-8.0 - 4.0 * 0.64, 0.0, -6.0]), (
            "beyond its end it pulls back, and brakes by the share of the way that leads on"
        )

    def test_guidance_leads_with_its_force_and_fades_at_the_end(self):
        bench = Bench(effect(EffectKind.GUIDANCE, force=2.0, damping=10.0, path=0), paths=[path_record(STRAIGHT)])
        assert bench.force((0.1, 0.02, 0.0)) == pytest.approx([2.0, 0.0, 0.0])
        assert not bench.force((0.1, 0.02, 0.0), (0.2, 0.7, 0.0)).round(12).any(), "steady speed: force / damping"
        assert bench.force((0.295, 0.0, 0.0)) == pytest.approx([1.0, 0.0, 0.0])
        assert not bench.force((0.32, 0.0, 0.0)).round(9).any()

    def test_work_of_guidance_along_a_bent_path_is_force_times_length(self):
        """Less half of the centimetre it fades over."""
        points = np.array(BENT)
        curve = build_tunnel(points, 0.0)
        bench = Bench(effect(EffectKind.GUIDANCE, force=2.0, path=0), paths=[path_record(BENT)])
        way = curve.point(curve.parameter_at(np.linspace(0.0, curve.length, 1000)))
        assert energy_gained(bench, way) == pytest.approx(2.0 * (curve.length - 0.005), rel=1e-3)

    def test_path_that_is_not_there_does_nothing(self):
        bench = Bench(effect(EffectKind.PATH_SPRING, stiffness=200.0, path=3))
        assert not bench.force((0.1, 0.1, 0.1)).any()
        bench = Bench(effect(EffectKind.PATH_SPRING, stiffness=200.0, path=-1))
        assert not bench.force((0.1, 0.1, 0.1)).any()


class TestBody:
    """Effects that belong to a body: place and opposite force."""

    def bench(self, *rows, flags=ALL) -> Bench:
        bench = Bench(*rows, bodies=1)
        bench.rows.bodies["flags"] = flags
        motion = bench.motions[0]
        turn = about_axis((0.0, 0.0, 1.0), 0.5 * math.pi)
        motion["orientation"] = turn
        to_matrix(turn, motion["rotation"])
        motion["position"], motion["centre"] = (1.0, 0.0, 0.0), (1.0, 0.1, 0.0)
        return bench

    def test_place_turns_and_moves_with_the_body(self):
        bench = self.bench(effect(EffectKind.SPRING, stiffness=100.0, damping=1.0, body=0, position=(0.3, 0.0, 0.0)))
        assert not bench.force((1.0, 0.3, 0.0)).round(12).any()
        bench.motions[0]["velocity"], bench.motions[0]["omega"] = (0.5, 0.0, 0.0), (0.0, 0.0, 2.0)
        # the place moves with v + omega x arm = (0.5 - 2 * 0.2, 0, 0); the hand with it feels no damper
        assert bench.force((1.1, 0.3, 0.0), (0.1, 0.0, 0.0)) == pytest.approx([-10.0, 0.0, 0.0])

    def test_opposite_force_and_torque_on_the_body(self):
        bench = self.bench(effect(EffectKind.SPRING, stiffness=100.0, body=0, position=(0.3, 0.0, 0.0)))
        f = bench.force((1.2, 0.3, 0.1))
        motion = bench.motions[0]
        arm = np.array([0.0, 0.2, 0.0])
        assert motion["force"] == pytest.approx(-f)
        assert motion["torque"] == pytest.approx(np.cross(arm, -f))
        assert motion["force_user"] == pytest.approx(f)

    @pytest.mark.parametrize("kept", [BodyFlag.FORCE_ON_OBJECT, BodyFlag.TORQUE_ON_OBJECT])
    def test_author_may_keep_force_or_torque_from_the_body(self, kept):
        bench = self.bench(
            effect(EffectKind.SPRING, stiffness=100.0, body=0, position=(0.3, 0.0, 0.0)), flags=int(kept)
        )
        assert bench.force((1.2, 0.3, 0.1)).any()
        motion = bench.motions[0]
        assert motion["force"].any() == (kept == BodyFlag.FORCE_ON_OBJECT)
        assert motion["torque"].any() == (kept == BodyFlag.TORQUE_ON_OBJECT)

    def test_effect_on_the_body_alone_is_not_felt(self):
        bench = self.bench(effect(EffectKind.SPRING, stiffness=100.0, body=0, on_body=1, position=(0.0, 0.1, 0.0)))
        assert not bench.force((5.0, 5.0, 5.0)).any()
        assert bench.motions[0]["force"] == pytest.approx([-100.0, 0.0, 0.0])
        assert not bench.motions[0]["torque"].any()
        assert bench.totals["stiffness"] == 0.0

    @pytest.mark.parametrize("kind", [EffectKind.VIBRATION, EffectKind.STICK_SLIP])
    def test_surface_effects_wait_for_a_touch(self, kind):
        row = effect(kind, body=0, stiffness=100.0, slip=0.01, force=2.0, frequency=50.0, direction=(1.0, 0.0, 0.0))
        bench = self.bench(row)
        bench.force((1.0, 0.0, 0.0), t=0.0)
        assert not bench.force((1.005, 0.0, 0.0), t=0.005).any()
        bench.motions[0]["touched"] = 1
        bench.force((1.0, 0.0, 0.0), t=0.0)
        assert bench.force((1.005, 0.0, 0.0), t=0.005).any()

    def test_stick_slip_holds_on_to_a_turning_body(self):
        """The anchor turns with the body: a hand that turns with it feels nothing."""
        bench = self.bench(effect(EffectKind.STICK_SLIP, stiffness=100.0, slip=0.05, body=0))
        motion = bench.motions[0]
        motion["touched"] = 1
        bench.force((1.1, 0.0, 0.0))
        turn = about_axis((0.0, 0.0, 1.0), math.pi)
        to_matrix(turn, motion["rotation"])
        assert not bench.force((1.0, 0.1, 0.0)).round(12).any()
        assert bench.force((1.0, 0.11, 0.0)) == pytest.approx([0.0, -1.0, 0.0])

    def test_body_there_is_not_leaves_the_effect_to_the_user(self):
        bench = Bench(effect(EffectKind.SPRING, stiffness=100.0, body=7))
        assert bench.force((0.1, 0.0, 0.0)) == pytest.approx([-10.0, 0.0, 0.0])


@typed_kernel(FIELD)
def _not_a_number_beyond_x(parameters, p, v, t, out):
    out[0] = 1.0 if p[0] < parameters[0] else np.nan


class TestFields:
    def test_curl_turns_the_hand_and_does_no_work(self):
        bench = Bench(effect(EffectKind.FIELD, parameters=(13.0, 0, 0, 0, 0, 0, 0, 0)), fields=(curl,))
        assert bench.force(v=(0.0, 0.5, 0.0)) == pytest.approx([-6.5, 0.0, 0.0])
        bench.rows.effects["parameters"][0, :4] = (13.0, 1.0, 2.0, 2.0)
        v = np.array([0.3, -0.2, 0.5])
        assert bench.force(v=v) == pytest.approx(13.0 * np.cross([1 / 3, 2 / 3, 2 / 3], v))

    def test_each_effect_calls_its_own_function_about_its_own_place(self):
        bench = Bench(
            effect(EffectKind.FIELD, field=1, parameters=(-100.0, 0, 0, 0, 0, 0, 0, 0), position=PLACE),
            effect(EffectKind.FIELD, field=0, parameters=(2.0, 0, 0, 1.0, 0, 0, 0, 0), force=0.5),
            fields=(curl, saddle),
        )
        assert bench.force(np.array(PLACE) + [0.02, 0, 0], (1.0, 0.0, 0.0)) == pytest.approx([-2.0, 0.5, 0.0])

    def test_field_that_is_not_finite_is_put_away_and_reported(self):
        """It does not stop the loop; disabling and enabling it tries again."""
        bench = Bench(
            effect(EffectKind.SPRING, stiffness=100.0),
            effect(EffectKind.FIELD, parameters=(0.05, 0, 0, 0, 0, 0, 0, 0)),
            fields=(_not_a_number_beyond_x,),
        )
        assert bench.force((0.01, 0, 0)) == pytest.approx([0.0, 0.0, 0.0])
        assert bench.totals["quarantined"] == -1
        assert bench.force((0.06, 0, 0)) == pytest.approx([-6.0, 0.0, 0.0])
        assert (bench.totals["quarantined"], bench.totals["status"]) == (1, 0)
        assert bench.force((0.01, 0, 0)) == pytest.approx([-1.0, 0.0, 0.0]), "it stays away"
        assert bench.totals["quarantined"] == -1, "reported once"
        bench.rows.effects["enabled"][1] = 0
        bench.force((0.01, 0, 0))
        bench.rows.effects["enabled"][1] = 1
        assert bench.force((0.01, 0, 0)) == pytest.approx([0.0, 0.0, 0.0])

    def test_number_out_of_range_calls_nothing(self):
        bench = Bench(effect(EffectKind.FIELD, field=9), effect(EffectKind.FIELD, field=-1))
        assert not bench.force((0.1, 0.1, 0.1)).any()


@pytest.mark.parametrize("kind", [kind for kind in EffectKind if kind != EffectKind.FIELD])
def test_hand_that_is_nowhere_feels_nothing_and_is_reported(kind):
    """NaN in: no force out; the tick stops by totals.status, or there was no force to give."""
    row = effect(kind, stiffness=100.0, damping=1.0, slip=0.01, force=2.0, frequency=50.0, radius=0.0, path=0)
    row["direction"] = (1.0, 0.0, 0.0)
    bench = Bench(row, paths=[path_record(STRAIGHT)])
    assert np.isfinite(bench.force((math.nan, 0.0, 0.0), (0.0, math.nan, 0.0), t=0.005)).all()
    assert np.isfinite(bench.force((0.1, 0.0, 0.0), (0.0, 0.0, 0.0))).all(), "and it recovers"


def test_disabled_effect_costs_and_does_nothing():
    bench = Bench(effect(EffectKind.SPRING, stiffness=100.0, enabled=0))
    assert not bench.force((0.1, 0.0, 0.0)).any()
