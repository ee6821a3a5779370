"""`import mimics_app`: a scene played from Python, and its recording as arrays with units."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest

import mimics_app as mimics
from mimics_app.app.api.opened import Opened, Record
from mimics_app.app.api.unit_array import Quantity, Table
from mimics_app.contracts.loop.loop_ports import DevicePlugin
from mimics_app.contracts.system.resources import root
from mimics_app.learning.policies.rules import Staircase
from mimics_app.learning.policy import Choice
from mimics_app.recording.run import Run
from mimics_app.rendering.haptic.devices.request import DeviceRequest
from mimics_app.rendering.haptic.devices.simulated_hapticmaster import build_simulated_hapticmaster
from tests.support.command import mimics as command
from tests.support.xvfb import display

TUNNEL = root() / "scenes" / "wavy_tunnel.json"
PAGE = root() / "docs" / "python.md"
NOTEBOOK = root() / "examples" / "notebook" / "session_and_analysis.ipynb"


def test_the_examples_of_the_page_run(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    snippets = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    assert len(snippets) >= 10
    assert all(snippet.count("\n") <= 10 for snippet in snippets)
    names: dict[str, object] = {}
    for snippet in snippets:
        exec(compile(snippet, str(PAGE), "exec"), names)
    assert len(names["rows"]) >= 1  # type: ignore[arg-type]
    assert names["pixels"].std() > 5.0  # type: ignore[attr-defined]
    assert (names["paused"].done, names["wide"].done, names["wrong"].done) == (True, True, False)  # type: ignore[attr-defined]
    assert names["heard"].shape == pytest.approx((48_000, 2), abs=800)  # type: ignore[attr-defined]
    assert 'there is no setting "sed"; did you mean "seed"' in capsys.readouterr().out


def test_the_notebook_runs(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """But for its drawing: Matplotlib is the reader's own."""
    drawing = Mock(subplots=Mock(return_value=(Mock(), (Mock(), Mock()))))
    monkeypatch.setitem(sys.modules, "matplotlib", Mock(pyplot=drawing))
    monkeypatch.setitem(sys.modules, "matplotlib.pyplot", drawing)
    monkeypatch.chdir(tmp_path)
    cells = json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]
    names: dict[str, object] = {}
    for cell in cells:
        if cell["cell_type"] == "code":
            assert not cell["outputs"], "it is kept without what it printed"
            exec(compile("".join(cell["source"]), str(NOTEBOOK), "exec"), names)
    assert capsys.readouterr().out.count(", finished: ") == 3 and drawing.show.called  # the practice, too
    assert names["contacts"].rows == sum(names["trials"]["contacts"]) > 0  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [("side", "lft", 'did you mean "left"'), ("difficulty", "hard", 'did you mean "harder"'), ("profile", 3, "known:")],
)
def test_a_setting_that_is_none_of_its_words_is_refused(name: str, value: object, said: str) -> None:
    """A scene would be played on the wrong side without a word."""
    with pytest.raises(mimics.errors.UsageError, match=f'{name}: there is no "{value}"(.|\n)*{said}'):
        mimics.open("wavy_tunnel", record=False, **{name: value})  # type: ignore[arg-type]


