"""`mimics replay RUN --view` and `--video`: what is shown of a recorded run is what its own pictures show."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import soundfile
from PIL import Image, ImageGrab

from mimics_app.app.cli import main
from mimics_app.app.commands.replay import SPEEDS as OFFERED
from mimics_app.app.replay_view.event_marks import Mark, marks_of
from mimics_app.app.replay_view.pane import Panes
from mimics_app.app.replay_view.playhead import SPEEDS, Playhead
from mimics_app.app.replay_view.replay_film import quality_of
from mimics_app.app.replay_view.replay_sound import ReplaySound
from mimics_app.app.replay_view.replayed_scene import ReplayedScene, open_replay
from mimics_app.app.replay_view.time_bar import HEIGHT, TimeBar, clock_text
from mimics_app.app.session.replay import TaskFrame
from mimics_app.contracts.clock import SECOND_NS, VirtualClock
from mimics_app.contracts.messages.stage_messages import TaskOrders
from mimics_app.recording.run import Run
from mimics_app.rendering.visual.figures.hud import Hud
from mimics_app.rendering.visual.surfaces.headless import open_offscreen, read_pixels
from mimics_app.world.content.world import World
from tests.support.xvfb import display

_ROOT = Path(__file__).parents[2]
_SIZE = (320, 180)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Run folder of six seconds of the wavy tunnel, with three pictures of the session itself."""
    runs = tmp_path_factory.mktemp("replay_view")
    words = ["--headless", "--seconds", "6", "--pictures", "3", "--size", "320x180", "--sound", "off"]
    assert main(["run", "wavy_tunnel", *words, "--runs", str(runs)]) == 0
    return next(runs.iterdir())


@pytest.fixture(scope="module")
def replayed(folder: Path) -> ReplayedScene:
    return open_replay(Run.open(folder))


