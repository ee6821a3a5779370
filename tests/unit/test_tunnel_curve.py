"""Building a tunnel: what it carries, and what is refused with which words at which place."""

from __future__ import annotations

import json

import numpy as np
import pytest

from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.loop.haptic_objects import MAX_PIECES, TUNNEL
from mimics_app.rendering.haptic.tunnel_geometry import TunnelError, build_tunnel
from mimics_app.rendering.haptic.tunnel_source import fit_path, read_path, tunnel_from_component
from mimics_app.world.components.robot import Tunnel
from tests.support.tunnels import coil, ring, straight, wavy

LINE = ((0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.2, 0.0, 0.0), (0.3, 0.0, 0.0))
HAIRPIN = ((0.0, 0.0, 0.0), (0.3, 0.0, 0.0), (0.3, 0.03, 0.0), (0.0, 0.03, 0.0))


def refusal(points=LINE, radius=0.02, **more):
    with pytest.raises(TunnelError) as caught:
        build_tunnel(points, radius, **more)
    return caught.value


def test_record_holds_the_curve_and_nothing_of_an_older_one():
    record = np.zeros(1, TUNNEL)
    coil().fill(record[0])
    record["stiffness"] = 7.0
    curve = straight([0.01, 0.03])
    curve.fill(record[0])
    n = len(curve.pieces)
    assert record[0]["pieces"] == n and record[0]["stiffness"] == 7.0
    np.testing.assert_array_equal(record[0]["centre"][:n], curve.pieces)
    np.testing.assert_array_equal(record[0]["centre"][n:], 0.0)
    assert record[0]["arc_length"][n] == curve.length and not record[0]["arc_length"][n + 1 :].any()
    np.testing.assert_allclose(np.linalg.norm(record[0]["normal"][: n + 1], axis=1), 1.0, atol=1e-14)


def test_radius_values_stand_at_equal_distances_along_the_tunnel():
    values = [0.03, 0.012, 0.02, 0.02, 0.035]
    curve = wavy(values, height=0.03)
    s = curve.parameter_at(np.linspace(0.0, curve.length, 5))
    # A value between two knots is met to second order in a quarter of the distance between values.
    np.testing.assert_allclose(curve.radius(s), values, atol=1e-3)
    dense = curve.radius(np.linspace(0.0, len(curve.pieces), 2000))
    assert dense.min() >= 0.012 - 1e-12 and dense.max() <= 0.035 + 1e-12


def test_radius_and_its_slope_have_no_step():
    curve = wavy([0.03, 0.012, 0.02, 0.02, 0.035], height=0.03)
    knots = np.arange(1.0, len(curve.pieces))
    h = 1e-7
    np.testing.assert_allclose(curve.radius(knots - h), curve.radius(knots + h), atol=1e-8)
    left = (curve.radius(knots - h) - curve.radius(knots - 2 * h)) / h
    right = (curve.radius(knots + 2 * h) - curve.radius(knots + h)) / h
    np.testing.assert_allclose(left, right, atol=1e-6)


def test_linear_radius_of_a_straight_tunnel_is_linear():
    curve = straight([0.01, 0.03])
    s = np.linspace(0.0, len(curve.pieces), 100)
    np.testing.assert_allclose(curve.radius(s), 0.01 + 0.02 * curve.arc_at(s) / curve.length, atol=5e-5)


def test_many_radius_values_cut_the_pieces():
    values = np.linspace(0.01, 0.02, 20)
    values[10] = 0.03
    curve = build_tunnel(LINE, values)
    assert len(curve.pieces) > 60
    assert curve.length == pytest.approx(0.3)
    assert curve.radius(curve.parameter_at(10 / 19 * 0.3))[0] == pytest.approx(0.03, abs=2e-3)


def test_two_and_three_points_are_enough():
    assert build_tunnel(LINE[:2], 0.02).length == pytest.approx(0.1)
    bend = build_tunnel([(0.0, 0.0, 0.0), (0.1, 0.1, 0.0), (0.2, 0.0, 0.0)], 0.01)
    np.testing.assert_allclose(bend.point(0.5), [[0.1, 0.05, 0.0]], atol=1e-15)


def test_product_of_radius_and_curvature_of_a_ring():
    curve, off = ring(bend_radius=0.1, radius=0.03)
    product, _ = curve.max_radius_curvature
    # The ends of a fit bend most freely.
    assert off < 1e-6
    assert product == pytest.approx(0.3, rel=0.05)
    assert curve.max_radius_scale == pytest.approx(1.0 / product)
    assert straight().max_radius_scale == np.inf


