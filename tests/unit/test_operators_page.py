"""Parts of the operator's page: what is shared, who may enter, and who operates."""

from __future__ import annotations

import asyncio
import hmac
import io
import json
import os
import shlex
import socket
import subprocess
import sys
import threading
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest

from assets.builders.texts.msgids import page_texts
from mimics_app.app.cli import parse
from mimics_app.app.commands.console import _lives
from mimics_app.app.picture.around_hand import AROUND
from mimics_app.app.study.study_folder import StudyFolder
from mimics_app.console import page_server
from mimics_app.console.access import COOKIE, Access, new_tokens
from mimics_app.console.clients import Client, Clients
from mimics_app.console.handover import VERSION, AttachedSession, SessionCard
from mimics_app.console.meeting_place import MeetingPlace, PageAddress
from mimics_app.console.participant_forms import FormRequest
from mimics_app.console.readiness import (
    Choice,
    device_light,
    files_of_next,
    find_choices,
    find_people,
    machine_lights,
    scene_light,
    shown_light,
    signal_light,
    start_words,
    study_light,
    tracker_light,
)
from mimics_app.console.stop_server import StopButton
from mimics_app.console.supervisor import _GONE, _LEFT
from mimics_app.console.telemetry import VALUES, Telemetry
from mimics_app.contracts.commands.command_records import CommandSource
from mimics_app.contracts.commands.vocabulary import Note, Pause, Stop, refusal
from mimics_app.contracts.errors import OutputError
from mimics_app.contracts.loop.haptic import SAMPLE
from mimics_app.contracts.shared_memory import ring
from mimics_app.contracts.shared_memory.newest_bytes import NEWEST_WORDS, NewestReader, NewestWriter
from mimics_app.contracts.shared_memory.ring_history import HistoryWriter, RingHistory
from mimics_app.contracts.shared_memory.session_memory import Capacities, SessionMemory
from mimics_app.contracts.shared_memory.shared_words import RING_WORDS, STOP_STRIDE
from tests.support.command import mimics


def test_the_newest_value_is_whole_while_its_writer_never_rests() -> None:
    words, slots = np.zeros(NEWEST_WORDS, np.int64), np.zeros((2, 4096), np.uint8)
    writer, reader, over = NewestWriter(words, slots), NewestReader(words, slots), threading.Event()

    def write() -> None:
        number = 0
        while not over.is_set():
            number = number % 250 + 1
            assert writer.write(bytes([number]), bytes([number]) * (number * 16))

    thread = threading.Thread(target=write)
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    thread.start()
    seen = set()
    while len(seen) < 50:
        if (value := reader.read()) is not None:
            assert set(value) == {value[0]} and len(value) == 1 + 16 * value[0]
            seen.add(value[0])
    over.set()
    thread.join()
    sys.setswitchinterval(interval)
    assert not writer.write(b"x" * 4097), "too long"


def test_a_history_has_every_record_in_order_and_counts_what_it_missed() -> None:
    words, slots = np.zeros(RING_WORDS, np.int64), np.zeros(64, np.int64)
    writer, history = HistoryWriter(words, slots), RingHistory(words, slots)
    taken, written = [], 0
    for count in (1, 5, 20, 31, 32, 7):
        writer.append(np.arange(written, written + count))
        written += count
        taken += history.take().tolist()
    assert taken == list(range(96)) and history.skipped == 0
    for _ in range(3):
        writer.append(np.arange(written, written + 30))
        written += 30
    assert history.take().tolist() == list(range(written - 32, written)) and history.skipped == 90 - 32


