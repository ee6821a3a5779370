"""The operator's page as `mimics console` serves it, and a session of this process that it shows."""

from __future__ import annotations

import json
import os
import subprocess
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from mimics_app.app.picture.picture import Picture, live_quality
from mimics_app.app.session.assembly import build_session
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.operator_link import OperatorLink
from mimics_app.app.settings import RunSettings
from mimics_app.console.meeting_place import MeetingPlace, PageAddress
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.visual.surfaces.headless import open_offscreen
from tests.support.ends_with_parent import ending_with_parent

__all__ = ["LinkedSession", "answers", "enter", "page_server_of", "post", "served"]

ROOT = Path(__file__).resolve().parents[2]
_LONGEST_S = 180.0


@contextmanager
def served(folder: Path, at: Path = ROOT) -> Iterator[PageAddress]:
    """Address of a page that is served from a folder, and whose meeting place is in a folder of the test."""
    pytest.importorskip("uvicorn", reason="the extra console is not installed")
    pytest.importorskip("starlette", reason="the extra console is not installed")
    before = os.environ.get("XDG_RUNTIME_DIR")
    os.environ["XDG_RUNTIME_DIR"] = str(folder)
    words = ending_with_parent("-m", "mimics_app", "console", "--port", "0", "--priority", "usual")
    page = subprocess.Popen(words, cwd=at, env={**os.environ, "PYTHONPATH": str(ROOT)}, stderr=subprocess.DEVNULL)
    try:
        until = time.monotonic() + _LONGEST_S
        while (address := MeetingPlace().served()) is None or not answers(address):
            assert page.poll() is None and time.monotonic() < until, "the page does not start"
            time.sleep(0.02)
        yield address
    finally:
        _end(page)
        if before is None:
            del os.environ["XDG_RUNTIME_DIR"]
        else:
            os.environ["XDG_RUNTIME_DIR"] = before


def _end(page: subprocess.Popen[bytes]) -> None:
    """End a page as Ctrl-C does; one that does not end is killed before the test fails, so that none is left."""
    page.terminate()
    try:
        page.wait(timeout=20)
    finally:
        page.kill()
        page.wait()


def answers(address: PageAddress) -> bool:
    """Whether the page's server answers."""
    try:
        urllib.request.urlopen(address.url.partition("#")[0], timeout=5).close()
    except OSError:
        return False
    return True


def post(url: str, body: object, **headers: str) -> tuple[int, dict[str, str]]:
    """Status and headers of a POST."""
    data = body if isinstance(body, bytes) else json.dumps(body).encode()
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    try:
        with urllib.request.urlopen(urllib.request.Request(url, data, named), timeout=10) as answer:
            return answer.status, dict(answer.headers)
    except urllib.error.HTTPError as error:
        with error:
            return error.code, dict(error.headers)


def enter(address: PageAddress, *, view: bool = False) -> tuple[str, str]:
    """Origin and cookie of a page that was entered by its address."""
    origin, _, token = (address.view_url if view else address.url).partition("/#")
    status, headers = post(f"{origin}/enter", {"token": token}, origin=origin)
    assert status == 200
    return origin, headers["set-cookie"].partition(";")[0]


def page_server_of(page: PageAddress) -> int:
    """Process of the page's server: the child of the supervisor that has no children of its own, and runs the page."""
    children = Path(f"/proc/{page.pid}/task/{page.pid}/children").read_text().split()
    return next(int(pid) for pid in children if b"spawn_main" in Path(f"/proc/{pid}/cmdline").read_bytes())


class LinkedSession:
    """A session of this process, on the virtual clock, with its recorder and its link to the page."""

    def __init__(self, runs: Path, scene: str = "wavy_tunnel", lost: str = "pause", **settings: Any) -> None:
        chosen = RunSettings(root() / "scenes" / f"{scene}.json", headless=True, sound="off", runs=runs, **settings)
        self.session = build_session(chosen, live=False)
        self.link = OperatorLink(self.session, lost)
        self.frames = Frames(self.session)
        self.play_until(lambda: self.link.attached and self.frames.number > 30)

    def draw(self, size: tuple[int, int] = (320, 180)) -> None:
        """Draw every frame from now on, without a window."""
        surface = open_offscreen("egl", size)
        scene, world = self.session.scene, self.session.world
        self.session.show(Picture(surface, scene, world, live_quality(scene, "training", surface)))

    def play(self, frames: int, beside: float = 0.002) -> None:
        """Play frames faster than the wall clock would, and leave `beside` seconds to the page after each."""
        for _ in range(frames):
            self.frames.advance_frame()
            if self.session.picture is not None:
                self.session.picture.show_frame(self.frames.board, self.session.clock)
            self.link.after_frame(self.frames)
            time.sleep(beside)

    def play_until(self, happened: Callable[[], Any], beside: float = 0.002) -> Any:
        """Play until something has happened, and return it."""
        until = time.monotonic() + _LONGEST_S
        while not (found := happened()):
            assert time.monotonic() < until, "it does not happen"
            self.play(1, beside)
        return found

    def journal(self, kind: str) -> list[dict[str, Any]]:
        """Lines of a kind in the journal, as they are on the disk."""
        file = self.session.folder / "events.jsonl"
        whole = file.read_text().rpartition("\n")[0] if file.exists() else ""
        return [line for text in whole.splitlines() if (line := json.loads(text))["kind"] == kind]

    def commands(self, name: str) -> list[dict[str, Any]]:
        """Lines of a command in the journal."""
        return [line for line in self.journal("command") if line.get("command") == name]

    def close(self, *, orderly: bool = True) -> None:
        """End the session with its recording."""
        self.link.close(orderly=orderly)
        self.session.end_stages()
        self.session.finish({})