def test_hairpin_is_refused_with_the_place():
    error = refusal(HAIRPIN, 0.02)
    (issue,) = error.at("scenes/wavy.json", "/entities/3/components/tunnel").issues
    assert str(issue).startswith("scenes/wavy.json#/entities/3/components/tunnel/radius: too wide for its bend")
    assert "s = 0.500" in issue.what and "m from the start, point (0.2250, 0.0150, 0.0000)" in issue.what
    limit = float(issue.fix.split("less than ")[1].split(" m")[0])
    build_tunnel(HAIRPIN, 0.98 * limit)
    refusal(HAIRPIN, 1.02 * limit)


def test_radius_scale_counts_for_the_bend():
    build_tunnel(HAIRPIN, 0.002, radius_scale=0.5)
    error = refusal(HAIRPIN, 0.001, radius_scale=2.0)
    assert error.faults[0].field == "radius"


@pytest.mark.parametrize(
    ("points", "field", "words"),
    [
        ([], "control_points", "at least 2"),
        ([(0.0, 0.0, 0.0)], "control_points", "at least 2"),
        ([(0.0, 0.0), (1.0, 1.0)], "control_points", "3 coordinates"),
        ([(0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.1, 0.0, 0.0)], "control_points/1", "lies on control_points/0"),
        ([(0.0, 0.0, 0.0), (0.1, np.nan, 0.0), (0.1, 0.0, 0.0)], "control_points/1", "not finite"),
        ([(0.0, 0.0, 0.0), (np.inf, 0.0, 0.0)], "control_points/1", "not finite"),
        ([(0.0, 0.0, 0.0), (1e200, 0.0, 0.0)], "control_points/1", "1 km"),
        ([(0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.0, 0.0, 0.0)], "control_points", "is zero at s = 0.500"),
        ([(0.01 * i, 0.0, 0.0) for i in range(MAX_PIECES + 4)], "control_points", f"at most {MAX_PIECES + 3}"),
    ],
)
def test_bad_control_points_are_refused_by_name(points, field, words):
    error = refusal(points, 0.0)
    assert error.faults[0].field == field
    assert words in error.faults[0].what


def test_largest_number_of_points_is_accepted():
    curve = build_tunnel([(0.01 * i, 0.0, 0.0) for i in range(MAX_PIECES + 3)], [0.01, 0.02, 0.01])
    assert len(curve.pieces) == MAX_PIECES
    record = np.zeros(1, TUNNEL)
    curve.fill(record[0])


@pytest.mark.parametrize(
    ("radius", "field"),
    [
        (-0.01, "radius"),
        (np.nan, "radius"),
        ([0.02, np.inf, 0.01], "radius/1"),
        ([], "radius"),
        ([[0.02]], "radius"),
        (np.full(MAX_PIECES + 2, 0.01), "radius"),
    ],
)
def test_bad_radius_is_refused_by_name(radius, field):
    assert refusal(LINE, radius).faults[0].field == field


@pytest.mark.parametrize("scale", [-1.0, np.nan, np.inf])
def test_bad_radius_scale_is_refused(scale):
    assert refusal(LINE, 0.01, radius_scale=scale).faults[0].field == "radius_scale"


