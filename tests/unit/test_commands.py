"""Commands: a closed vocabulary, one ring for each source, and keys and files that give them."""

from __future__ import annotations

import json
import threading
from pathlib import Path
from typing import Any, get_args

import pytest

import mimics_app
from mimics_app.contracts.commands.command_records import CommandSource
from mimics_app.contracts.commands.vocabulary import (
    AnyCommand,
    Command,
    End,
    Fault,
    Mark,
    Note,
    Pause,
    Reset,
    Resume,
    SetAssistance,
    SetParameter,
    StartTrial,
    Stop,
    command_names,
    read_command,
    refusal,
    write_command,
)
from mimics_app.contracts.errors import SceneError, UsageError
from mimics_app.contracts.messages.trial_state import TaskView, TrialState
from mimics_app.contracts.messages.window_input import GamepadState, InputEvent
from mimics_app.contracts.ports.input_port import WindowFrame
from mimics_app.contracts.shared_memory.command_ring import Answer, CommandReceiver, CommandSender
from mimics_app.contracts.shared_memory.session_memory import Capacities, SessionMemory
from mimics_app.contracts.shared_memory.shared_words import STOP_STRIDE
from mimics_app.inputs.commands.command_file import TimedCommand, TimedCommands, read_command_file
from mimics_app.inputs.commands.keys import KeyCommands

ISSUE = (
    "pause resume stop reset skip repeat start_trial set_parameter set_assistance policy confirm obstacle fault "
    "calibrate note mark view volume mute recalibrate end"
)
FRAME_NS = 16_666_667


def test_the_vocabulary_is_the_whole_one() -> None:
    assert " ".join(command_names()) == ISSUE
    assert {kind.__name__ for kind in get_args(AnyCommand)} <= {*mimics_app.__all__}, "each is offered to Python"


@pytest.mark.parametrize("command", [Pause(), SetParameter("radius", 1.25), Note("ä" * 200), SetAssistance(1.0)])
def test_a_command_survives_its_text(command: Command) -> None:
    assert read_command(write_command(command)) == command


@pytest.mark.parametrize(
    "command", [SetParameter("radius", float("nan")), SetAssistance(1.5), Note(""), Mark("x" * 81)]
)
def test_a_value_that_a_command_does_not_take_is_refused_at_its_source(command: Command) -> None:
    sender = CommandSender(SessionMemory(), CommandSource.PYTHON, "me")
    with pytest.raises(UsageError):
        sender.send(command, 0)
    assert sender.send(Pause(), 0) == 0, "what was refused has no number"


@pytest.mark.requirement("R24")
def test_who_may_give_what() -> None:
    present = {CommandSource.KEYS, CommandSource.GAMEPAD, CommandSource.BUTTON, CommandSource.OPERATOR}
    for command in (Reset(), StartTrial(), SetAssistance(0.5)):
        assert {s for s in CommandSource if not refusal(command, s, simulated=False)} == present
        assert {s for s in CommandSource if not refusal(command, s, simulated=True)} == set(CommandSource) - {
            CommandSource.LSL,
            CommandSource.STOP_BUTTON,
            CommandSource.ATTENDANCE,
        }
    assert refusal(Fault("jump"), CommandSource.OPERATOR, simulated=False)
    for command in (Note("x"), Mark("x"), Stop()):
        assert not refusal(command, CommandSource.LSL, simulated=False)
    assert refusal(Pause(), CommandSource.LSL, simulated=True)


def test_each_source_has_its_own_ring_and_gets_its_own_answers() -> None:
    memory = SessionMemory()
    python, keys = (
        CommandSender(memory, CommandSource.PYTHON, "me"),
        CommandSender(memory, CommandSource.KEYS, "x" * 99),
    )
    python.send(Pause(), 20)
    keys.send(Note("a"), 10)
    assert python.send(Mark("b"), 30) == 1
    desk = CommandReceiver(memory)
    given = desk.take()
    assert [(each.source, each.sequence, each.t_ns, each.command) for each in given] == [
        (CommandSource.KEYS, 0, 10, Note("a")),
        (CommandSource.PYTHON, 0, 20, Pause()),
        (CommandSource.PYTHON, 1, 30, Mark("b")),
    ]
    assert given[0].who == "x" * 32 and not desk.take()
    desk.answer(given[2], Answer(1, done=False, why="ü" * 300, frame=3, tick=50))
    (answer,) = python.answers()
    assert (answer.sequence, answer.done, answer.frame, answer.tick) == (1, False, 3, 50)
    assert answer.why.startswith("üüü") and not keys.answers() and not python.answers()


