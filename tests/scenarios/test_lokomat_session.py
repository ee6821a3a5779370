"""The obstacle sequence in a session: called by command, told in events and columns, ended by STOP on the brakes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import msgspec
import numpy as np
import pytest

import mimics_app as mimics
from mimics_app.app.api.loaded_run import Recording
from mimics_app.app.cues.cue_watch import gait_triggers
from mimics_app.app.picture.loop_cards import gait_card
from mimics_app.contracts.loop.controller_port import ControllerColumn, ControllerPlugin
from mimics_app.contracts.loop.controller_slots import CommandKind, Lead
from mimics_app.contracts.loop.gait_state import GAIT_STATES
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.recording.report_gait import draw_gait, gait_spans
from mimics_app.recording.run import Run
from mimics_app.rendering.haptic.controllers.no_controller import no_controller
from mimics_app.rendering.haptic.devices.simulated_lokomat import PLANT
from mimics_app.rendering.haptic.kernels.lokomat import linear_drive, orthosis
from tests.support.command import mimics as command

SCENE = "scenes/examples/lokomat_obstacle.json"
LEGS = ("left", "right")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Run folder of a walk with one obstacle, explored for a second; a stop ends the walk after it."""
    with mimics.open(SCENE, runs=tmp_path_factory.mktemp("runs")) as session:
        parts = session.scene.entity("robot").components
        numbers = dict(parts["controller"].parameters) | {"exploration": 1.0}
        parts["controller"] = msgspec.structs.replace(parts["controller"], parameters=numbers)
        session.step(2.0)
        early = session.command(mimics.Obstacle("wall left"))
        session.step(6.0)
        wrong = session.command(mimics.Obstacle("moon"))
        called = session.command(mimics.Obstacle("wall left"))
        session.step(1.0)
        assert session._frames.board.cards["gait"].text == "Stop. Wait until the left leg is free"
        for _ in range(15):
            session.step(0.5)
            _check_picture(session)
        plant = session._begun.haptics.plugin.memory[PLANT]
        assert _drives(plant, linear_drive.BRAKED).tolist() == [0.0] * 4
        session.command(mimics.Stop())
        session.step(0.5)
        assert _drives(plant, linear_drive.BRAKED).tolist() == [1.0] * 4
        assert _drives(plant, linear_drive.CURRENT).tolist() == [0.0] * 4
    assert not early.done and "walks" in early.why
    assert not wrong.done and "wall right" in wrong.why and called.done
    return session.run_dir


def _check_picture(session: mimics.Session) -> None:
    """In the frame itself: marks where the belt has brought them, lamps lit on the leg that is free, on no other."""
    world, snapshot = session._begun.world, session._frames.snapshot
    for number in range(6):
        z = -0.85 + 0.325 * number - snapshot.belt_travel
        assert world.find(f"belt_mark_{number}").position[2] == pytest.approx(-0.95 + (z + 0.95) % 1.95, abs=1e-5)
    free = GAIT_STATES[snapshot.gait_state] in ("leg_released", "exploring")
    for leg in LEGS:
        for bone in ("thigh", "shank"):
            shown = world.find(f"{leg}_{bone}_lamp").entity.subentities[0].material
            assert shown == ("lamp_lit" if free and leg == "left" else "lamp_dark"), snapshot.gait_state


def _drives(plant: np.ndarray, place: int) -> np.ndarray:
    """One number of all four drives."""
    legs = [orthosis.leg_of(plant, number) for number in range(2)]
    return np.array([leg[orthosis.DRIVES + joint * linear_drive.DRIVE + place] for leg in legs for joint in range(2)])


@pytest.fixture(scope="module")
def recording(folder: Path) -> Recording:
    return mimics.load(folder)


def test_every_step_is_told_in_its_order_and_the_walk_resumes(recording: Recording) -> None:
    lines = [line for line in recording.run.lines if line["kind"] == "gait_state"]
    names = [line["name"] for line in lines]
    begun = names.index("walking")
    assert names[begun:] == [*GAIT_STATES[:9], "walking", "standing"]
    assert all(GAIT_STATES[int(line["state"])] == line["name"] for line in lines)
    column = np.asarray(recording.haptic["gait_state"])
    assert all(column[line["tick"]] == line["state"] for line in lines)


