"""The soccer ball at the feet in the gait orthosis: a body of the loop, felt, kicked by the swing of the own legs."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

import mimics_app as mimics
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.contracts.loop.loop_fields import MAX_CONTACTS
from mimics_app.contracts.messages.leg_motion import LegMotion
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.haptic.kernels.objects.object_inputs import INPUT_LENGTH, INPUT_POSITION, INPUT_VELOCITY
from mimics_app.rendering.haptic.no_objects import NO_FIELDS
from mimics_app.rendering.haptic.objects import new_object_work
from mimics_app.rendering.haptic.scene_objects import objects_of_scene
from mimics_app.rendering.haptic.simulate import simulate_objects
from mimics_app.tasks.kinds.soccer.ball import BALL, SoccerBall
from mimics_app.tasks.kinds.soccer.felt_ball import FeltBall
from mimics_app.tasks.kinds.soccer.match import Match, Pitch
from mimics_app.tasks.walking.legs import GAITS
from mimics_app.tasks.walking.walker import Walker
from tests.support.ball_impact import impact_speed

SCENE = root() / "scenes" / "soccer.json"
TICK = 1e-3
FRAME = 1.0 / 60.0


def _kicked(foot_mass: float, foot_speed: float) -> tuple[float, float]:
    """Speed of the shipped ball after a free foot ran into its middle, and the momentum that both have less [N s]."""
    scene = objects_of_scene(load_checked_scene(SCENE, device="lokomat:sim"))
    work = new_object_work(scene.capacities, scene.mesh_table)
    inputs, force = np.zeros(INPUT_LENGTH), np.zeros(3 * MAX_CONTACTS)
    rests = scene.rows.bodies[0]["position"]
    offset = scene.rows.points[0]["offset"]
    place, speed = rests - offset - (0.2, 0.0, 0.0), foot_speed
    for _ in range(400):
        place[0] += TICK * speed
        inputs[INPUT_POSITION : INPUT_POSITION + 3], inputs[INPUT_VELOCITY] = place, speed
        inputs[INPUT_POSITION + 3 : INPUT_POSITION + 6] = -9.0  # the other foot is elsewhere
        simulate_objects(scene.rows, work, scene.counts[0], inputs, NO_FIELDS, TICK, force)
        speed += TICK * force[0] / foot_mass
    ball = float(work.motions[0]["velocity"][0])
    return ball, foot_mass * (foot_speed - speed) - BALL.mass * ball


@pytest.mark.parametrize("foot_speed", [0.3, 0.8, 1.5, 2.5, 4.0])
@pytest.mark.parametrize("foot_mass", [2.0, 6.0, 15.0])
def test_the_ball_in_the_loop_gets_the_speed_of_the_impact_of_two_bodies(foot_mass: float, foot_speed: float) -> None:
    ball, lost = _kicked(foot_mass, foot_speed)
    assert ball == pytest.approx(impact_speed(foot_mass, foot_speed), rel=0.05)
    assert abs(lost) < 1e-9 * foot_mass, "the foot feels what moves the ball"


class Loop:
    """In the place of the loop: a body that flies straight on, and a foot that may touch it."""

    def __init__(self, felt: FeltBall) -> None:
        self.felt, self.place, self.velocity, self.spawn = felt, np.array([3.0, 0.2, 0.0]), np.zeros(3), 1
        self.foot, self.foot_velocity, self.touching, self.tick = np.zeros(3), np.zeros(3), 0, 0
        self.age_ns = 0  # of the loop's newest state in a frame

    def frame(self, ball: SoccerBall, walker: Walker) -> float:
        orders = {field.field: value for field, value in self.felt.orders.items()}
        if orders.get("spawn", self.spawn) != self.spawn:
            self.spawn = orders["spawn"]
            self.place, self.velocity = np.array(orders["position"]), np.array(orders["velocity"])
        self.place = self.place + FRAME * self.velocity
        self.tick += 1
        point = SimpleNamespace(hip_world=self.foot, v_world=self.foot_velocity)
        speed = float(np.linalg.norm(self.foot_velocity))
        seen = SimpleNamespace(
            bodies={"felt": tuple((self.place - 1e-9 * self.age_ns * self.velocity).tolist())},
            points=[SimpleNamespace(touching=self.touching, speed=speed)],
            now_ns=round(self.tick * FRAME * 1e9),
            snapshot=SimpleNamespace(points=(point,), t_ns=round(self.tick * FRAME * 1e9) - self.age_ns),
        )
        return self.felt.follow(seen, ball, walker)  # type: ignore[arg-type]


@pytest.mark.parametrize("yaw", [0.0, math.pi, 0.7])
def test_the_body_is_where_the_person_sees_the_ball_until_a_foot_is_near(yaw: float) -> None:
    felt, ball, walker = FeltBall("felt", 0.2), SoccerBall(), Walker(GAITS["healthy"], 0)
    loop = Loop(felt)
    walker.put(2.0, -1.0, yaw)
    ahead, right = np.array([math.sin(yaw), math.cos(yaw)]), np.array([-math.cos(yaw), math.sin(yaw)])
    ball.put(*(np.array([2.0, -1.0]) + 0.9 * ahead + 0.3 * right))
    for _ in range(3):
        loop.frame(ball, walker)
    np.testing.assert_allclose(loop.place, (0.9, 0.2, 0.3), atol=1e-9)
    assert not felt.held
    loop.foot, loop.foot_velocity = np.array([0.6, 0.2, 0.3]), np.array([3.0, 0.0, 0.0])
    loop.frame(ball, walker)
    assert felt.held, "the touch is 47 ms away"


def test_the_task_takes_the_speed_that_the_loop_gave_and_has_the_ball_again() -> None:
    felt, ball, walker = FeltBall("felt", 0.2), SoccerBall(), Walker(GAITS["healthy"], 0)
    loop = Loop(felt)
    walker.put(0.0, 0.0, math.pi)
    walker.speed = 0.5  # of legs whose person stands before a board: over the ground nobody moves
    ball.put(0.0, -0.5)
    for _ in range(3):
        loop.frame(ball, walker)
    loop.foot, loop.foot_velocity, loop.touching = loop.place - (0.15, 0.0, 0.0), np.array([2.0, 0.0, 0.0]), 1
    assert loop.frame(ball, walker) == 2.0, "a touch begins"
    loop.velocity = np.array([2.1, 0.4, -0.3])
    assert loop.frame(ball, walker) == 0.0
    loop.touching, loop.foot_velocity = 0, np.zeros(3)
    for _ in range(3):
        loop.frame(ball, walker)
    assert not felt.held
    np.testing.assert_allclose(ball.velocity, (-0.3, 0.4, -2.1), atol=1e-9)  # ahead is -z, the right +x


@pytest.mark.parametrize("turn", [-1.8, 0.0, 1.2])
def test_a_ball_that_lies_still_lies_still_for_who_walks_and_turns(turn: float) -> None:
    """The loop has it in the person's frame, which moves and turns; over the ground it has no velocity."""
    felt, ball, walker = FeltBall("felt", 0.2), SoccerBall(), Walker(GAITS["healthy"], 0)
    loop, legs = Loop(felt), LegMotion(0.0, 0.0, 0.0, 0.0, 0.5)
    walker.put(0.0, 0.0, math.pi)
    ball.put(0.3, -0.6)
    for _ in range(3):
        walker.step_by_legs(legs, turn, FRAME)
        loop.frame(ball, walker)
    assert not felt.held
    loop.foot = loop.place - (0.16, 0.0, 0.0)
    for _ in range(4):
        walker.step_by_legs(legs, turn, FRAME)
        loop.frame(ball, walker)
        assert felt.held
        assert np.linalg.norm(ball.velocity) < 0.15, "a body flies straight on in a frame that turns for 60 ms"
    np.testing.assert_allclose(ball.place, (0.3, ball.spec.radius, -0.6), atol=0.006)


