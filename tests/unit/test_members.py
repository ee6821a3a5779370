"""Devices and groups of methods are found by their files, and a broken file is named."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from mimics_app.contracts.ports.members import MemberError, load_member, member_names
from mimics_app.contracts.system.resources import root
from mimics_app.lab import groups
from mimics_app.lab.catalogue import GROUPS, load_methods
from mimics_app.rendering.haptic.devices import built_in
from mimics_app.rendering.haptic.devices.device_names import BUILT_IN, BuiltInDevice, load_built_in
from mimics_app.rendering.haptic.devices.registry import find_builder

ROW = '''"""A device that reads zeros."""

from mimics_app.rendering.haptic.devices.device_names import BuiltInDevice

DEVICE = BuiltInDevice(__doc__, "nobody", "zeros:build_zeros")
'''
ZEROS = """
import numpy as np
from mimics_app.contracts.loop.loop_ports import DevicePlugin
from mimics_app.rendering.haptic.devices.replay import ignore_command, read_recorded

def build_zeros(request):
    return DevicePlugin("zeros", read_recorded, ignore_command, np.zeros(100))
"""
SUMS = """
from mimics_app.lab.rivals import Probes, Rival, compare

compare(
    __name__, "a sum of two numbers", "1",
    [Rival(name, "by hand", "any", {"by": name}) for name in ("one", "other")],
    Probes(lambda name: 1.0, lambda name: 0.0), default="one", few="a planted group",
)
"""


def run_beside(code: str, folder: Path) -> str:
    """Return what a process prints that runs code with the folder as its argument."""
    command = [sys.executable, "-c", f"import sys\n{code}", str(folder)]
    done = subprocess.run(command, cwd=root(), capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.seconds
def test_a_module_among_the_built_in_devices_is_one(tmp_path: Path) -> None:
    (tmp_path / "built_in").mkdir()
    (tmp_path / "built_in" / "zero_robot.py").write_text(ROW)
    (tmp_path / "zeros.py").write_text(ZEROS)
    said = run_beside(
        """
from mimics_app.rendering.haptic import devices
from mimics_app.rendering.haptic.devices import built_in
devices.__path__.append(sys.argv[1])
built_in.__path__.append(sys.argv[1] + "/built_in")
from mimics_app.app.commands.devices import find_all
print(*(row["about"] for row in find_all()["devices"] if row["name"] == "zero_robot"))
assert "numba" not in sys.modules, "a list compiles nothing"
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.world.components.robot import Robot
print(build_device(Robot(device="zero_robot")).name)
""",
        tmp_path,
    )
    assert said.splitlines() == ["A device that reads zeros.", "zeros"]


def test_a_module_among_the_groups_of_methods_is_one(tmp_path: Path) -> None:
    (tmp_path / "sums_of_two.py").write_text(SUMS)
    said = run_beside(
        """
from mimics_app.lab import groups
groups.__path__.append(sys.argv[1])
from mimics_app.lab.catalogue import all_groups, load_methods
assert "sums of two" in all_groups()
print(*(rival.name for rival in load_methods(["sums of two"]).rivals("sums of two")))
assert [name for name in sys.modules if name.startswith(groups.__name__ + ".")] == [groups.__name__ + ".sums_of_two"]
""",
        tmp_path,
    )
    assert said.split() == ["one", "other"]


@pytest.mark.parametrize("name", BUILT_IN)
def test_every_built_in_device_says_what_it_is_and_who_plays(name: str) -> None:
    device = load_built_in(name)
    assert device.about.endswith(".") and device.caption
    assert callable(find_builder(name))


def test_a_member_without_its_constant_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(built_in, "__path__", [str(tmp_path)])
    for name, text in {"bare_robot": "", "numbered_robot": "DEVICE = 7"}.items():
        (tmp_path / f"{name}.py").write_text(text)
        with pytest.raises(MemberError, match=rf"{name}\.py: .*built_in\.{name} has no DEVICE of type BuiltInDevice"):
            load_member(built_in, name, "DEVICE", BuiltInDevice)
    (tmp_path / "_notes.py").write_text("")
    assert member_names(built_in) == ("bare_robot", "numbered_robot")
    with pytest.raises(MemberError, match=r"absent_robot\.py is missing"):
        load_member(built_in, "absent_robot", "DEVICE", BuiltInDevice)


def test_a_member_that_lacks_a_library_says_which(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(built_in, "__path__", [str(tmp_path)])
    (tmp_path / "robot_of_a_library.py").write_text("import no_such_library")
    with pytest.raises(ModuleNotFoundError, match="no_such_library"):
        load_member(built_in, "robot_of_a_library", "DEVICE", BuiltInDevice)


def test_a_module_that_registers_no_method_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(groups, "__path__", [str(tmp_path)])
    monkeypatch.setitem(GROUPS, "differences", "differences")
    (tmp_path / "differences.py").write_text("")
    with pytest.raises(ImportError, match='registers no method of "differences"'):
        load_methods(["differences"])
