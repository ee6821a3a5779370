"""The operator's page against its attackers, and a session that outlives it: real processes, real sockets."""

from __future__ import annotations

import json
import os
import signal
import socket
import ssl
import subprocess
import sys
import time
import urllib.request
import uuid
from collections.abc import Iterator
from contextlib import ExitStack
from datetime import timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from mimics_app.app.mirror.mirror_buffer import MirrorBuffer
from mimics_app.app.mirror.mirror_display import MirroredScene
from mimics_app.app.mirror.mirror_link import MirrorLink
from mimics_app.app.play.launching import launcher_settings, settings_of_choice
from mimics_app.app.play.operators_page import DEFAULT_PORT, open_page
from mimics_app.console import own_certificate as own_certificate_module
from mimics_app.console.meeting_place import MeetingPlace, PageAddress
from mimics_app.console.own_certificate import fingerprint, own_certificate
from mimics_app.contracts.commands.command_records import CommandSource
from mimics_app.contracts.errors import DeviceError, SceneError
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.contracts.messages.mirror_frame import MirrorFrame
from mimics_app.contracts.shared_memory.session_memory import AttendanceWord
from mimics_app.contracts.shared_memory.shared_words import STOP_STRIDE
from mimics_app.rendering.visual.launcher.launcher import LauncherChoice
from tests.support.operators_page import ROOT, LinkedSession, answers, enter, page_server_of, post, served


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[PageAddress]:
    with served(tmp_path_factory.mktemp("run")) as address:
        yield address


@pytest.fixture(scope="module")
def play(page: PageAddress, tmp_path_factory: pytest.TempPathFactory) -> Iterator[LinkedSession]:
    session = LinkedSession(tmp_path_factory.mktemp("runs"))
    yield session
    session.close()


def open_socket(page: PageAddress, *, view: bool = False, **changes: Any) -> Any:
    """A web socket of a page that has entered; `changes` of origin, host and cookie."""
    origin, cookie = enter(page, view=view)
    headers = {"Cookie": changes.pop("cookie", cookie)}
    return connect(
        origin.replace("http", "ws") + "/live",
        origin=changes.pop("origin", origin),
        additional_headers=headers | changes,
        open_timeout=20,
        max_queue=None,  # a client that does not read would not answer pings either
    )


def ask(client: Any, number: int, **content: Any) -> dict[str, Any]:
    """The answer to a request."""
    client.send(json.dumps({"id": number, **content}))
    return next(said for said in spoken(client) if said["kind"] == "answer")


def press(page: PageAddress, **changes: str) -> int:
    """The status of a press of STOP."""
    origin, cookie = enter(page)
    headers = {"origin": origin, "cookie": cookie} | changes
    return post(f"{page.stop_url}/stop", {"nonce": str(uuid.uuid4())}, **headers)[0]


@pytest.mark.requirement("R22")
@pytest.mark.fault(id="F14")
def test_no_wrong_or_foreign_client_gets_in(page: PageAddress) -> None:
    origin, cookie = enter(page)
    assert post(f"{origin}/enter", {"token": "x" * 43}, origin=origin)[0] == 403
    assert post(f"{origin}/enter", {"token": page.url.partition("#")[2]})[0] == 403, "no origin"
    assert post(f"{origin}/enter", {"token": page.url.partition("#")[2]}, origin="http://evil.example")[0] == 403
    for damaged in (b'{"token": "\xff"}', b'{"other": ' + b"[" * 20_000, b""):
        assert post(f"{origin}/enter", damaged, origin=origin)[0] in (400, 413)
    for changes in ({"cookie": ""}, {"cookie": cookie[:-1] + "0"}, {"origin": "http://evil.example"}, {"origin": None}):
        with pytest.raises(InvalidStatus) as refused:
            open_socket(page, **changes)
        assert refused.value.response.status_code == 403
    assert press(page, cookie="") == press(page, origin="http://evil.example") == 403
    assert enter(page, view=True)[1] and press(page, cookie=enter(page, view=True)[1]) == 403, "a viewer"
    for address in (origin, page.stop_url):
        assert post(f"{address}/enter", {}, origin=origin, host="evil.example")[0] == 400, "rebinding of a name"