def test_telemetry_reads_beside_the_recorder_and_keeps_the_peak_of_one_tick() -> None:
    memory = SessionMemory()
    telemetry, sample = Telemetry(memory), np.zeros(1, SAMPLE)
    assert telemetry.newest() is None
    for tick in range(16):
        sample["t"], sample["f_user_world"] = tick * 1e-3, (0.0, 3.0, 4.0) if tick == 7 else (0.0, 0.0, 1.0)
        ring.push(memory.sample_words, memory.samples, sample)
    values = dict(zip(VALUES, np.frombuffer(telemetry.newest() or b"", "<f8", offset=8), strict=True))
    assert (values["t_s"], values["force"], values["force_low"], values["force_high"]) == (0.015, 1.0, 1.0, 5.0)
    assert ring.waiting(memory.sample_words) == 16, "nothing was taken from the recorder"


def test_a_cookie_is_sealed_and_gives_the_role_of_its_token() -> None:
    access = Access(("127.0.0.1",), 1, 2, new_tokens(operate=True))
    assert access.role_of_token(access.tokens["operate"]) == "operate"
    assert access.role_of_token(access.tokens["view"]) == "view" and access.role_of_token("") is None
    cookie = access.cookie("view")
    name, _, seal = cookie.rpartition(".")
    assert seal == hmac.new(access.secret, name.encode(), sha256).hexdigest()
    assert access.role_of_cookies(f"other=1; {COOKIE}={cookie}") == "view"
    for forged in (cookie.replace("view", "operate"), name, "", "=;=", f"{name}.{'0' * 64}", "operate.x.é"):
        assert access.role_of_cookies(f"{COOKIE}={forged}") is None
    lan = Access(("192.0.2.1",), 1, 2, new_tokens(operate=False), secure=True)
    assert not lan.address("operate") and lan.address("view").startswith("https://192.0.2.1:1/#")


def test_only_its_own_names_and_origins_reach_the_page() -> None:
    access = Access(("127.0.0.1", "localhost"), 8765, 9000, new_tokens(operate=True))
    assert access.allows_host("localhost:8765", 8765) and access.allows_origin("http://127.0.0.1:8765")
    for host in ("localhost", "evil.example:8765", "localhost:9000", ""):
        assert not access.allows_host(host, 8765)
    for origin in ("", "null", "https://127.0.0.1:8765", "http://127.0.0.1:9000", "http://127.0.0.1:8765.evil.example"):
        assert not access.allows_origin(origin)


def test_stop_raises_its_own_word_before_the_ring_takes_its_line_or_not() -> None:
    memory, button = SessionMemory(), StopButton()
    assert not button.press(), "no session"
    session = object.__new__(AttachedSession)
    session.memory = memory
    button.attach(session)
    for _ in range(200):  # more than the ring holds between two frames
        assert button.press()
    assert memory.stop_words[STOP_STRIDE * CommandSource.STOP_BUTTON] == 200 == memory.stop_words.sum()
    assert button.is_new("a") and not button.is_new("a")


def test_what_stop_and_attendance_may_give() -> None:
    for source, allowed in ((CommandSource.STOP_BUTTON, {Stop}), (CommandSource.ATTENDANCE, {Stop, Pause})):
        given = {type(each) for each in (Stop(), Pause(), Note("x")) if not refusal(each, source, simulated=True)}
        assert given == allowed


def test_one_operator_at_a_time_with_a_hand_over() -> None:
    async def play() -> None:
        clients = Clients(4)
        first, second, viewer = (clients.join(None, role) for role in ("operate", "operate", "view"))  # type: ignore[arg-type]
        assert [each.operates for each in clients.open] == [True, False, False]
        assert clients.ask(viewer)
        assert not clients.ask(second) and first.operates, "the operator is asked first"
        assert not clients.grant(first, accept=False) and first.operates
        clients.ask(second)
        assert not clients.grant(first, accept=True) and second.operates and not first.operates
        clients.ask(first)
        assert not clients.ask(first) and first.operates, "asked twice without an answer"
        clients.leave(first)
        assert clients.operators == 0
        assert not clients.ask(second) and second.operates
        clients.leave(second)
        display = clients.join(None, "operate", is_display=True)  # type: ignore[arg-type]
        assert not display.operates and clients.join(None, "operate").operates, "a display takes no place"  # type: ignore[arg-type]

    asyncio.run(play())


