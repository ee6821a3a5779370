"""Wires: every output arrives at every input, times gain plus offset, and adds up."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.contracts.loop.haptic_objects import EffectKind, SignalSource, SignalTarget
from mimics_app.maths.quat import about_axis, to_matrix
from tests.support.effect_bench import Bench, effect, wire

HAND = {"p": (1, 2, 3), "v": (4, 5, 6), "measured": (7, 8, 9), "felt": (10, 11, 12), "grasp": 13.0, "t": 14.0}

OF_HAND = {
    SignalSource.POSITION_ROBOT: (1, 2, 3),
    SignalSource.VELOCITY_ROBOT: (4, 5, 6),
    SignalSource.FORCE_MEASURED: (7, 8, 9),
    SignalSource.FORCE_USER: (10, 11, 12),
    SignalSource.GRASP: (13, 0, 0),
    SignalSource.TIME: (14, 0, 0),
}


def moving(bench: Bench, body: int) -> None:
    motion = bench.motions[body]
    turn = about_axis((0.0, 0.0, 1.0), 0.5)
    motion["orientation"] = turn
    to_matrix(turn, motion["rotation"])
    motion["position"], motion["velocity"], motion["omega"] = (1, 2, 3), (4, 5, 6), (7, 8, 9)
    motion["force_user"], motion["touched"], motion["collided"] = (10, 11, 12), 1, 0


C, S = np.cos(0.5), np.sin(0.5)
OF_BODY = {
    SignalSource.POSITION_OBJECT: (1, 2, 3),
    SignalSource.VELOCITY_OBJECT: (4, 5, 6),
    SignalSource.OMEGA_OBJECT: (7, 8, 9),
    SignalSource.AXIS_X_OBJECT: (C, S, 0),
    SignalSource.AXIS_Y_OBJECT: (-S, C, 0),
    SignalSource.AXIS_Z_OBJECT: (0, 0, 1),
    SignalSource.FORCE_OBJECT: (10, 11, 12),
    SignalSource.TOUCHED: (1, 0, 0),
    SignalSource.COLLIDED: (0, 0, 0),
}


def test_every_source_is_tried():
    assert {*OF_HAND, *OF_BODY} == set(SignalSource)


@pytest.mark.parametrize("source", OF_HAND)
def test_outputs_of_the_robot(source):
    bench = Bench(bodies=1, wires=[wire(source, SignalTarget.FORCE_AUX)])
    bench.set_hand(**HAND)
    bench.carry()
    assert bench.work.aux_forces[0] == pytest.approx(OF_HAND[source])


@pytest.mark.parametrize("source", OF_BODY)
def test_outputs_of_an_object(source):
    bench = Bench(bodies=2, wires=[wire(source, SignalTarget.TORQUE_AUX, of=1, to=0)])
    moving(bench, 1)
    bench.carry()
    assert bench.work.aux_torques[0] == pytest.approx(OF_BODY[source])
    assert not bench.work.aux_torques[1].any()


def test_gain_offset_own_value_and_several_wires_add_up():
    turn = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
    wires = [
        wire(SignalSource.POSITION_ROBOT, SignalTarget.FORCE_AUX, gain=2.0, offset=(0, 0, 1)),
        wire(SignalSource.VELOCITY_ROBOT, SignalTarget.FORCE_AUX, gain=turn),
    ]
    bench = Bench(bodies=1, wires=wires)
    bench.rows.bodies["force_aux"] = (100, 200, 300)
    bench.set_hand(**HAND)
    for _ in range(2):  # nothing is left over from the last tick
        bench.carry()
        assert bench.work.aux_forces[0] == pytest.approx([100 + 2 + 5, 200 + 4 + 6, 300 + 6 + 1 + 4])


def test_inputs_of_an_effect():
    row = effect(EffectKind.SPRING, position=(0, 0, 1), stiffness=10.0, force=5.0)
    wires = [
        wire(SignalSource.POSITION_ROBOT, SignalTarget.EFFECT_POSITION),
        wire(SignalSource.GRASP, SignalTarget.EFFECT_STIFFNESS, gain=3.0),
        wire(SignalSource.VELOCITY_ROBOT, SignalTarget.EFFECT_FORCE, gain=[[0, 1, 0], [0, 0, 0], [0, 0, 0]]),
    ]
    bench = Bench(row, wires=wires)
    bench.set_hand(**HAND)
    bench.carry()
    memory = bench.work.effects[0]
    assert memory["position"].tolist() == [1, 2, 4]
    assert (memory["stiffness"], memory["size"]) == (10 + 39, 5 + 5)


def test_grasp_that_makes_a_spring_stiffer_is_felt():
    row = effect(EffectKind.SPRING, stiffness=10.0)
    bench = Bench(row, wires=[wire(SignalSource.GRASP, SignalTarget.EFFECT_STIFFNESS, gain=20.0)])
    assert bench.force((0.1, 0, 0), grasp=2.0) == pytest.approx([-5.0, 0, 0])
    bench.rows.wires["gain"] *= -1.0
    assert not bench.force((0.1, 0, 0), grasp=2.0).any(), "no stiffness below nothing"


def test_body_not_yet_in_its_place_brings_nothing():
    """Before the first tick a body is at no place: not even the offset of a wire from it counts."""
    bench = Bench(bodies=2, wires=[wire(SignalSource.POSITION_OBJECT, SignalTarget.FORCE_AUX, of=1, offset=(1, 1, 1))])
    bench.motions[1]["orientation"] = 0.0
    bench.carry()
    assert not bench.work.aux_forces.any()


@pytest.mark.parametrize("target", SignalTarget)
@pytest.mark.parametrize(("of", "to"), [(5, 0), (0, 5), (-1, -1)])
def test_rows_there_are_not_are_frozen_objects(target, of, to):
    bench = Bench(effect(EffectKind.SPRING), bodies=1, wires=[wire(SignalSource.POSITION_OBJECT, target, of=of, to=to)])
    bench.motions[0]["position"] = (1, 2, 3)
    bench.carry()
    assert not bench.work.aux_forces.any()
    assert not bench.work.aux_torques.any()
    assert not bench.work.effects["position"].any()