def test_the_tour_shows_the_tick_in_which_a_wall_begins_to_push(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    page = (root() / "docs" / "guide" / "tour.md").read_text(encoding="utf-8")
    names: dict[str, object] = {}
    for snippet in re.findall(r"```python\n(.*?)```", page, re.DOTALL):
        exec(compile(snippet, "tour.md", "exec"), names)
    rows = np.array(names["rows"])
    depth, wall, person = rows[:, 1], rows[:, 3], rows[:, 4]
    assert depth[0] == 0.0 < depth[1] < depth[-1]
    assert wall[1] > 2.0 * wall[0] and person == pytest.approx(wall, abs=1e-9), "as the page says of its five lines"
    (table,) = re.findall(r"```text\n(.*?)```", page, re.DOTALL)
    printed = [[float(number) for number in re.findall(r"[\d.]+(?= [smN])", line)] for line in table.splitlines()]
    assert rows == pytest.approx(np.array(printed), abs=6e-3), "another compiler may differ in a last digit"


def test_played_in_steps_it_is_the_run_of_the_command(tmp_path: Path) -> None:
    done = command("run", TUNNEL, "--headless", "--seconds", "1.5", "--seed", "3", "--pictures", "0", "--json",
                   "--runs", tmp_path / "a")  # fmt: skip
    with mimics.open("wavy_tunnel", seed=3, seconds=1.5, runs=tmp_path / "b") as session:
        session.step(0.5)
        session.picture(64, 36)
        session.run()
    assert session.result["state_hash"] == json.loads(done.stdout)["state_hash"]
    assert session.run_dir.parent == tmp_path / "b"


def test_an_unrecorded_session_is_the_recorded_one_and_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)

    def played(record: Record) -> tuple[dict[str, bytes], Opened, list[dict[str, object]]]:
        rows: list[dict[str, object]] = []
        with mimics.open("wavy_tunnel", seed=3, trials=1, patient="healthy", seconds=20, record=record) as session:
            session.on_trial(rows.append)
            assert session.step_until(lambda s: s.orders.person_may_act) and "trial" in session.board.cards
            assert not session.step_until(lambda s: bool(s.trials), 1.0) and session.task["counted"] == "under way"
            session.step(18.0 - session.time_s)
            sent = session.command(mimics.Note("here"))
            session.step(0.5)
            assert sent.done and session.picture(64, 36).std() > 5.0
            state = {name: column.tobytes() for name, column in session.state.items()}
        return state, session, rows

    state, kept, rows = played("memory")
    assert rows and not list(tmp_path.iterdir())
    recorded_state, recorded, recorded_rows = played(record=True)
    assert state == recorded_state and rows == recorded_rows
    assert set(recorded.result) - set(kept.result) == {"seed", "run_dir", "audio", "state_hash"}
    assert kept.result["unread"] == [*recorded.result["unread"], "sound"]
    assert all(kept.result[name] == recorded.result[name] for name in set(kept.result) - {"wall_s", "unread"})
    recording = mimics.load(recorded.run_dir)
    assert kept.haptic.units == recording.haptic.units and kept.haptic.rows == 18_500
    for name, column in recording.haptic.items():
        np.testing.assert_array_equal(kept.haptic[name], column, name)
    for source, kind in (("app", "frame"), ("app", "command"), ("app", "state"), ("loop", "state")):
        ours, theirs = (of.events.where(source=source, kind=kind) for of in (kept, recording))
        assert ours.rows == theirs.rows > 0, kind
        np.testing.assert_array_equal(ours["t_s"], theirs["t_s"], kind)


def test_what_needs_a_recording_is_refused_without_one() -> None:
    for settings in ({"sound": "auto"}, {"window": True}):
        with pytest.raises(mimics.errors.UsageError, match="need a recorded session"):
            mimics.open("wavy_tunnel", record=False, **settings)
    with mimics.open("wavy_tunnel", record=False) as session:
        with pytest.raises(mimics.errors.UsageError, match="no run folder"):
            print(session.run_dir)
        with pytest.raises(mimics.errors.UsageError, match='record="memory"'):
            print(session.haptic)
    with pytest.raises(mimics.errors.UsageError, match="there is no 'disk'"):
        mimics.open("wavy_tunnel", record="disk")  # type: ignore[arg-type]
    with pytest.raises(mimics.errors.UsageError, match="another scene"), mimics.open("wavy_tunnel", record=False):
        mimics.open("wavy_tunnel")


def test_an_edited_scene_is_another_scene(tmp_path: Path) -> None:
    def played(**changes: float) -> dict[str, object]:
        with mimics.open("wavy_tunnel", seed=3, runs=tmp_path) as session:
            session.edit("tunnel", **changes)
            session.step(3.0)
        recorded = Run.open(session.run_dir).session["scene"]
        entities = {each["id"]: each["components"] for each in recorded["document"]["entities"]}
        assert all(entities["tunnel"]["tunnel"][name] == value for name, value in changes.items())
        return {"hash": recorded["hash"], **session.result}

    plain, soft, again = played(), played(stiffness=500.0), played(stiffness=np.float64(500.0))
    assert plain["hash"] != soft["hash"] == again["hash"]
    assert plain["state_hash"] != soft["state_hash"] == again["state_hash"]


def test_an_edited_task_is_played_and_recorded(tmp_path: Path) -> None:
    with mimics.open("wavy_tunnel", seed=3, runs=tmp_path) as session:
        session.edit(
            "task", trials=[{"name": "own", "trials": [{"label": "one"}]}], goals=[{"kind": "duration", "seconds": 1.0}]
        )
        session.step_until(lambda s: bool(s.trials), 20.0)
    (row,) = session.trials
    assert (row["label"], row["outcome"]) == ("one", "finished")
    assert Run.open(session.run_dir).session["scene"]["document"]["task"]["trials"][0]["name"] == "own"
    assert command("replay", session.run_dir).returncode == 0