def test_what_is_no_command_is_said_to_be_none() -> None:
    memory = SessionMemory()
    sender = CommandSender(memory, CommandSource.OPERATOR, "page")
    sender._out.push((0, 0, b"page", b'{"command": "jump"}'))
    (given,) = CommandReceiver(memory).take()
    assert given.command is None and "not a command" in given.fault


def test_a_full_ring_counts_what_it_loses_and_says_so() -> None:
    memory = SessionMemory(Capacities(commands=4))
    sender, desk = CommandSender(memory, CommandSource.FILE, "f"), CommandReceiver(memory)
    for _ in range(4):
        sender.send(Pause(), 0)
    for _ in range(3):
        with pytest.raises(UsageError, match="4 commands wait"):
            sender.send(Pause(), 0)
    assert desk.take_dropped() == {CommandSource.FILE: 3} and desk.take_dropped() == {}
    assert len(desk.take()) == 4 and sender.send(Pause(), 0) == 4


@pytest.mark.seconds
def test_none_of_a_hundred_thousand_is_lost_between_two_threads() -> None:
    memory, count = SessionMemory(Capacities(commands=1024)), 100_000
    sender, desk = CommandSender(memory, CommandSource.OPERATOR, "page"), CommandReceiver(memory)

    def give() -> None:
        for number in range(count):
            while not sender.room:
                pass
            sender._out.push((number, number, b"page", b'{"command":"pause"}'))

    thread = threading.Thread(target=give)
    thread.start()
    seen = 0
    while seen < count:
        for given in desk.take():
            assert given.sequence == given.t_ns == seen
            seen += 1
    thread.join()
    assert not desk.take_dropped()


def test_a_stop_is_requested_before_it_is_queued() -> None:
    memory = SessionMemory(Capacities(commands=1))
    sender = CommandSender(memory, CommandSource.LSL, "lsl")
    sender.send(Note("full"), 0)
    with pytest.raises(UsageError):
        sender.send(Stop(), 0)
    assert memory.stop_words[STOP_STRIDE * CommandSource.LSL] == 1 and memory.stop_words.sum() == 1


class Keys:
    """Keys, pressed frame by frame before a desk."""

    def __init__(self) -> None:
        self.memory, self.said, self.now_ns = SessionMemory(), list[str](), 0
        self.keys, self.desk = KeyCommands(self.memory, self.said.append), CommandReceiver(self.memory)

    def press(self, *names: str, view: TaskView | None = None, **window: Any) -> list[tuple[str, Command | None]]:
        self.keys.step(WindowFrame(**window), names, view or TaskView(), self.now_ns)
        self.now_ns += FRAME_NS
        return [(given.source.name, given.command) for given in self.desk.take()]

    @property
    def stops(self) -> int:
        return int(self.memory.stop_words.sum())


TRAVEL, PAUSED = TaskView(TrialState.TRAVEL), TaskView(TrialState.TRAVEL, paused=True)


@pytest.mark.parametrize(
    ("name", "view", "command"),
    [
        ("p", TRAVEL, Pause()),
        ("p", PAUSED, Resume()),
        ("pad_start", PAUSED, Resume()),
        ("h", TRAVEL, Pause()),
        ("h", PAUSED, None),
        ("h", TaskView(TrialState.READY), None),
        ("r", TRAVEL, Reset()),
        ("space", TRAVEL, Stop()),
        ("pad_b", TRAVEL, Stop()),
        ("enter", TaskView(TrialState.READY, reading=True), StartTrial()),
        ("mouse_left", TRAVEL, None),
        ("escape", TaskView(TrialState.REST), End()),
        ("escape", TaskView(TrialState.READY, reading=True), End()),
        ("x", TRAVEL, None),
    ],
)
def test_a_key_gives_its_command(name: str, view: TaskView, command: Command | None) -> None:
    source = "GAMEPAD" if name.startswith("pad_") else "KEYS"
    assert Keys().press(name, view=view) == ([] if command is None else [(source, command)])


