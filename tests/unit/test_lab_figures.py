"""Figures: the keys others read, finite numbers, well-formed drawings, one page that fetches nothing."""

from __future__ import annotations

import json
import math
import re
import sys
from dataclasses import replace
from html import unescape
from itertools import pairwise
from pathlib import Path
from types import ModuleType
from xml.etree import ElementTree

import pytest

from mimics_app.app.cli import main
from mimics_app.contracts.ports.method_table import Table
from mimics_app.contracts.ports.methods import Group, Method, Registry
from mimics_app.lab.chart import draw_chart
from mimics_app.lab.experiment import Experiment, Outcome, largest_disagreement
from mimics_app.lab.figure import write_figure
from mimics_app.lab.gallery import _time, write_gallery
from mimics_app.lab.measure import Growth, Measured, MeasuredGroup
from mimics_app.lab.panel import Label, Panel
from mimics_app.lab.stability_chart import draw_outcome
from mimics_app.plotting.axis import Axis, format_number, format_ticks
from mimics_app.plotting.drawing import text_width
from mimics_app.plotting.marks import circle, word

CHARTS = Path(__file__).parents[2] / "docs" / "charts"
KEYS = ["kind", "name", "command", "machine", "rows", "front", "default", "boundary"]
ROW_KEYS = {"method", "x", "cost_ns", "error", "valid"}
BOUNDARY_KEYS = {"simulated", "exact", "rule", "disagreement"}


def row(name: str, cost: float, error: float, *, default: bool = False, growth: Growth | None = None) -> Measured:
    one = Method("two <words>", name, "a & b", lambda: cost, lambda: error, "m", "x < 1", sum, default=default)
    return Measured(one, cost, cost / 0.5, error, growth)


@pytest.fixture
def chart():
    growth = Growth((1, 10), (1.0, 10.0), 1.0)
    rows = [
        row("quick", 0.1, 1e-2, growth=growth),
        row("exact", 1.0, 0.0, default=True, growth=growth),
        row("beaten", 2.0, 1e-2),
        row("fails", 0.5, math.inf),
    ]
    group = Group("two <words>", "what it is", "m", "pieces", lambda: 0.5)
    return draw_chart(MeasuredGroup(group, 0.5, rows, {"absent": "no device"}))


def outcome(simulated: float = 1.0) -> tuple[Experiment, Outcome]:
    points = [(0.1, 2.0 * simulated), (1.0, 20.0 * simulated), (0.1, 3.0), (1.0, 30.0)]
    exact = [(0.1, 2.0), (1.0, 20.0), (0.1, 3.0), (1.0, 30.0)]
    rows = [{"rate_Hz": 60.0, "stable": True, "limit": None}, {"rate_Hz": 1000.0, "stable": False, "limit": 2.0}]
    found = Outcome(rows, points, exact, {"a < b": exact[:2]}, abs(simulated - 1.0), note="What is to be seen.")
    made = Experiment("planted", "Claims.", "x", "y", "boundary", lambda _: found, 0.02, True, True, "S99")
    return made, made.run(4)


def _read(folder: Path, stem: str) -> dict:
    def refuse(token: str) -> float:
        raise AssertionError(f"{token} in {stem}.json")

    return json.loads((folder / f"{stem}.json").read_text(encoding="utf-8"), parse_constant=refuse)


def test_micro_and_mu_are_drawn_as_such_and_words_stay():
    assert ">cost [µs per call], 3 µm, μ F_N<" in word(0, 0, "cost [us per call], 3 um, mu F_N")
    assert ">thus a bus<" in word(0, 0, "thus a bus")
    assert "<title>5 µs</title>" in circle("dot", 0, 0, 1, "5 us")


def test_chart_file_has_the_keys_in_order_and_finite_numbers(chart, tmp_path):
    write_figure(chart, tmp_path)
    data = _read(tmp_path, "two_<words>")
    assert list(data)[: len(KEYS)] == KEYS
    assert data["kind"] == "chart" and data["name"] == "two <words>"
    assert all(set(one) == ROW_KEYS | {"spread_ns"} for one in data["rows"])
    assert set(data["boundary"]) == BOUNDARY_KEYS
    assert data["front"] == ["quick", "exact"] and data["default"] == "exact"
    assert [one["valid"] for one in data["rows"]] == [True, True, True, False]
    assert data["rows"][0]["cost_ns"] == pytest.approx(100.0) and data["rows"][3]["error"] is None


