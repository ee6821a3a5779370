"""The report holds every part, needs nothing but itself, and comes out of a damaged run too."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from mimics_app.app.cli import main
from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.loop.haptic import SafetyState, TripCause
from mimics_app.contracts.messages.report_section import ReportSection
from mimics_app.plotting.axis import Axis, nice_ticks
from mimics_app.plotting.plot import Plot, envelope
from mimics_app.recording.attempts import find_attempts, tunnel_shape
from mimics_app.recording.columns import column_names
from mimics_app.recording.json_text import indented_json
from mimics_app.recording.report import page_of, write_report
from mimics_app.recording.report_figures import draw_path
from mimics_app.recording.report_real_time import punctuality
from mimics_app.recording.report_stability import stability_lines
from mimics_app.recording.report_tables import contact_rows, governor_tables, plan_tables, trials_of
from mimics_app.recording.report_values import Seconds, shown, thousands
from mimics_app.recording.result_words import trial_lines
from mimics_app.recording.run import Run
from mimics_app.recording.trial_table import TrialTable, read_trials, table_text
from mimics_app.tasks.kinds.registry import report_sections
from tests.support.synthetic_run import RADIUS, bisector, samples_of_session, scene_block, write_synthetic_run


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_synthetic_run(tmp_path_factory.mktemp("run"))


@pytest.fixture(scope="module")
def page(folder: Path) -> str:
    return write_report(folder, report_sections()).read_text()


class _Reader(HTMLParser):
    """Collects tags, and fails on one that closes what is not open."""

    VOID = ("meta", "path", "rect", "circle", "br", "img")

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.seen: set[str] = set()
        self.links: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.seen.add(tag)
        self.links += [value or "" for name, value in attrs if name in ("src", "href", "action", "data")]
        if tag not in self.VOID or (tag in ("path", "rect", "circle") and not self.get_starttag_text().endswith("/>")):
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.seen.add(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


@pytest.mark.seconds
def test_page_is_well_formed_and_offline(page: str) -> None:
    reader = _Reader()
    page = re.sub(r"data:image/jpeg;base64,[A-Za-z0-9+/=]+", "", page)  # a picture within the page
    reader.feed(page.replace('<meta charset="utf-8">', "").replace("<!doctype html>", ""))
    assert reader.open in ([], ["meta"])
    assert (
        {link[:1] for link in reader.links} <= {"", "#"} and "script" not in reader.seen and "link" not in reader.seen
    )
    assert not re.search(r"https?:|//[a-z]|@import|url\(", page)
    assert not any(ord(c) < 32 and c != "\n" for c in page)
    assert "nan" not in re.findall(r'd="([^"]*)"', page).__str__()


def test_page_holds_every_part(page: str) -> None:
    for words in (
        "handle path", "centre line of the tunnel", "walls of the tunnel", "lateral [mm]", "vertical [mm]",
        "force [N]", "tunnel force [N]", "velocity [m/s]", "off the line [mm]",
        "stability margin [%]", "energy [mJ]",
        "smallest stability margin", "smallest stable stiffness then [N/m]",
        "<h2>Trials</h2>", "path error rms [mm]", "Contacts: touch, picture and sound", "first frame",
        "sound after [ms]",
        "Safety", "E_STOP", "Safety stops: 1; short holds: 0", "the stop key was pressed", "reset it when it is safe",
        "recording complete", "Real time", "p99.9", "fifo", "late control cycles after the first second",
        "Settings", "settings.safety.force_limit", "scene.hash",
        "200 values",
        "The whole scene", "moderate", "tunnel projection", "Left out",
        "Environment", "machine.cores", "versions.numpy", "State hash", "trials.csv", "no safety function",
    ):  # fmt: skip
        assert words in page, words
    assert "wavy &lt;1&gt;" in page and "wavy <1>" not in page, "a label is text, not markup"


def _play(parent: Path, name: str, time_s: float, score: float, preset: str = "severe") -> Path:
    """A run of participant P1 in a folder of runs."""
    folder = parent / name
    folder.mkdir()
    write_synthetic_run(folder, 4.0)
    session, manifest = (json.loads((folder / file).read_text()) for file in ("session.json", "manifest.json"))
    session["settings"] = {**session.get("settings", {}), "participant": "P1"}
    session["clock"] = {"utc": "2026-01-02T10:15:00+00:00"}
    session["moved_by"] = {"device": "simulated_hapticmaster", "person": "simulated", "preset": preset}
    task = {"completed": 2, "trials": 3, "counted": "trials", "time_s": time_s, "score": score}
    manifest["summary"]["task"] = task
    (folder / "session.json").write_text(json.dumps(session))
    (folder / "manifest.json").write_text(json.dumps(manifest))
    rows = [
        {**row, "practice": False, "outcome": "finished", "time_s": time_s}
        for row in read_trials(folder / "trials.csv")
    ]
    (folder / "trials.csv").write_bytes(table_text(rows))
    return folder


def test_page_one_says_who_when_what_it_came_to_and_how_it_went_over_time(tmp_path: Path) -> None:
    first = _play(tmp_path, "20260101T000000Z_a", 5.0, 60.0)
    second = _play(tmp_path, "20260201T000000Z_b", 4.0, 72.0)
    page = write_report(second, report_sections()).read_text()
    assert "2 of 3 trials finished, 20 % faster than last time." in page
    assert "participant P1" in page and "2026-01-0" in page, "local date"
    assert "simulated patient, severe" in page
    assert page.index("<b>72</b><span>score of 100</span>") < page.index("<h2>Trials</h2>")
    assert page.index("Score over the sessions of P1") < page.index("Movement through the tunnel")
    assert page_of(Run.open(second), report_sections()).front.trend is not None
    front = page_of(Run.open(first), report_sections()).front
    assert front.trend is None and front.sentence == "2 of 3 trials finished.", "what came later is no earlier session"
    assert front.trials is not None and list(front.trials.names[:3]) == ["Trial", "Result", "Time"]


def test_a_simulated_person_is_not_compared_with_one_of_another_preset(tmp_path: Path) -> None:
    _play(tmp_path, "20260101T000000Z_a", 5.0, 60.0, "moderate")
    second = _play(tmp_path, "20260201T000000Z_b", 4.0, 72.0)
    front = page_of(Run.open(second), report_sections()).front
    assert front.trend is None and front.sentence == "2 of 3 trials finished."


def test_a_simulated_person_whose_preset_is_lost_is_reported_without_it(tmp_path: Path) -> None:
    """A damaged header, which a replay copies into its own."""
    write_synthetic_run(tmp_path, 1.0)
    header = tmp_path / "session.json"
    header.write_text(json.dumps(json.loads(header.read_text()) | {"moved_by": {"person": "simulated"}}))
    assert "simulated patient, –" in write_report(tmp_path, report_sections()).read_text(encoding="utf-8")


def test_a_scene_is_shown_with_a_list_of_numbers_in_one_line() -> None:
    scene = {"points": [[0.5, -1.0], [2.0, 0.0]], "text": 'a "[" and\na {brace}', "empty": {}, "deep": [{"a": [1, {}]}]}
    text = indented_json(scene)
    assert json.loads(text) == scene
    assert "[ 0.5, -1.0 ]" in text


def test_what_is_for_an_operator_is_folded(page: str) -> None:
    behind = page[page.index("Every measure of each trial") :]
    for words in ("short holds", "smallest stability margin", "State hash", "N/m]", "sound after [ms]"):
        assert words in behind and words not in page[: page.index("Every measure of each trial")], words
    assert behind.count("<details") == behind.count("</details>") - 1  # the one whose summary this is


class _Places(HTMLParser):
    """Where the links lead, and in how many foldable parts each place lies that they name."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.depth, self.places, self.links = 0, dict[str, int](), list[str]()
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.depth += tag == "details"
        found = dict(attrs)
        self.places |= {str(found["id"]): self.depth} if "id" in found else {}
        self.links += [str(found["href"])] if tag == "a" else []

    def handle_endtag(self, tag: str) -> None:
        self.depth -= tag == "details"


