"""Sweep files, their points by number, and the chunks they are kept in."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

from mimics_app.app.cli import main
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.sweep.experiments import NAMES, find_experiment
from mimics_app.app.sweep.patient import travel
from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.system.resources import root
from mimics_app.lab.stability.catalogue import NAMES as STABILITY
from mimics_app.lab.stability.catalogue import load_experiment
from mimics_app.lab.stability.wall_loop import Wall, exact_limit
from mimics_app.lab.sweep.points import count_points, points_between
from mimics_app.lab.sweep.spec import Sweep, load_sweep
from mimics_app.lab.sweep.store import ChunkStore, chunks_of
from mimics_app.lab.sweep.wall_stability import EXPERIMENT

ROOT = Path(__file__).resolve().parents[2]


def spec(folder: Path, parameters: dict[str, Any], **parts: Any) -> Path:
    file = folder / "sweep.json"
    head = {"format": "mimics-sweep", "version": 1, "experiment": "wall_stability"}
    file.write_text(json.dumps({**head, "parameters": parameters, **parts}))
    return file


def load(file: Path) -> Sweep:
    return load_sweep(file, find_experiment, NAMES)


def test_examples_are_right():
    for file in sorted((ROOT / "docs" / "sweeps").glob("*.json")):
        assert count_points(load(file)) > 1


@pytest.mark.parametrize(
    ("parameters", "parts", "said"),
    [
        ({"stifness": 1.0}, {}, '#/parameters/stifness: "wall_stability" has no parameter "stifness"; did you mean'),
        ({"stiffness": []}, {}, "#/parameters/stiffness: has no values"),
        ({"stiffness": [1.0, -1.0]}, {}, "#/parameters/stiffness/1: -1 is outside 0 to"),
        ({"stiffness": {"from": 5.0, "to": 1.0}}, {}, "#/parameters/stiffness/to: is below from"),
        ({"stiffness": {"from": 0.0, "to": 1.0, "scale": "log"}}, {}, "#/parameters/stiffness/scale: equal ratios"),
        ({"stiffness": {"from": 0.0, "too": 1.0}}, {}, "#/parameters/stiffness"),
        ({"delay_ticks": [0.5]}, {}, "#/parameters/delay_ticks/0: 0.5 must be a whole number"),
        ({"mass": "heavy"}, {}, '#/parameters/mass: "heavy" is not a number'),
        ({}, {"experiment": "wal_stability"}, "#/experiment: there is no experiment"),
        ({}, {"sampel": {"points": 3}}, "#/sampel: unknown key"),
        ({}, {"sample": {"points": 0}}, "#/sample/points"),
    ],
)
def test_faults_are_reported_with_their_place(tmp_path, parameters, parts, said):
    with pytest.raises(SceneError) as caught:
        load(spec(tmp_path, parameters, **parts))
    assert said in str(caught.value)


def test_grid_has_every_combination_once(tmp_path):
    sweep = load(spec(tmp_path, {"stiffness": {"from": 1.0, "to": 100.0, "count": 3, "scale": "log"}, "mass": [1, 2]}))
    values = points_between(sweep, EXPERIMENT, 0, count_points(sweep))
    pairs = set(zip(values["mass"], np.round(values["stiffness"], 9).tolist(), strict=True))
    assert pairs == {(m, k) for m in (1.0, 2.0) for k in (1.0, 10.0, 100.0)}
    assert values["stiffness"][2] == 100.0, "the end of a range is hit exactly"


def test_points_of_a_sample_depend_on_seed_and_number_alone(tmp_path):
    parameters = {"stiffness": {"from": 1.0, "to": 9.0}, "delay_ticks": {"from": 0, "to": 3}, "mass": [1.0, 2.0]}
    sweep = load(spec(tmp_path, parameters, sample={"points": 4000, "seed": 5}))
    whole = points_between(sweep, EXPERIMENT, 0, 4000)
    part = points_between(sweep, EXPERIMENT, 700, 720)
    assert all(part[name] == whole[name][700:720] for name in whole)
    assert set(whole["delay_ticks"]) == {0, 1, 2, 3} and set(whole["mass"]) == {1.0, 2.0}
    # The mean of n uniform values of width 8 errs by 8 / sqrt(12 n) = 0.037; five times that is never met by chance.
    assert abs(np.mean(whole["stiffness"]) - 5.0) < 5 * 0.037
    other = load(spec(tmp_path, parameters, sample={"points": 4000, "seed": 6}))
    assert points_between(other, EXPERIMENT, 0, 20)["stiffness"] != whole["stiffness"][:20]


def test_a_default_is_part_of_the_sweep(tmp_path):
    sweep = load(spec(tmp_path, {"stiffness": 100.0}))
    assert sweep.parameters["mass"] == 3.0
    assert load(spec(tmp_path, {"mass": 3.0, "stiffness": 100.0}, title="the same")).digest == sweep.digest


def test_simulated_walls_meet_the_exact_boundary(tmp_path):
    """1 % on either side of the eigenvalue boundary, where the answer must not be in doubt."""
    walls = [
        Wall(m, 5.0, B, rate, n) for m in (0.3, 3.0) for B in (0.0, 8.0) for rate in (500.0, 2000.0) for n in (0, 2)
    ]
    limits = [exact_limit(wall) for wall in walls]
    for factor, wanted in ((0.99, True), (1.01, False)):
        values = {
            "stiffness": [factor * limit for limit in limits],
            "wall_damping": [wall.wall_damping for wall in walls],
            "mass": [wall.mass for wall in walls],
            "device_damping": [wall.device_damping for wall in walls],
            "period": [1.0 / wall.rate for wall in walls],
            "delay_ticks": [wall.delay for wall in walls],
        }
        assert EXPERIMENT.run(values, tmp_path)["stable"] == [wanted] * len(walls)


def test_bytes_depend_on_the_points_alone(tmp_path, capsys):
    parameters = {"stiffness": {"from": 1e2, "to": 1e5, "scale": "log"}, "mass": [0.1, 3.0]}
    for name, chunk in (("a", 7), ("b", 64)):
        file = spec(tmp_path, parameters, sample={"points": 100, "seed": 1}, chunk=chunk)
        assert main(["sweep", str(file), "--workers", "1", "--out", str(tmp_path / f"{name}.parquet")]) == 0
    assert (tmp_path / "a.parquet").read_bytes() == (tmp_path / "b.parquet").read_bytes()
    assert not (tmp_path / "a.parquet.pieces").exists()
    table = pq.read_table(tmp_path / "a.parquet")
    assert table["point"].to_pylist() == list(range(100))
    assert 0 < sum(table["stable"].to_pylist()) < 100
    assert "100 points" in capsys.readouterr().out


def test_a_torn_chunk_is_computed_again(tmp_path):
    file = spec(tmp_path, {"stiffness": [100.0, 200.0]}, chunk=1)
    sweep, store = load(file), ChunkStore(tmp_path / "out.parquet", "identity")
    chunks = chunks_of(2, 1)
    store.put(chunks[0], b"ARROW1 torn")
    assert not store.has(chunks[0])
    with pytest.raises(KeyError, match="points 0 to 0 are missing"):
        store.finish(chunks, sweep)


@pytest.mark.seconds
def test_patient_is_repeatable_and_actions_change_the_travel():
    scene = load_checked_scene(root() / "scenes" / "wavy_tunnel.json")
    plain = travel(scene, "healthy", 3, {}, profile="training", seconds=60.0)
    assert plain["outcome"] == "finished" and plain["time_s"] > 1.0
    assert travel(scene, "healthy", 3, {}, profile="training", seconds=60.0) == plain
    helped = travel(scene, "healthy", 3, {"assistance": 1.0}, profile="training", seconds=60.0)
    assert helped["parameter.assistance"] == 1.0 and helped["time_s"] < plain["time_s"]
    assert travel(scene, "healthy", 3, {}, profile="training", seconds=1.0) == {}


@pytest.mark.parametrize("name", ["S1", "S5"])
def test_a_stability_experiment_is_swept_over_its_grid(name, tmp_path, capsys):
    file = spec(tmp_path, {"points": [2, 3]}, experiment=name)
    assert main(["sweep", str(file), "--workers", "1", "--out", str(tmp_path / "out.parquet")]) == 0
    table = pq.read_table(tmp_path / "out.parquet").to_pydict()
    assert table["passed"] == [True, True]
    assert table["rows"][0] < table["rows"][1]
    alone = load_experiment(name).run(3)
    assert (table["rows"][1], table["disagreement"][1]) == (len(alone.rows), alone.disagreement)


def test_every_stability_experiment_can_be_swept():
    assert set(STABILITY) < set(NAMES)
    for name in STABILITY:
        found = find_experiment(name)
        assert found is not None and found.name == name and "points" in found.parameters
        experiment = load_experiment(name)
        assert found.what == f"{experiment.title}: {experiment.claim}", "read from the source, without its import"


def test_list_names_the_experiments_that_a_sweep_file_may_name(tmp_path, capsys):
    """The description of the sweep file sends people to --list."""
    assert main(["sweep", "--list", "--json"]) == 0
    listed = {one["name"]: one for one in json.loads(capsys.readouterr().out)["experiments"]}
    assert tuple(listed) == NAMES
    assert listed["wall_stability"]["parameters"]["stiffness"] == {
        "kind": "float",
        "low": 0.0,
        "high": 1e9,
        "unit": "N/m",
        "default": 1000.0,
    }
    assert "choices" in listed["patient"]["parameters"]["preset"]
    assert main(["sweep", "--list"]) == 0
    said = capsys.readouterr().out
    assert all(f"{name}: " in said for name in NAMES)
    assert "stiffness          float [N/m], from 0 to 1e+09, default 1000.0" in said
    assert main(["sweep", "--list", str(tmp_path / "a.json")]) == 2
    assert main(["sweep"]) == 2
