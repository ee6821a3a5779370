"""Further sources of commands: buttons of the device, markers of the lab streaming layer, the gamepad's views."""

from __future__ import annotations

import time

import pytest

from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.commands.command_records import CommandSource
from mimics_app.contracts.commands.vocabulary import Command, Mark, Note, Pause, Reset, StartTrial, Stop, View, refusal
from mimics_app.contracts.errors import DeviceError, UsageError
from mimics_app.contracts.loop.haptic import Button
from mimics_app.contracts.messages.trial_state import TaskView
from mimics_app.contracts.ports.input_port import WindowFrame
from mimics_app.contracts.shared_memory.command_ring import Answer, CommandReceiver
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.contracts.shared_memory.shared_words import STOP_STRIDE
from mimics_app.inputs.commands.device_buttons import DeviceButtons
from mimics_app.inputs.commands.keys import KeyCommands
from mimics_app.inputs.commands.marker_stream import MarkerStream, command_of_marker
from mimics_app.rendering.haptic.devices.button_commands import button_commands

PRIMARY = int(Button.PRIMARY)


def test_a_button_gives_its_command_once_and_is_told_of_a_refusal() -> None:
    memory, said = SessionMemory(), list[str]()
    buttons, desk = DeviceButtons(memory, button_commands({}), said.append), CommandReceiver(memory)
    for word in (PRIMARY, PRIMARY | Button.STOP, 0, PRIMARY):
        buttons.step(word, 0)
    given = desk.take()
    assert [(each.source, each.command) for each in given] == [(CommandSource.BUTTON, StartTrial())] * 2
    desk.answer(given[0], Answer(0, done=False, why="the trial is under way"))
    buttons.step(PRIMARY, 0)
    assert said == ["start_trial by the device's button is refused: the trial is under way"]


def test_a_button_that_stops_does_so_as_long_as_it_is_held() -> None:
    memory = SessionMemory()
    buttons = DeviceButtons(memory, button_commands({"primary": "stop"}), print)
    for word in (PRIMARY, PRIMARY, PRIMARY, 0, 0):
        buttons.step(word, 0)
    assert memory.stop_words[STOP_STRIDE * CommandSource.BUTTON] == 3
    assert [each.command for each in CommandReceiver(memory).take()] == [Stop()]


def test_the_scene_says_what_a_button_commands() -> None:
    assert button_commands({}) == {PRIMARY: StartTrial()}
    assert button_commands({"primary": "reset"}) == {PRIMARY: Reset()} and button_commands({"primary": ""}) == {}
    with pytest.raises(UsageError, match='there is no button "third"; known: primary'):
        button_commands({"third": "reset"})


@pytest.mark.parametrize(
    ("marker", "command"),
    [
        ("block 1", Mark("block 1")),
        (" Stop ", Stop()),
        ("", None),
        ("x" * 81, Note("x" * 81)),
        ('{"command": "note", "text": "a cough"}', Note("a cough")),
        ('{"command": "pause"}', Pause()),
    ],
)
def test_a_marker_is_a_command(marker: str, command: Command | None) -> None:
    assert command_of_marker(marker) == command
    if isinstance(command, Pause):
        assert refusal(command, CommandSource.LSL, simulated=True), "refused by the session, with the reason"


def test_markers_of_a_stream_are_given_by_a_thread_of_their_own() -> None:
    import pylsl

    name, memory, said = f"mimics markers {time.monotonic_ns()}", SessionMemory(), list[str]()
    outlet = pylsl.StreamOutlet(pylsl.StreamInfo(name, "Markers", 1, 0, "string", name))
    markers = MarkerStream(memory, name, MonotonicClock(), said.append)
    try:
        assert outlet.wait_for_consumers(10.0)
        for text in ("block 1", "{no command}", "stop"):
            outlet.push_sample([text])
        desk, given, end = CommandReceiver(memory), [], time.monotonic() + 10.0
        while len(given) < 2 and time.monotonic() < end:
            given += desk.take()
            time.sleep(0.01)
        assert [(each.source, each.who, each.command) for each in given] == [
            (CommandSource.LSL, name[:32], Mark("block 1")),
            (CommandSource.LSL, name[:32], Stop()),
        ]
        assert memory.stop_words[STOP_STRIDE * CommandSource.LSL] == 1
        assert len(said) == 1 and "no command" in said[0]
    finally:
        markers.close()


def test_a_stream_of_numbers_gives_no_commands() -> None:
    import pylsl

    name = f"mimics numbers {time.monotonic_ns()}"
    outlet = pylsl.StreamOutlet(pylsl.StreamInfo(name, "EEG", 1, 100, "float32", name))
    with pytest.raises(DeviceError, match="no text"):
        MarkerStream(SessionMemory(), name, MonotonicClock(), print)
    del outlet


@pytest.mark.parametrize(
    ("shown", "button", "view"),
    [
        ("", "pad_right_bumper", "b"),
        ("b", "pad_right_bumper", "c"),
        ("c", "pad_right_bumper", "a"),
        ("a", "pad_left_bumper", "c"),
    ],
)
def test_the_gamepad_goes_through_the_views(shown: str, button: str, view: str) -> None:
    memory = SessionMemory()
    keys, desk = KeyCommands(memory, print, ["a", "b", "c"], lambda: shown), CommandReceiver(memory)
    keys.step(WindowFrame(), (button,), TaskView(), 0)
    assert [(each.source, each.command) for each in desk.take()] == [(CommandSource.GAMEPAD, View(view))]


def test_a_scene_with_one_view_has_nothing_to_go_through() -> None:
    memory = SessionMemory()
    KeyCommands(memory, print, ["a"]).step(WindowFrame(), ("pad_right_bumper",), TaskView(), 0)
    assert not CommandReceiver(memory).take()
