"""A display and a tracker of another package, installed as packages are: no file of the product is touched."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from mimics_app.contracts.ports.display_choice import DISPLAY_KINDS
from mimics_app.contracts.ports.tracker_port import TRACKER_KINDS
from mimics_app.contracts.system.resources import root
from mimics_app.inputs.trackers import tracker_kinds
from mimics_app.rendering.visual.displays import display_kinds
from tests.support.command import Answer, mimics_with
from tests.support.plugin_site import write_package

ENTRY_POINTS = """
[mimics_app.displays]
upper_half = lab_of_devices:UpperHalf
[mimics_app.trackers]
rail = lab_of_devices:Rail
"""

PACKAGE = '''
from mimics_app.contracts.ports.display_port import Eye
from mimics_app.contracts.ports.tracker_port import TrackerSample
from mimics_app.inputs.trackers.polled_tracker import PolledTracker
from mimics_app.rendering.visual.displays.plain_display import PlainDisplay


class UpperHalf(PlainDisplay):
    """The picture in the upper half of the screen."""

    def __init__(self, request):
        super().__init__()
        self.kind = request.kind

    def eyes(self, viewpoint, drawn, display_ns):
        width, height = drawn[0], drawn[1] // 2
        return [Eye("", viewpoint.world_from_head, (-0.8, 0.8, -0.4, 0.4), (0, height, width, height))]


class Rail(PolledTracker):
    """A sensor that slides along x at 1 m/s."""

    def __init__(self, request):
        super().__init__(request.spec.name)

    def _report(self, now_ns, sink):
        sink(TrackerSample("1", now_ns, (1e-9 * now_ns, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)))
'''


def scene(folder: Path, **systems: Any) -> Path:
    document = json.loads((root() / "scenes" / "examples" / "free_objects.json").read_text())
    document["systems"] = document.get("systems", {}) | systems
    path = folder / "scene.json"
    path.write_text(json.dumps(document))
    return path


def rail(kind: str) -> dict[str, Any]:
    return {"devices": [{"name": "rail", "kind": kind, "roles": {"1": "head"}}], "tape": True}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("runs")


@pytest.fixture(scope="module")
def answers(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Answer]:
    """What commands say with the package installed, by name."""
    site = write_package(tmp_path_factory.mktemp("site"), "lab_of_devices", PACKAGE, ENTRY_POINTS)
    good, wrong = (tmp_path_factory.mktemp("scene") for _ in range(2))
    used = scene(good, display={"kind": "upper_half"}, trackers=rail("rail"))
    commands = {
        "check": ("check", used),
        "wrong": ("check", scene(wrong, display={"kind": "upper_haf"}, trackers=rail("rial"))),
        "render": ("render", used, "--size", "64x64", "--seconds", 0.1, "--output", folder / "frames"),
        "run": ("run", used, "--headless", "--seconds", 0.2, "--sound", "off", "--runs", folder / "runs"),
        "devices": ("devices", "--json"),
        "doctor": ("doctor", "--json"),
    }
    return dict(zip(commands, mimics_with(site, *commands.values()), strict=True))


def test_a_scene_names_them(answers: dict[str, Answer]) -> None:
    assert answers["check"].returncode == 0, answers["check"].stderr


def test_a_mistyped_name_is_reported_with_its_place(answers: dict[str, Answer]) -> None:
    assert answers["wrong"].returncode == 3
    assert (
        '#/systems/display/kind: there is no display "upper_haf"; did you mean "upper_half"' in answers["wrong"].stderr
    )
    assert '#/systems/trackers/devices/0/kind: there is no tracker "rial"' in answers["wrong"].stderr


def test_the_display_shows_the_picture(answers: dict[str, Answer], folder: Path) -> None:
    assert answers["render"].returncode == 0, answers["render"].stderr
    (file,) = (folder / "frames").glob("*.png")
    upper, lower = np.split(np.asarray(Image.open(file).convert("L"), float), 2)
    assert upper.std() > 5.0 and lower.std() == 0.0


def test_the_tracker_is_heard(answers: dict[str, Answer], folder: Path) -> None:
    assert answers["run"].returncode == 0, answers["run"].stderr
    (tape,) = (folder / "runs").rglob("trackers.jsonl")
    places = [json.loads(line).get("position", [0.0])[0] for line in tape.read_text().splitlines()]
    assert max(places) == pytest.approx(0.2, abs=0.05)


def test_commands_list_them(answers: dict[str, Answer]) -> None:
    assert '"upper_half"' in answers["devices"].stdout
    assert "upper_half" in answers["doctor"].stdout and "rail" in answers["doctor"].stdout


def test_every_built_in_kind_has_a_builder() -> None:
    assert set(display_kinds.BUILT_IN) == set(DISPLAY_KINDS)
    assert set(tracker_kinds.BUILT_IN) == set(TRACKER_KINDS)
