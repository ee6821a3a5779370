"""A session that is steered: commands take effect at their place, are recorded, and a replay obeys them again."""

from __future__ import annotations

import json
import random
from collections import Counter
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from mimics_app.app.scenes.loading import check_scene, read_scene
from mimics_app.contracts.commands.command_records import CommandSource
from mimics_app.contracts.commands.vocabulary import (
    Calibrate,
    Command,
    Confirm,
    End,
    Mute,
    Note,
    Policy,
    Reset,
    SetAssistance,
    SetParameter,
    StartTrial,
    Stop,
    View,
    command_values,
    name_of,
)
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.loop.haptic import Button, SafetyState
from mimics_app.contracts.messages.stage_messages import TaskAction
from mimics_app.contracts.shared_memory.command_ring import CommandSender
from mimics_app.contracts.system.resources import root
from mimics_app.recording.run import Run
from tests.support.command import mimics as command
from tests.support.core_play import CorePlay, KeepingRecorder

TUNNEL = root() / "scenes" / "wavy_tunnel.json"
PLAIN = ("pause", "resume", "stop", "reset", "skip", "repeat", "start_trial", "mute", "recalibrate", "confirm")


class Journal(KeepingRecorder):
    """Keeps the lines of the journal, too."""

    def __init__(self, memory: Any) -> None:
        super().__init__(memory)
        self.lines: list[tuple[str, dict[str, Any]]] = []

    def journal(self, kind: str, data: Any) -> None:
        self.lines.append((kind, dict(data)))


class Steered(CorePlay):
    """A session with a sender of each source."""

    def __init__(self, **settings: Any) -> None:
        from mimics_app.app.session.core import open_core
        from mimics_app.app.session.preparation import prepare_scene
        from mimics_app.app.settings import RunSettings

        scene = check_scene(read_scene(TUNNEL))
        super().__init__(open_core(prepare_scene(scene, RunSettings(scene.path, **settings)), Journal))
        free = set(CommandSource) - {
            CommandSource.KEYS,
            CommandSource.GAMEPAD,
            CommandSource.BUTTON,
            CommandSource.FILE,
        }
        self.senders = {source: CommandSender(self.core.memory, source, source.name) for source in free}

    def give(self, *commands: Command, source: CommandSource = CommandSource.OPERATOR) -> list[dict[str, Any]]:
        """Give commands, play a frame, return their lines of the journal."""
        for each in commands:
            self.senders[source].send(each, self.core.clock.now_ns())
        self.recorder.lines.clear()
        self.step()
        return [line for kind, line in self.recorder.lines if kind == "command"]


def _random_commands(count: int, seconds: float) -> list[dict[str, Any]]:
    """Commands of every kind that steers a task, at random times; a stop is mostly followed by a reset."""
    chance = random.Random(4)
    made: list[dict[str, Any]] = []
    for _ in range(count):
        t, name = chance.uniform(0.0, seconds), chance.choice((*PLAIN, "set_parameter", "set_assistance", "policy"))
        values: dict[str, Any] = {}
        if name == "set_parameter":
            values = {"name": chance.choice(["radius", "stiffness", "force_limit"]), "value": chance.uniform(-1, 900)}
        elif name == "set_assistance":
            values = {"share": chance.random()}
        elif name == "policy":
            values = {"mode": chance.choice(["on", "off", "propose"])}
        made.append({"t": t, "command": name, **values})
        if name == "stop":
            made.append({"t": t + 0.3, "command": "reset"})
    return made


def test_a_session_steered_by_random_commands_replays_bit_for_bit(tmp_path: Path) -> None:
    listed = _random_commands(200, 15.0)
    file = tmp_path / "commands.json"
    file.write_text(json.dumps(listed))
    done = command("run", TUNNEL, "--headless", "--seconds", "16", "--pictures", "0", "--sound", "off", "--json",
                   "--trials", "100", "--learn", "kalman", "--commands", file, "--runs", tmp_path)  # fmt: skip
    run = Path(json.loads(done.stdout)["run_dir"])
    lines = Run.open(run).lines_of("app", "command")
    assert Counter(line["command"] for line in lines) == Counter(each["command"] for each in listed)
    assert [line["sequence"] for line in lines] == list(range(len(listed)))
    obeyed = Counter(line["command"] for line in lines if line["done"])
    steering = {"pause", "resume", "stop", "reset", "skip", "repeat", "start_trial", "set_parameter", "set_assistance"}
    assert steering <= set(obeyed), "a command that is never carried out shows nothing"
    replayed = command("replay", run, "--json")
    assert replayed.returncode == 0, replayed.stderr
    assert json.loads(replayed.stdout)["task"]["events"] > 30


@pytest.mark.parametrize("source", [CommandSource.OPERATOR, CommandSource.PYTHON, CommandSource.LSL])
def test_a_stop_of_every_source_acts_within_two_ticks_and_is_left_by_a_reset(source: CommandSource) -> None:
    play = Steered(seed=2)
    with play.core:
        play.frames.play_to_start()
        for _ in range(60):
            play.step()
        (line,) = play.give(Stop(), source=source)
        assert line["done"] and line["from"] == source.name.lower() and line["who"] == source.name
        states = play._kept[-1]["state"]
        assert (states[2:] == SafetyState.E_STOP).all()
        assert not play._kept[-1]["f_user_world"][2:].any()
        assert not play.give(Stop(), Reset())[1]["done"], "a stop and a reset in one frame: the stop wins"
        (line,) = play.give(Reset())
        assert line["done"]
        play.step()
        assert play.frames.snapshot.state not in (SafetyState.E_STOP, SafetyState.SAFE_STOP)
        (line,) = play.give(Reset())
        assert not line["done"] and line["why"] == "no stop is latched"