def test_how_old_the_state_of_the_loop_is_changes_no_velocity_of_who_walks() -> None:
    felt, ball, walker = FeltBall("felt", 0.2), SoccerBall(), Walker(GAITS["healthy"], 0)
    loop, legs = Loop(felt), LegMotion(0.0, 0.0, 0.0, 0.0, 0.5)
    walker.put(0.0, 0.0, math.pi)
    ball.put(0.3, -1.2)
    ordered = []
    for number in range(8):
        loop.age_ns = (0, 12_000_000)[number % 2]
        walker.step_by_legs(legs, 0.0, FRAME)
        loop.frame(ball, walker)
        ordered += [value[0] for field, value in felt.orders.items() if field.field == "velocity"]
    np.testing.assert_allclose(ordered[1:], -0.5, atol=1e-6)


def test_how_old_the_state_of_the_loop_is_changes_no_velocity_of_the_ball() -> None:
    """Who walks at 0.5 m/s and turns kicks it; in a frame whose newest state is old the loop did less, they did not."""
    felt, ball, walker = FeltBall("felt", 0.2), SoccerBall(), Walker(GAITS["healthy"], 0)
    loop, legs = Loop(felt), LegMotion(0.0, 0.0, 0.0, 0.0, 0.5)
    walker.put(0.0, 0.0, math.pi)
    ball.put(0.3, -0.6)
    kicked, speeds = np.array([2.0, 0.0, 0.3]), []
    for number in range(12):
        walker.step_by_legs(legs, 0.0, FRAME)
        loop.age_ns = (0, 12_000_000)[number % 2]
        if number >= 4:
            loop.touching, loop.velocity = 1, kicked
        loop.frame(ball, walker)
        speeds.append(ball.velocity.tolist())
    np.testing.assert_allclose(speeds[6:], np.tile((0.3, 0.0, -2.5), (6, 1)), atol=1e-6)


