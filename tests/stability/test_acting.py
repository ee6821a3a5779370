"""What acts: the stiffness cap, the passivity controller and the energy tank, in the loop and in closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mimics_app.contracts.loop.haptic import EventKind, SafetyState, TripCause
from mimics_app.contracts.loop.haptic_objects import ShapeKind
from mimics_app.lab.stability.s05b_energy_dissipated import UNLIMITED, given_by_taps
from mimics_app.rendering.haptic.kernels.acting import payable_share, tank_level
from mimics_app.rendering.haptic.kernels.closed_region import contact_share
from mimics_app.rendering.haptic.kernels.passivity_control import contact_scale, middle_velocity, stored_share
from mimics_app.rendering.haptic.kernels.stability import spring_share
from mimics_app.world.components.robot import Robot
from tests.support.haptic_bench import FORCE, PUSH, Bench, glide, patient_bench, pushed_bench, script, scripted
from tests.support.object_bench import scripted_with, shape_below
from tests.support.regions import HEAVY, linear_region

T = 1e-3
OWN, WALL = 8.0, 20.0  # damping [N s/m] of the virtual mass and of the wall
UNSTABLE = (2.0, 6.0)  # times the stiffness limit


def _limit(damping: float, delay: float) -> float:
    return damping / (0.5 * T + delay)


def _pressed(stiffness: float, delay: float, **values: float) -> Bench:
    """A scripted hand that presses 0.2 mm into the wall of a straight tunnel at tick 900, and leaves at 1100."""
    rows = script(1200)
    glide(rows, 850, 2, 0.0102)
    glide(rows, 1100, 2, 0.0)
    bench = scripted(rows)
    bench.publish(tunnel__stiffness=stiffness, tunnel__damping=WALL, virtual_damping=OWN, device_delay=delay)
    bench.publish(**{**HEAVY, **values})
    return bench


@pytest.mark.parametrize("delay", [1e-3, 4e-3, 12e-3])
def test_a_wall_beyond_its_limit_is_rendered_with_the_margin_it_should_keep(delay: float):
    stiffness = 3.0 * _limit(OWN + WALL, delay)
    bench = _pressed(stiffness, delay)
    rows = bench.advance(1200)
    share = _limit(OWN + WALL, delay) / 1.2 / stiffness
    assert rows["stiffness_share"] == pytest.approx(share, rel=1e-12)
    assert rows["margin"] == pytest.approx(0.2, rel=1e-12)
    assert np.linalg.norm(rows["f_user_world"][1000]) == pytest.approx(share * stiffness * 2e-4, rel=1e-9)
    events = bench.engine.events()
    capped = events[events["kind"] == EventKind.CAP]
    assert len(capped) == 1 and capped["force"][0] == pytest.approx(share, rel=1e-6)
    assert bench.engine.stability().stiffness_share == pytest.approx(share, rel=1e-12)


def test_only_reported_the_wall_stays_as_stiff_as_authored():
    bench = _pressed(2.0 * _limit(OWN + WALL, 4e-3), 4e-3, cap=0)
    rows = bench.advance(1200)
    assert (rows["stiffness_share"] == 1.0).all() and rows["margin"][0] == pytest.approx(-0.5, rel=1e-12)
    kinds = bench.engine.events()["kind"]
    assert (kinds == EventKind.MARGIN).sum() == 1 and not (kinds == EventKind.CAP).any()


def test_a_healthy_wall_is_frozen_objects():
    bench = _pressed(0.5 * _limit(OWN + WALL, 4e-3), 4e-3)
    assert (bench.advance(1200)["stiffness_share"] == 1.0).all()
    assert not (bench.engine.events()["kind"] == EventKind.CAP).any()


def test_a_contact_may_soften_but_never_stiffens_while_it_lasts():
    """Stiffening under load would make 1/2 dK d^2 of energy: what comes back waits for free motion."""
    stiffness = 1.5 * _limit(OWN + WALL, 4e-3)
    bench = _pressed(stiffness, 4e-3)
    bench.advance(950)
    bench.publish(device_delay=8e-3)
    soft = bench.advance(50)["stiffness_share"]
    assert soft[-1] == pytest.approx(_limit(OWN + WALL, 8e-3) / 1.2 / stiffness)
    bench.publish(device_delay=1e-3)
    rows = bench.advance(200)
    touching = rows["penetration"] > 0.0
    assert touching[:50].all() and not touching[-1]
    assert (rows["stiffness_share"][touching] == soft[-1]).all() and rows["stiffness_share"][-1] == 1.0


@given(
    stiffness=st.floats(10, 1e6), damping=st.floats(0, 100), own=st.floats(0, 100), lag=st.floats(1e-4, 0.1),
    margin=st.floats(0, 1),
)  # fmt: skip
def test_shares_keep_the_margin_and_are_the_largest_that_do(
    stiffness: float, damping: float, own: float, lag: float, margin: float
):
    share = contact_share(linear_region(own, lag), stiffness, damping, margin)
    assert 0.0 <= share <= 1.0
    assert share * stiffness * lag * (1 + margin) <= (own + share * damping) * (1 + 1e-9)
    more = 1.001 * share + 1e-9
    assert share == 1.0 or more * stiffness * lag * (1 + margin) > own + more * damping
    spring = spring_share(stiffness, (own + damping) / lag, margin)
    assert spring * stiffness * (1 + margin) <= (own + damping) / lag * (1 + 1e-9)


def _pushed(times: float, **values: float) -> tuple[np.ndarray, Bench]:
    """A constant push by nobody's hand into a wall of so many times its limit, from 0.4 s on."""
    robot = Robot(sensor_noise=0.0)
    limit = WALL / (T + 1.0 / (2.0 * math.pi * robot.servo_bandwidth_hz))
    bench = pushed_bench(robot)
    bench.publish(tunnel__stiffness=times * limit, tunnel__damping=WALL, virtual_damping=0.0, tunnel__drag=0.0)
    bench.publish(max_acceleration=1e3, velocity_limit=10.0, power_limit=1e6, energy_limit=1e6, **values)
    bench.advance(900)
    bench.engine.plugin.memory[PUSH + 2] = 10.0
    return bench.advance(4300), bench