def test_nothing_changes_by_a_get_and_no_other_file_is_served(page: PageAddress) -> None:
    origin, _ = enter(page)
    for address in (f"{page.stop_url}/stop", f"{origin}/enter", f"{origin}/..%2f..%2faccess.py", f"{origin}/vendor"):
        with pytest.raises(urllib.error.HTTPError) as refused, urllib.request.urlopen(address, timeout=10):
            pass
        refused.value.close()
        assert refused.value.code in (404, 405)
    with urllib.request.urlopen(f"{origin}/", timeout=10) as answer:
        policy = answer.headers["content-security-policy"]
        assert "default-src 'none'" in policy and "script-src 'self'" in policy and "unsafe" not in policy
        assert answer.headers["x-frame-options"] == "DENY"
    assert (
        "SameSite=strict"
        in post(f"{origin}/enter", {"token": page.url.partition("#")[2]}, origin=origin)[1]["set-cookie"]
    )


def test_a_press_and_a_request_count_once(page: PageAddress, play: LinkedSession) -> None:
    origin, cookie = enter(page)
    nonce = {"nonce": "once"}
    assert post(f"{page.stop_url}/stop", nonce, origin=origin, cookie=cookie)[0] == 200
    assert post(f"{page.stop_url}/stop", nonce, origin=origin, cookie=cookie)[0] == 409
    with open_socket(page) as client:
        assert ask(client, 5, ask="operate")["done"]
        assert "before" in ask(client, 5, ask="operate")["why"]
    play.play(5)


def test_an_address_for_viewing_tells_nothing_of_studies_and_their_participants(page: PageAddress) -> None:
    choice = {"scene": "wavy_tunnel", "study": "gait", "participant": "P07"}
    with open_socket(page, view=True) as client:
        for number, asked in enumerate(
            ({"ask": "choices"}, {"ask": "people"}, {"ask": "check", "choice": choice}), start=1
        ):
            answer = ask(client, number, **asked)
            assert (answer["done"], "for viewing" in answer["why"]) == (False, True), asked
            assert not {"choices", "people", "lights"} & set(answer)


def test_long_messages_are_refused(page: PageAddress) -> None:
    origin, cookie = enter(page)
    assert post(f"{page.stop_url}/stop", b"{" + b" " * 100_000, origin=origin, cookie=cookie)[0] == 400
    with open_socket(page) as client, pytest.raises(ConnectionClosed) as closed:
        client.send("x" * 1_000_000)
        for _ in range(2000):
            client.recv(timeout=20)
    assert closed.value.rcvd is None or closed.value.rcvd.code == 1009
    assert answers(page)


@pytest.mark.fault(id="F14")
def test_stop_acts_while_a_thousand_sockets_and_slow_requests_hold_both_servers(
    page: PageAddress, play: LinkedSession
) -> None:
    memory, before = play.session.memory, 0
    word = STOP_STRIDE * CommandSource.STOP_BUTTON
    before = int(memory.stop_words[word])
    origin, cookie = enter(page)
    ports = [int(each.rpartition(":")[2]) for each in (origin, page.stop_url)]
    with ExitStack() as stack:
        for number in range(1000):
            attacker = stack.enter_context(socket.create_connection(("127.0.0.1", ports[number % 2]), timeout=20))
            if number % 3:
                attacker.send(b"POST /stop HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Slow: ")
        status, _ = post(f"{page.stop_url}/stop", {"nonce": "beside them"}, origin=origin, cookie=cookie)
        assert status == 200 and memory.stop_words[word] == before + 1
        assert answers(page)


