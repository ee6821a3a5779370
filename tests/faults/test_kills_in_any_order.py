"""Application, page and recorder of a live session killed in any order: what the page showed is recorded."""

from __future__ import annotations

import itertools
import json
import os
import random
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect
from websockets.typing import Origin

from mimics_app.console.meeting_place import PageAddress
from mimics_app.console.telemetry import TELEMETRY, VALUES
from mimics_app.recording.recover import recover
from mimics_app.recording.run import Run
from tests.support.ends_with_parent import ending_with_parent
from tests.support.operators_page import ROOT, answers, enter, page_server_of, served

MOST_LOST_TICKS = 100
ORDERS = tuple(itertools.permutations(("application", "page", "recorder")))
_LONGEST_S = 180.0
_TICKS = VALUES.index("ticks")


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[PageAddress]:
    with served(tmp_path_factory.mktemp("run")) as address:
        yield address


class Watched:
    """What a page has seen of a session."""

    def __init__(self, client: Any) -> None:
        self.client = client
        self.folder, self.ticks, self.trials = "", 0, list[dict[str, Any]]()

    def look(self, seconds: float) -> None:
        """Take what the page is told for some time, or until it is gone."""
        until = time.monotonic() + seconds
        while (left := until - time.monotonic()) > 0:
            try:
                self._take(self.client.recv(timeout=left))
            except (TimeoutError, ConnectionClosed):
                return

    def _take(self, message: str | bytes) -> None:
        if isinstance(message, bytes):
            kind = int.from_bytes(message[:4], "little")
            if kind == TELEMETRY and len(message) > 8 and self.folder:
                self.ticks = int(np.frombuffer(message, "<f8", offset=8)[_TICKS])
            return
        said = json.loads(message)
        if said["kind"] == "session":
            self.folder = self.folder or (said["card"] or {}).get("folder", "")
        elif said["kind"] == "trials":
            self.trials += said["entries"]


def waited(what: str, happens: Callable[[], Any]) -> Any:
    until = time.monotonic() + _LONGEST_S
    while not (found := happens()):
        assert time.monotonic() < until, f"no {what}"
        time.sleep(0.02)
    return found


def recorder_of(folder: Path) -> int:
    """The process that has the file of the ticks open; 0: none."""
    for each in Path("/proc").glob("[0-9]*/fd"):
        try:
            if any(os.readlink(file) == str(folder / "haptic.arrows") for file in each.iterdir()):
                return int(each.parent.name)
        except OSError:
            continue
    return 0


def kill_in_order(page: PageAddress, runs: Path, order: tuple[str, ...], seed: int) -> None:
    words = ["run", "wavy_tunnel", "--headless", "--console", "0", "--operator-lost", "continue", "--pictures", "0"]
    words += ["--sound", "off", "--trials", "100", "--runs", str(runs)]
    run = subprocess.Popen(ending_with_parent("-m", "mimics_app", *words), cwd=ROOT, stderr=subprocess.DEVNULL)
    try:
        origin, cookie = enter(page)
        address, headers = origin.replace("http", "ws") + "/live", {"Cookie": cookie}
        with connect(address, origin=Origin(origin), additional_headers=headers, max_queue=None) as client:
            seen = Watched(client)
            waited("tick", lambda: seen.look(0.1) or seen.ticks > 500)
            kill_each(page, run.pid, runs / seen.folder, order, seen, random.Random(seed))
    finally:
        run.kill()
        run.wait()
    folder = runs / seen.folder
    waited("end of the recorder", lambda: recorder_of(folder) == 0)
    waited("page", lambda: answers(page))
    kept = Run.open(folder)
    last = int(kept.haptic["tick"].max()) if len(kept.haptic) else -1
    restarts = kept.lines_of("recorder", "restart")
    lost = f"{order}, {seed}: {seen.ticks - last} ticks lost, gaps {kept.gaps}, restarts {restarts}"
    assert last >= seen.ticks - MOST_LOST_TICKS, lost
    finished = {(row["trial"], row["attempt"]) for row in kept.trials}
    assert {(trial["trial"], trial["attempt"]) for trial in seen.trials} <= finished
    assert recover(folder).verdict.status in ("interrupted", "recovered")


def kill_each(
    page: PageAddress, application: int, folder: Path, order: tuple[str, ...], seen: Watched, moments: random.Random
) -> None:
    seen.look(moments.uniform(0.0, 1.0))
    for number, victim in enumerate(order):
        find = {"application": lambda: application, "page": lambda: page_server_of(page)}
        pid = find.get(victim, lambda: recorder_of(folder))()
        assert pid or "application" in order[:number], "a recorder ends by itself only after its application"
        if pid:
            os.kill(pid, signal.SIGKILL)
        seen.look(moments.uniform(0.0, 0.3))


@pytest.mark.fault(id="F12")
def test_one_order_of_kills(page: PageAddress, tmp_path: Path) -> None:
    kill_in_order(page, tmp_path, ("recorder", "page", "application"), 0)


@pytest.mark.slow
@pytest.mark.parametrize("round_", range(100))
def test_hundred_kills_in_every_order(page: PageAddress, tmp_path: Path, round_: int) -> None:
    kill_in_order(page, tmp_path, ORDERS[round_ % len(ORDERS)], round_)