@pytest.mark.parametrize(
    ("part", "values", "place"),
    [
        ("tunnel", {"stiffness": -1.0}, "components/tunnel"),
        ("task", {"time_limit_s": -1.0}, "#/task"),
        ("tunnel", {"stiffness": 1j}, "components/tunnel(.|\n)*complex"),
    ],
)
def test_a_wrong_edit_is_told_with_its_place_and_begins_nothing(
    part: str, values: dict[str, float], place: str, tmp_path: Path
) -> None:
    with mimics.open("wavy_tunnel", runs=tmp_path / "runs") as session:
        session.edit(part, **values)  # type: ignore[arg-type]
        with pytest.raises(mimics.errors.SceneError, match=place):
            session.step()
    assert not (tmp_path / "runs").exists()


def test_what_an_edit_does_not_find_is_refused_by_name() -> None:
    with mimics.open("pick_and_place", record=False) as session:
        for wrong, what in (
            (("tunel", "", {}), 'this scene has no component "tunel"'),
            (("patient", "robot", {}), 'the entity "robot" has no component "patient"'),
            (("patient", "", {"tremour": 0.0}), 'no field "tremour"(.|\n)*did you mean "tremor"'),
            (("mesh", "", {}), r'entities have a component "mesh"(.|\n)*name one of'),
        ):
            component, entity, values = wrong
            with pytest.raises(mimics.errors.UsageError, match=what):
                session.edit(component, entity, **values)
        session.step()
        with pytest.raises(mimics.errors.UsageError, match="has begun"):
            session.edit("patient", tremor=0.0)


def test_a_steered_session_replays(tmp_path: Path) -> None:
    with mimics.open("wavy_tunnel", seed=3, runs=tmp_path) as session:
        session.step(2.0)
        stop = session.command(mimics.Stop())
        session.step()
        assert stop.done and session.done, "latched, and nobody is here to reset it"
        reset = session.command(mimics.Reset())
        session.step(1.0)
        skipped = session.command(mimics.Skip())
        session.step(6.0)
        assert reset.done and skipped.done and session.trials[-1]["cause"] == "skipped"
        with pytest.raises(mimics.errors.UsageError, match="set_assistance"):
            session.command(mimics.SetAssistance(2.0))
    assert command("replay", session.run_dir).returncode == 0


def _build_own(request: DeviceRequest) -> DevicePlugin:
    return replace(build_simulated_hapticmaster(request), name="own")


def test_what_is_given_as_an_object_plays_and_is_asked(tmp_path: Path) -> None:
    class Hardest(Staircase):
        def act(self) -> Choice:
            return Choice(np.array([1.0]), np.array([1.0]))

    with mimics.open("wavy_tunnel", patient="healthy", learn=Hardest(), goal="success:0.7", device=_build_own,
                     seconds=30, runs=tmp_path) as session:  # fmt: skip
        while not session.trials and not session.done:
            session.step()
        session.step()
    recording = mimics.load(session.run_dir)
    assert recording.session["moved_by"]["device"] == "own"
    (choice,) = recording.run.lines_of("app", "choice")
    assert choice["at_trial"] == 1 and choice["values"], "asked for the demand of the next trial"
    assert command("replay", session.run_dir).returncode == 0
    with (
        mimics.open("wavy_tunnel", learn=Hardest(), goal="arousal:0:1", runs=tmp_path) as other,
        pytest.raises(mimics.errors.UsageError, match="cannot follow the goal"),
    ):
        other.step()


def test_a_window_is_played_in_steps_and_ended_by_a_command(tmp_path: Path) -> None:
    script = tmp_path / "play.py"
    script.write_text(
        "import mimics_app as mimics\n"
        f"runs = {str(tmp_path / 'runs')!r}\n"
        "with mimics.open('wavy_tunnel', window=True, size=(320, 180), sound='off', runs=runs) as s:\n"
        "    s.step(0.5)\n"
        "    paused = s.command(mimics.Pause())\n"
        "    s.step(0.5)\n"
        "    s.command(mimics.End())\n"
        "    result = s.run()\n"
        "print(paused.done, s.done, result['safety']['state'] != 'OFF', result['task']['completed'])\n"
    )
    with display("320x180x24") as screen:
        done = subprocess.run(
            [sys.executable, script], capture_output=True, text=True, check=False, cwd=root(),
            env={**os.environ, "DISPLAY": screen, "PYTHONPATH": str(root())},
        )  # fmt: skip
    assert done.stdout == "True True True 0\n", done.stderr


def test_silence_says_so(tmp_path: Path) -> None:
    with mimics.open("wavy_tunnel", runs=tmp_path) as session:
        session.step()
        with pytest.raises(mimics.errors.UsageError, match="no sound"):
            session.sound()


