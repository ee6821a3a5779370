"""What a person asks of the picture of a live run: layers, kept pictures, shaders of another mind."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import msgspec
import numpy as np
import pytest

from mimics_app.app.play.reload import SceneReload
from mimics_app.app.play.session_keys import OPERATORS_PAGE
from mimics_app.app.play.view_keys import ViewKeys, rate_note
from mimics_app.contracts.clock import VirtualClock
from mimics_app.contracts.errors import DeviceError, Issue
from mimics_app.contracts.loop.haptic import EVENT
from mimics_app.contracts.messages.stage_messages import TaskOrders
from mimics_app.contracts.messages.trial_state import TaskView, TrialState
from mimics_app.contracts.messages.window_input import InputEvent
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.visual.figures.key_page import KeyPage
from mimics_app.tasks.task import TaskSpec
from mimics_app.world.files.scene.file import load_scene
from tests.support.task_play import Player, make_manager


class Picture:
    """As much of a picture as is requested here."""

    def __init__(self, issues: list[Issue] | None = None) -> None:
        self.layers: set[str] = set()
        overlay = SimpleNamespace(
            note="", toggle=lambda layer: self.layers.symmetric_difference_update({layer}), arrows=[]
        )
        self.renderer = SimpleNamespace(
            overlay=overlay, shows=lambda layer: layer in self.layers, reload_shaders=lambda: issues or []
        )
        self.abandoned = False
        self.page: KeyPage | None = None

    def save(self, file: Path) -> None:
        file.write_bytes(b"a picture")

    def abandon(self) -> None:
        self.abandoned = True


def make_session(folder: Path, picture: Picture | None, *events: InputEvent) -> SimpleNamespace:
    journal: list[tuple[str, dict]] = []
    return SimpleNamespace(
        picture=picture,
        folder=folder,
        clock=VirtualClock(),
        trouble="",
        settings=SimpleNamespace(journey=None),
        haptics=SimpleNamespace(plugin=SimpleNamespace(name="pointer", simulated=True, descriptor=None)),
        journal=journal,
        scene=load_scene(root() / "scenes" / "wavy_tunnel.json"),
        recorder=SimpleNamespace(journal=lambda kind, data: journal.append((kind, data))),
        inputs=SimpleNamespace(frame=SimpleNamespace(events=events)),
    )


def press(name: str) -> InputEvent:
    return InputEvent("key", name, True)


def make_frames() -> SimpleNamespace:
    push = np.array([4.0, 0.0, 0.0])
    still = np.zeros(3)
    point = SimpleNamespace(ball_radius=0.02, hip_world=still, f_user_world=push, f_meas_world=still, f_grip=still)
    snapshot = SimpleNamespace(points=(point,), **vars(point))
    return SimpleNamespace(snapshot=snapshot, events=np.zeros(0, EVENT), orders=TaskOrders())


def seen(state: TrialState, trial: int, *, reading: bool = False) -> SimpleNamespace:
    frames = make_frames()
    frames.orders = TaskOrders(view=TaskView(state, trial=trial, reading=reading))
    return frames


def test_h_shows_what_to_do_then_the_operators_keys_then_nothing(tmp_path):
    session = make_session(tmp_path, picture := Picture(), press("h"))
    keys, shown = ViewKeys(session), []
    for _ in range(4):
        keys.step(make_frames())
        shown.append(picture.page)
    assert ("Space, gamepad B", "stop the force at once") in shown[0].keys and "green" in shown[0].words
    assert shown[1] is OPERATORS_PAGE and shown[2] is None and shown[3] == shown[0]
    assert not {key for key, _ in shown[0].keys} & {"F1", "F2", "F3", "F4", "F5", "F6", "F12"}, "not for the person"


def test_escape_closes_a_page_so_that_what_it_asks_is_seen(tmp_path):
    session = make_session(tmp_path, picture := Picture(), press("h"))
    keys = ViewKeys(session)
    keys.step(seen(TrialState.TRAVEL, 1))
    assert picture.page is not None
    session.inputs.frame.events = (press("escape"),)
    keys.step(seen(TrialState.TRAVEL, 1))
    assert picture.page is None


@pytest.mark.parametrize(
    ("device", "waits"), [("pointer", "Enter, click"), ("simulated_hapticmaster", "Begins on its own")]
)
def test_a_person_reads_what_to_do_until_the_first_trial_begins(tmp_path, device, waits):
    session = make_session(tmp_path, picture := Picture())
    session.settings.journey, session.haptics.plugin.name = tmp_path, device
    keys = ViewKeys(session)
    for state, reading, foot in (
        (TrialState.APPROACH, False, "One moment"),
        (TrialState.READY, True, waits),
        (TrialState.TRAVEL, False, ""),
    ):
        keys.step(seen(state, 1, reading=reading))
        assert picture.page.foot.startswith(foot) if foot else picture.page is None
    keys.step(seen(TrialState.READY, 2))
    assert picture.page is None


@pytest.mark.parametrize(
    ("pressed", "line"), [(False, "The robot moves to the start. Space stops it"), (True, "Paused. Press P to resume")]
)
def test_a_drive_and_a_pause_are_announced_on_the_page_before_the_first_trial(tmp_path, pressed, line):
    """What the task says of a robot that moves on its own must not be hidden by the page of what to do."""
    player = Player(make_manager(msgspec.convert({}, TaskSpec), introduced=True, waits=True))
    player.q = np.array([0.05, 0.1, 0.0])  # away from the start
    session = make_session(tmp_path, picture := Picture())
    session.settings.journey = tmp_path
    keys = ViewKeys(session)
    before = player.step()
    if pressed:
        before = player.step(pressed=("p",))
    keys.step(SimpleNamespace(snapshot=None, events=(), orders=before))
    assert player.scene["target"] == tuple(player.q), "it has not set out yet"
    assert picture.page.foot == line


def test_the_operators_keys_are_read_before_the_first_trial_too(tmp_path):
    session = make_session(tmp_path, picture := Picture())
    session.settings.journey = tmp_path
    keys = ViewKeys(session)
    keys.step(seen(TrialState.READY, 1, reading=True))
    session.inputs.frame.events = (press("h"),)
    keys.step(seen(TrialState.READY, 1, reading=True))
    session.inputs.frame.events = ()
    keys.step(seen(TrialState.READY, 1, reading=True))
    assert picture.page is OPERATORS_PAGE
    keys.step(seen(TrialState.TRAVEL, 1))
    assert picture.page is None


def test_arrows_are_laid_out_only_while_they_are_looked_at(tmp_path):
    picture = Picture()
    session = make_session(tmp_path, picture)
    keys = ViewKeys(session)
    keys.step(make_frames())
    assert picture.renderer.overlay.arrows == []
    session.inputs.frame.events = (press("f5"),)
    keys.step(make_frames())
    assert len(picture.renderer.overlay.arrows) == 1 and picture.layers == {"forces"}


def test_pictures_are_kept_in_the_run_and_reported(tmp_path, capsys):
    keys = ViewKeys(make_session(tmp_path, Picture(), press("f12")))
    keys.step(make_frames())
    keys.step(make_frames())
    assert sorted(file.name for file in (tmp_path / "pictures").iterdir()) == ["kept_001.png", "kept_002.png"]
    assert capsys.readouterr().err.count("mimics: picture ") == 2


def test_without_a_picture_nothing_is_done(tmp_path):
    ViewKeys(make_session(tmp_path, None, press("f12"), press("f1"))).step(make_frames())
    assert list(tmp_path.iterdir()) == []


def test_a_picture_that_is_lost_is_reported_and_journalled(tmp_path, capsys):
    picture = Picture()
    session = make_session(tmp_path, picture)
    ViewKeys(session).end_without_picture(DeviceError("no context"))
    assert session.picture is None and picture.abandoned
    assert session.journal == [("picture", {"lost": "no context"})]
    assert "the picture is lost: no context; the run ends here" in capsys.readouterr().err


@pytest.mark.parametrize("issues", [[], [Issue("lit.frag", "line 7", "`what' undeclared")]])
def test_a_broken_shader_is_reported_over_the_picture_and_on_stderr(tmp_path, capsys, issues):
    reload = SceneReload(make_session(tmp_path, Picture(issues)))
    reload.check(between=True)
    wanted = "lit.frag#line 7: `what' undeclared"
    assert reload.message == (wanted if issues else "")
    assert capsys.readouterr().err == (f"mimics: {wanted}\n" if issues else "")


@pytest.mark.parametrize(
    ("times_ms", "lowered", "words"),
    [
        ([0.0], [], "full quality"),
        ([0.0, 40.0, 80.0], [], "25 frames per second; full quality"),
        ([0.0, 100.0], ["resolution scale 0.75", "resolution scale 0.5", "shadows off"],
         "10 frames per second; lowered: resolution scale 0.5, shadows off"),
    ],
)  # fmt: skip
def test_the_window_says_how_fast_it_is_and_what_was_given_up_for_it(times_ms, lowered, words):
    assert rate_note([round(1e6 * each) for each in times_ms], lowered) == words
