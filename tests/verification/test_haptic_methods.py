"""The rivals of the single-contact kernels: registered with the functions that run, measured, ranked as they must."""

from __future__ import annotations

import math

import pytest

from mimics_app.lab.catalogue import load_methods
from mimics_app.lab.groups import integrator
from mimics_app.lab.groups.passivity_control import CONTROLLERS, press
from mimics_app.lab.haptic.probe import SIZES

DEFAULTS = {
    "integrator": "semi-implicit, 1 kHz",
    "rotation update": "exponential, half step",
    "contact law": "(9) clamped",
    "box face": "face of entry",
    "friction": "Hayward-Armstrong",
    "passivity control": "bounded by the energy",
}
registry = load_methods(DEFAULTS)


def errors(group):
    return {method.name: method.error() for method in registry.rivals(group)}


@pytest.mark.parametrize("group", DEFAULTS)
def test_group_has_rivals_a_default_and_a_description(group):
    assert len(registry.rivals(group)) >= 3
    default = registry.default(group)
    assert default is not None
    assert default.name == DEFAULTS[group]
    assert {method.unit for method in registry.rivals(group)} == {registry.described(group).unit}


@pytest.mark.parametrize("group", DEFAULTS)
def test_costs_are_measured(group):
    assert registry.described(group).reference() > 0.0
    for method in registry.rivals(group):
        assert 0.0 < method.cost() < 1e3, method.name


@pytest.mark.parametrize("group", [group for group in DEFAULTS if group not in ("box face", "passivity control")])
def test_cost_grows_with_the_work(group):
    method = registry.default(group)
    assert method.sizes == SIZES
    assert method.growth(1000) > 10.0 * method.growth(1)


def test_only_controllers_that_spread_what_they_take_are_quiet_and_give_nothing():
    """Of a plate of 600 N/m: none gives 5 mJ, the published one runs away, that against the next tick chatters."""
    found = errors("passivity control")
    assert all(math.isinf(found[name]) for name in CONTROLLERS[:3])
    assert found["bounded by the energy"] < 0.3 * found["reference energy"] < 0.3
    none, published, before, *spread = (press(name, 600.0) for name in CONTROLLERS)
    assert none.given > 1e-3 and none.contacts == 3
    assert published.beyond > 10.0
    assert before.contacts > 10 and before.shaking > 0.3 and before.beyond <= 1e-9
    for each in spread:
        assert each.given < 1e-4 and each.beyond <= 1e-9 and each.shaking < none.shaking + 0.02 and each.contacts <= 4
    assert [each.share for each in spread] == pytest.approx([0.10, 0.02], abs=0.01)


def test_integrators_rank_as_their_orders():
    found = errors("integrator")
    at_1_khz = [found[f"{name}, 1 kHz"] for name in ("exact", "rk4", "implicit midpoint", "semi-implicit", "explicit")]
    assert at_1_khz == sorted(at_1_khz)
    for name in integrator.STEPS:
        if name != "exact":
            assert found[f"{name}, 16 kHz"] < found[f"{name}, 4 kHz"] < found[f"{name}, 1 kHz"]


def test_rotations_rank_as_their_orders():
    found = errors("rotation update")
    assert found["rk4"] < 1e-7 < found["exponential, half step"] < 0.01
    assert min(found[name] for name in ("printed", "axis product", "exponential, start")) > 1.0


def test_contact_laws_err_by_their_touch_step_and_the_printed_one_by_its_pull():
    """(9) printed: 0.451 - exp(-pi zeta/root) = 0.079 beside what a tick is worth; without touch step less than .01."""
    found = errors("contact law")
    assert found["(9) printed"] > 0.079 > found["(9) clamped"] > found["Hunt-Crossley, n = 1"] > 0.0
    assert found["Hunt-Crossley, n = 1.5"] < 0.01


def test_box_faces_err_by_the_corner():
    found = errors("box face")
    assert found["face of entry"] == 0.0
    assert found["nearest face"] == pytest.approx(8.485, abs=0.01)
    assert found["(14) printed"] > 10.0


def test_friction_drifts_in_the_order_known():
    found = errors("friction")
    assert found["Karnopp"] == 0.0
    assert found["Hayward-Armstrong"] < found["LuGre implicit"] < found["regularised"] < found["4.3.2 printed"]
    assert math.isinf(found["LuGre explicit"])