def _swing(rows: np.ndarray) -> tuple[float, float]:
    """In the first second and in the fourth [m]."""
    height = rows["hip_world"][:, 1]
    return float(np.ptp(height[300:1300])), float(np.ptp(height[3300:]))


@pytest.mark.parametrize("times", UNSTABLE)
def test_the_cap_brings_an_unstable_wall_to_rest(times: float):
    wild, _ = _pushed(times, cap=0, passivity=0)
    calm, _ = _pushed(times, cap=1, passivity=0)
    assert _swing(wild)[1] > 0.08 or wild["cause"][-1] == TripCause.OSCILLATION
    assert _swing(calm)[1] < 0.25 * _swing(calm)[0] and calm["calm"][1:].min() == 1.0
    assert calm["margin"].min() == pytest.approx(0.2, rel=1e-9)


@pytest.mark.parametrize("times", UNSTABLE)
def test_the_passivity_controller_makes_no_energy_where_the_wall_swings_up(times: float):
    """Without it the wall gives the virtual mass 0.1 J and more; with it next to nothing, and the swing never grows."""
    wild, _ = _pushed(times, cap=0, passivity=0)
    tame, bench = _pushed(times, cap=0, passivity=1)
    assert wild["credit"].min() < -0.1 and wild["passivity"].max() == 0.0
    assert tame["credit"].min() > -1e-3
    early, late = _swing(tame)
    assert late < 1.01 * early < 0.06
    assert bench.engine.stability().passivity_ticks == (tame["passivity"] > 0.0).sum() > 20