@pytest.fixture(scope="module")
def renamed(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> ReplayedScene:
    """The same run with a scene file whose title was changed, which no picture shows."""
    scene = tmp_path_factory.mktemp("renamed") / "wavy_tunnel.json"
    scene.write_text((_ROOT / "scenes/wavy_tunnel.json").read_text().replace('"Wavy tunnel"', '"Other tunnel"'))
    return open_replay(Run.open(folder), scene)


def drawn(panes: Panes, surface, run: ReplayedScene, number: int) -> np.ndarray:
    assert run.to(number)
    panes.draw(run.now_ns)
    return read_pixels(surface)[..., :3].astype(int)


def test_a_frame_is_shown_as_the_session_showed_it_whichever_was_shown_before(folder, replayed):
    """Session and replay draw the same world on the same driver: not a pixel differs, forwards and backwards."""
    files = sorted((folder / "pictures").glob("frame_*.png"))
    assert len(files) == 3 and not replayed.notes
    with open_offscreen("auto", _SIZE) as surface:
        panes = Panes(surface, [replayed], quality_of, "", forces=False)
        for file in (*files, *files[::-1], files[1]):
            wanted = np.array(Image.open(file)).astype(int)
            assert np.array_equal(drawn(panes, surface, replayed, int(file.stem[-6:])), wanted), file.name


def test_forces_are_drawn_over_the_world_and_can_be_left_out(replayed):
    """At its end the device measures 2 N, an arrow of 26 mm beside the ball."""
    number = 358
    with open_offscreen("auto", _SIZE) as surface:
        panes = Panes(surface, [replayed], quality_of, "", forces=False)
        plain = drawn(panes, surface, replayed, number)
        panes.toggle_forces()
        forced = drawn(panes, surface, replayed, number)
        panes.toggle_forces()
        assert np.array_equal(drawn(panes, surface, replayed, number), plain)
    changed = np.abs(forced - plain).max(axis=-1) > 20
    assert 5 < changed[42:].sum() < 0.05 * changed.size  # below the cards


def test_a_free_camera_turns_around_the_hand_until_a_view_is_selected(replayed):
    with open_offscreen("auto", _SIZE) as surface:
        panes = Panes(surface, [replayed], quality_of, "", forces=False)
        plain = drawn(panes, surface, replayed, 100)
        eye = panes.pictures[0].views[0].eye_world
        panes.orbit(300.0, 0.0)
        turned = drawn(panes, surface, replayed, 100)
        (view,) = panes.pictures[0].views
        clip = view.clip_from_world @ [*replayed.hand, 1.0]
        assert np.abs(clip[:2] / clip[3]).max() < 1e-5, "the hand is in the centre"
        before, now = eye - replayed.hand, view.eye_world - replayed.hand
        assert now[1] == pytest.approx(before[1]) and before[[0, 2]] @ now[[0, 2]] == pytest.approx(0.0, abs=1e-6)
        panes.zoom(1.0)
        nearer = panes.pictures[0].views[0].eye_world - replayed.hand
        assert np.linalg.norm(nearer) < np.linalg.norm(now) == pytest.approx(np.linalg.norm(before))
        assert panes.is_free and (turned != plain).any()
        panes.show_view(panes.views[0])
        assert np.array_equal(drawn(panes, surface, replayed, 100), plain) and not panes.is_free


def test_two_runs_stand_side_by_side_each_as_alone(replayed, renamed):
    with open_offscreen("auto", _SIZE) as surface:
        surface.resize((160, 180))
        alone = [Panes(surface, [replayed], quality_of, "", forces=False) for _ in range(2)]
        single = [drawn(*each) for each in zip(alone, [surface] * 2, [replayed] * 2, (60, 340), strict=True)]
        surface.resize(_SIZE)
        panes = Panes(surface, [replayed, renamed], quality_of, "", forces=False)
        replayed.to(60)
        both = drawn(panes, surface, renamed, 340)
    assert np.array_equal(both[:, :160], single[0]) and np.array_equal(both[:, 160:], single[1])


def test_a_film_has_a_picture_of_every_sixtieth_second_and_fewer_at_a_higher_speed(folder, tmp_path, capsys):
    film = tmp_path / "film"
    words = ["--video", str(film), "--speed", "8", "--plain", "--size", "96x54", "--json"]
    assert main(["replay", str(folder), *words]) == 0
    answer = json.loads(capsys.readouterr().out)
    pictures = sorted(film.glob("frame_*.png"))
    assert answer["files"] == [str(film)] and answer["frames"] == [360]
    assert len(pictures) == 1 + round(359 / 8)  # 359 sixtieths from the first frame to the last
    ball = [np.array(Image.open(file)).astype(int) for file in (pictures[0], pictures[-1])]
    assert (np.abs(ball[0] - ball[1]).max(axis=-1) > 20).sum() > 5


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--plain"], "--plain needs a picture"),
        (["--view", "--video", "a.mp4"], "give one of them"),
        (["--video", "film", "--scene", "no_such_scene"], "scene not found"),
        (["--video", "film", "--camera", "nose"], 'no camera "nose"'),
    ],
)
def test_what_cannot_be_shown_is_said(folder, words, message, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["replay", str(folder), *words]) in (2, 3)
    assert message in capsys.readouterr().err


def test_a_scene_that_was_changed_since_is_told(renamed):
    assert "changed since" in " ".join(renamed.notes)


