"""Measuring: the front, the exponent, the reference in the same run, and what a planted rival does to the planner."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from mimics_app.app.planner.plan import choose
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.ports.method_table import Row, Table
from mimics_app.contracts.ports.methods import Group, Method, Registry
from mimics_app.lab.chart import pareto_front
from mimics_app.lab.measure import MeasuredGroup, count_probes, fit_exponent, measure, to_table

GROUP = "sums"


def planted(**methods: Method) -> Registry:
    registry = Registry()
    registry.describe(Group(GROUP, "adding numbers", "m", "numbers", lambda: 0.5))
    for one in methods.values():
        registry.register(one)
    return registry


def method(name: str, cost: float, error: float, **more: object) -> Method:
    return Method(GROUP, name, "planted", lambda: cost, lambda: error, "m", "anywhere", **{"settings": {}, **more})  # type: ignore[arg-type]


def test_front_holds_what_nothing_beats_cheapest_first():
    points = [(4.0, 1.0), (1.0, 8.0), (2.0, 8.0), (2.0, 3.0), (3.0, 3.0), (5.0, 1.0)]
    assert pareto_front(points) == [1, 3, 0]


def test_front_of_equal_points_is_the_first_and_what_fails_is_never_on_it():
    assert pareto_front([(1.0, 1.0), (1.0, 1.0), (0.5, math.inf), (0.1, math.nan)]) == [0]
    assert pareto_front([]) == []


@pytest.mark.parametrize("exponent", [0.0, 0.5, 1.0, 2.0, -1.0])
def test_exponent_of_a_power_law_is_found(exponent: float):
    sizes = (3, 8, 20, 100)
    costs = [7.0 * size**exponent for size in sizes]
    assert fit_exponent(sizes, costs) == pytest.approx(exponent, abs=1e-12)


def test_exponent_with_an_outlier_is_the_least_squares_one():
    # log2 of sizes 0, 1, 2; of costs 0, 1, 3: slope = sum (x - 1) y / sum (x - 1)^2 = 3 / 2
    assert fit_exponent((1, 2, 4), (1.0, 2.0, 8.0)) == pytest.approx(1.5)


@pytest.mark.parametrize(("sizes", "costs"), [((2, 2), (1.0, 1.0)), ((1, 2), (0.0, 1.0)), ((0, 2), (1.0, 1.0))])
def test_exponent_of_nothing_is_refused(sizes: tuple[int, ...], costs: tuple[float, ...]):
    with pytest.raises(ValueError, match="no exponent"):
        fit_exponent(sizes, costs)


def test_of_several_rounds_the_least_cost_of_each_stands_and_the_error_is_asked_once():
    costs, sizes, errors = iter([8.0, 1.0, 5.0]), iter([4.0, 8.0, 2.0, 6.0, 9.0, 4.0]), iter([1e-3])
    quick = method("quick", 0.0, 0.0, growth=lambda _: next(sizes), sizes=(1, 2))
    registry = planted(quick=replace(quick, cost=lambda: next(costs), error=lambda: next(errors)))
    [row] = measure(GROUP, registry, rounds=3).rows
    assert (row.cost_us, row.ratio, row.error) == (1.0, 2.0, 1e-3)
    assert row.growth.cost_us == (2.0, 4.0) and row.growth.exponent == pytest.approx(1.0)
    assert count_probes(registry, [GROUP], 3) == 9


def test_a_method_that_is_lost_in_a_later_round_keeps_its_first():
    answers = iter([3.0])

    def cost():
        try:
            return next(answers)
        except StopIteration:
            raise DeviceError("gone", "plug it in") from None

    rows = measure(GROUP, planted(a=replace(method("a", 0.0, 1.0), cost=cost), b=method("b", 2.0, 1.0)), rounds=2).rows
    assert [(row.method.name, row.cost_us) for row in rows] == [("a", 3.0), ("b", 2.0)]


def test_costs_are_reported_against_the_reference_loop_beside_them():
    references = iter([2.0, 1.0, 4.0])  # before the first, between, after the last
    registry = Registry()
    registry.describe(Group(GROUP, "adding numbers", "m", "", lambda: next(references)))
    registry.register(method("one", 8.0, 1e-3))
    registry.register(method("two", 8.0, -1e-3))
    measured = measure(GROUP, registry)
    assert [row.ratio for row in measured.rows] == [8.0, 8.0]
    assert measured.reference_us == 1.0
    assert [row.error for row in measured.rows] == [1e-3, 1e-3]


def test_growth_is_measured_at_every_size_and_each_probe_is_announced():
    registry = planted(
        a=method("a", 1.0, 0.0, growth=lambda n: 2.0 * n * n, sizes=(1, 10, 100)), b=method("b", 1.0, 0.0)
    )
    words: list[str] = []
    rows = measure(GROUP, registry, words.append).rows
    assert len(words) == count_probes(registry, [GROUP]) == 5
    assert rows[0].growth is not None and rows[0].growth.exponent == pytest.approx(2.0)
    assert rows[1].growth is None


@pytest.mark.parametrize("odd", [ZeroDivisionError("by\nzero"), SystemExit(3), KeyError("x")])
@pytest.mark.parametrize("probe", ["cost", "error", "reference"])
def test_a_package_whose_probe_raises_anything_is_named_in_one_line_and_the_rest_goes_on(
    probe: str, odd: BaseException
):
    def fail() -> float:
        raise odd

    def register(registry: Registry) -> None:
        if probe == "reference":
            registry.describe(Group("products", "multiplying", "m", "", fail))
            registry.register(replace(method("torn", 1.0, 1.0), group="products"))
        else:
            registry.register(replace(method("torn", 1.0, 1.0), **{probe: fail}))

    group = "products" if probe == "reference" else GROUP
    registry = planted(one=method("one", 1.0, 0.0))
    registry.take(group, register)
    measured = measure(group, registry)
    assert [row.method.name for row in measured.rows] == ([] if probe == "reference" else ["one"])
    assert measured.skipped["torn"].startswith(f"the probes of {__name__} fail: {type(odd).__name__}")
    assert "\n" not in measured.skipped["torn"]
    assert list(to_table([measured]).groups) == ([] if probe == "reference" else [GROUP])


@pytest.mark.parametrize("cost", [-1.0, 0.0, math.nan, math.inf])
def test_a_cost_that_is_no_duration_is_skipped(cost: float):
    registry = planted(one=method("one", 1.0, 0.0))
    registry.take(GROUP, lambda trial: trial.register(method("free", cost, 0.0)))
    measured = measure(GROUP, registry)
    assert [row.method.name for row in measured.rows] == ["one"]
    assert measured.skipped["free"].endswith(f"a cost of {cost} us")


def test_a_built_in_probe_that_raises_anything_is_not_hidden():
    def fail() -> float:
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        measure(GROUP, planted(one=replace(method("one", 1.0, 0.0), cost=fail)))


def test_what_cannot_run_here_is_skipped_with_its_reason():
    def refuse() -> float:
        raise DeviceError("no such device")

    absent = Method(GROUP, "absent", "planted", refuse, refuse, "m", "nowhere", sum)
    measured = measure(GROUP, planted(a=absent, b=method("b", 1.0, 1.0)))
    assert [row.method.name for row in measured.rows] == ["b"]
    assert "no such device" in measured.skipped["absent"]


def test_not_a_number_is_a_failure():
    assert measure(GROUP, planted(a=method("a", 1.0, math.nan))).rows[0].error == math.inf


def _chosen(registry: Registry, tolerance: float) -> str:
    return choose(to_table([measure(GROUP, registry)]).groups[GROUP], tolerance).method


def test_planted_rival_at_half_the_cost_is_chosen_and_at_ten_times_the_error_dropped():
    ours = method("ours", 2.0, 5e-7, default=True)
    assert _chosen(planted(a=ours, b=method("rival", 1.0, 5e-7)), 1e-6) == "rival"
    assert _chosen(planted(a=ours, b=method("rival", 1.0, 5e-6)), 1e-6) == "ours"


def test_a_yardstick_is_measured_but_no_table_offers_it():
    registry = planted(a=method("ours", 2.0, 5e-7), b=method("rival", 1.0, 5e-7, settings=None))
    assert len(measure(GROUP, registry).rows) == 2
    assert _chosen(registry, 1e-6) == "ours"


def test_a_group_has_one_description_one_default_and_each_name_once():
    registry = planted(a=method("a", 1.0, 1.0, default=True))
    with pytest.raises(ValueError, match="two defaults"):
        registry.register(method("b", 1.0, 1.0, default=True))
    with pytest.raises(ValueError, match="twice"):
        registry.register(method("a", 1.0, 1.0))
    with pytest.raises(ValueError, match="twice"):
        registry.describe(Group(GROUP, "again", "m", "", lambda: 1.0))
    default = registry.default(GROUP)
    assert default is not None and default.name == "a"


def test_table_comes_back_from_its_file_as_it_was(tmp_path):
    rows = [Row("quick", 1.25, 0.5, math.inf, "m"), Row("exact", 2.5, 1.0, 0.0, "m")]
    table = Table({GROUP: rows}, {"processor": "planted"}, {GROUP: 2.5})
    file = table.save(tmp_path / "folder" / "methods.json")
    assert file is not None and Table.load(file) == table
    assert "Infinity" not in file.read_text(encoding="utf-8")


def test_measuring_one_group_again_leaves_the_others_in_the_table():
    older = Table({"a": [Row("x", 1.0, 1.0, 1.0, "m")], "b": []}, {"cores": 1}, {"a": 1.0, "b": 1.0})
    newer = Table({"a": [Row("y", 2.0, 1.0, 1.0, "m")]}, {"cores": 2}, {"a": 3.0})
    both = older.with_groups(newer)
    assert both.groups == {"a": newer.groups["a"], "b": []}
    assert both.reference_us == {"a": 3.0, "b": 1.0}
    assert both.machine == {"cores": 2}


def test_a_saved_table_that_is_no_table_is_none(tmp_path, monkeypatch):
    broken = tmp_path / "methods.json"
    monkeypatch.setattr("mimics_app.contracts.ports.method_table.saved_file", lambda: broken)
    for text in ("", "[]", '{"groups": {"a": [{}]}}'):
        broken.write_text(text, encoding="utf-8")
        assert Table.load_saved() is None


def test_measured_group_names_its_default():
    assert measure(GROUP, planted(a=method("a", 1.0, 1.0), b=method("b", 1.0, 1.0, default=True))).default == "b"
    assert MeasuredGroup(Group(GROUP, "", "m", "", lambda: 1.0), 1.0, []).default == ""