def test_columns_of_both_legs_say_what_the_legs_do(recording: Recording) -> None:
    haptic = recording.haptic
    for number, leg in enumerate(LEGS):
        foot = np.asarray(haptic["hip_world" if number == 0 else "point_1_hip_world"])[:, 0]
        acted = np.asarray(haptic["gait_state"]) >= 0
        told = np.asarray(haptic[f"{leg}_x_real"])
        acted &= np.asarray(haptic["state"]) < SafetyState.SAFE_STOP
        assert np.abs(told - foot)[acted].max() < 1e-9, "the robot's x is the scene's"
        assert haptic[f"{leg}_f_x"].units == "N" and haptic[f"{leg}_eta_2"].units == "m"
    explored = np.asarray(haptic["gait_state"]) == GAIT_STATES.index("exploring")
    assert explored.any() and not np.asarray(haptic["left_guidance"])[explored].any()
    assert (np.asarray(haptic["free_leg"])[explored] == 0).all()
    freed = explored | (np.asarray(haptic["gait_state"]) == GAIT_STATES.index("leg_released"))
    assert np.asarray(haptic["left_f_x"])[freed].min() < -5.0, "the foot meets the wall"
    travel = np.asarray(haptic["belt_travel"])
    assert np.diff(travel).min() >= 0.0 and np.ptp(travel[explored]) == 0.0 and travel[-1] > 1.5
    assert np.asarray(haptic["right_guidance"])[explored].min() > 0.99
    assert (
        np.abs(np.asarray(haptic["right_eta_1"])[explored] - np.asarray(haptic["right_eta_1"])[explored][0]).max()
        < 5e-3
    )


def test_each_state_has_words_and_a_trigger_of_sounds(recording: Recording) -> None:
    triggers = [trigger.kind for trigger in gait_triggers(recording.run.events)]
    assert triggers == [line["name"] for line in recording.run.lines if line["kind"] == "gait_state"]
    assert gait_card(-1, -1) is None
    words = {card.text for state in range(len(GAIT_STATES)) if (card := gait_card(state, 1)) is not None}
    assert len(words) == len(GAIT_STATES) and "Explore the obstacle with the right foot" in words


def test_stop_takes_the_current_away_and_a_braked_leg_does_not_move(recording: Recording) -> None:
    haptic = recording.haptic
    stopped = np.asarray(haptic["state"]) >= SafetyState.SAFE_STOP
    assert stopped.any() and not np.asarray(haptic["torque_command"])[stopped].any()
    assert (np.asarray(haptic["gait_state"])[stopped] == GAIT_STATES.index("standing")).all()
    begun = next(line["tick"] for line in recording.run.lines if line.get("name") == "to_start")
    braked = np.degrees(np.asarray(haptic["q"])[begun - 900 : begun - 20, :4])
    assert np.ptp(braked, axis=0).max() < 1.0, "while the guidance returns the device's own brakes hold both legs"


def test_the_recording_is_replayed_bit_for_bit(folder: Path) -> None:
    assert "equal bit for bit" in command("replay", folder).stdout


def test_the_recording_names_the_columns_of_its_controller(folder: Path) -> None:
    assert [name for name, _ in Run.open(folder).layout.extent.numbers] == [
        f"{leg}_{name}"
        for leg in LEGS
        for name in ("x_real", "x_des", "f_x", "eta_1", "eta_2", "guidance", "hip_residual", "knee_residual")
    ]


def test_the_report_draws_the_states_and_both_feet_below_them(folder: Path) -> None:
    run = Run.open(folder)
    lines = [line for line in run.lines if line["kind"] == "gait_state"]
    begun = [(name, round(1000 * begin)) for name, begin, _ in gait_spans(run.haptic)]
    assert begun == [(line["name"], line["tick"]) for line in lines]
    assert not draw_gait(run.haptic, replace(run.layout.extent, gait=False))
    command("report", folder)
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert all(f"gait-{name}" in page for name in GAIT_STATES) and "height of the foot" in page


def test_a_column_has_a_name_of_its_own() -> None:
    with pytest.raises(ValueError, match="depth"):
        ControllerPlugin(
            "own", no_controller, Lead.PERSON, CommandKind.FORCE, columns=(ControllerColumn("depth", "m"),)
        )