def test_a_script_without_a_guard_is_played_once(tmp_path: Path) -> None:
    """Recorder and sound are processes of their own, and must not import the program that opens the scene."""
    script = tmp_path / "play.py"
    script.write_text(
        "import mimics_app as mimics\n"
        f"with mimics.open('wavy_tunnel', seconds=0.5, runs={str(tmp_path / 'runs')!r}) as session:\n"
        "    print(session.run()['ticks'])\n"
    )
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, check=False, cwd=root())
    assert (done.stdout, done.returncode) == ("500\n", 0), done.stderr
    assert len(list((tmp_path / "runs").iterdir())) == 1


def test_one_scene_at_a_time_and_one_after_the_other(tmp_path: Path) -> None:
    with mimics.open("wavy_tunnel", runs=tmp_path) as session:
        with pytest.raises(mimics.errors.UsageError, match="another scene is open"):
            mimics.open("wavy_tunnel", runs=tmp_path)
        session.step()
    with pytest.raises(mimics.errors.UsageError):
        session.step()
    with mimics.open("wavy_tunnel", runs=tmp_path) as second:
        second.step()
    assert session.run_dir != second.run_dir


@pytest.mark.parametrize(
    ("settings", "what"),
    [
        ({"sed": 1}, 'no setting "sed"'),
        ({"headless": False}, 'no setting "headless"'),
        ({"device": "nothing"}, "nothing"),
    ],
)
def test_a_wrong_setting_is_refused_before_a_run_begins(settings: dict[str, object], what: str, tmp_path: Path) -> None:
    with pytest.raises(mimics.errors.MimicsError, match=what):
        mimics.open("wavy_tunnel", runs=tmp_path / "runs", **settings)
    assert not (tmp_path / "runs").exists()
    with mimics.open("wavy_tunnel", runs=tmp_path):
        pass  # a refusal leaves nothing open


@pytest.mark.parametrize("seconds", [0.0, -1.0, float("nan"), float("inf")])
def test_time_goes_forward(seconds: float, tmp_path: Path) -> None:
    with (
        mimics.open("wavy_tunnel", runs=tmp_path) as session,
        pytest.raises(mimics.errors.UsageError, match="cannot play"),
    ):
        session.step(seconds)


@pytest.mark.parametrize("name", ["run_0_1_0", "run_0_1_0_block", "run_0_1_0_objects", "run_0_1_0_tunnel"])
def test_a_recording_has_the_numbers_of_its_files(name: str) -> None:
    folder = root() / "tests" / "data" / name
    recording, run = mimics.load(folder), Run.open(folder)
    for column in ("t", "hip_world", "f_user_world"):
        np.testing.assert_array_equal(recording.haptic[column], run.haptic[column])
    assert recording.haptic.units["hip_world"] == "m" and recording.haptic["f_user_world"].units == "N"
    lines = [line for line in run.lines if line["source"] == "loop"]
    loop = recording.events.where(source="loop")
    assert loop.rows == len(lines)
    np.testing.assert_array_equal(loop["position_world"], [line["position_world"] for line in lines])
    np.testing.assert_array_equal(loop["kind"], [line["kind"] for line in lines])
    assert recording.trials.rows == len(run.trials)


def test_a_recording_that_was_cut_off_is_read_and_says_what_it_lacks(tmp_path: Path) -> None:
    source = root() / "tests" / "data" / "run_0_1_0"
    whole = mimics.load(source).haptic.rows
    for file in source.iterdir():
        data = file.read_bytes()
        if file.name != "manifest.json":
            (tmp_path / file.name).write_bytes(data[: len(data) * 2 // 3] if file.name == "haptic.arrows" else data)
    cut = mimics.load(tmp_path)
    assert 0 < cut.haptic.rows < whole
    assert any("never closed" in problem for problem in cut.problems)
    assert any("haptic.arrows" in problem or "ticks" in problem for problem in cut.problems)


def test_a_table_says_what_it_has() -> None:
    table = Table({"t": Quantity([0.0, 1.0], "s"), "p": Quantity(np.eye(2), "m"), "kind": Quantity(["a", "b"])})
    assert table.units == {"t": "s", "p": "m", "kind": ""}
    assert table["p"][0].units == "m" and not hasattr(table["p"] * 2.0, "units")
    assert table.where(kind="b")["t"].tolist() == [1.0]
    with pytest.raises(mimics.errors.UsageError, match='no column "T"'):
        table["T"]


def test_the_import_is_light() -> None:
    code = "import sys, mimics_app; print(len({m.split('.')[0] for m in sys.modules} & {'numpy', 'numba', 'moderngl'}))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=root())
    assert done.stdout == "0\n"
    assert {"open", "load", "errors"} <= set(dir(mimics)) | set(mimics.__all__)
    with pytest.raises(AttributeError, match="has no attribute"):
        mimics.lode  # type: ignore[attr-defined]  # noqa: B018