def test_a_ball_that_something_else_moves_is_the_tasks_again() -> None:
    felt, ball, walker = FeltBall("felt", 0.2), SoccerBall(), Walker(GAITS["healthy"], 0)
    loop = Loop(felt)
    walker.put(0.0, 0.0, 0.0)
    ball.put(0.0, 0.5)
    for _ in range(3):
        loop.frame(ball, walker)
    loop.foot = loop.place - (0.16, 0.0, 0.0)
    loop.frame(ball, walker)
    loop.frame(ball, walker)
    assert felt.held
    ball.put(0.0, 0.0)
    ball.place[2] = 1.2  # a kick-off
    loop.frame(ball, walker)
    loop.frame(ball, walker)
    assert not felt.held and ball.place[2] == 1.2 and loop.place[0] == pytest.approx(1.2)


def test_a_ball_that_lies_waits_for_who_comes_slowly() -> None:
    """At 0.3 m/s the way of 2.4 m takes longer than the five seconds after which it is put nearer otherwise."""
    match = Match(Pitch(), GAITS["severe"], None, 1, 7.0)
    kinds = [each.kind for _ in range(60 * 6) for each in match.step(0.3, 0.0, False, FRAME)]
    assert "whistle" not in kinds
    still = [each.kind for _ in range(60 * 6) for each in match.step(0.0, 0.0, False, FRAME)]
    assert "whistle" in still


def test_a_person_in_the_orthosis_feels_the_ball_and_kicks_it_by_the_swing_of_a_leg() -> None:
    """Kicks of some 2.5 m/s, as the foot swings; force where the ball is touched and only there; nothing stops."""
    felt: list[float] = []
    with mimics.open(SCENE, device="lokomat:sim", record=False) as session:
        session.step_until(lambda s: s.orders.person_may_act)
        ball, speeds, touched = session.world.find("ball"), [], []
        before = ball.world_matrix()[:3, 3].copy()
        for _ in range(60 * 8):
            session.step()
            state = session.state
            assert state["state"] == SafetyState.ACTIVE
            felt.append(max(float(np.linalg.norm(state[f"{point}f_user_world"])) for point in ("", "point_1_")))
            touched.append(any(state[f"{point}partners"] for point in ("", "point_1_")))
            now = ball.world_matrix()[:3, 3].copy()
            speeds.append(float(np.linalg.norm(now - before)) / FRAME)
            before = now
    assert session.task["kicks"] >= 1
    assert max(felt) > 5.0 and max(f for f, t in zip(felt, touched, strict=True) if not t) == 0.0
    first = touched.index(True)
    assert 1.0 < max(speeds[first : first + 12]) < 5.0