def test_every_trial_is_reached_from_its_row_from_the_list_and_from_its_neighbours(folder: Path, page: str) -> None:
    """A browser unfolds what a link leads into: the place lies inside the folded part, not on it."""
    attempts, found = find_attempts(Run.open(folder)), _Places(page)
    assert len(attempts) > 1
    for i, attempt in enumerate(attempts):
        assert found.places[attempt.anchor] == 1
        neighbours = 2 if 0 < i < len(attempts) - 1 else 1
        assert found.links.count(f"#{attempt.anchor}") == 1 + bool(attempt.row) + neighbours
    assert {link[1:] for link in found.links} <= set(found.places)


def _in_browser(folder: Path, tmp_path: Path, option: str, anchor: str = "") -> str:
    """What Chromium prints about a report."""
    browser = shutil.which("chromium") or shutil.which("google-chrome")
    if browser is None:
        pytest.skip("no Chromium: apt-get install chromium")
    words = ["--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={tmp_path / 'profile'}"]
    done = subprocess.run(
        [browser, *words, option, f"{(folder / 'report.html').as_uri()}{anchor}"],
        check=True, timeout=120, capture_output=True, text=True,
    )  # fmt: skip
    return done.stdout


@pytest.mark.slow
def test_a_browser_unfolds_the_trial_that_a_link_names(folder: Path, page: str, tmp_path: Path) -> None:
    folded = next(each.anchor for each in page_of(Run.open(folder), report_sections()).movement if not each.open)
    followed = _in_browser(folder, tmp_path, "--dump-dom", f"#{folded}")
    for text, begins in ((page, "<details>"), (followed, "<details open")):
        before = text[: text.index(f'id="{folded}"')]
        assert before[before.rindex("<details") :].startswith(begins)


