"""A scene with a reference: the leg is led along it, commands change its pace and guidance, and the run replays."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.contracts.system.resources import root
from mimics_app.recording.run import Run
from tests.support.command import mimics as command

KICKING = root() / "scenes" / "examples" / "kicking.json"
REFERENCE = {"body_height": 1.75, "speed": 0.4, "cadence_rate": 0.3, "guidance_rate": 0.8, "amplitude_rate": 0.6}
JOINTS = slice(0, 2)


def _parameter(least: float, most: float, default: float, rate: float, target: str) -> dict[str, Any]:
    return {"min": least, "max": most, "default": default, "rate": rate, "maps": [{"to": f"haptic.{target}"}]}


def guided_scene(folder: Path, reference: dict[str, Any] = REFERENCE) -> Path:
    """The leg of `kicking` in the air, with a limp person, a reference, and parameters of the task for it."""
    scene = json.loads(KICKING.read_text())
    kept = {"side_eye", "hand", "robot", "patient"}
    scene["entities"] = [each for each in scene["entities"] if each["id"] in kept]
    scene.pop("assets")
    robot, patient = (next(e for e in scene["entities"] if e["id"] == name) for name in ("robot", "patient"))
    patient["components"]["patient"] = {"intent": False}
    robot["components"] |= {"joint_reference": reference, "controller": {"name": "guided_joints"}}
    robot["components"]["admittance"] |= {"max_velocity": 2.4}
    scene["task"] = {
        "goals": [{"kind": "duration", "seconds": 60}],
        "time_limit_s": 90,
        "parameters": {
            "assistance": _parameter(0.0, 1.0, 1.0, 5.0, "guidance"),
            "cadence": _parameter(0.3, 0.8, 0.5, 5.0, "reference_cadence"),
            "amplitude": _parameter(0.0, 1.0, 1.0, 5.0, "reference_amplitude"),
            "knee": _parameter(0.0, 1.0, 1.0, 5.0, "curves.knee.guidance"),
        },
    }
    file = folder / "guided.json"
    file.write_text(json.dumps(scene))
    return file


@pytest.fixture(scope="module")
def played(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Any]:
    """A run of 20 s: the cadence rises at 10 s, guidance falls at 14 s, the walk stops at 16 s."""
    folder = tmp_path_factory.mktemp("guided")
    steered = [
        {"t": 10.0, "command": "set_parameter", "name": "cadence", "value": 0.8},
        {"t": 14.0, "command": "set_assistance", "share": 0.3},
        {"t": 16.0, "command": "set_parameter", "name": "amplitude", "value": 0.0},
        {"t": 18.0, "command": "set_parameter", "name": "controller.stiffness", "value": 0.0},
        {"t": 18.0, "command": "set_parameter", "name": "controller.damping", "value": -7.0},
        {"t": 18.0, "command": "set_parameter", "name": "controller.force_limit", "value": 9.0},
        {"t": 18.0, "command": "set_parameter", "name": "controller.stifness", "value": 9.0},
    ]
    commands = folder / "commands.json"
    commands.write_text(json.dumps(steered))
    done = command("run", guided_scene(folder), "--headless", "--seconds", "20", "--pictures", "0", "--sound", "off",
                   "--json", "--commands", commands, "--runs", folder)  # fmt: skip
    assert done.returncode == 0, done.stderr
    run = Path(json.loads(done.stdout)["run_dir"])
    return run, Run.open(run).haptic


def test_the_leg_follows_the_reference(played: tuple[Path, Any]) -> None:
    _, samples = played
    led = samples[9_000:10_000]
    assert (led["state"] == SafetyState.ACTIVE).all()
    assert led["guidance"][:, JOINTS].min() > 0.99 and led["amplitude"].min() > 0.99
    away = np.degrees(led["q"][:, JOINTS] - led["q_reference"][:, JOINTS])
    moved = np.degrees(np.ptp(samples["q"][7_000:10_000, JOINTS], axis=0))
    assert moved[0] > 20.0 and moved[1] > 30.0
    assert np.sqrt((away**2).mean(axis=0)).max() < 3.0


def test_less_guidance_follows_less_closely(played: tuple[Path, Any]) -> None:
    _, samples = played
    away = np.abs(samples["q"][:, JOINTS] - samples["q_reference"][:, JOINTS]).mean(axis=1)
    assert samples["guidance"][15_900, JOINTS] == pytest.approx([0.3, 0.3], abs=0.01)
    assert away[15_400:16_000].mean() > 1.5 * away[9_000:10_000].mean()


def test_the_phase_goes_on_evenly_when_a_command_changes_the_cadence(played: tuple[Path, Any]) -> None:
    _, samples = played
    walking = samples[9_000:15_000]
    steps = np.mod(np.diff(walking["phase"]), 1.0) * 1000.0
    assert steps[:900] == pytest.approx(0.5, abs=0.01) and steps[-500:] == pytest.approx(0.8, abs=0.01)
    assert np.abs(np.diff(steps)).max() <= 0.3 * 1e-3 * 1.001
    assert np.abs(np.diff(samples["guidance"][:, JOINTS], axis=0)).max() <= 0.8 * 1e-3 * 1.001
    assert np.abs(np.diff(samples["amplitude"])).max() <= 0.6 * 1e-3 * 1.001


def test_it_ends_in_standing(played: tuple[Path, Any]) -> None:
    _, samples = played
    assert not samples["q_reference"][-1].any() and samples["phase"][-1] == 0.0
    assert samples["amplitude"][15_900] > 0.99


def test_a_command_sets_the_parameters_of_the_controller_within_their_limits(played: tuple[Path, Any]) -> None:
    run, samples = played
    said = [line["why"] for line in Run.open(run).lines_of("app", "command") if line["t_ns"] > 17.9e9]
    assert said[:2] == ["", "damping is limited to 0 1/s"]
    assert '"force_limit" is a limit of the haptic loop' in said[2]
    assert 'no parameter "stifness"; did you mean "stiffness"' in said[3]
    speeds = np.abs(samples["dq"][:, JOINTS]).max(axis=1)
    assert speeds[17_400:18_000].max() > 0.1, "drawn to and fro"
    assert speeds[18_600:].max() < 0.05, "nothing draws the leg"


def test_the_run_replays_bit_for_bit(played: tuple[Path, Any]) -> None:
    run, _ = played
    replayed = command("replay", run, "--json")
    assert replayed.returncode == 0, replayed.stderr


@pytest.mark.parametrize(
    ("reference", "said"),
    [
        ({"curves": [{"joint": "ankle", "values": [0.1]}], "cadence": 0.5}, 'no joint is called "ankle"'),
        ({"curves": [{"joint": "hip", "values": [0.1, 2.0, 0.0]}], "cadence": 0.5}, "hip goes from"),
        ({"curves": [{"joint": "knee", "values": [0.6, 0.5, 0.0]}], "cadence": 3.0}, "per second"),
        ({"curves": [{"joint": "hip", "values": [0.1, 0.2]}], "cadence": 0.5}, "mean and two for every harmonic"),
        ({"curves": [{"joint": "hip", "file": "cycle.csv"}]}, "ends +0.300 from its begin"),
        ({"curves": [{"joint": "hip", "values": [0.1]}]}, "how long a cycle lasts"),
        ({"speed": 0.5}, "moves no joint"),
    ],
)
def test_a_reference_that_cannot_be_followed_is_refused(tmp_path: Path, reference: dict[str, Any], said: str) -> None:
    (tmp_path / "cycle.csv").write_text("t,hip\n0,0.0\n0.5,0.1\n1.0,0.3\n")
    done = command("check", guided_scene(tmp_path, reference))
    assert done.returncode == 3 and said in done.stdout + done.stderr


def test_a_parameter_of_a_joint_that_the_device_does_not_have_is_refused(tmp_path: Path) -> None:
    file = guided_scene(tmp_path)
    scene = json.loads(file.read_text())
    scene["task"]["parameters"]["knee"] = _parameter(0.0, 1.0, 1.0, 5.0, "curves.ankle.guidance")
    file.write_text(json.dumps(scene))
    done = command("check", file)
    assert done.returncode == 3 and 'unknown haptic parameter "curves.ankle.guidance"' in done.stdout + done.stderr


def test_a_recorded_cycle_is_played_at_its_own_pace(tmp_path: Path) -> None:
    from mimics_app.app.scenes.loading import check_scene, read_scene
    from mimics_app.rendering.haptic.scene_reference import reference_of_scene, sample_curve

    t = np.linspace(0.0, 2.0, 401)
    hip = 0.2 + 0.15 * np.sin(np.pi * t)
    rows = "\n".join(f"{a:.4f},{b:.9f}" for a, b in zip(t, hip, strict=True))
    (tmp_path / "cycle.csv").write_text(f"t,hip\n{rows}\n")
    scene = check_scene(read_scene(guided_scene(tmp_path, {"curves": [{"joint": "hip", "file": "cycle.csv"}]})))
    made = reference_of_scene(scene)
    assert made.fields["reference_cadence"] == pytest.approx(0.5)
    assert sample_curve(made.rows[0], 0.0, 0.0) == pytest.approx(
        0.2 + 0.15 * np.sin(2 * np.pi * np.arange(400) / 400), abs=1e-3
    )
    assert made.rows[1]["kind"] == 0