def test_the_handle_alone_would_not_show_it():
    """Why the virtual mass is watched: at the measured position the wall that swings up has taken energy."""
    wild, _ = _pushed(2.0, cap=0, passivity=0)
    assert wild["energy"].min() >= 0.0 and wild["credit"].min() < -0.1


@settings(max_examples=20)
@given(speed=st.floats(0.02, 0.5), ticks=st.floats(4, 200), stiffness=st.floats(100, 5000))
def test_with_the_controller_a_tap_draws_nothing(speed: float, ticks: float, stiffness: float):
    """From four ticks in on; a hand that turns sooner turns before it has paid for the force it meets."""
    depth = ticks * speed * T
    _, worst, taken = given_by_taps(speed, depth, UNLIMITED, stiffness)
    assert worst <= 1e-15 and 0.0 < taken < stiffness * depth


def test_a_damped_wall_needs_no_controller():
    """b > K T / 2: the force is the authored one in every tick."""
    _, worst, taken = given_by_taps(0.1, 3e-3, UNLIMITED, 2000.0, 1.1)
    assert worst < 0.0 and taken == 0.0


def _advanced(size: float, seconds: float = 2.0, damping: float = 0.0, returned: float = 0.0) -> np.ndarray:
    """A tunnel whose assistance of 4 N drives nobody's hand, with an energy tank."""
    bench = pushed_bench(Robot(sensor_noise=0.0))
    bench.publish(tank_size=size, tank_refill=0.0, tank_return=returned, tunnel__drag=0.0, virtual_damping=damping)
    bench.advance(600)
    bench.publish(tunnel__advance=4.0)
    return bench.advance(round(1000 * seconds))


def _work(rows: np.ndarray) -> float:
    """Of the force felt on the virtual mass [J]; robot axes x, y, z are world z, x, y."""
    v = rows["v_virtual"][:, [1, 2, 0]]
    return float(np.sum(rows["f_user_world"][1:] * 0.5 * (v[:-1] + v[1:])) * T)


def test_assistance_ends_with_the_tank_and_softly():
    rows = _advanced(0.05, seconds=0.9)
    force = np.linalg.norm(rows["f_user_world"], axis=1)
    assert 0.8 * 0.05 < _work(rows) <= 0.05 * (1 + 1e-9)
    assert force.max() == pytest.approx(4.0, rel=1e-6) and force[-1] < 0.5
    assert np.abs(np.diff(force[100:])).max() < 0.1
    assert (rows["tank"] >= 0.0).all() and rows["tank_share"].min() < 0.1


def test_a_full_tank_pays_all():
    rows = _advanced(5.0, seconds=0.5)
    assert (rows["tank_share"] == 1.0).all()


@pytest.mark.parametrize("returned", [0.0, 0.5, 1.0])
def test_a_share_of_what_the_virtual_damping_takes_flows_into_the_tank(returned: float):
    rows = _advanced(5.0, seconds=0.4, damping=10.0, returned=returned)
    dissipated = 10.0 * float(np.sum(rows["v_virtual"] ** 2)) * T
    assert dissipated > 0.05
    assert rows["tank"][-1] == pytest.approx(5.0 - _work(rows) + returned * dissipated, abs=2e-3)


@given(level=st.floats(0, 10), power=st.floats(-100, 100), inflow=st.floats(0, 5), size=st.floats(0, 10))
@pytest.mark.requirement("R12")
def test_no_tick_overdraws_the_tank(level: float, power: float, inflow: float, size: float):
    level = min(level, size)
    share = payable_share(level, power, inflow)
    assert 0.0 <= share <= 1.0 and (power > 0.0 or share == 1.0)
    assert level - share * power * T + inflow * T >= -1e-12
    assert 0.0 <= tank_level(level, share * power * T, inflow, size, T) <= size


# what stops the loop


def _jumping(way: float, *, silent: int = 0) -> np.ndarray:
    rows = script(600)
    rows[400:, 2] = way
    rows[400 - silent : 400, -1] = 1.0
    return scripted(rows, straight=None).advance(600)