@pytest.mark.slow
def test_it_prints_on_four_pages(folder: Path, page: str, tmp_path: Path) -> None:
    file = tmp_path / "report.pdf"
    _in_browser(folder, tmp_path, f"--print-to-pdf={file}")
    assert 1 <= len(re.findall(rb"/Type\s*/Page[^s]", file.read_bytes())) <= 4


def test_stops_and_short_holds_are_counted_apart(tmp_path: Path) -> None:
    folder = write_synthetic_run(tmp_path, 4.0)
    line = (
        '{"source":"loop","kind":"%s","n":%d,"t_ns":0,"tick":%d,"body_a":0,"body_b":-1,"material_a":0,'
        '"material_b":0,"speed":0,"force":%d,"value":0,"position_world":[0,0,0],"normal_world":[0,0,0]}'
    )
    reported = [("state", SafetyState.DEGRADED), ("trip", TripCause.LATE_TICK)]
    reported += [("state", SafetyState.SAFE_STOP), ("trip", TripCause.STALE_DEVICE)]
    lines = [line % (kind, i, 1000 + i, number) for i, (kind, number) in enumerate(reported)]
    (folder / "events.jsonl").write_text("\n".join(lines) + "\n")
    page = write_report(folder, report_sections()).read_text(encoding="utf-8")
    assert "<b>1</b><span>safety stops</span>" in page and "<b>1</b><span>short holds</span>" in page
    assert "this computer was too busy" in page and "check its cable and its power" in page


def test_figure_48_colours(page: str) -> None:
    style = page[page.index("<style>") : page.index("</style>")]
    assert ".line.robot { stroke: var(--robot)" in style and "--robot: #1559c9" in style
    assert "--bisector: #c62828" in style and "--wall: #1f8a3b" in style
    assert "prefers-color-scheme: dark" in style and "@media print" in style


def test_tunnel_is_drawn_where_it_is() -> None:
    """Hermite pieces of a sine: 4th-order, bound h^4/384 max|y''''| = 0.06 (2 pi/0.24)^4 0.045^4/384 = 0.3 mm."""
    shape = tunnel_shape(*scene_block(1, 1, 3))
    assert shape is not None
    x, y = shape.bisector_world[:, 0], shape.bisector_world[:, 1]
    assert np.abs(y - bisector(x)).max() <= 0.06 * (2 * np.pi / 0.24) ** 4 * 0.045**4 / 384
    assert np.allclose(shape.radius, RADIUS - 0.0012 * np.linspace(0, 8, len(x)), atol=1e-15)
    block, rows = scene_block(1, 1, 3)
    assert tunnel_shape(block, rows._replace(tunnels=rows.tunnels[:0])) is None
    assert tunnel_shape(block, None) is None


