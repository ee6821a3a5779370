"""The groups as the product registers them, and the laboratory's own ones against theory."""

from __future__ import annotations

import json
from dataclasses import fields

import pytest

from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.ports.methods import Method, Registry
from mimics_app.lab.catalogue import GROUPS, load_methods
from mimics_app.lab.groups import haptic_rate
from mimics_app.lab.stability.catalogue import NAMES, load_experiments


def test_every_group_of_the_catalogue_is_registered_described_and_has_rivals():
    registry = load_methods()
    assert set(registry.groups()) >= set(GROUPS)
    for group in GROUPS:
        described, rivals = registry.described(group), registry.rivals(group)
        assert len(rivals) >= 2, f"{group}: with one row it is no method"
        assert len(rivals) >= 3 or described.few, f"{group}: why no third?"
        assert {rival.unit for rival in rivals} == {described.unit}
        assert registry.default(group) is not None
        for rival in rivals:
            assert rival.source and rival.valid_range
            assert (rival.growth is None) == (rival.sizes == ())
            assert list(rival.sizes) == sorted(set(rival.sizes))
            assert rival.growth is None or described.work, f"{group}: {rival.name} grows with nothing"


def test_what_a_rival_sets_is_plain_json_and_no_two_of_a_group_set_the_same():
    registry = load_methods()
    for group in GROUPS:
        runnable = [method for method in registry.rivals(group) if method.runnable]
        assert runnable and registry.default(group).runnable, group
        for method in runnable:
            assert json.loads(json.dumps(method.settings)) == method.settings
        raised = [json.dumps(method.settings, sort_keys=True) for method in runnable]
        if group not in ("model reading", "bounding geometry"):  # kinds of files; meshes of two sizes
            assert len(raised) == len(set(raised)), group


def test_no_method_carries_a_function_that_nobody_calls():
    assert {one.name for one in fields(Method)} >= {"settings", "cost", "error"}
    assert "run" not in {one.name for one in fields(Method)}


def test_a_default_that_the_product_cannot_run_is_refused():
    yardstick = Method("sums", "one", "planted", float, float, "m", "any", settings=None, default=True)
    with pytest.raises(ValueError, match="cannot run"):
        Registry().register(yardstick)


def test_the_false_force_of_a_form_is_that_of_the_loops_own_tick():
    """Polar is of second order in the tick: 3 kg at 1 kHz give 1.8 mN, a million times a tick of 1 us."""
    errors = {method.name: method.error() for method in load_methods(["admittance form"]).rivals("admittance form")}
    assert errors["polar"] == pytest.approx(1.816e-3, rel=1e-2)
    assert errors["cartesian"] < 1e-9 < 1.0 < errors["seed"]


def test_a_group_that_is_not_there_is_named_with_the_nearest_one():
    with pytest.raises(UsageError) as raised:
        load_methods(["tunel projection"])
    assert "tunnel projection" in raised.value.fix


def test_all_fifteen_experiments_are_listed_and_described():
    assert {f"S{i}" for i in range(1, 16)} <= set(NAMES)
    for one in load_experiments():
        assert one.title and one.claim and one.x_label and one.y_label and one.tolerance > 0.0
        assert one.kind == "invariant" or one.tolerance <= 0.02, f"{one.name}: 2 % for boundaries, always"


@pytest.mark.parametrize("rate", [500, 1000, 2500, 4000])
def test_wall_gives_away_as_much_as_theory_says(rate: int):
    """K T v d at whole ticks; the depth of the last tick and the tick of the turn take at most 2 T v off d."""
    period = 1.0 / rate
    theory = haptic_rate.STIFFNESS * period * haptic_rate.SPEED * haptic_rate.DEPTH
    short = 2.0 * period * haptic_rate.SPEED / haptic_rate.DEPTH
    leak = haptic_rate.tap_leak(rate)
    assert theory * (1.0 - short) < leak < theory * (1.0 + 1e-9)


def test_twice_the_rate_halves_the_leak():
    assert haptic_rate.tap_leak(2000) == pytest.approx(0.5 * haptic_rate.tap_leak(1000), rel=0.02)