@pytest.mark.requirement("R13")
def test_a_position_that_jumps_stops_the_loop_although_the_reported_velocity_stays():
    """Reach: 1.2 m/s for the tick and 2 ms of lateness that nothing else notices, and 1 mm."""
    assert _jumping(0.0045)["state"][-1] == SafetyState.ACTIVE
    rows = _jumping(0.0047)
    assert rows["state"][399] == SafetyState.ACTIVE
    assert rows["state"][400] == SafetyState.SAFE_STOP and rows["cause"][400] == TripCause.JUMP
    assert (rows["f_user_world"][400:] == 0.0).all()


def test_after_a_silence_the_position_may_be_further_away():
    assert _jumping(0.0101, silent=5)["state"][-1] == SafetyState.ACTIVE
    assert _jumping(0.0107, silent=5)["cause"][-1] == TripCause.JUMP


@pytest.mark.parametrize(("force", "ticks", "stops"), [(300.0, 21, True), (300.0, 20, False), (249.0, 200, False)])
@pytest.mark.requirement("R14")
def test_a_force_sensor_that_sticks_beyond_its_limit_stops_the_loop(force: float, ticks: int, stops: bool):
    """The limit is 250 N for 20 ms: a spike passes, and what a hand can do."""
    rows = script(700)
    rows[400 : 400 + ticks, FORCE + 2] = force
    rows = scripted(rows, straight=None).advance(700)
    if not stops:
        assert (rows["state"][400:] == SafetyState.ACTIVE).all()
        return
    assert (rows["state"][400:420] == SafetyState.ACTIVE).all()
    assert rows["state"][420] == SafetyState.SAFE_STOP and rows["cause"][420] == TripCause.SENSOR
    assert (rows["f_user_world"][420:] == 0.0).all()


@pytest.mark.requirement("R12")
def test_one_contact_that_gives_too_much_stops_the_loop():
    """A tap of 10 mm at 0.1 m/s draws K T v d = 2 mJ from an undamped wall of 2 kN/m; the limit is 1 mJ."""
    rows = script(1500)
    glide(rows, 600, 2, 0.02, 200)
    glide(rows, 800, 2, 0.0, 200)
    for limit, state in ((1.5e-3, SafetyState.SAFE_STOP), (2.5e-3, SafetyState.ACTIVE)):
        bench = scripted(rows)
        bench.publish(tunnel__damping=0.0, tunnel__drag=0.0, tunnel__drag_growth=0.0, energy_limit=limit)
        samples = bench.advance(1500)
        assert samples["state"][-1] == state
    assert samples["energy"].min() == pytest.approx(-2e-3, rel=0.05)


def test_silence_is_reported_once_when_it_begins():
    rows = script(600)
    rows[300:308, -1] = 1.0
    rows[400:402, -1] = 1.0
    bench = scripted(rows)
    bench.advance(600)
    events = bench.engine.events()
    assert [int(e["tick"]) for e in events if e["kind"] == EventKind.STALE] == [303]


# no contact pulls


def _against(rows: np.ndarray) -> np.ndarray:
    """Force felt along the contact's own [N], where drag, assistance and virtual damping are off: nothing else acts."""
    wanted = rows["f_virt_world"]
    size = np.linalg.norm(wanted, axis=1)
    return np.sum(rows["f_user_world"] * wanted, axis=1)[size > 0.0] / size[size > 0.0]


@pytest.mark.parametrize("times", [1.1, *UNSTABLE])
def test_the_controller_weakens_the_wall_and_never_lets_it_pull(times: float):
    """Of a wall that swings up it may take all in a tick, and gives back none as a pull; nor does a debt arise."""
    rows, _ = _pushed(times, cap=0, passivity=1)
    assert (rows["passivity"] > 0.0).sum() > 20
    assert _against(rows).min() > -1e-12
    assert rows["credit"].min() > -1e-12