def test_the_noise_of_a_hand_at_rest_is_no_path(folder: Path) -> None:
    run = Run.open(folder)
    moved = find_attempts(run)[0]
    samples = moved.samples.copy()
    samples["hip_world"] = [0.0, 0.3, 0.0] + np.random.default_rng(1).normal(0.0, 1e-4, (len(samples), 3))
    plain = ReportSection()
    assert draw_path(plain, moved, {}, run.events) is not None
    assert draw_path(plain, replace(moved, samples=samples), {}, run.events) is None


def test_attempts_are_reported_apart_by_the_parameter_blocks(folder: Path) -> None:
    attempts = find_attempts(Run.open(folder))
    assert [attempt.number for attempt in attempts] == [1, 2]
    assert [len(attempt.samples) for attempt in attempts] == [12_000, 12_000]
    assert [int(attempt.free.sum()) for attempt in attempts] == [10_500, 10_500]
    assert attempts[0].title == "Practice · wavy <1> · finished · score 81 of 100"


def test_a_trial_ends_in_the_same_word_in_the_table_and_above_its_figure(tmp_path: Path) -> None:
    table = write_synthetic_run(tmp_path) / "trials.csv"
    table.write_text(table.read_text(encoding="utf-8").replace("finished", "aborted"), encoding="utf-8")
    run = Run.open(tmp_path)
    words = [line[1] for line in trial_lines(run.trials)[1]]
    assert words
    assert set(words) == {"broken off"}
    assert all(" broken off" in attempt.title for attempt in find_attempts(run))


def test_a_sound_whose_tick_is_null_is_of_no_contact(tmp_path: Path) -> None:
    write_synthetic_run(tmp_path, 4.0)
    with (tmp_path / "events.jsonl").open("a") as events:
        events.write('{"source":"app","kind":"sound","tick":null}\n')
    assert contact_rows(Run.open(tmp_path)) == []


def test_contacts_meet_their_frame_and_their_sound(folder: Path) -> None:
    rows = contact_rows(Run.open(folder))
    assert len(rows) > 20
    for row in rows:
        frame = int(np.ceil(row["tick"] * 60 / 1000 - 1e-9))
        assert row["first frame"] in (frame, frame - 1, frame + 1)
        assert 0 <= row["frame after [ms]"] <= 17
        assert row["sound after [ms]"] == pytest.approx(10.0)
        assert row["peak force [N]"] == pytest.approx(1.2 * row["depth [mm]"])
        assert row["lasted [ms]"] >= 1


def test_lateness_comes_from_the_rows() -> None:
    samples = samples_of_session(10.0)
    result = punctuality(samples)
    assert result is not None
    late = samples[1000:]
    assert result.marks["max"] == pytest.approx(late["lateness_ns"].max() * 1e-3)
    assert result.missed == int((late["lateness_ns"] + late["duration_ns"] > 1e6).sum()) > 0
    assert punctuality(samples_of_session(2.0, live=False)) is None


_SCRIPT = "<script>alert(1)</script>"


def _poisoned(item: object) -> object:
    """The same object with a script in every text and name, and instead of every number."""
    if isinstance(item, dict):
        return {f"{name}{_SCRIPT}" if _is_listed(name) else name: _poisoned(part) for name, part in item.items()}
    return [_poisoned(part) for part in item] if isinstance(item, list) else _SCRIPT


def _is_listed(name: str) -> bool:
    """Whether a report lists what stands under this name as it comes."""
    return name in ("force_limit", "cores", "numpy", "left_out")


def test_no_text_of_a_recording_is_markup(tmp_path: Path) -> None:
    """A run folder from elsewhere: a script in every value of the manifest's summary, session, events and trials."""
    write_synthetic_run(tmp_path, 4.0)
    manifest = json.loads((tmp_path / "manifest.json").read_text())
    manifest["summary"] = _poisoned({**manifest["summary"], "governor": {"moves": 1, "shares": {"full": 1}}})
    manifest["problem"] = _SCRIPT
    (tmp_path / "manifest.json").write_text(json.dumps(manifest))
    session = json.loads((tmp_path / "session.json").read_text())
    (tmp_path / "session.json").write_text(json.dumps(_poisoned(session)))
    with (tmp_path / "events.jsonl").open("a") as file:
        for kind in ("audio", "quality", "action", "governor", "scheduler"):
            file.write(json.dumps({"source": "app", "kind": kind, _SCRIPT: _SCRIPT, "step": _SCRIPT}) + "\n")
        file.write(json.dumps({"source": "recorder", "kind": "gap", "after_row": 0, "reason": _SCRIPT}) + "\n")
    trials = (tmp_path / "trials.csv").read_text()
    (tmp_path / "trials.csv").write_text(trials.replace("finished", _SCRIPT).replace("81.25", _SCRIPT))
    page = write_report(tmp_path, report_sections()).read_text()
    assert "<script" not in page
    assert page.count("&lt;script&gt;") > 20, "it is shown as text"