def test_stability_file_has_the_keys_and_both_boundaries(tmp_path):
    write_figure(draw_outcome(*outcome(1.01), 4), tmp_path)
    data = _read(tmp_path, "S99")
    assert list(data)[: len(KEYS)] == KEYS and data["kind"] == "stability"
    assert set(data["boundary"]) == BOUNDARY_KEYS
    assert data["boundary"]["exact"][0] == [0.1, 2.0] and data["boundary"]["rule"]["a < b"]
    assert data["boundary"]["disagreement"] == pytest.approx(0.01)
    assert all(set(one) >= ROW_KEYS for one in data["rows"])
    assert "--points 4" in data["command"]


def test_drawings_are_well_formed_and_hold_every_mark_with_its_words(chart):
    for figure, marks in ((chart, 4), (draw_outcome(*outcome(), 4), 4)):
        tree = ElementTree.fromstring(figure.svg)
        titles = [node.text or "" for node in tree.iter("{http://www.w3.org/2000/svg}title")]
        assert len(titles) >= marks
        places = [float(v) for v in re.findall(r' (?:cx|cy|x|y)="([^"]+)"', figure.svg)]
        assert all(math.isfinite(value) for value in places)
    assert any("a & b" in title for title in [n.text or "" for n in ElementTree.fromstring(chart.svg).iter()])


def test_curves_that_follow_or_take_turns_are_not_joined():
    """Each curve is one line: 2 of three points each; a line straight up stays one."""
    followed = [(1.0, 1.0), (2.0, 2.0), (3.0, 3.0), (1.0, 10.0), (2.0, 20.0), (3.0, 30.0)]
    turns = [point for pair in zip(followed[:3], followed[3:], strict=True) for point in pair]
    for exact in (followed, turns):
        experiment, _ = outcome()
        svg = draw_outcome(experiment, Outcome([], [], exact, {"up": [(2.0, 1.0), (2.0, 30.0)]}, 0.0), 4).svg
        curves = re.findall(r'<path class="line s0" d="(M[^"]*)"', svg)[1:]  # the first is the legend's
        assert len(curves) == 2 and all(curve.count("L") == 2 for curve in curves)
        assert len(re.findall(r'<path class="line s2 dashed"', svg)) == 2


@pytest.mark.parametrize(
    "outcome",
    [
        Outcome([{"difference": 0.0}], [(1.0, 1.0)], [(1.0, 1.0)], disagreement=math.nan),
        Outcome([{"difference": 0.0}, {"difference": math.nan}], [], []),
        Outcome([], [(1.0, 1.0), (2.0, math.nan)], [(1.0, 1.0), (2.0, 1.0)]),
    ],
    ids=["found", "of a row", "of a curve"],
)
def test_a_disagreement_that_is_no_number_passes_nowhere(outcome):
    experiment = Experiment("Nothing", "It holds.", "x", "y", "boundary", lambda points: outcome, 0.1, name="S0")
    assert not experiment.run(4).passed


def test_caption_says_the_disagreement_and_whether_it_is_allowed():
    assert "within the 2 % allowed" in draw_outcome(*outcome(1.01), 4).svg
    assert "OUTSIDE" in draw_outcome(*outcome(1.5), 4).svg


def test_gallery_shows_every_figure_and_fetches_nothing(chart, tmp_path):
    write_figure(chart, tmp_path)
    write_figure(draw_outcome(*outcome(), 4), tmp_path)
    page = write_gallery(tmp_path).read_text(encoding="utf-8")
    assert page.count("<figure") == page.count("<svg") == 2
    assert page.index("two &lt;words&gt;") < page.index("S99")
    assert 'mimics lab chart "two' in unescape(page) and "mimics lab stability S99" in page
    assert "no device" in page
    addresses = re.findall(r'(?:src|href|url)\s*[=(]\s*["\']?([^"\')\s>]+)', page)
    assert all(address.startswith("#") for address in addresses)
    assert not re.findall(r"https?://(?!www\.w3\.org/2000/svg)", page)
    assert "prefers-color-scheme: dark" in page and "<script" not in page


