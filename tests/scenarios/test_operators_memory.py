"""Eight hours of telemetry through the page's server and through the page in a browser, as fast as they take it."""

from __future__ import annotations

import asyncio
import gc
import os
import shutil
import socket
from pathlib import Path

import numpy as np
import pytest
from playwright import sync_api

from mimics_app.console.access import Access, new_tokens
from mimics_app.console.handover import VERSION, AttachedSession, SessionCard
from mimics_app.console.page_server import PageServer
from mimics_app.console.session_view import SessionView
from mimics_app.console.telemetry import SIGNALS, TELEMETRY, VALUES
from mimics_app.contracts.loop.haptic import SAMPLE
from mimics_app.contracts.shared_memory.newest_bytes import NewestWriter
from mimics_app.contracts.shared_memory.ring_history import HistoryWriter
from mimics_app.contracts.shared_memory.session_memory import SIGNAL_SAMPLE, SessionMemory
from mimics_app.recording.event_log import to_json
from tests.support.operators_page import served

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
pytestmark = pytest.mark.slow

PASSES = 8 * 3600 * 60
_STATUS = 60


class _NoSocket:
    """A client that takes everything at once, and counts it."""

    count = 0

    async def send_text(self, text: str) -> None: ...

    async def send_bytes(self, content: bytes) -> None:
        self.count += 1


def card(memory: SessionMemory) -> SessionCard:
    about = {"scene": "wavy_tunnel", "title": "Wavy tunnel", "folder": "run", "device": "simulated", "participant": "7"}
    size, capacities = memory.segment.size, memory.capacities
    rest = {"scene_hash": "0", "simulated": True, "has_policy": False, "lost": "pause", "signals": ["ecg"]}
    return SessionCard(VERSION, size, capacities, 1, **about, **rest)  # type: ignore[arg-type]


def test_the_server_grows_by_less_than_20_mb() -> None:
    asyncio.run(_pass_hours())


def resident_mb() -> float:
    """Memory of this process."""
    gc.collect()
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096 / 2**20


async def _pass_hours() -> None:
    ours, theirs = socket.socketpair()
    theirs.setblocking(False)
    access = Access(("127.0.0.1",), 1, 2, tokens=new_tokens(operate=True))
    server, memory = PageServer(access, theirs), SessionMemory()
    server._session = SessionView(AttachedSession(card(memory), os.dup(memory.segment.descriptor)))
    taken = _NoSocket()
    client = server._clients.join(taken, "operate")  # type: ignore[arg-type]
    writer = asyncio.create_task(client.write())
    ticks = HistoryWriter(memory.sample_words, memory.samples)
    signals = HistoryWriter(memory.signal_words, memory.signal_samples)
    status = NewestWriter(memory.status_words, memory.status)
    samples, rows, base_mb = np.zeros(17, SAMPLE), np.zeros(17, SIGNAL_SAMPLE), 0.0
    for number in range(PASSES):
        samples["t"] = np.arange(17 * number, 17 * number + 17) / 1000
        ticks.append(samples)
        signals.append(rows)
        if number % _STATUS == 0:
            entry = {"n": number, "t_ns": number, "kind": "report", "what": f"line {number}"}
            status.write(to_json({"task": {}, "events": [entry], "trials": [{"n": number}]}))
            ours.recv(1 << 16, socket.MSG_DONTWAIT) if number else None
        server._pass()
        await asyncio.sleep(0)
        if number == PASSES // 20:
            base_mb = resident_mb()
    writer.cancel()
    assert taken.count > 1.9 * PASSES, "it was given what there was"
    assert resident_mb() - base_mb < 20.0


def test_the_page_grows_by_less_than_50_mb(tmp_path: Path) -> None:
    if CHROMIUM is None:
        pytest.skip("chromium is not installed: apt-get install chromium")
    numbers = np.zeros(len(VALUES))
    with served(tmp_path) as address, sync_api.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"])
        tab = browser.new_page(viewport={"width": 1280, "height": 720})
        tab.add_init_script(_KEEP_SOCKET)
        tab.goto(address.url)
        tab.locator("#before").wait_for()
        tools = tab.context.new_cdp_session(tab)

        def heap_mb() -> float:
            tools.send("HeapProfiler.collectGarbage")
            return float(tools.send("Runtime.getHeapUsage")["usedSize"]) / 2**20

        shown = {"kind": "session", "card": card(SessionMemory()).shown(may_operate=True), "why": "", "orderly": False}
        tab.evaluate("shown => window.kept.onmessage({ data: JSON.stringify(shown) })", shown)
        base_mb = 0.0
        for part in range(_PARTS):
            tab.evaluate(_FEED, [part, PASSES // _PARTS, len(numbers), TELEMETRY, SIGNALS])
            if part == _PARTS // 20:
                base_mb = heap_mb()
        grown = heap_mb() - base_mb
        assert tab.locator("#log li").count() <= 200 and tab.locator("#trial-rows tr").count() <= 200
        assert grown < 50.0
        browser.close()


_PARTS = 160
_KEEP_SOCKET = """
const Real = WebSocket;
window.WebSocket = class extends Real { constructor(url) { super(url); window.kept = this; } };
"""
_FEED = """
async ([part, passes, count, telemetry, signals]) => {
  for (let n = 0; n < passes; n += 1) {
    const pass = part * passes + n;
    const numbers = new ArrayBuffer(8 + 8 * count);
    new DataView(numbers).setUint32(0, telemetry, true);
    new Float64Array(numbers, 8).fill(pass / 60);
    window.kept.onmessage({ data: numbers });
    const samples = new ArrayBuffer(8 + 16 * 17);
    const at = new DataView(samples);
    at.setUint32(0, signals, true);
    for (let i = 0; i < 17; i += 1) at.setBigInt64(8 + 16 * i, BigInt(17 * pass + i) * 1000000n, true);
    window.kept.onmessage({ data: samples });
    if (pass % 600 === 0) {
      const event = { n: pass, t_ns: pass, kind: "report", what: `line ${pass}` };
      window.kept.onmessage({ data: JSON.stringify({ kind: "events", entries: [event] }) });
      const trial = { n: pass, trial: pass, outcome: "finished", seconds: 1.5, score: 9 };
      window.kept.onmessage({ data: JSON.stringify({ kind: "trials", entries: [trial] }) });
      await new Promise((go) => requestAnimationFrame(go));
    }
  }
}
"""
