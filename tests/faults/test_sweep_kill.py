"""A sweep that was killed half-way goes on where it stopped and ends in the same bytes; so does a lost Dask worker."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import distributed
import pytest

ROOT = Path(__file__).resolve().parents[2]
PATIENCE_S = 600.0

PARAMETERS = {
    "stiffness": {"from": 100.0, "to": 100000.0, "scale": "log"},
    "wall_damping": {"from": 0.0, "to": 40.0},
    "mass": {"from": 0.1, "to": 5.0, "scale": "log"},
    "delay_ticks": {"from": 0, "to": 5},
}


def spec(folder: Path, points: int, chunk: int) -> Path:
    head = {"format": "mimics-sweep", "version": 1, "experiment": "wall_stability", "chunk": chunk}
    file = folder / f"sweep_{chunk}.json"
    file.write_text(json.dumps({**head, "parameters": PARAMETERS, "sample": {"points": points, "seed": 3}}))
    return file


def command(file: Path, out: Path, *options: object) -> list[str]:
    return [sys.executable, "-m", "mimics_app.app.cli", "sweep", *map(str, (file, "--out", out, "--json", *options))]


def finish(file: Path, out: Path, *options: object) -> dict[str, Any]:
    done = subprocess.run(
        command(file, out, *options), cwd=ROOT, capture_output=True, text=True, timeout=PATIENCE_S, check=False
    )
    assert done.returncode == 0, done.stderr
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer


def pieces_in(out: Path) -> int:
    folder = out.with_name(f"{out.name}.pieces")
    return len(list(folder.glob("*.arrow"))) if folder.is_dir() else 0


def wait_for_pieces(out: Path, wanted: int, child: subprocess.Popen[bytes]) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while pieces_in(out) < wanted:
        assert child.poll() is None, "the sweep ended before it could be killed"
        assert time.monotonic() < deadline, "no piece appeared"
        time.sleep(0.005)


def kill_half_way(file: Path, out: Path, wanted: int, *options: object) -> None:
    child = subprocess.Popen(
        command(file, out, *options), cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        wait_for_pieces(out, wanted, child)
    finally:
        child.send_signal(signal.SIGKILL)
        child.wait()
    assert not out.exists()


def compare(folder: Path, points: int, chunk: int, wanted: int, *options: object) -> None:
    killed, whole = folder / "killed.parquet", folder / "whole.parquet"
    file = spec(folder, points, chunk)
    kill_half_way(file, killed, wanted, *options)
    kept = pieces_in(killed)
    resumed = finish(file, killed, *options)
    assert resumed["pieces"] == -(-points // chunk)
    assert resumed["computed"] <= resumed["pieces"] - kept + 1, "what was finished is not computed again"
    assert resumed["computed"] < resumed["pieces"]
    finish(spec(folder, points, 10 * chunk), whole, "--workers", 1)
    assert killed.read_bytes() == whole.read_bytes()


def test_sweep_killed_half_way_and_resumed_is_the_same_file(tmp_path):
    compare(tmp_path, 3000, 6, 150, "--workers", 1)


@pytest.mark.slow
def test_sweep_of_10000_points_in_processes_killed_and_resumed_is_the_same_file(tmp_path):
    compare(tmp_path, 10_000, 50, 60, "--workers", 2)


@pytest.mark.slow
def test_processes_of_a_killed_sweep_leave_with_it(tmp_path):
    file, out = spec(tmp_path, 10_000, 25), tmp_path / "out.parquet"
    mark = {**os.environ, "MIMICS_TEST_MARK": str(tmp_path)}
    child = subprocess.Popen(command(file, out, "--workers", 2), cwd=ROOT, env=mark, stdout=subprocess.DEVNULL)
    wait_for_pieces(out, 10, child)
    child.send_signal(signal.SIGKILL)
    child.wait()
    deadline = time.monotonic() + 30.0
    while survivors(str(tmp_path)) and time.monotonic() < deadline:
        time.sleep(0.1)
    assert not survivors(str(tmp_path))


def survivors(mark: str) -> list[str]:
    """Processes that carry a word in their environment."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            if f"MIMICS_TEST_MARK={mark}".encode() in (folder / "environ").read_bytes():
                found.append(folder.name)
        except OSError:
            continue
    return found


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port


@contextmanager
def dask_cluster(folder: Path, workers: int) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """Address of a scheduler that knows its workers, and their processes."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}
    started: list[subprocess.Popen[bytes]] = []

    def start(*words: str) -> subprocess.Popen[bytes]:
        started.append(subprocess.Popen([sys.executable, "-m", *words], cwd=folder, env=environment))
        return started[-1]

    port = free_port()
    address = f"tcp://127.0.0.1:{port}"
    options = ("--nthreads", "1", "--no-nanny", "--no-dashboard")
    try:
        start("distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard")
        own = [start("distributed.cli.dask_worker", address, *options) for _ in range(workers)]
        with distributed.Client(address, timeout=PATIENCE_S) as client:
            client.wait_for_workers(workers, timeout=PATIENCE_S)
        yield address, own
    finally:
        for process in started:
            process.kill()
            process.wait()


@pytest.mark.parametrize(
    ("points", "chunk", "wanted"), [(3000, 25, 20), pytest.param(10_000, 50, 40, marks=pytest.mark.slow)]
)
def test_dask_worker_killed_half_way_the_file_is_the_same(tmp_path, points, chunk, wanted):
    plain, out = tmp_path / "plain.parquet", tmp_path / "dask.parquet"
    file = spec(tmp_path, points, chunk)
    with dask_cluster(tmp_path, 2) as (address, workers):
        client = subprocess.Popen(command(file, out, "--scheduler", address), cwd=ROOT, stdout=subprocess.DEVNULL)
        try:
            wait_for_pieces(out, wanted, client)
            workers[0].send_signal(signal.SIGKILL)
            assert client.wait(PATIENCE_S) == 0
        finally:
            client.kill()
            client.wait()
    finish(file, plain, "--workers", 1)
    assert out.read_bytes() == plain.read_bytes()
