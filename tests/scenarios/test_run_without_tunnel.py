"""A scene with neither tunnel nor carrying: its run, pictures and report speak of what it has, and of nothing else."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from mimics_app.contracts.system.resources import root
from mimics_app.recording.run import Run
from tests.support.command import mimics

SCENE = root() / "scenes" / "examples" / "free_objects.json"


@pytest.fixture(scope="module")
def answer(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    runs = tmp_path_factory.mktemp("runs")
    done = mimics("run", SCENE, "--headless", "--seconds", 4, "--pictures", 4, "--json", "--runs", runs)
    assert done.returncode == 0, done.stderr
    result: dict[str, Any] = json.loads(done.stdout)
    return result


def test_as_many_pictures_are_kept_as_were_asked_for_spread_over_the_run(answer: dict[str, Any]) -> None:
    frames = [int(Path(picture).stem.removeprefix("frame_")) for picture in answer["pictures"]]
    assert frames == [30, 90, 150, 210]  # 1/8, 3/8, 5/8 and 7/8 of 240 frames


def test_figures_that_do_not_apply_are_left_out(answer: dict[str, Any]) -> None:
    assert not {"path_error_m", "score", "placed", "drops", "bruises", "grasp_error_n"} & set(answer["task"])
    assert (answer["task"]["completed"], answer["task"]["trials"]) == (0, 0)
    assert not {"lateness_us", "lateness", "missed"} & set(answer)  # on a virtual clock no tick is late
    assert answer["unread"] == []
    absent = {"path_error_rms_m", "path_error_max_m", "progress", "drops", "bruises", "grasp_error_n", "score"}
    (row,) = Run.open(Path(answer["run_dir"])).trials
    assert not absent & set(row)


def test_its_report_is_about_no_tunnel(answer: dict[str, Any]) -> None:
    page = Path(answer["report"]).read_text()
    assert "Movement of the hand" in page
    shown = page.split("</style>")[1].split("<h2>Settings</h2>")[0]
    for word in ("tunnel", "bisector", "path error", "wall contacts", "0 of 0", ">-0<", "virtual clock</b>"):
        assert word not in shown, word


def test_without_a_display_the_terminal_says_who_plays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    options = ("--seconds", 0.2, "--pictures", 0, "--sound", "off", "--runs", tmp_path)
    for screen in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.setenv(screen, "")
    done = mimics("run", SCENE, *options)
    assert done.returncode == 0
    assert "mimics: no display: the simulated patient plays\n" in done.stderr
    assert done.stdout.splitlines()[0].split(maxsplit=1) == ["task", "no trial ended"]
    assert "0.0" not in done.stdout
    headless = mimics("run", SCENE, "--headless", *options)
    assert "no display" not in headless.stderr