def test_changes_of_quality_have_a_direction_under_either_name(tmp_path: Path) -> None:
    """Older recordings call it "way"."""
    write_synthetic_run(tmp_path, 2.0)
    with (tmp_path / "events.jsonl").open("a") as file:
        for name in ("way", "direction"):
            line = {"source": "app", "kind": "governor", "step": "bloom", "level": "off", name: "down"}
            file.write(json.dumps(line) + "\n")
    assert governor_tables(Run.open(tmp_path))["Changes of quality"].rows == [["bloom", "off", "down", None]] * 2


def test_the_figure_that_was_markup(tmp_path: Path) -> None:
    write_synthetic_run(tmp_path, 2.0)
    manifest = json.loads((tmp_path / "manifest.json").read_text())
    manifest["summary"]["task"] = {"completed": _SCRIPT, "trials": _SCRIPT, "contacts": _SCRIPT}
    (tmp_path / "manifest.json").write_text(json.dumps(manifest))
    page = write_report(tmp_path, report_sections()).read_text()
    assert "<script" not in page and "<b>&lt;script&gt;alert(1)&lt;/script&gt;</b>" in page


@pytest.mark.parametrize(
    ("reported", "said"),
    [
        ({}, "Averages of all trials that ended"),
        ({"counted": "trials"}, "Averages of all trials that ended"),
        ({"counted": "practice"}, "figures are those of practice"),
        ({"counted": "under way"}, "figures are those of the one that was cut off"),
    ],
)
def test_the_note_says_what_the_figures_are_over(tmp_path: Path, reported: dict[str, str], said: str) -> None:
    write_synthetic_run(tmp_path, 2.0)
    manifest = json.loads((tmp_path / "manifest.json").read_text())
    manifest["summary"]["task"] = {"completed": 0, "trials": 0, "time_s": 1.0, **reported}
    (tmp_path / "manifest.json").write_text(json.dumps(manifest))
    assert said in write_report(tmp_path, report_sections()).read_text()


def test_trials_come_first_with_units_and_within_the_page(tmp_path: Path) -> None:
    write_synthetic_run(tmp_path, 4.0)
    session = json.loads((tmp_path / "session.json").read_text())
    parameters = {"radius": {"min": 0, "max": 1}, "stiffness": {"unit": "N/m"}}
    session["scene"]["document"]["task"] = {"parameters": parameters}
    (tmp_path / "session.json").write_text(json.dumps(session))
    names = [f"measure_{i}" for i in range(20)]
    row = {
        "trial": 0,
        "outcome": "finished",
        "smoothness": -1.5,
        "parameter.radius": 1.2,
        "parameter.stiffness": 2400.0,
    }
    table = TrialTable(tmp_path / "trials.csv", resume=True)
    table.append({**row, **dict.fromkeys(names, 1)})
    table.close()
    trials = trials_of(Run.open(tmp_path))
    assert trials is not None and trials.given is not None
    assert trials.given.names == ["trial", "radius [–]", "stiffness [N/m]"]
    assert "smoothness (spectral arc length) [–]" in trials.measured[0].names
    assert all(len(table.names) <= 13 and table.names[0] == "trial" for table in trials.measured)
    assert {name.replace("_", " ") for name in names} <= {n for t in trials.measured for n in t.names}, "none is lost"
    page = write_report(tmp_path, report_sections()).read_text()
    assert page.index("<h2>Trials") < page.index("<h2>Movement")


def test_moments_of_a_long_run_are_reported_to_the_millisecond() -> None:
    assert shown(Seconds(1583.1234)) == "1583.123" and shown(1583.1234) == "1583"
    assert (shown(None), shown(float("nan")), shown(True), shown([1, {"a": 2.5}])) == ("–", "–", "yes", "1, a 2.5")