def test_gallery_begins_with_what_is_chosen_and_what_each_profile_takes(chart, tmp_path):
    write_figure(chart, tmp_path)
    data = json.loads(next(tmp_path.glob("*.json")).read_text(encoding="utf-8"))
    rows = [row for row in data["rows"] if row["valid"]]
    cheapest, best = min(rows, key=lambda row: row["cost_ns"]), min(rows, key=lambda row: row["error"])
    bounds = {"loose": 2.0 * max(row["error"] for row in rows) + 1.0, "strict": best["error"], "none": -1.0}
    limits = {name: {data["unit"]: bound} for name, bound in bounds.items()}
    page = unescape(write_gallery(tmp_path, limits).read_text(encoding="utf-8"))
    table = page[: page.index("<nav>")]
    assert f"<td>{cheapest['method']}</td><td>{best['method']}</td><td>no method</td>" in table
    assert "<th>loose</th><th>strict</th><th>none</th>" in table
    assert [_time(ns) for ns in (None, 4.5021, 999.7, 46460.0, 1.3e7, 2e9)] == [
        "", "4.5 ns", "1 µs", "46.5 µs", "13 ms", "2 s"
    ]  # fmt: skip


def test_gallery_names_no_yardstick_as_the_method_of_a_profile(tmp_path):
    """The product cannot run it, however cheap and accurate it is."""
    yardstick = row("yardstick", 0.1, 0.0)
    rows = [row("runs", 1.0, 1e-2, default=True), replace(yardstick, method=replace(yardstick.method, settings=None))]
    write_figure(draw_chart(MeasuredGroup(Group("two <words>", "what", "m", "", lambda: 0.5), 0.5, rows)), tmp_path)
    page = write_gallery(tmp_path, {"draft": {"m": 0.1}, "study": {"m": 1e-3}}).read_text(encoding="utf-8")
    assert "<td>runs</td><td>no method</td>" in page[: page.index("<nav>")]


def test_a_chart_of_many_methods_numbers_its_points_and_lists_them():
    rows = [row(f"method {i}", 1.0 + i, 1.0 / (1.0 + i), default=i == 0) for i in range(25)]
    figure = draw_chart(MeasuredGroup(Group("crowded", "what", "m", "", lambda: 0.5), 0.5, rows))
    texts = [node.text for node in ElementTree.fromstring(figure.svg).iter("{http://www.w3.org/2000/svg}text")]
    assert all(texts.count(str(i + 1)) >= 2 and texts.count(f"method {i}") == 1 for i in range(25))


def test_long_captions_are_wrapped_and_numbers_of_an_axis_do_not_touch():
    group = Group("two <words>", "many words " * 30, "m", "vertices", lambda: 0.5)
    growth = Growth((1000, 10_000, 100_000), (1.0, 10.0, 100.0), 1.0)
    figure = draw_chart(MeasuredGroup(group, 0.5, [row("one", 1.0, 0.1, default=True, growth=growth)]))
    texts = [node for node in ElementTree.fromstring(figure.svg).iter("{http://www.w3.org/2000/svg}text")]
    assert max(len(node.text or "") for node in texts if node.get("class") == "small") <= 150
    numbers = [node for node in texts if node.get("class") == "small" and (node.text or "").isdigit()]
    below = sorted((float(node.get("x", 0)), len(node.text or "")) for node in numbers if node.get("y") == "407.0")
    assert all(b[0] - a[0] > 3.3 * (a[1] + b[1]) for a, b in pairwise(below)) and len(below) >= 3