def test_a_command_of_a_person_wins_over_a_choice_of_the_policy_in_its_frame() -> None:
    play = Steered(seed=2, learn="kalman")
    with play.core:
        play.step()
        play.frames._action = TaskAction({"radius": 0.9, "stiffness": 800.0})
        (line,) = play.give(SetParameter("radius", 1.1))
        action = next(data for kind, data in play.recorder.lines if kind == "action")
        frame = next(data for kind, data in play.recorder.lines if kind == "frame")
        assert line["done"] and action["overruled"] == ["radius"] and frame["action"]["values"]["radius"] == 0.9
        for _ in range(600):
            play.step()
        values = play.core.tasks.values
        assert values["radius"] == pytest.approx(1.1) and values["stiffness"] == pytest.approx(800.0)


def test_a_proposal_waits_for_its_confirmation() -> None:
    play = Steered(seed=2, learn="kalman")
    with play.core:
        play.step()
        gate, proposed = play.frames.desk.gate, TaskAction({"stiffness": 900.0})
        assert not play.give(Confirm())[0]["done"]
        play.give(Policy("propose"))
        assert gate.passed(proposed) is None and gate.proposal is proposed
        assert play.give(Confirm(accept=False))[0]["done"] and gate.proposal is None
        gate.passed(proposed)
        play.give(Confirm())
        assert [data["values"] for kind, data in play.recorder.lines if kind == "action"] == [{"stiffness": 900.0}]
        play.give(Policy("off"))
        assert gate.passed(proposed) is None and gate.proposal is None


def test_a_real_robot_obeys_what_moves_a_person_only_from_who_sees_them(monkeypatch: pytest.MonkeyPatch) -> None:
    play = Steered(seed=2)
    with play.core:
        play.step()
        real = replace(play.core.haptics.plugin, simulated=False)
        monkeypatch.setattr(type(play.core.haptics), "plugin", property(lambda _: real))
        moving = (Reset(), StartTrial(), SetAssistance(0.5))
        for line in play.give(*moving, source=CommandSource.PYTHON):
            assert not line["done"] and "on a real device" in line["why"] and not line["of_task"]
        assert [line["done"] for line in play.give(*moving, source=CommandSource.OPERATOR)] == [False, False, True]
        assert play.give(Stop(), source=CommandSource.PYTHON)[0]["done"], "a stop from everywhere"


def test_what_no_part_of_the_session_can_do_is_refused_with_the_reason() -> None:
    play = Steered(seed=2)
    with play.core:
        play.step()
        answers = {line["command"]: (line["done"], line["why"]) for line in play.give(
            Policy("off"), View("above"), Mute(), Note("a cough"), SetParameter("velocity_limit", 9.0),
            SetParameter("radios", 1.0), Calibrate("force_sensor"), End(),
        )}  # fmt: skip
        assert answers["policy"] == (False, "this session has no policy")
        assert answers["view"] == (False, 'this scene has no view "above"; known: patient_eye')
        assert answers["mute"] == (False, "this session has no sound")
        assert answers["note"] == (True, "")
        assert answers["set_parameter"] == (False, 'there is no adaptable parameter "radios"; did you mean "radius"')
        assert answers["calibrate"] == (False, "the device simulated_hapticmaster has no steps of calibration")
        assert answers["end"][0] and play.frames.desk.ended
        told = play.senders[CommandSource.OPERATOR].answers()
        assert len(told) == 8 and "limit of the haptic loop" in told[4].why
        assert {answer.frame for answer in told} == {play.frames.number - 1}


def test_a_button_of_the_device_steers_the_session() -> None:
    """The simulated robot passes on what its person presses; the loop takes it with the data of a tick."""
    play = Steered(seed=2)
    with play.core:
        play.step()
        play.core.haptics._inbox[0]["buttons"] = Button.PRIMARY
        for _ in range(3):
            play.step()
        (line,) = [line for kind, line in play.recorder.lines if kind == "command"]
        assert (line["from"], line["who"], line["command"]) == ("button", "device", "start_trial")


def test_the_journal_holds_the_whole_command() -> None:
    play = Steered(seed=2)
    with play.core:
        play.step()
        given_ns = play.core.clock.now_ns()
        (line,) = play.give(SetParameter("assistance", 0.5))
    assert line == {
        "frame": 1, "tick": line["tick"], "t_ns": line["t_ns"], "from": "operator", "who": "OPERATOR", "sequence": 0,
        "given_ns": given_ns, "command": name_of(SetParameter("assistance", 0.5)), "of_task": True, "done": True,
        "why": "", "values": command_values(SetParameter("assistance", 0.5)),
    }  # fmt: skip
    assert line["t_ns"] - given_ns <= 17_000_000, "the next frame"


def test_what_comes_too_fast_is_counted_and_told() -> None:
    play, told = Steered(seed=2), list[str]()
    with play.core:
        play.step()
        play.core.report = told.append
        room, sender = play.core.memory.commands.shape[1], play.senders[CommandSource.OPERATOR]
        for number in range(room + 6):
            with suppress(UsageError):
                sender.send(Note(str(number)), 0)
        play.step()
    assert [data for kind, data in play.recorder.lines if kind == "commands_dropped"] == [
        {"from": "operator", "number": 6}
    ]
    assert sum(kind == "command" for kind, _ in play.recorder.lines) == room
    assert told == ["6 commands from the operator came too fast and were lost"]