def test_an_address_for_viewing_is_not_told_what_was_changed_for_the_person() -> None:
    """A card, as it is shown to both roles: measures, files and the side are of the person."""
    edit: dict[str, object] = {"avatar": "people/anna/body.glb", "fit": {"source": "sub-P07/ses-001/run"}}
    words = {"scene": "s", "title": "S", "folder": "f", "device": "d", "participant": "P07", "scene_hash": "h"}
    card = SessionCard(
        version=VERSION, size=1, capacities=Capacities(), pid=1, simulated=True, has_policy=False, lost="pause",
        edit=edit, **words,
    )  # fmt: skip
    assert card.shown(may_operate=True)["edit"] == edit
    seen = card.shown(may_operate=False)
    assert seen["edit"] is None and b"anna" not in msgspec.json.encode(seen)
    assert replace(card, edit={}).shown(may_operate=False)["edit"] == {}


def test_who_can_be_chosen_is_known_to_a_study_that_can_be_chosen_or_to_a_recording(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each that is listed is a choice that the server takes, and comes to the page as JSON; a name never does."""

    async def command(*words: str) -> dict[str, Any]:
        return dict(json.loads(mimics(words[0], "--json", *words[1:]).stdout))

    protocol = {"format": "mimics study", "version": 1, "conditions": {"a": {"scene": "wavy_tunnel"}}}
    text = json.dumps({**protocol, "blocks": [{"conditions": ["a"]}]})
    for name in ("gait", ".hidden", "x" * 121, "a\\b", "two\nlines", "caf\u00e9 2", os.fsdecode(b"\xff")):
        (tmp_path / name).mkdir()
        (tmp_path / name / "study.json").write_text(text)
    (tmp_path / "damaged").mkdir()
    (tmp_path / "damaged" / "study.json").write_text("{")
    study = StudyFolder(tmp_path / "gait")
    study.find_or_add("P07"), study.find_or_add("=cmd 007"), study.of_name("Jane Roe")
    for number, code in enumerate(("P07", "P09", "", "P10", "P09", "Jane Roe", "P1\x1b[31m")):
        run = tmp_path / "runs" / f"2026010{number}T000000Z_0"
        run.mkdir(parents=True)
        (run / "session.json").write_text(json.dumps({"scene": {"name": "s"}, "settings": {"participant": code}}))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("mimics_app.console.readiness.ask_command", command)
    people = asyncio.run(find_people())
    studies = {"caf\u00e9 2": [], "damaged": [], "gait": ["P07", "=cmd 007", "P001"]}
    assert people == {"studies": studies, "recorded": ["P09", "P10", "P07"]}
    for name in studies:
        written = msgspec.json.encode({"scene": "wavy_tunnel", "study": name, "participant": "P07"})
        assert msgspec.json.decode(written, type=Choice).study == name


def test_a_display_that_is_listed_can_be_chosen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its path may be as long as a path may be; one that is no text is not listed."""
    long = f"wall:/{'d' * 200}/{'e' * 200}/wall.json"
    no_text = os.fsdecode(b"wall:/\xff.json")
    files = [{"write": each, "error": ""} for each in (long, "wall:/a\n.json", no_text)]
    files.append({"write": "wall:/b.json", "error": "no wall"})

    async def command(*words: str) -> dict[str, Any]:
        return {"display_files": files if words == ("devices",) else []}

    monkeypatch.setattr("mimics_app.console.readiness.ask_command", command)
    assert [each["name"] for each in asyncio.run(find_choices())["displays"]] == [long]
    written = msgspec.json.encode({"scene": "wavy_tunnel", "display": long})
    assert msgspec.json.decode(written, type=Choice).display == long
    assert parse(start_words(Choice("wavy_tunnel", display=long))).display == long


def test_a_run_that_ended_lives_no_more_though_its_parent_has_not_asked() -> None:
    """Its parent may wait for the end of what the page writes, and the page for the end of the run: for ever."""
    run = subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    assert run.stdin is not None and run.stdout is not None and _lives(run.pid)
    run.stdin.close()
    run.stdout.read()
    os.waitid(os.P_PID, run.pid, os.WEXITED | os.WNOWAIT)
    assert not _lives(run.pid)
    run.stdout.close()
    run.wait()
    assert not _lives(run.pid)


def test_a_client_is_held_to_new_numbers_and_to_its_rate() -> None:
    async def play() -> None:
        client = Clients(1).join(None, "operate")  # type: ignore[arg-type]
        assert not client.may_ask(1, 0.0) and client.may_ask(1, 0.0) and client.may_ask(0, 0.0)
        refused = [bool(client.may_ask(number, 0.0)) for number in range(2, 102)]
        assert refused == [False] * 39 + [True] * 61, "forty at once"
        assert not client.may_ask(200, 1.0), "twenty a second"

    asyncio.run(play())


def test_the_meeting_place_is_private_and_its_address_that_of_a_living_process(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import os

    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    place = MeetingPlace()
    assert place.served() is None
    place.prepare()
    place.publish(PageAddress("u", "v", "s", os.getpid()))
    assert place.address_file.stat().st_mode & 0o777 == 0o600
    assert place.address_file.parent.stat().st_mode & 0o777 == 0o700
    assert place.served() == PageAddress("u", "v", "s", os.getpid())
    place.withdraw()
    assert place.served() is None
    place.address_file.parent.rmdir()
    place.address_file.parent.symlink_to(tmp_path)
    with pytest.raises(OutputError):
        place.prepare()


def test_a_choice_becomes_the_words_of_a_run_that_take_no_other_option() -> None:
    hostile = Choice("wavy_tunnel", "--runs=/tmp", "simulated_leg", display="sbs", trials=3, despite="disk: full")
    args = parse(start_words(hostile))
    assert (args.participant, args.device, args.trials, args.difficulty) == ("--runs=/tmp", "simulated_leg", 3, "usual")
    assert args.despite == "disk: full" and args.console == 8765 and str(args.runs) == "runs" and args.display == "sbs"
    for refused in (
        {"scene": "../x"},
        {"scene": "a", "trials": -1},
        {"scene": "a", "device": "a\nb"},
        {"scene": "a", "x": 1},
    ):
        with pytest.raises(msgspec.ValidationError):
            msgspec.convert(refused, Choice)


def test_a_study_is_played_by_its_next_run_and_nothing_of_a_choice_becomes_an_option() -> None:
    hostile = Choice(
        "a", participant="--out=/tmp", study="my study", device="sim x", interrupted="resume", despite="a 'b"
    )
    args = parse(start_words(hostile))
    assert (str(args.scene), args.words) == ("run", ["my study", "--out=/tmp"])
    assert args.resume and not args.restart_block and str(args.out) == "study"
    run = parse(["run", "a", *shlex.split(args.options)])
    assert (run.device, run.despite, run.console) == ("sim x", "a 'b", 8765)
    for name in ("../x", "a/b", "..", ".hidden", "a\\b", "a\nb"):
        with pytest.raises(msgspec.ValidationError):
            msgspec.convert({"scene": "a", "study": name}, Choice)


@pytest.mark.parametrize(
    ("participant", "interrupted", "light", "word"),
    [
        ("P01", "", "green", "run 2 of session 1: blind"),
        ("P01", "resume", "red", "was not interrupted"),
        ("P02", "", "red", ", was interrupted"),
        ("P02", "restart-block", "green", "run 1"),
        ("P03", "", "red", "are done"),
        ("P04", "", "amber", "new in the study"),
        ("", "", "red", "no participant"),
    ],
)
def test_the_light_of_a_study_says_what_its_participant_plays_next(
    participant: str, interrupted: Any, light: str, word: str
) -> None:
    rows = [
        {"participant": "P01", "session": 1, "over": False, "run": 2, "condition": "blind", "interrupted": 1},
        {
            "participant": "P02",
            "session": 1,
            "over": False,
            "run": 1,
            "condition": "seen",
            "interrupted_attempt": 1,
            "resume_at": 3,
        },
        {"participant": "P03", "session": 2, "over": True},
    ]
    found = study_light(
        Choice("a", study="s", participant=participant, interrupted=interrupted), {"participants": rows}
    )
    assert found.light == light and word in found.found and (found.light == "green") == (found.remedy == "")


@pytest.mark.parametrize(("participant", "files"), [("P01", ["b"]), ("P02", []), ("P03", ["a", "b"])])
def test_the_scenes_of_a_study_that_may_come_next_are_checked(participant: str, files: list[str]) -> None:
    rows = [{"participant": "P01", "condition": "late"}, {"participant": "P02", "over": True}]
    status = {"participants": rows, "scenes": {"early": "a", "again": "a", "late": "b"}}
    assert files_of_next(Choice("a", study="s", participant=participant), status) == files


class Desk:
    """Pages at a server, whose commands run in this process; `words` is what a list of processes would show."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.chdir(folder)
        monkeypatch.setattr("mimics_app.console.participant_forms.ask_command", self.command)
        self.patch, self.words, self.number = monkeypatch, list[str](), 0
        access = Access(("127.0.0.1",), 1, 2, new_tokens(operate=True))
        self.server = page_server.PageServer(access, socket.socketpair()[0])

    async def command(self, *words: str, given: bytes = b"") -> dict[str, Any]:
        self.words += words
        self.patch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(given)))
        return dict(json.loads(mimics(words[0], "--json", *words[1:]).stdout))

    async def ask(self, client: Client, **form: Any) -> dict[str, Any]:
        self.number += 1
        wanted = {"id": self.number, "ask": "form", "form": {"study": "gait", "participant": "P07", **form}}
        client._asked_s = 0.0  # a test is faster than a person
        self.server._take(client, json.dumps(wanted))
        while not client._texts:
            await asyncio.sleep(0)
        return dict(json.loads(client._texts.popleft()))


def test_who_operates_opens_and_answers_a_participants_form_and_nobody_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The study on the disk is asked what was kept."""
    assert mimics("study", "new", tmp_path / "gait", "wavy_tunnel", "--form", "person").returncode == 0
    desk, study = Desk(tmp_path, monkeypatch), StudyFolder(tmp_path / "gait")
    right = {"age": "61.5", "hand": "left", "side": ""}

    async def play() -> None:
        join = desk.server._clients.join
        operator, second, viewer = (join(None, role) for role in ("operate", "operate", "view"))  # type: ignore[arg-type]
        for wanted in ({}, {"form": "person", "add": True}, {"form": "person", "add": True, "answers": right}):
            for other in (viewer, second):
                refused = await desk.ask(other, **wanted)
                assert not refused["done"] and not {"forms", "form", "known"} & set(refused)
        assert desk.words == [] and study.participants == []
        listed = await desk.ask(operator)
        assert listed["done"] and not listed["known"] and list(listed["forms"]) == ["person"]
        new = await desk.ask(operator, form="person")
        assert "no participant" in new["why"] and study.participants == [], "it is added when that is confirmed only"
        shown = (await desk.ask(operator, form="person", add=True))["form"]
        assert list(shown["items"]) == ["age", "hand", "side"] and "answered" not in shown
        assert (await desk.ask(operator, participant=" P07 "))["known"]
        wrong = await desk.ask(operator, form="person", answers=right)
        assert not wrong["done"] and wrong["faults"] == {"/side": '"side" has no answer'}
        assert study.answers_of(study.find("P07")) == []
        assert (await desk.ask(operator, form="person", answers=right | {"side": "none"}))["done"]
        kept = {"age": 61.5, "hand": "left", "side": "none"}
        assert [line["answers"] for line in study.answers_of(study.find("P07"))] == [kept]
        assert (await desk.ask(operator, form="person"))["form"]["answered"] == 1
        for absent in ({"form": "persn"}, {"study": "x"}):
            assert not (await desk.ask(operator, **absent))["done"]

    asyncio.run(play())
    assert "--answers=-" in desk.words and not [word for word in desk.words if "61.5" in word or "left" in word]


@pytest.mark.parametrize(
    "form",
    [
        {"study": "../gait"},
        {"study": ""},
        {"participant": ""},
        {"participant": "P\n7"},
        {"participant": "7" * 121},
        {"form": "x" * 121},
        {"answers": {"age": 61}},
        {"answers": {"age": "6" * 2001}},
        {"answers": {str(number): "" for number in range(201)}},
        {"out": "/tmp"},
    ],
)
def test_what_is_asked_of_a_form_is_held_to_its_schema(form: dict[str, Any]) -> None:
    good = {"study": "gait", "participant": "P07", "form": "person", "answers": {"age": "61"}}
    assert msgspec.json.decode(json.dumps(good), type=FormRequest).answers == {"age": "61"}
    with pytest.raises(msgspec.ValidationError):
        msgspec.json.decode(json.dumps(good | form), type=FormRequest)


def test_a_folder_that_is_no_study_is_said() -> None:
    status = {"errors": [{"what": "is not the folder of a study"}]}
    assert study_light(Choice("a", study="s", participant="P01"), status).found == "is not the folder of a study"


def test_lights_say_what_is_missing_and_what_to_do() -> None:
    ready = {
        "runs": {"writable": True, "free_gb": 9.0, "gb_an_hour": 0.9},
        "al": {"ok": True},
        "scheduler": {"fifo": True},
        "displays": {"monitors": ["HDMI-1 1920 x 1080"]},
    }
    assert {light.light for light in machine_lights(ready)} == {"green"}
    full = {
        light.name: light
        for light in machine_lights(ready | {"runs": {"writable": True, "free_gb": 0.5, "gb_an_hour": 0.9}})
    }
    assert full["disk"].light == "red" and full["disk"].remedy
    bare = machine_lights({})
    assert [light.light for light in bare] == ["red", "amber", "amber", "amber"] and all(light.remedy for light in bare)
    assert scene_light({"errors": [{"what": "no camera", "fix": "add one"}]}).remedy == "add one"
    devices = {"devices": [{"name": "serial"}]}
    assert device_light(Choice("a", device="serial:/dev/ttyUSB0"), devices).light == "green"
    assert device_light(Choice("a", device="unknown"), devices).light == "red"
    kinds = {"display_kinds": [{"name": "sbs", "error": ""}, {"name": "openxr", "error": "no runtime"}]}
    chosen = {each: shown_light(Choice("a", display=each), kinds) for each in ("", "sbs", "openxr", "hmd:a.json")}
    assert chosen[""] == [] and [light.light for (light,) in list(chosen.values())[1:]] == ["green", "red", "red"]
    assert tracker_light({}).light == "green"
    sought = tracker_light({"files": [{"ok": True, "trackers": ["fastrak", "vrpn"]}]})
    assert sought.light == "amber" and "fastrak, vrpn" in sought.found and sought.remedy
    assert [signal_light(Choice("a", physio=kind)).light for kind in ("", "sim:calm", "lsl:ECG")] == [
        "green",
        "green",
        "amber",
    ]


def test_the_texts_of_the_page_are_found_in_its_files() -> None:
    texts = set(page_texts())
    assert {"STOP", "Force on", "pain", "Refused: {why}", "no data arrive", _LEFT, _GONE, *AROUND} <= texts


def test_a_reader_gets_the_catalogue_of_the_first_language_that_there_is() -> None:
    german = page_server.catalogue("xx, de-CH;q=0.9, en;q=0.8")
    assert german["language"] == "de" and set(page_texts()) <= set(german["texts"])  # type: ignore[call-overload]
    english = {"language": "en", "texts": {}, "plurals": {}}
    assert page_server.catalogue("en, de") == page_server.catalogue("../..") == english