def test_the_playhead_goes_by_its_speed_and_stays_within_the_run():
    head = Playhead(10 * SECOND_NS)
    head.advance(SECOND_NS)
    assert (head.time_ns, head.share) == (SECOND_NS, 0.1)
    head.change_speed(99)
    assert head.speed == 8.0
    head.advance(SECOND_NS // 2)
    assert head.time_ns == 5 * SECOND_NS
    head.toggle()
    head.advance(SECOND_NS)
    assert head.time_ns == 5 * SECOND_NS
    head.toggle()
    head.change_speed(-99)
    assert head.speed == 0.1
    head.advance(10 * SECOND_NS)
    assert head.time_ns == 6 * SECOND_NS
    head.seek(-5)
    assert head.time_ns == 0
    head.seek(99 * SECOND_NS)
    head.advance(1)
    assert (head.time_ns, head.playing) == (10 * SECOND_NS, False)
    head.toggle()
    assert (head.time_ns, head.playing) == (0, True)
    assert OFFERED == SPEEDS


def test_a_time_has_the_frame_that_was_on_the_screen_then(replayed):
    times = replayed.times_ns
    assert replayed.number_at(-1.0) == replayed.number_at(0.0) == 1
    for number in (2, 100, 360):
        assert replayed.number_at(times[number - 1]) == number
        assert replayed.number_at(times[number - 1] - 1) == number - 1
    assert replayed.number_at(1e18) == replayed.count == 360


def test_events_are_marks_at_their_times_on_the_bar(folder, replayed):
    """The begin of the trial stands in events.jsonl at the time of its frame."""
    begins = [line["t_ns"] for line in replayed.run.lines_of("app", "state") if line["state"] == "travel"]
    marks = marks_of(replayed.run, replayed.begun_ns)
    assert [mark.time_ns for mark in marks if mark.kind == "begin"] == [t - replayed.begun_ns for t in begins]
    hud, head = Hud(), Playhead(100)
    bar = TimeBar([Mark(0, "contact"), Mark(100, "stop"), Mark(101, "note")], 100)
    bar.draw(hud, head, "here")
    assert bar.time_at(hud, (0.0, 1.0)) == 0 and bar.time_at(hud, (hud.width, 1.0)) == 100
    assert bar.time_at(hud, (600.0, HEIGHT + 1.0)) is None
    boxes = hud.rows()["box"]
    ends = [x for x in np.arange(0.0, hud.width) if 0 < bar.time_at(hud, (x, 1.0)) < 100]
    stop = boxes[np.isclose(boxes[:, 2], 3.0)]  # three wide, once: the later note is beyond the run
    assert len(stop) == 1 and abs(stop[0, 0] + 1.5 - ends[-1]) < 8.0
    assert [clock_text(t) for t in (0, 62_500_000_000, 59_999_999_999)] == ["0:00.00", "1:02.50", "1:00.00"]


def test_a_person_holds_steps_and_seeks_in_the_window(folder):
    if shutil.which("xdotool") is None:
        pytest.skip("xdotool is not installed: apt-get install xdotool")
    with display("640x360x24") as name:
        environment = os.environ | {"DISPLAY": name, "PYTHONPATH": str(_ROOT)}
        command = [sys.executable, "-m", "mimics_app", "replay", str(folder), "--view", "--size", "640x360", "--json"]
        window = subprocess.Popen(command, env=environment, text=True, stdout=subprocess.PIPE)

        def send(*words: str) -> None:
            subprocess.run(["xdotool", *words], env=environment, check=True, timeout=60)

        def shown() -> np.ndarray:
            return np.asarray(ImageGrab.grab(xdisplay=name).convert("RGB")).astype(int)

        def until(what: str, fits: Callable[[np.ndarray], bool]) -> np.ndarray:
            """The picture that fits and stands still."""
            same, last = 0, shown()
            for _ in range(300):
                time.sleep(0.15)
                last, earlier = shown(), last
                same = same + 1 if np.array_equal(last, earlier) and fits(last) else 0
                if same == 2:
                    return last
            pytest.fail(f"the window did not show {what}")

        def another(than: np.ndarray) -> Callable[[np.ndarray], bool]:
            return lambda picture: bool((picture != than).any())

        try:
            until("a picture", lambda picture: bool(picture.any()))
            send("key", "End")
            end = until("the end", lambda picture: bool(picture.any()))
            send("key", "Home")
            first = until("the first frame", another(end))
            send("key", "Right")
            second = until("the second frame", another(first))
            send("key", "Left")
            until("the first frame again", lambda picture: np.array_equal(picture, first))
            send("mousemove", "300", "349", "click", "1")
            until("the middle", lambda picture: another(first)(picture) and another(second)(picture))
            send("key", "End")
            until("the end again", lambda picture: np.array_equal(picture, end))
            send("mousemove", "320", "150", "mousedown", "3", "mousemove", "380", "130", "mouseup", "3")
            turned = until("another side", another(end))
            send("click", "4")
            until("it from nearer", lambda picture: another(turned)(picture) and another(end)(picture))
            send("key", "1")
            until("the view of the scene", lambda picture: np.array_equal(picture, end))
            send("key", "Escape")
            told, _ = window.communicate(timeout=60)
        finally:
            window.kill()
            window.wait()
    assert window.returncode == 0 and json.loads(told)["frames"] == [360]


def test_a_body_that_is_not_there_any_more_is_said_and_the_scene_is_shown(folder: Path, tmp_path: Path) -> None:
    copied = tmp_path / folder.name
    shutil.copytree(folder, copied)
    header = json.loads((copied / "session.json").read_text())
    (copied / "session.json").write_text(json.dumps({**header, "edit": {"avatar": str(tmp_path / "gone.glb")}}))
    shown = open_replay(Run.open(copied))
    assert len(shown.notes) == 1 and f"{tmp_path / 'gone.glb'}, is not there any more" in shown.notes[0]


_TOUCHED = ["--seconds", "8.2", "--seed", "7"]
"""Long enough for the simulated person to strike glass and steel, whose sounds follow the force."""


@pytest.mark.parametrize(
    ("scene", "more", "leap"),
    [
        ("wavy_tunnel", ["--patient", "severe", "--seconds", "7"], (300, 345)),
        ("soccer", ["--seconds", "7"], (300, 345)),
        (str(_ROOT / "scenes/examples/surfaces.json"), _TOUCHED, None),
    ],
)
def test_the_sounds_of_a_replay_are_those_of_the_session_but_for_a_leap(tmp_path, scene, more, leap):
    """On the clock of the session every sample is that of its file: also where forces drive the sound, or sliding."""
    words = ["run", scene, *more, "--headless", "--pictures", "0", "--sound", "file", "--runs", str(tmp_path)]
    assert main(words) == 0
    replayed = open_replay(Run.open(next(tmp_path.iterdir())))
    wanted = [(line["sound"], line["t_ns"]) for line in replayed.run.lines_of("app", "sound")]
    sounds, mixed = played(replayed, leap=None)
    assert sounds == wanted and len(wanted) >= 2
    file, _ = soundfile.read(replayed.run.folder / "sound.wav", dtype="float32")
    assert len(mixed) == len(file) and np.abs(file).max() > 0.01
    assert np.abs(mixed.clip(-1.0, 1.0) - file).max() <= 2.0 / 32768.0
    if leap is None:
        assert any(":live:" in name for name, _ in wanted)
        return
    begin_ns, end_ns = (int(replayed.begun_ns + replayed.times_ns[number - 1]) for number in leap)
    heard = [t_ns for _, t_ns in wanted if not begin_ns < t_ns <= end_ns]
    assert [t_ns for _, t_ns in played(replayed, leap)[0]] == heard and 0 < len(heard) < len(wanted)


def played(replayed: ReplayedScene, leap: tuple[int, int] | None) -> tuple[list[tuple[str, int]], np.ndarray]:
    """Replay a run from its first frame on; return name and time of each sound, and the mix [n, channels]."""
    clock = VirtualClock()
    sound = ReplaySound(replayed, clock, live=False)
    blocks: list[np.ndarray] = []
    sound._sound.output.listener = lambda block: blocks.append(block.copy())

    def listen(frame: TaskFrame, orders: TaskOrders, world: World) -> None:
        clock.sleep_until_ns(frame.now_ns)
        number = int(np.searchsorted(replayed.times_ns, frame.now_ns - replayed.begun_ns)) + 1
        sound.set_audible(on=leap is None or not leap[0] < number <= leap[1])
        sound.step(frame, orders, world)

    replayed.listener = listen
    replayed._restart()
    replayed.to(replayed.count)
    replayed.listener = None
    report = sound.close()
    assert report is not None
    return [(row.sound, row.t_ns) for row in report.rows], np.concatenate(blocks)
