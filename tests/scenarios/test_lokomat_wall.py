"""The scene of Figure 55: in the loop, under either control, the foot of the simulated person rests at the wall."""

from __future__ import annotations

import msgspec
import numpy as np
import pytest

import mimics_app as mimics
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.rendering.haptic.controllers.orthosis_legs import PARAMETERS
from mimics_app.rendering.haptic.controllers.parameter_vector import parameter_vector
from mimics_app.rendering.haptic.controllers.registry import find_controller

SCENE = "scenes/examples/lokomat_wall.json"
WALL = 0.24


def test_the_foot_is_held_at_the_wall_and_nothing_stops(tmp_path) -> None:
    with mimics.open(SCENE, runs=tmp_path) as session:
        session.step(20.0)
        folder = session.run_dir
    haptic = mimics.load(folder).haptic
    assert np.asarray(haptic["state"])[-1] == SafetyState.ACTIVE and not np.asarray(haptic["cause"]).any()
    x = np.asarray(haptic["hip_world"])[:, 0]
    late = np.asarray(haptic["t"]) > 9.0
    assert x.max() < WALL + 0.03, "the goal of the limb lies 35 mm behind the wall"
    assert (x[late] > WALL - 0.06).any() and np.asarray(haptic["tank"]).min() >= 0.0
    wish, felt = np.asarray(haptic["left_x_des"])[late], np.asarray(haptic["left_f_x"])[late]
    assert wish.max() < WALL + 1e-3, "x_des stays on the border"
    assert np.abs(wish - x[late]).max() < 0.08, "and near the foot, also while an empty tank holds the drives back"
    assert (felt < 0.0).mean() > 0.15, "the wall is pressed again and again"


@pytest.mark.parametrize("name", ["lokomat_impedance", "lokomat_combined"])
def test_a_control_at_500_hz_holds_its_torques_for_two_ticks_and_the_wall_too(tmp_path, name: str) -> None:
    with mimics.open(SCENE, runs=tmp_path) as session:
        parts = session.scene.entity("robot").components
        numbers = dict(parts["controller"].parameters) | {"rate": 500.0}
        parts["controller"] = msgspec.structs.replace(parts["controller"], name=name, parameters=numbers)
        session.step(4.5)
        folder = session.run_dir
    haptic = mimics.load(folder).haptic
    assert np.asarray(haptic["state"])[-1] == SafetyState.ACTIVE and not np.asarray(haptic["cause"]).any()
    assert np.asarray(haptic["hip_world"])[:, 0].max() < WALL + 0.03
    seen = np.asarray(haptic["left_x_real"])[np.asarray(haptic["state"]) == SafetyState.ACTIVE]
    assert (np.diff(seen) == 0.0).mean() > 0.45, "measured every second tick"


@pytest.mark.parametrize("name", ["lokomat_impedance", "lokomat_combined"])
def test_parameters_are_named_and_within_their_ranges(name: str) -> None:
    plugin = find_controller(name)
    vector = parameter_vector(plugin, {"object_kind": 1, "object": [0.3, 0.0], "as_printed": 1})
    assert np.isfinite(vector).all() and sum(each.size for each in PARAMETERS) <= vector.size
    with pytest.raises(UsageError, match="hip_virtual_mass"):
        parameter_vector(plugin, {"hip_virtual_mass": 1e-3})
    with pytest.raises(UsageError, match=r'"rate".*500 and 1000 Hz'):
        parameter_vector(plugin, {"rate": 400.0})
    with pytest.raises(UsageError, match="no parameter"):
        parameter_vector(plugin, {"force_limit": 500.0})
