"""Plans of whole scenes as points of a chart: which there are, what they err, and how their costs spread."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest

from mimics_app.app.bench import whole_scenes
from mimics_app.app.bench.whole_play import _laid_over
from mimics_app.app.bench.whole_scenes import GROUPS, register_whole, variants
from mimics_app.app.planner.plan import plan_scene
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.settings import Profile
from mimics_app.contracts.loop.haptic import SCENE
from mimics_app.contracts.ports.methods import Group, Method, Registry
from mimics_app.lab.chart import draw_chart
from mimics_app.lab.measure import measure

TUNNEL = ("tunnel projection",)


@pytest.mark.seconds
def test_every_scenario_has_a_chart_of_its_tick_and_of_its_frame() -> None:
    assert len(GROUPS) == 6 and {kind for kind, _ in GROUPS.values()} == {"tick of ", "frame of "}
    registry = Registry()
    for group in GROUPS:
        register_whole(registry, group)
        names = [method.name for method in registry.rivals(group)]
        assert set(get_args(Profile)) <= set(names) and len(names) > 2, "no group of two points"
        assert all(method.runnable for method in registry.rivals(group))


def test_single_changes_run_what_the_planner_may_take_and_nothing_twice() -> None:
    found = variants("wavy_tunnel", TUNNEL)
    scene = load_checked_scene(whole_scenes._file("wavy_tunnel"))
    runs = [
        (profile, {**plan_scene(scene, profile).settings, **changes}["tunnel projection"]["projection"])
        for profile, changes in found.values()
    ]
    assert {projection for _, projection in runs} == {
        "newton warm", "newton one step", "golden section", "brute force"
    }  # fmt: skip
    changed = [projection for (_, projection), (_, changes) in zip(runs, found.values(), strict=True) if changes]
    assert len(changed) == len(set(changed)), "the same run under two names"


@pytest.mark.seconds
def test_a_worse_method_errs_on_the_same_hand_and_a_studys_own_plan_does_not(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(whole_scenes, "_FRAMES", 90)
    whole_scenes._reference.cache_clear()
    errors = {
        name: whole_scenes._false_force("wavy_tunnel", name)
        for name in ("study", "draft, tunnel projection: brute force")
    }
    whole_scenes._reference.cache_clear()
    assert errors["study"] == 0.0 and errors["draft, tunnel projection: brute force"] > 1e-9


def test_only_what_methods_set_is_laid_over() -> None:
    first, changed, later = (np.zeros(1, SCENE) for _ in range(3))
    changed["controller"], changed["device_delay"] = 2, 0.25
    first["virtual_mass"] = changed["virtual_mass"] = 3.0
    later["virtual_mass"], later["sequence"] = 5.0, 9
    made = _laid_over(later, first, changed)
    assert (made["controller"][0], made["device_delay"][0]) == (2, 0.25)
    assert (made["virtual_mass"][0], made["sequence"][0]) == (5.0, 9)


def test_costs_carry_their_spread_over_the_rounds() -> None:
    costs = iter([3.0, 1.0, 2.0, 5.0, 5.0, 5.0])
    registry = Registry()
    registry.describe(Group("planted", "", "m", "", lambda: 1.0))
    for name in ("first", "second"):
        registry.register(
            Method("planted", name, "", lambda: next(costs), lambda: 0.5, "m", "", {}, default=name == "first")
        )
    figure = draw_chart(measure("planted", registry, rounds=3))
    spreads = {row["method"]: (row["cost_ns"], row["spread_ns"]) for row in figure.rows}
    assert spreads == {"first": (2000.0, [2000.0, 5000.0]), "second": (1000.0, [1000.0, 5000.0])}
    assert figure.svg.count('class="spread"') == 2
    once = draw_chart(measure("planted", _once(registry)))
    assert {row["spread_ns"] for row in once.rows} == {None} and 'class="spread"' not in once.svg


def _once(registry: Registry) -> Registry:
    """The same group with costs that can be requested."""
    again = Registry()
    again.describe(registry.described("planted"))
    for method in registry.rivals("planted"):
        again.register(Method("planted", method.name, "", lambda: 1.0, lambda: 0.5, "m", "", {}))
    return again