def test_a_default_that_loses_in_its_own_shipped_chart_says_why_it_stays():
    figures = [json.loads(file.read_text(encoding="utf-8")) for file in CHARTS.glob("*.json")]
    charts = [data for data in figures if data["kind"] == "chart"]
    losing = {data["name"]: data for data in charts if data["default"] and data["default"] not in data["front"]}
    assert len(charts) > 30 and all(data["why_default"] for data in losing.values())
    page = re.sub("</?code>", "`", unescape((CHARTS / "index.html").read_text(encoding="utf-8")))
    assert "spatialiser" in losing and f"Why it stays: {losing['spatialiser']['why_default']}." in page


def test_drawings_keep_their_size_on_a_narrow_screen_and_the_shipped_page_is_as_the_template():
    style = (Path(__file__).parents[2] / "mimics_app/lab/templates/gallery.css").read_text(encoding="utf-8").strip()
    narrow = style.split("@media (max-width: 720px)")[1]
    assert "overflow-x: auto" in narrow and "svg { width: 720px" in narrow
    assert style in (CHARTS / "index.html").read_text(encoding="utf-8")


def _spoilt(value, planted):
    """The same with another text in the place of every text, but what sorts it."""
    if isinstance(value, dict):
        return {key: item if key == "kind" else _spoilt(item, planted) for key, item in value.items()}
    if isinstance(value, list):
        return [_spoilt(item, planted) for item in value]
    return planted if isinstance(value, str) else value


def test_gallery_escapes_every_text_of_a_figure(chart, tmp_path):
    """The files may come from elsewhere."""
    planted = "<script>alert(1)</script>"
    for figure in (chart, draw_outcome(*outcome(), 4)):
        write_figure(figure, tmp_path)
        file = tmp_path / f"{figure.stem}.json"
        file.write_text(json.dumps(_spoilt(json.loads(file.read_text(encoding="utf-8")), planted)), encoding="utf-8")
    page = write_gallery(tmp_path).read_text(encoding="utf-8")
    assert page.count("&lt;script&gt;") > 10 and "<script" not in page


def test_words_keep_off_each_other_and_inside_the_frame():
    axis = Axis("", 0.0, 1.0)
    panel = Panel(0.0, 0.0, 600.0, 300.0, axis, axis)
    for i in range(8):  # all on one spot, in the corner
        panel.dot(0.97, 0.97 - 0.01 * i, "dot")
        panel.label(Label(0.97, 0.97 - 0.01 * i, f"method {i}"))
    words = re.findall(r'<text class="name" x="([\d.]+)" y="([\d.]+)" text-anchor="(\w+)"', panel.svg())
    held = {"start": 0.0, "middle": 27.0, "end": 54.0}
    lefts = [(float(x) - held[anchor], float(y)) for x, y, anchor in words]
    boxes = [(x, y - 11.0, x + 54.0, y + 4.0) for x, y in lefts]
    assert len(boxes) == 8
    for i, a in enumerate(boxes):
        assert a[0] > 78.0 and a[2] < 600.0 and a[1] > 0.0
        for b in boxes[i + 1 :]:
            assert a[2] <= b[0] or b[2] <= a[0] or a[3] <= b[1] or b[3] <= a[1]


def test_a_word_beside_a_point_is_held_on_the_side_of_the_point():
    """However wide a font draws it, it does not cover what it names."""
    axis = Axis("", 0.0, 1.0)
    for x, anchor in ((0.9, "end"), (0.1, "start")):
        panel = Panel(0.0, 0.0, 300.0, 300.0, axis, axis)
        panel.dot(x, 0.5, "dot")
        for side in (0.35, 0.65):  # above and below are taken
            panel.dot(x, side, "dot")
        panel.label(Label(x, 0.5, "a long name of a method"))
        assert f'text-anchor="{anchor}">a long name' in panel.svg()


def test_methods_without_any_error_stand_on_one_line_and_frames_are_reported_in_milliseconds():
    rows = [row("off", 20_000.0, 0.0), row("all", 11_000.0, 0.0, default=True)]
    drawing = draw_chart(MeasuredGroup(Group("g", "w", "m", "", lambda: 0.5), 0.5, rows)).svg
    assert "error [m]: 0 for all" in drawing and "(error 0)" not in drawing
    assert "cost [ms per call]" in drawing and "cost 20 ms" in drawing
    heights = re.findall(r'<circle class="(?:dot|open)" cx="[\d.]+" cy="([\d.]+)" r="4.5"><title>', drawing)
    assert len(heights) == 2 and len(set(heights)) == 1