@pytest.mark.requirement("R23")
def test_stop_acts_while_the_page_hangs_and_a_dead_page_comes_back(page: PageAddress, play: LinkedSession) -> None:
    with open_socket(page) as client:
        ask(client, 1, ask="operate")
        play.play(5)  # presses of earlier tests are seen
        for number in (2, 3):  # they pressed while a pause, too, may have been given for a lost operator
            give(client, play, number, "reset" if number == 2 else "resume")
        play.play_until(lambda: play.frames.snapshot.state == SafetyState.ACTIVE)
        origin, cookie = enter(page)
        server = page_server_of(page)
        os.kill(server, signal.SIGSTOP)
        try:
            assert post(f"{page.stop_url}/stop", {"nonce": "hung"}, origin=origin, cookie=cookie)[0] == 200
            play.play(2)
            assert play.frames.snapshot.state == SafetyState.E_STOP
        finally:
            os.kill(server, signal.SIGKILL)
    lines = play.play_until(lambda: play.commands("stop"))
    assert (lines[-1]["from"], lines[-1]["done"]) == ("stop_button", True)
    until = time.monotonic() + 30
    while not answers(page):
        assert time.monotonic() < until
        time.sleep(0.05)
    assert page_server_of(page) != server
    with open_socket(page) as client:  # the same cookie key, and the session is there again
        card = next(said for said in spoken(client) if said["kind"] == "session")
        assert card["card"]["folder"] == play.session.folder.name


def give(client: Any, play: LinkedSession, number: int, name: str) -> None:
    """Give a command, and play until it is in the journal, done or refused."""
    before = len(play.commands(name))
    client.send(json.dumps({"id": number, "command": {"command": name}}))
    play.play_until(lambda: len(play.commands(name)) > before)


def spoken(client: Any) -> Iterator[dict[str, Any]]:
    """Texts that the server sends, for a minute."""
    until = time.monotonic() + 60
    while time.monotonic() < until:
        if isinstance(message := client.recv(timeout=20), str):
            yield json.loads(message)


@pytest.mark.parametrize(("lost", "leads_to"), [("pause", "pause"), ("stop", "stop"), ("continue", "")])
def test_a_lost_operator_leads_to_what_was_set(
    lost: str, leads_to: str, page: PageAddress, play: LinkedSession
) -> None:
    play.link._lost = lost
    with open_socket(page) as client:
        ask(client, 1, ask="operate")
        play.play_until(lambda: play.link._seen_ns is not None)
    before = len(play.journal("operator"))
    play.play_until(lambda: len(play.journal("operator")) > before)
    assert play.journal("operator")[-1]["leads_to"] == lost
    play.play(10)
    given = [line["command"] for line in play.journal("command") if line["from"] == "attendance"]
    assert given[-1:] == ([leads_to] if leads_to else given[-1:])


@pytest.mark.parametrize(("orderly", "says"), [(True, "over"), (False, "gone")])
def test_the_page_says_how_a_session_left_and_shows_the_next(
    orderly: bool, says: str, page: PageAddress, play: LinkedSession
) -> None:
    play.play_until(lambda: play.link.attached)
    with open_socket(page) as client:
        sessions = (said for said in spoken(client) if said["kind"] == "session")
        assert next(sessions)["card"]["scene"] == "wavy_tunnel"
        play.link.close(orderly=orderly)
        left = next(sessions)
        assert left["card"] is None and says in left["why"]
        play.play_until(lambda: play.link.attached)
        assert next(sessions)["card"]["folder"] == play.session.folder.name