def test_a_person_in_the_tunnel_is_never_pulled_to_its_wall():
    bench = patient_bench("severe", seed=3)
    bench.advance(2200)
    bench.publish(controller=3, trial=1, tunnel__drag=0.0, tunnel__drag_growth=0.0)
    bench.send(active=1, trial=1)
    rows = np.concatenate([bench.advance(4000) for _ in range(4)])
    inside = rows[rows["penetration"] > 0.0]
    assert len(inside) > 200 and (inside["passivity"] > 0.0).any()
    assert _against(inside).min() > -1e-12


@given(
    credit=st.floats(0.0, 1.0), force=st.floats(0.0, 100.0), push=st.floats(-50.0, 50.0), v=st.floats(-1.0, 1.0),
    mass=st.floats(0.2, 20.0), dt=st.sampled_from([2.5e-4, 5e-4, 1e-3, 4e-3]),
)  # fmt: skip
def test_no_tick_of_the_virtual_mass_overdraws_its_credit(
    credit: float, force: float, push: float, v: float, mass: float, dt: float
):
    """Exact work of the weakened force over the tick it accelerates the mass in, of any force, hand and mass."""
    f, hand, speed, middle = (np.array([value, 0.0, 0.0]) for value in (force, push, v, 0.0))
    middle_velocity(speed, f, hand, mass, dt, middle)
    factor = contact_scale(credit, f, middle, dt, math.inf)
    assert 0.0 <= factor <= 1.0
    work = factor * force * (v + 0.5 * dt * (factor * force + push) / mass) * dt
    assert work <= credit + 1e-12


@pytest.mark.parametrize("left", [-0.01, 0.0, 0.1, 0.5, 1.0, 3.0])
def test_a_spring_returns_the_energy_that_is_left_and_no_more(left: float):
    """A spring of k pressed by d holds k d^2 / 2; the weakened one, of share^2 of that, holds what may be given."""
    stiffness, depth = 800.0, 0.005
    stored = 0.5 * stiffness * depth**2
    share = stored_share(left * stored, stiffness * depth, stiffness * depth, depth, 0.0)
    assert share**2 * stored == pytest.approx(min(max(left, 0.0), 1.0) * stored, abs=1e-15)


def test_the_middle_velocity_is_that_of_the_motion_under_a_held_force():
    """Half of the acceleration and no more: a faster one would weaken contacts that keep their credit."""
    v, f, hand, middle = np.array([0.1, 0.0, -0.2]), np.array([3.0, -1.0, 0.0]), np.array([1.0, 0.0, 5.0]), np.zeros(3)
    middle_velocity(v, f, hand, 2.0, T, middle)
    moved = v * T + 0.5 * (f + hand) / 2.0 * T**2
    np.testing.assert_allclose(middle * T, moved, rtol=1e-12)


# at other periods than 1 ms


def test_the_wall_is_capped_for_the_period_the_loop_has():
    """At 2 kHz the force is half as old: the wall may be stiffer by (1 ms / 2 + delay) / (0.5 ms / 2 + delay)."""
    stiffness = 3.0 * _limit(OWN + WALL, 1e-3)
    rows = script(100)
    bench = scripted(rows, rate=2000)
    bench.publish(tunnel__stiffness=stiffness, tunnel__damping=WALL, virtual_damping=OWN, device_delay=1e-3, **HEAVY)
    share = bench.advance(100)["stiffness_share"]
    assert share == pytest.approx((OWN + WALL) / (0.25e-3 + 1e-3) / 1.2 / stiffness, rel=1e-12)


