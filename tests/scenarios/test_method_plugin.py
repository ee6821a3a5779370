"""A group of methods of another package, with the scenario that runs them: measured, drawn, planned and run.

Nothing of the product knows it; it is installed as packages are, so it touches no existing file.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from mimics_app.contracts.system.resources import root
from tests.support.command import Answer, mimics, mimics_with
from tests.support.plugin_site import write_package

ENTRY_POINTS = """
[mimics_app.methods]
guessing = lab_of_guesses:GUESSES
broken = lab_of_guesses:no_such_thing
wrong = lab_of_guesses:Guesser
odd = lab_of_guesses:ODD
half = lab_of_guesses:HALF
bare = lab_of_guesses:BARE
[mimics_app.scenarios]
guesses = lab_of_guesses:Guesser
"""

PACKAGE = """
import math
from mimics_app.contracts.ports.method_table import Row
from mimics_app.contracts.ports.methods import Group, Method
from mimics_app.scenarios.parts.touch_scene import TouchScene
from mimics_app.world.components.robot import Robot
from mimics_app.world.files.scene.method_plugins import MethodPlugin, Use

GROUP = "square root"


def series(x, steps):
    guess = x
    for _ in range(steps):
        guess = 0.5 * (guess + x / guess)
    return guess


CALLS = 1000  # one call is as short as a step of the clock


def cost(steps):
    from mimics_app.lab.probe import shortest_us

    return shortest_us(lambda: [series(2.0, steps) for _ in range(CALLS)], CALLS)


def register(registry):
    from mimics_app.lab.probe import reference_us

    registry.describe(Group(GROUP, "the square root of 2", "m", "", reference_us, few="an example"))
    for steps in (1, 6):
        registry.register(Method(
            GROUP, f"{steps} steps", "Heron", lambda steps=steps: cost(steps),
            lambda steps=steps: abs(series(2.0, steps) - math.sqrt(2.0)), "m", "x > 0", {"steps": steps}, steps == 6))


GUESSES = MethodPlugin(
    GROUP, register,
    rows=(Row("1 steps", 0.0, 0.1, 0.0858, "m", {"steps": 1}), Row("6 steps", 0.0, 0.4, 2e-16, "m", {"steps": 6})),
    use=Use("square roots", lambda scene: scene.has(Robot)))


def half(registry):
    registry.register(Method(GROUP, "no step", "x", lambda: 1.0, lambda: 1.0, "m", "never", None))
    raise RuntimeError("half way")


HALF, BARE = MethodPlugin(GROUP, half), MethodPlugin("bare", lambda registry: None)
ODD = MethodPlugin("odd", lambda registry: None, (Row("a", 0.0, 1.0, 0.0, "parsec", {}),), Use("x", lambda scene: True))


class Guesser(TouchScene):
    @property
    def facts(self):
        return {**super().facts, "root": series(2.0, self._scene.methods[GROUP]["steps"])}
"""


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_package(tmp_path_factory.mktemp("site"), "lab_of_guesses", PACKAGE, ENTRY_POINTS)


def scene(folder: Path, position_m: float) -> Path:
    document = json.loads((root() / "scenes" / "examples" / "free_objects.json").read_text())
    document["scenario"] = "guesses"
    document.setdefault("systems", {})["tolerances"] = {"position_m": position_m}
    path = folder / f"guesses_{position_m}.json"
    path.write_text(json.dumps(document))
    return path


TOLERANCES = (0.1, 1e-9)
"""Of scenes that are run [m]."""


@pytest.fixture(scope="module")
def answers(installed: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[object, Answer]:
    """What commands say with the plug-in installed: runs by their tolerance, the others by name."""
    folder, charts = (tmp_path_factory.mktemp(name) for name in ("scenes", "charts"))
    options = ("--headless", "--seconds", 0.1, "--pictures", 0, "--sound", "off", "--json", "--runs", folder)
    commands: dict[object, tuple[object, ...]] = {
        "chart": ("lab", "chart", "square root", "--json", "--out", charts),
        "bare": ("lab", "measure", "bare"),
        "explain": ("explain", scene(folder, 0.1)),
        "doctor": ("doctor", "--json"),
    }
    for tolerance in TOLERANCES:
        commands[tolerance] = ("run", scene(folder, tolerance), *options)
    return dict(zip(commands, mimics_with(installed, *commands.values()), strict=True))


def test_it_is_measured_and_drawn_as_the_built_in_ones_are(answers: dict[object, Answer]) -> None:
    done = answers["chart"]
    assert done.returncode == 0, done.stderr
    (figure,) = json.loads(done.stdout)["figures"]
    assert (figure["default"], set(figure["front"])) == ("6 steps", {"1 steps", "6 steps"})
    assert "1 steps" in Path(figure["svg"]).read_text(encoding="utf-8")
    unknown = mimics("lab", "chart", "square root")
    assert unknown.returncode == 2 and 'no group of methods "square root"' in unknown.stderr


def test_of_methods_that_cannot_be_registered_whole_nothing_stays(answers: dict[object, Answer]) -> None:
    assert 'methods of lab_of_guesses for "square root" are left out: RuntimeError: half way' in answers["chart"].stderr
    assert "no step" not in answers["chart"].stdout
    done = answers["bare"]
    assert done.returncode == 2 and "Traceback" not in done.stderr
    assert 'group "bare" has no description, or no method' in done.stderr and "no method is left" in done.stderr


def test_the_planner_takes_the_cheapest_within_and_that_one_runs(answers: dict[object, Answer]) -> None:
    roots: dict[float, Any] = {}
    for tolerance in TOLERANCES:
        done = answers[tolerance]
        assert done.returncode == 0, done.stderr
        session = json.loads((Path(json.loads(done.stdout)["run_dir"]) / "session.json").read_text())
        roots[tolerance] = session["facts"]["root"]
        assert "square root" in json.dumps(session["plan"])
    assert roots[0.1] == 1.5 and roots[1e-9] == pytest.approx(2.0**0.5, abs=1e-12)
    said = "".join(answer.stderr for answer in answers.values())  # once in a process
    for name, why in {
        "broken": "its plug-in lab_of_guesses:no_such_thing cannot be imported: AttributeError",
        "wrong": "its plug-in lab_of_guesses:Guesser is not a mimics_app.world.files.scene.method_plugins.MethodPlugin",
        "odd": 'its plug-in lab_of_guesses:ODD has errors in "parsec", which no tolerance bounds',
    }.items():
        assert f'mimics: the entry of methods "{name}" is left out: {why}' in said


def test_explain_says_what_it_costs_and_errs(answers: dict[object, Answer]) -> None:
    done = answers["explain"]
    assert done.returncode == 0, done.stderr
    assert "square roots" in done.stdout and "1 steps" in done.stdout


def test_doctor_says_which_cannot_be_had(answers: dict[object, Answer]) -> None:
    rows = json.loads(answers["doctor"].stdout)["plugins"]
    faults = {row["name"]: row["error"] for row in rows if row["group"] == "mimics_app.methods"}
    assert faults["guessing"] == ""
    assert "AttributeError" in faults["broken"] and "is not a mimics_app" in faults["wrong"]
