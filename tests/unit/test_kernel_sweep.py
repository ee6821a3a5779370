"""Machine code that nobody uses goes after 30 days, the present one never, and several processes may sweep."""

from __future__ import annotations

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from mimics_app.compiled import kernel_sweep
from mimics_app.compiled.kernel_sweep import cache_bytes, mark_used, sweep
from mimics_app.contracts.clock import wall_time
from mimics_app.contracts.system.resources import root

_DAY_S = 86_400.0


def _kept(base: Path, name: str, days: float) -> Path:
    """A folder with a file of machine code that was last used some days ago."""
    folder = base / name
    folder.mkdir(parents=True)
    (folder / "code.nbc").write_bytes(b"\x90" * 100)
    then = wall_time().timestamp() - days * _DAY_S
    os.utime(folder, (then, then))
    return folder


def _never(_: str) -> bool:
    return False


def test_what_was_not_used_for_thirty_days_goes(tmp_path: Path) -> None:
    old = _kept(tmp_path / "kernels-now", "mimics_app.tick-0", 31.0)
    used = _kept(tmp_path / "kernels-now", "mimics_app.tick-1", 29.0)
    older_version = _kept(tmp_path / "kernels-before", "mimics_app.tick-0", 40.0)
    without_folders = _kept(tmp_path, "kernels-of_a_version_that_kept_files", 40.0)
    foreign = _kept(tmp_path, "mesa_shader_cache", 400.0)
    assert sorted(sweep(tmp_path, _never)) == sorted([old, older_version, without_folders])
    assert used.is_dir() and foreign.is_dir()
    assert not list(tmp_path.rglob(".going-*"))


def test_the_present_one_stays_however_old(tmp_path: Path) -> None:
    present = _kept(tmp_path / "kernels-now", "mimics_app.tick-1", 400.0)
    assert sweep(tmp_path, lambda name: name == "mimics_app.tick-1") == []
    assert present.is_dir()


def test_use_is_marked_once_a_day(tmp_path: Path) -> None:
    used, unused = (_kept(tmp_path / "kernels-now", f"mimics_app.tick-{number}", 31.0) for number in range(2))
    mark_used(used)
    mark_used(tmp_path / "kernels-now" / "not_there")
    assert sweep(tmp_path, _never) == [unused]
    marked = _kept(tmp_path / "kernels-now", "mimics_app.tick-2", 0.5)
    before = marked.stat().st_mtime
    mark_used(marked)
    assert marked.stat().st_mtime == before


def test_processes_that_sweep_together_share_the_work(tmp_path: Path) -> None:
    for number in range(60):
        _kept(tmp_path / "kernels-now", f"mimics_app.tick-{number}", 31.0)
    with ThreadPoolExecutor(4) as pool:
        gone = [each for found in pool.map(lambda _: sweep(tmp_path, _never), range(4)) for each in found]
    assert len(gone) == len(set(gone)) == 60


def test_a_sweep_that_was_broken_off_is_finished_by_the_next(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _kept(tmp_path / "kernels-now", "mimics_app.tick-0", 31.0)
    _kept(tmp_path, "kernels-before", 31.0)
    with monkeypatch.context() as broken:
        broken.setattr(kernel_sweep.shutil, "rmtree", lambda *_, **__: None)
        sweep(tmp_path, _never)
    assert len(list(tmp_path.rglob(".going-*"))) == 2
    sweep(tmp_path, _never)
    assert not list(tmp_path.rglob(".going-*"))


def test_the_size_is_that_of_every_version(tmp_path: Path) -> None:
    for name in ("kernels-now", "kernels-before"):
        _kept(tmp_path / name, "mimics_app.tick-0", 1.0)
    assert cache_bytes(tmp_path) == 200


_KERNEL = """
from mimics_app.compiled.kernel import kernel

@kernel
def twice(x):
    return 2.0 * x

print(twice({argument}))
"""


@pytest.mark.seconds
def test_a_process_that_compiles_sweeps_and_marks_what_it_opens(tmp_path: Path) -> None:
    """The first run of a program makes a new folder and sweeps; the next one marks it as used."""
    program = tmp_path / "program.py"
    program.write_text(_KERNEL.format(argument="1.5"), encoding="utf-8")
    old = _kept(tmp_path / "cache" / "mimics" / "kernels-before", "mimics_app.tick-0", 31.0)

    def run() -> str:
        environment = os.environ | {"PYTHONPATH": str(root()), "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
        return subprocess.run(
            [sys.executable, program], capture_output=True, text=True, env=environment, check=True
        ).stdout

    assert run() == "3.0\n"
    assert not old.exists()
    made = next((tmp_path / "cache" / "mimics").glob("kernels-*/program-*"))
    then = wall_time().timestamp() - 20 * _DAY_S
    os.utime(made, (then, then))
    assert run() == "3.0\n"
    assert made.stat().st_mtime > then + 19 * _DAY_S