def test_escape_is_asked_for_twice_during_a_trial() -> None:
    keys = Keys()
    assert keys.press("escape", view=TRAVEL) == [] and "again" in keys.keys.message
    assert keys.press("escape", view=TRAVEL) == [("KEYS", End())]
    late = Keys()
    late.press("escape", view=TRAVEL)
    late.now_ns += 5_000_000_000
    assert late.press(view=TRAVEL) == [] and not late.keys.message
    assert late.press("escape", view=TRAVEL) == []


def test_a_stop_lasts_while_its_key_is_held_and_is_told_once() -> None:
    keys = Keys()
    down = InputEvent("key", "space", pressed=True)
    assert keys.press("space", events=(down,)) == [("KEYS", Stop())]
    before = keys.stops
    assert keys.press() == [] and keys.stops == before + 1
    keys.press(events=(InputEvent("key", "space"),))
    before = keys.stops
    keys.press()
    assert keys.stops == before
    keys.press(gamepad=GamepadState("pad", buttons=frozenset({"b"})))
    assert keys.stops == before + 1


def test_a_refused_key_is_told_to_the_person() -> None:
    keys = Keys()
    keys.keys.step(WindowFrame(), ("r",), TRAVEL, 0)
    (given,) = keys.desk.take()
    keys.desk.answer(given, Answer(given.sequence, done=False, why="no stop is latched"))
    keys.press()
    assert keys.said == ["reset is refused: no stop is latched"]


def test_commands_of_a_list_come_at_their_times_and_wait_for_room() -> None:
    memory = SessionMemory(Capacities(commands=2))
    listed = [
        TimedCommand(1.0, Resume()),
        TimedCommand(0.5, Pause()),
        *[TimedCommand(0.0, Mark(str(i))) for i in range(3)],
    ]
    source, desk = TimedCommands(memory, listed, print), CommandReceiver(memory)
    taken = []
    for frame in range(80):
        source.step(5_000_000_000 + frame * FRAME_NS)
        taken += [(frame, given.command) for given in desk.take()]
    marks = [(0, Mark("0")), (0, Mark("1")), (1, Mark("2"))]
    assert taken == [*marks, (30, Pause()), (60, Resume())]


def test_a_file_of_commands_is_read(tmp_path: Path) -> None:
    file = tmp_path / "commands.json"
    file.write_text(
        '[{"t": 2, "command": "pause", "x-why": "cough"},'
        ' {"t": 0.5, "command": "set_parameter", "name": "radius", "value": 2}]'
    )
    assert read_command_file(file) == [TimedCommand(2.0, Pause()), TimedCommand(0.5, SetParameter("radius", 2.0))]


@pytest.mark.parametrize(
    ("entry", "pointer", "what"),
    [
        ({"command": "pause"}, "/0/t", "missing"),
        ({"t": -1, "command": "pause"}, "/0/t", "invalid"),
        ({"t": True, "command": "pause"}, "/0/t", "invalid"),
        ({"t": 0, "command": "pouse"}, "/0/command", "no command"),
        ({"t": 0, "command": "set_parameter", "name": "a"}, "/0", "value"),
        ({"t": 0, "command": "set_parameter", "name": "a", "value": "b"}, "/0/value", "float"),
        ({"t": 0, "command": "set_assistance", "share": 2}, "/0/share", "<= 1.0"),
        ({"t": 0, "command": "pause", "name": "a"}, "/0", "unknown field"),
        ([1], "/0", "not a command"),
    ],
)
def test_a_fault_of_a_file_has_its_place(entry: object, pointer: str, what: str, tmp_path: Path) -> None:
    file = tmp_path / "commands.json"
    file.write_text(json.dumps([entry]))
    with pytest.raises(SceneError) as caught:
        read_command_file(file)
    (issue,) = caught.value.issues
    assert issue.pointer == pointer and what in issue.what