def test_the_wall_is_capped_for_the_period_that_was_measured():
    """A loop that stalled: 4 ms instead of 1 lower the stiffness that is rendered, not the margin alone."""
    stiffness = 3.0 * _limit(OWN + WALL, 1e-3)
    bench = _pressed(stiffness, 1e-3)
    rows = bench.advance(1080)
    stalled = rows.copy()
    stalled["period_s"][1000:] = 4e-3
    out = bench.replay(stalled)
    share = (OWN + WALL) / (2e-3 + 1e-3) / 1.2 / stiffness
    assert out["stiffness_share"][999] == rows["stiffness_share"][999]
    assert out["stiffness_share"][1001:] == pytest.approx(share, rel=1e-12)
    felt = np.linalg.norm(out["f_user_world"][1050]) / np.linalg.norm(rows["f_user_world"][1050])
    assert felt == pytest.approx(share / rows["stiffness_share"][1050], rel=1e-9)


@pytest.mark.parametrize("kind", [ShapeKind.WALL, ShapeKind.BOX, ShapeKind.SPHERE])
def test_a_shape_is_capped_for_the_period_that_was_measured(kind: ShapeKind):
    """As the tunnel's wall: a loop that stalled renders less of a shape's stiffness, not its margin alone."""
    rows = script(1100)
    rows[:, 2] = 0.01
    glide(rows, 850, 2, -0.0002)
    bench = scripted_with(shape_below(kind, stiffness=1e5, damping=WALL), rows)
    bench.publish(virtual_damping=OWN, device_delay=1e-3)
    in_time = bench.advance(1080)
    stalled = in_time.copy()
    stalled["period_s"][1000:] = 4e-3
    late = bench.replay(stalled)
    assert in_time["touching"][1000] == 1 and late["stiffness_share"][999] == in_time["stiffness_share"][999] < 1.0
    assert late["stiffness_share"][1001] < 0.8 * in_time["stiffness_share"][1001]
    felt = [np.linalg.norm(rows["f_user_world"][1050]) for rows in (late, in_time)]
    share = late["stiffness_share"][1050] / in_time["stiffness_share"][1050]
    assert felt[0] == pytest.approx(share * felt[1], rel=1e-9)


def test_sticking_friction_that_is_stiffer_than_its_surface_is_capped():
    """The surface alone may be rendered whole; a hand that sticks to it feels the stiffer spring along it."""
    rows = script(1100)
    rows[:, 2] = 0.01
    glide(rows, 850, 2, -0.0002)

    def share(along: float) -> float:
        surface = {"stiffness": 500.0, "damping": WALL, "friction_static": 0.6, "friction_dynamic": 0.5}
        play = shape_below(ShapeKind.WALL, friction_stiffness=along, **surface)
        bench = scripted_with(play, rows)
        bench.publish(virtual_damping=OWN, device_delay=1e-3)
        samples = bench.advance(1080)
        assert samples["touching"][1000] == 1
        return float(samples["stiffness_share"][1000])

    assert share(500.0) == 1.0
    needed = [1.0 / share(along) for along in (0.5e5, 1e5, 1.5e5)]  # k T (1 + margin) / own, less the dampers' part
    assert needed[0] > 5.0
    assert needed[2] - needed[1] == pytest.approx(needed[1] - needed[0], rel=1e-9)


@pytest.mark.parametrize("rate", [500, 1000, 2000, 4000])
def test_the_force_rises_by_its_limit_in_a_second_at_any_rate(rate: int):
    """A hand put into the wall: 200 N/s, so 0.2 N a tick at 1 kHz and 0.1 N at 2 kHz."""
    rows = script(2 * rate)
    rows[:, 2] = 0.0105  # in the wall from the first tick on
    bench = scripted(rows, rate=rate)
    bench.publish(tunnel__stiffness=2e4, tunnel__damping=0.0, cap=0, ramp_time=0.0, ramp_force=1e3)
    bench.publish(force_rate_limit=200.0, force_limit=60.0)
    rows = bench.advance(2 * rate)
    force = np.linalg.norm(rows["f_user_world"], axis=1)
    rising = np.diff(force)[np.diff(force) > 0.0]
    assert len(rising) > 5
    assert rising[:-1] == pytest.approx(200.0 / rate, rel=1e-9), "the last step may be shorter"