def test_numbers_along_an_axis_are_written_in_one_way():
    assert format_ticks([1e-6, 1e-3, 1.0, 10.0]) == ["10⁻⁶", "10⁻³", "1", "10"]
    assert format_ticks([0.01, 0.1, 1.0]) == ["0.01", "0.1", "1"]
    assert format_ticks([-2.0, 0.0, 2.0]) == ["−2", "0", "2"]


@pytest.mark.parametrize(
    ("text", "bold", "width"),
    [
        ("newton warm", True, 92.1),
        ("semi-implicit, 1 kHz", False, 118.3),
        ("mmmm", False, 46.8),
        ("fill it", False, 26.1),
    ],
)
def test_widths_of_texts_are_those_of_the_widest_font_of_the_style(text, bold, width):
    """Of DejaVu Sans at 12 px. A label that is wider than it was placed for lies on the numbers of an axis."""
    assert text_width(text, bold) == pytest.approx(width, rel=0.12)


def test_an_axis_of_things_names_them():
    panel = Panel(
        0.0, 0.0, 400.0, 300.0, Axis("who", -1.0, 2.0, at=(0.0, 1.0), words=("Ann", "Bo")), Axis("y", 0.0, 1.0)
    )
    drawn = str(panel.svg())
    assert ">Ann<" in drawn and ">Bo<" in drawn


def test_scales_have_few_ticks_inside_and_numbers_read_well():
    for low, high in ((1e-16, 1e-2), (3.0, 8.0), (1.0, 900.0), (40.0, 45.0)):
        scale = Axis.around("", [low, high], log=True)
        ticks = scale.ticks()
        assert 2 <= len(ticks) <= 12 and all(0.0 <= scale.share_within(tick) <= 1.0 for tick in ticks)
        assert scale.low < low and scale.high > high
    assert [format_number(v) for v in (0.0, 12000.0, -0.5, 1e-7, 2.5e-9)] == ["0", "12000", "−0.5", "10⁻⁷", "2.5·10⁻⁹"]


def test_disagreement_is_by_the_exact_value_at_the_same_place():
    assert largest_disagreement([(1.0, 9.0), (2.0, 5.0)], [(1.0, 10.0), (2.0, 5.0)]) == pytest.approx(0.1)
    for wrong in ([], [(1.0, 1.0), (2.0, 1.0)], [(3.0, 1.0)]):
        with pytest.raises(ValueError, match="points"):
            largest_disagreement(wrong, [(1.0, 1.0)])


def _planted_catalogue(monkeypatch, *, passed: bool) -> None:
    experiment, _ = outcome(1.0 if passed else 1.5)
    module = ModuleType("mimics_app.lab.stability.s99_planted")
    vars(module)["EXPERIMENT"] = experiment
    monkeypatch.setitem(sys.modules, module.__name__, module)
    monkeypatch.setattr("mimics_app.lab.stability.catalogue._MODULES", {"S99": "s99_planted"})


@pytest.mark.parametrize(("passed", "code"), [(True, 0), (False, 6)])
def test_command_says_by_its_exit_code_whether_an_experiment_passed(monkeypatch, tmp_path, capsys, passed, code):
    _planted_catalogue(monkeypatch, passed=passed)
    assert main(["lab", "stability", "s99", "--out", str(tmp_path), "--json"]) == code
    answer = json.loads(capsys.readouterr().out)
    assert list(answer)[:2] == ["schema", "command"] and answer["figures"][0]["passed"] is passed
    assert (tmp_path / "S99.svg").is_file() and (tmp_path / "index.html").is_file()