def test_interrupted_run_is_reported_and_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_synthetic_run(tmp_path, 6.0, closed=False)
    path = tmp_path / "haptic.arrows"
    os.truncate(path, path.stat().st_size * 2 // 3)
    assert main(["report", str(tmp_path), "--json"]) == 6
    answer = json.loads(capsys.readouterr().out)
    assert answer["status"] == "open" and any("never closed" in problem for problem in answer["problems"])
    text = Path(answer["report"]).read_text()
    assert "This recording is not whole" in text and "handle path" in text


def test_run_without_anything_is_still_reported(tmp_path: Path) -> None:
    (tmp_path / "session.json").write_text("{")
    text = write_report(tmp_path, report_sections()).read_text()
    assert "No tick was recorded" in text and "No trial was finished" in text
    with pytest.raises(SceneError):
        write_report(tmp_path / "nothing", report_sections())


def test_record_command_mends_and_verifies(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_synthetic_run(tmp_path, 4.0, closed=False)
    assert main(["record", "info", str(tmp_path)]) == 6
    assert main(["record", "recover", str(tmp_path), "--json"]) == 6, "all there is was saved, and it was cut off"
    lines = capsys.readouterr().out.splitlines()
    answer = json.loads(lines[-1])
    assert answer["status"] == "recovered" and answer["ticks"] == 4000
    assert answer["problems"] == ["the run is recovered"] and "manifest.json" in answer["repaired"]
    with (tmp_path / "trials.csv").open("a") as file:
        file.write("x")
    assert main(["record", "verify", str(tmp_path)]) == 6
    assert "trials.csv was changed" in capsys.readouterr().out


def test_verify_gives_a_verdict_and_does_not_describe(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """What `info` prints says nothing of whether the files are those that were sealed."""
    for name in ("whole", "open"):
        (tmp_path / name).mkdir()
    write_synthetic_run(tmp_path / "whole", 2.0)
    assert main(["record", "verify", str(tmp_path / "whole")]) == 0
    (line,) = capsys.readouterr().out.splitlines()
    assert line.split()[0] == "verified" and "files and the state hash match their checksums" in line
    assert main(["record", "verify", "--json", str(tmp_path / "whole")]) == 0
    assert json.loads(capsys.readouterr().out)["verified"] is True
    with (tmp_path / "whole" / "trials.csv").open("a") as file:
        file.write("x")
    assert main(["record", "verify", str(tmp_path / "whole")]) == 6
    said = capsys.readouterr().out.splitlines()
    assert said[0].split()[0] == "damaged" and all(line.split()[0] == "problem" for line in said[1:])
    write_synthetic_run(tmp_path / "open", 2.0, closed=False)
    assert main(["record", "verify", str(tmp_path / "open")]) == 6
    assert capsys.readouterr().out.startswith("not verified")


def test_title_of_the_scene_is_the_title_of_its_report(tmp_path: Path) -> None:
    write_synthetic_run(tmp_path, 2.0)
    session = json.loads((tmp_path / "session.json").read_text())
    session["scene"]["title"] = "Along the bisector only"
    (tmp_path / "session.json").write_text(json.dumps(session))
    assert page_of(Run.open(tmp_path), report_sections()).title == "Report of Along the bisector only"


def test_figures_are_no_rounding_noise_and_large_ones_have_no_exponent() -> None:
    assert (shown(9.006e-15), shown(-3e-16), shown(2e-9)) == ("0", "0", "2e-09")
    assert (shown(10_370.4), shown(-12_000.0), shown(1.5e9)) == ("10370", "-12000", "1.5e+09")
    parts = [{"part": "shadow", "cost_us": 10_370.0}, {"part": "tunnel", "cost_us": 0.31}, {"part": "sky"}]
    tables = plan_tables({"parts": parts, "left_out": [{"part": "skin", "saved_us": 1500.0}]})
    assert [row[3] for row in tables["Methods"].rows] == ["10.4 ms", "0.310 µs", None]
    assert tables["Left out"].rows[0][2] == "1.5 ms"


def test_stability_is_drawn_only_where_something_was_touched(folder: Path) -> None:
    attempt = find_attempts(Run.open(folder))[0]
    assert set(stability_lines(attempt)) == {"stability margin [%]", "energy [mJ]"}
    samples = attempt.samples.copy()
    samples["penetration"], samples["touching"] = 0.0, 0.0
    assert stability_lines(replace(attempt, samples=samples)) == {}


def test_late_control_cycles_are_those_after_the_first_second(tmp_path: Path) -> None:
    """The word of the terminal; a run of two seconds or less leaves none out, and does not say that it does."""
    for seconds, after in ((4.0, " after the first second"), (2.0, "")):
        folder = tmp_path / str(seconds)
        folder.mkdir()
        page = page_of(Run.open(write_synthetic_run(folder, seconds)), report_sections())
        counted = thousands(3000 if after else 2000)
        assert page.safety is not None and f"late control cycles of {counted}{after}" in page.safety.cards
        assert page.real_time is not None and page.real_time.table is not None
        assert f"control cycles{after}" in [row[0] for row in page.real_time.table.rows]
        assert not any("missed" in name for name in page.cards)


def test_info_says_the_length_of_the_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """It lasted as long as its ticks, the last one included."""
    write_synthetic_run(tmp_path, 2.0)
    assert main(["record", "info", "--json", str(tmp_path)]) == 0
    assert json.loads(capsys.readouterr().out)["seconds"] == 2.0


# the plots


def test_envelope_keeps_every_peak() -> None:
    values = np.zeros(100_000)
    values[[77, 50_001, 99_999]] = 5.0
    values[31_234] = -3.0
    t = np.arange(100_000.0)
    x, y = envelope(t, values, 500)
    assert len(y) <= 1000 and np.all(np.diff(x) > 0)
    assert sorted(x[y != 0]) == [77, 31_234, 50_001, 99_999]
    assert np.array_equal(envelope(t[:10], values[:10])[1], values[:10])


@pytest.mark.parametrize(("low", "high"), [(0, 1), (-0.03, 0.07), (1e-9, 3e-9), (-5000, 12345), (999.9, 1000.1)])
def test_ticks_are_few_round_and_inside(low: float, high: float) -> None:
    ticks = nice_ticks(low, high)
    assert 2 <= len(ticks) <= 13
    assert ticks[0] >= low - 1e-9 * (high - low) and ticks[-1] <= high + 1e-9 * (high - low)
    assert Axis("", 0.5, 2000.0, log=True).ticks() == [1.0, 10.0, 100.0, 1000.0]


def test_equal_axes_have_one_scale() -> None:
    """One millimetre is as long upwards as sideways, whichever range is the longer."""
    for x, y in ((Axis("x", 0, 100), Axis("y", 0, 10)), (Axis("x", 0, 1), Axis("y", 0, 50))):
        plot = Plot.equal(x, y, "t")
        across = float(np.diff(plot._pixels(np.array([0.0, 1.0]), np.zeros(2))[0])[0])
        upwards = float(-np.diff(plot._pixels(np.zeros(2), np.array([0.0, 1.0]))[1])[0])
        assert across == pytest.approx(upwards)
        assert plot.x.low <= x.low + 1e-9 and plot.y.high >= y.high - 1e-9


def test_flat_and_empty_data_have_an_axis() -> None:
    for data in (np.zeros(3), np.full(3, 7.0), np.array([]), np.array([np.nan])):
        axis = Axis.of("a", data, zero=True)
        assert axis.high > axis.low
        assert len(axis.ticks()) > 1


@pytest.mark.seconds
def test_snippets_of_the_guide_run(folder: Path) -> None:
    guide = (Path(__file__).parents[2] / "docs" / "recording.md").read_text()
    names: dict[str, object] = {"run": str(folder)}
    for snippet in re.findall(r"```python\n(.*?)```", guide, re.DOTALL):
        exec(compile(snippet, "docs/recording.md", "exec"), names)
    assert np.array_equal(names["height"], Run.open(folder).haptic["hip_world"][:, 1])
    assert len(names["contacts"]) > 20
    assert f"a list of {len(column_names()) - 1} numbers" in guide


@pytest.mark.parametrize(
    ("walk", "captions"), [({}, {"Path"}), ({"distance_m": 140.0, "walk_speed_mps": 1.2}, {"Walked"})]
)
def test_the_path_of_a_hand_that_steers_a_walk_is_not_among_the_results(walk, captions) -> None:
    row = {"trial": 0, "outcome": "finished", "time_s": 168.0, "path_m": 0.79, **walk}
    assert {"Path", "Walked"} & set(trial_lines([row])[0]) == captions
