"""System packages: asked of the loader and of PATH, shown as one line to type."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from mimics_app.app.installation import system_packages
from mimics_app.app.installation.system_packages import NEEDS, SystemNeed, apt_line, missing

ROOT = Path(__file__).resolve().parents[2]
KINDS = ("run", "optional", "test", "test-optional")


def test_library_that_loads_is_found_by_its_name() -> None:
    assert SystemNeed("libc6", "everything", libraries=("libnope.so.9", "libc.so.6")).found() == "libc.so.6"


def test_library_that_is_absent_is_missing() -> None:
    assert SystemNeed("nope", "nothing", libraries=("libnope.so.9",)).found() == ""


def test_program_is_looked_for_on_the_path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    program = tmp_path / "Xnest"
    need = SystemNeed("xnest", "tests", kind="test", program="Xnest")
    monkeypatch.setenv("PATH", str(tmp_path))
    assert need.found() == ""
    program.write_text("#!/bin/sh\n")
    program.chmod(0o755)
    assert need.found() == str(program)


def test_driver_without_a_loadable_name_is_looked_for_as_a_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(system_packages, "_FOLDERS", (f"{tmp_path}/*/dri",))
    need = SystemNeed("libgl1-mesa-dri", "drawing", files=("swrast_dri.so", "libgallium-*.so"))
    assert need.found() == ""
    driver = tmp_path / "x86_64-linux-gnu" / "dri" / "libgallium-25.0.so"
    driver.parent.mkdir(parents=True)
    driver.touch()
    assert need.found() == str(driver)


def test_kinds_are_kept_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    """One unknown package name fails a whole apt line: what a distribution may have dropped stands alone."""
    monkeypatch.setattr(SystemNeed, "found", lambda need: "")
    for kind in KINDS:
        assert {need.kind for need in missing([kind])} == {kind}
    assert "libosmesa6" not in apt_line(missing(["run", "test"]))


def test_one_line_to_type() -> None:
    assert apt_line(NEEDS[:2]) == "sudo apt-get install -y libegl1 libgl1"


def test_every_need_says_how_it_is_found_and_what_it_is_for() -> None:
    for need in NEEDS:
        assert need.libraries or need.files or need.program
        assert need.purpose
        assert need.kind in KINDS


def test_every_program_that_a_test_looks_for_is_installed_for_the_tests() -> None:
    """A proof that is skipped wherever nobody happened to install its tool is none."""
    listening = ("pulseaudio", "parec")
    sources = [file.read_text(encoding="utf-8") for file in (ROOT / "tests").rglob("*.py")]
    looked_for = {name for text in sources for name in re.findall(r'\bwhich\("([^"]+)"\)', text)}
    brought = {need.program for need in NEEDS if need.kind.startswith("test")}
    by_hand = {"make", "google-chrome", "chromium-browser", "bids-validator-deno", "chrt"}
    # how tests are started; other names of a browser; a judge of PyPI; util-linux, without which there is no Debian
    assert {*looked_for, *listening} - by_hand <= brought
    assert len(looked_for) >= 3, "they are found"


def test_the_measured_head_is_installed_for_the_tests() -> None:
    """What the mixer is judged by: without it, its test is skipped."""
    from mimics_app.lab import audio_bench

    brought = [name for need in NEEDS if need.kind.startswith("test") for name in need.files]
    assert audio_bench.KEMAR.name in brought and str(audio_bench.KEMAR.parent).startswith("/usr/share/")


def test_every_package_that_a_test_imports_is_pinned() -> None:
    """None is skipped for want of a Python package but what cannot be pinned; the pins hold all others."""
    # brainflow needs an older setuptools than the pinned one; NeuroKit2 and Blender are large, and rivals only; wfdb
    # brings a web client and tables for one of four sources of a test
    apart = {"test_blender.py", "test_board_source.py", "test_neurokit.py", "test_signal_sources_in_runs.py"}
    # liblsl is a system's library, and the judges of the exports are larger than what they judge (group "judges")
    apart |= {"test_lsl_outlets.py", "test_lsl_flood.py", "test_lsl_beside_load.py"}
    apart |= {"test_exported_files.py", "test_exporters.py", "test_export_memory.py"}
    apart |= {"test_study_hostile.py"}  # brainflow, for a message of its own
    for file in (ROOT / "tests").rglob("test_*.py"):
        if file != Path(__file__) and file.name not in apart:
            assert not re.search(r"importorskip\(|util\.find_spec\(", file.read_text(encoding="utf-8")), file
    pins = (ROOT / "requirements-test.txt").read_text(encoding="utf-8")
    assert all(re.search(rf"^{name}==", pins, re.MULTILINE) for name in ("mujoco-core", "distributed"))


def test_script_runs_on_a_bare_interpreter() -> None:
    """Set-up asks it before anything is installed: -S and -I leave the standard library only."""
    script = Path(system_packages.__file__)
    command = [sys.executable, "-I", "-S", str(script), "run", "test"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.split() == [need.package for need in missing(["run", "test"])]