def test_figures_go_to_the_working_folder_unless_the_shipped_ones_are_asked_for(monkeypatch, tmp_path, capsys):
    """In a checkout a measurement made in passing must not change the figures that the product ships with."""
    _planted_catalogue(monkeypatch, passed=True)
    checkout, other = tmp_path / "checkout", tmp_path / "other"
    (checkout / "docs" / "charts").mkdir(parents=True)
    other.mkdir()
    monkeypatch.setattr("mimics_app.contracts.system.resources.root", lambda: checkout)
    monkeypatch.chdir(checkout)
    assert main(["lab", "stability", "s99"]) == 0
    assert (checkout / "charts" / "S99.svg").is_file() and not list((checkout / "docs" / "charts").iterdir())
    assert main(["lab", "stability", "s99", "--shipped", "--out", str(other)]) == 2
    assert main(["lab", "stability", "s99", "--shipped"]) == 0
    assert (checkout / "docs" / "charts" / "S99.svg").is_file() and not list(other.iterdir())
    monkeypatch.setattr("mimics_app.contracts.system.resources.root", lambda: other)
    assert main(["lab", "stability", "s99", "--shipped"]) == 2
    assert "in a source checkout only" in capsys.readouterr().err


def test_command_refuses_what_is_not_there(tmp_path, capsys):
    for words in (["stability", "S77"], ["chart", "no such group"], ["measure", "friction", "--all"]):
        assert main(["lab", *words, "--out", str(tmp_path)]) == 2
    assert not list(tmp_path.iterdir())


def test_measure_prints_one_object_and_saves_where_it_is_asked_to(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr("mimics_app.contracts.ports.method_table.saved_file", lambda: tmp_path / "methods.json")
    assert main(["lab", "measure", "admittance_form", "--save", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    group = answer["groups"]["admittance form"]
    assert {one["method"] for one in group["rows"]} == {"cartesian", "polar", "seed"}
    assert answer["saved"] == str(tmp_path / "methods.json")
    assert group["reference_us"] > 0.0 and (tmp_path / "methods.json").is_file()


def test_measure_leaves_out_what_does_not_apply_to_a_method(monkeypatch, capsys):
    """Settings of a yardstick, growth of a constant cost, the file of a table not saved."""
    registry = planted_registry()
    monkeypatch.setattr("mimics_app.lab.catalogue.load_methods", lambda _: registry)
    monkeypatch.setattr("mimics_app.app.commands.lab._groups", lambda _: ["sums"])
    assert main(["lab", "measure", "sums", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    ours, yardstick = (set(row) for row in answer["groups"]["sums"]["rows"])
    assert ours == {"method", "cost_us", "ratio", "error", "unit", "default", "settings"}
    assert yardstick == ours - {"settings"}
    assert "saved" not in answer


def test_shipped_charts_and_the_shipped_table_are_of_one_measurement(monkeypatch, tmp_path):
    registry, table_file = planted_registry(), tmp_path / "table" / "methods.json"
    monkeypatch.setattr("mimics_app.lab.catalogue.load_methods", lambda _: registry)
    monkeypatch.setattr("mimics_app.app.commands.lab._groups", lambda _: ["sums"])
    monkeypatch.setattr("mimics_app.app.commands.lab._folder", lambda _: tmp_path)
    monkeypatch.setattr("mimics_app.contracts.ports.method_table.shipped_file", lambda: table_file)
    Table({}, {}, {}).save(table_file)
    assert main(["lab", "chart", "sums", "--shipped"]) == 0
    drawn = json.loads((tmp_path / "sums.json").read_text())["rows"]
    (row,) = Table.load(table_file).groups["sums"]
    assert {one["method"]: one["cost_ns"] for one in drawn}[row.method] == pytest.approx(1e3 * row.cost_us)
    assert (row.method, row.settings) == ("ours", {"way": 1})


def planted_registry() -> Registry:
    """One that runs, and a yardstick."""
    registry, costs = Registry(), iter((3.0, 5.0, 7.0, 11.0))
    registry.describe(Group("sums", "adding", "m", "", lambda: 1.0, few="planted"))
    for name, settings in (("ours", {"way": 1}), ("yardstick", None)):
        method = Method("sums", name, "planted", lambda: next(costs), lambda: 1e-3, "m", "any", settings)
        registry.register(method)
    return registry