def own_address() -> str:
    """This computer's address in its network; "": it has none. Nothing is sent."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))
            return str(probe.getsockname()[0])
        except OSError:
            return ""


@pytest.mark.skipif(own_address() in ("", "127.0.0.1"), reason="this computer has no address in a network")
def test_from_another_computer_the_page_is_seen_by_tls_and_does_not_operate(tmp_path: Path) -> None:
    host, homes = own_address(), {"XDG_CONFIG_HOME": str(tmp_path / "own"), "XDG_RUNTIME_DIR": str(tmp_path)}
    words = [sys.executable, "-m", "mimics_app", "console", "--port", "0", "--host", host, "--json"]
    page = subprocess.Popen(words, env=os.environ | homes, stdout=subprocess.PIPE, text=True)
    try:
        address = json.loads(page.stdout.readline())
        origin, _, token = address["view_url"].partition("/#")
        assert origin.startswith("https://") and not address["url"]
        port = int(origin.rpartition(":")[2])
        shown = ssl.get_server_certificate((host, port), timeout=60)
        kept = tmp_path / "own" / "mimics" / "certificates" / f"{host}.pem"
        assert shown in kept.read_text() and all(file.stat().st_mode & 0o77 == 0 for file in kept.parent.iterdir())
        trusting = ssl.create_default_context(cafile=str(kept))
        trusting.verify_flags |= ssl.VERIFY_X509_PARTIAL_CHAIN  # it is trusted by itself, as a browser does when told
        request = urllib.request.Request(f"{origin}/enter", json.dumps({"token": token}).encode(), {"origin": origin})
        with urllib.request.urlopen(request, context=trusting, timeout=60) as entered:
            assert json.load(entered)["role"] == "view" and "Secure" in entered.headers["set-cookie"]
    finally:
        page.terminate()
        page.wait(timeout=20)


def test_an_own_certificate_is_kept_and_made_anew_before_it_expires(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = own_certificate(tmp_path, "fd00::2")
    before = fingerprint(first)
    assert own_certificate(tmp_path, "fd00::2") == first and fingerprint(first) == before
    monkeypatch.setattr(own_certificate_module, "_RENEWED", timedelta(days=366))
    assert fingerprint(own_certificate(tmp_path, "fd00::2")) != before


def test_the_entry_of_the_launcher_opens_the_page_in_the_browser_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    offered = {setting.name: [choice.value for choice in setting.choices] for setting in launcher_settings()}
    assert offered["console"] == ["", "open"]
    usual = {name: values[0] if values else "" for name, values in offered.items()}
    chosen = [
        settings_of_choice(LauncherChoice(Path("a.json"), usual | {"console": each})).console for each in ("", "open")
    ]
    assert chosen == [None, DEFAULT_PORT]
    browser, opened = tmp_path / "browser", tmp_path / "opened"
    browser.write_text(f'#!/bin/sh\necho "$1" >> {opened}\n')
    browser.chmod(0o700)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    monkeypatch.setenv("BROWSER", f"{browser} %s")
    open_page(0)
    address = MeetingPlace().served()
    assert address is not None
    try:
        open_page(0)  # of the next session
        assert opened.read_text().split() == [address.url]
        while not answers(address):
            time.sleep(0.05)
        assert enter(address)[1]
    finally:
        os.kill(address.pid, signal.SIGTERM)


def test_a_second_display_shows_the_world_of_the_session_and_gives_no_command(
    page: PageAddress, play: LinkedSession, tmp_path: Path
) -> None:
    buffer = MirrorBuffer(100_000_000)
    link = MirrorLink(page.view_url, buffer, None)
    try:
        play.play_until(lambda: buffer.at(time.monotonic_ns()))
        card, theirs = link.card, play.session.world.transforms
        assert card is not None and card["edit"] == {}
        mirrored = MirroredScene(card["scene"], card["scene_hash"])
        ours = mirrored.world.transforms
        mirrored.show(play.play_until(lambda: whole(buffer.at(time.monotonic_ns()), len(theirs))))
        play.play(5)
        until = time.monotonic() + 30.0
        while (frame := buffer.at(time.monotonic_ns())).number < play.frames.number:
            assert time.monotonic() < until
            time.sleep(0.02)
        mirrored.show(frame)
        np.testing.assert_allclose(ours.world, theirs.world, atol=1e-5)
        np.testing.assert_array_equal(ours.shown, theirs.shown)
        assert play.commands("view") == [] and not play.session.memory.attendance[AttendanceWord.OPERATORS]
        with pytest.raises(SceneError, match="another one than that of the session"):
            MirroredScene(card["scene"], "0" * 64)
    finally:
        link.close()
    file = tmp_path / "mirror.png"
    words = ["mirror", page.view_url, "--output", str(file), "--seconds", "1", "--size", "320x180", "--json"]
    mirror = subprocess.Popen([sys.executable, "-m", "mimics_app", *words], cwd=ROOT, stdout=subprocess.PIPE, text=True)
    play.play_until(lambda: mirror.poll() is not None)
    assert mirror.returncode == 0 and json.load(mirror.stdout)["frames"]
    assert np.asarray(Image.open(file)).std() > 10.0
    with pytest.raises(DeviceError, match="does not know this token"):
        MirrorLink(page.view_url[:-1] + "0", buffer, None)


def whole(frame: MirrorFrame | None, rows: int) -> MirrorFrame | None:
    """The frame, if it has all rows."""
    return frame if frame is not None and len(frame.rows) == rows else None