def test_all_faults_come_at_once():
    error = refusal([(0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (np.nan, 0.0, 0.0)], [-1.0, 0.1, np.nan])
    assert [fault.field for fault in error.faults] == ["control_points/2", "control_points/1", "radius/0", "radius/2"]


def test_component_with_control_points():
    curve, residual = tunnel_from_component(Tunnel(control_points=LINE, radius=(0.01, 0.02)), None, "a.json", "/t")
    assert residual is None and curve.length == pytest.approx(0.3)


@pytest.mark.parametrize("more", [{}, {"control_points": LINE, "path_file": "p.csv"}])
def test_component_needs_exactly_one_source(tmp_path, more):
    with pytest.raises(SceneError, match=r"a.json#/t/control_points: give either"):
        tunnel_from_component(Tunnel(radius=0.01, **more), tmp_path, "a.json", "/t")


def wave(count=120):
    t = np.linspace(0.0, 1.0, count)
    return np.column_stack([0.4 * t, 0.05 * np.sin(7.0 * t), 0.0 * t])


def test_component_with_a_recorded_path_is_fitted_and_says_how_well(tmp_path):
    np.savetxt(tmp_path / "p.csv", wave(), delimiter=",")
    coarse, coarse_rms = tunnel_from_component(
        Tunnel(path_file="p.csv", basis_functions=6, radius=0.01), tmp_path, "a.json", "/t"
    )
    fine, fine_rms = tunnel_from_component(
        Tunnel(path_file="p.csv", basis_functions=14, radius=0.01), tmp_path, "a.json", "/t"
    )
    assert len(coarse.pieces) == 3 and len(fine.pieces) == 11
    assert fine_rms < 0.1 * coarse_rms
    np.testing.assert_allclose(fine.point([0.0, 11.0]), wave()[[0, -1]], atol=1e-3)


@pytest.mark.parametrize("uri", ["../p.csv", "missing.csv", "/etc/hostname"])
def test_path_file_outside_or_missing_is_refused(tmp_path, uri):
    scene = tmp_path / "scene"
    scene.mkdir()
    np.savetxt(tmp_path / "p.csv", wave(), delimiter=",")
    with pytest.raises(SceneError, match=r"a.json#/t/path_file"):
        tunnel_from_component(Tunnel(path_file=uri, basis_functions=6), scene, "a.json", "/t")


def test_too_many_basis_functions_for_the_path_name_the_field(tmp_path):
    np.savetxt(tmp_path / "p.csv", wave(10), delimiter=",")
    with pytest.raises(SceneError, match=r"a.json#/t/basis_functions: 20 basis functions"):
        tunnel_from_component(Tunnel(path_file="p.csv", basis_functions=20), tmp_path, "a.json", "/t")


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("p.csv", "0,1,2\n3,4,5\n"),
        ("p.csv", "\ufeffx,y,z\n0,1,2\n\n3,4,5\n"),
        ("p.csv", "t, Z, X ,Y\n9,2,0,1\n9,5,3,4\n"),
        ("p.CSV", "0,1,2,99\n3,4,5,99\n"),
        ("p.json", "[[0,1,2],[3,4,5]]"),
        ("p.json", '{"points": [[0,1,2],[3,4.0,5e0]], "rate": 100}'),
    ],
)
def test_paths_are_read(tmp_path, name, text):
    (tmp_path / name).write_text(text, encoding="utf-8")
    np.testing.assert_array_equal(read_path(tmp_path / name), [[0, 1, 2], [3, 4, 5]])


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("p.txt", "0,1,2\n", 'not ".txt"'),
        ("p.csv", "", "0 samples"),
        ("p.csv", "0,1,2\n", "1 samples"),
        ("p.csv", "a,b,c\n0,1,2\n", "lacks the column x, y, z"),
        ("p.csv", "x,y,z\n0,1,2\n0,1\n", "line 3"),
        ("p.csv", "0,1,2\n0,nan,2\n", "line 2"),
        ("p.csv", "0,1,2\n0,inf,2\n", "line 2"),
        ("p.json", "[[0,1,2],[3,4]]", r"#/1: must be a list of three"),
        ("p.json", "[[0,1,2],[3,4,NaN]]", r"#/1"),
        ("p.json", '[[0,1,2],[3,4,"5"]]', r"#/1"),
        ("p.json", "[[0,1,2],[3,4,true]]", r"#/1"),
        ("p.json", '{"points": [[0,1,2],7]}', r"#/points/1"),
        ("p.json", '{"dots": []}', r"#/points"),
        ("p.json", "[[0,1,", "is not JSON"),
        ("p.json", "[" * 100_000, "nested deeper"),
        ("p.json", "[[1" + "0" * 400 + ",0,0],[1,1,1]]", r"#/0"),
    ],
)
def test_bad_paths_are_refused_with_line_or_pointer(tmp_path, name, text, words):
    (tmp_path / name).write_text(text, encoding="utf-8")
    with pytest.raises(SceneError, match=words):
        read_path(tmp_path / name)


def test_unreadable_paths_are_refused(tmp_path):
    (tmp_path / "p.csv").write_bytes(b"\xff\xfe\x00\x81")
    for name in ("p.csv", "none.csv"):
        with pytest.raises(SceneError, match=r"p.csv: is not UTF-8 text \(byte 0\)|none.csv: no such file"):
            read_path(tmp_path / name)


def test_long_list_of_faults_is_cut(tmp_path):
    (tmp_path / "p.json").write_text(json.dumps([None] * 500))
    with pytest.raises(SceneError) as caught:
        read_path(tmp_path / "p.json")
    assert len(caught.value.issues) == 20


def test_fit_path_reports_both_residuals():
    points, rms, worst = fit_path(wave(), 8)
    assert points.shape == (8, 3) and 0.0 < rms < worst < 0.01
    with pytest.raises(TunnelError):
        fit_path(wave(5), 8)
