"""The participants' pages of the launcher: what they offer, what is kept, that they fit, and that keys and mouse do."""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace

import pytest

from mimics_app.app.commands import launch
from mimics_app.app.commands.run import _own_body, add_arguments
from mimics_app.app.play.journey import JourneyEnd
from mimics_app.app.play.launching import launcher_settings
from mimics_app.app.scenes.scene_search import find_scene
from mimics_app.app.study import people_screen, study_runs
from mimics_app.app.study.forms import Form, Item
from mimics_app.app.study.people_pages import (
    Person,
    answers_given,
    earlier_content,
    fault_words,
    form_content,
    list_content,
    person_content,
    settings_content,
)
from mimics_app.app.study.people_screen import show_people
from mimics_app.app.study.studies import body_of_code, fit_of_code, studies_in, usual_study
from mimics_app.app.study.study_export import write_participant_page
from mimics_app.app.study.study_folder import StudyFolder
from mimics_app.app.study.study_runs import words_of_settings
from mimics_app.app.terminal.participant import why_no_code
from mimics_app.contracts.errors import SceneError, UsageError
from mimics_app.contracts.messages.calibration_record import MEASURE_TITLES, CalibratedMeasure, Calibration
from mimics_app.contracts.messages.window_input import InputEvent
from mimics_app.contracts.system.language import LANGUAGES, speaking, translated
from mimics_app.recording.trial_table import table_text
from mimics_app.rendering.visual.launcher import form_page
from mimics_app.rendering.visual.launcher.form_page import FormContent, FormPage, PageButton
from mimics_app.rendering.visual.launcher.launcher import LauncherChoice
from mimics_app.rendering.visual.launcher.setting import Setting
from mimics_app.tasks.walking.throttle import Throttle
from tests.support.watched_hud import WatchedHud, page_canvas

CANVASES = [(1280, 720), (1080, 1920)]
ENTER, LEAVE = InputEvent("key", "enter", True), InputEvent("key", "escape", True)
DOWN, RIGHT = InputEvent("key", "down", True), InputEvent("key", "right", True)
TO_SETTINGS = [[ENTER], [*[InputEvent("key", "up", True)] * 2, ENTER]]
"""From the list of the participants to the settings of the first."""


def typed(text: str) -> list[InputEvent]:
    return [InputEvent("text", letter) for letter in text]


def calibration(session: int) -> Calibration:
    names = [*MEASURE_TITLES]
    return Calibration({name: CalibratedMeasure(name, 0.1 * session + 8.0, "m", 3, 0.1) for name in names}, {}, "run")


@pytest.fixture
def study(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> StudyFolder:
    monkeypatch.chdir(tmp_path)
    return usual_study(Path())


def calibrated(study: StudyFolder) -> Person:
    """A participant with three calibrations, answers and a note."""
    person = study.find_or_add("P07")
    for session in (1, 2, 3):
        study.write_calibration(person, session, calibration(session))
        items = study.protocol.forms["nasa_tlx"].items
        study.write_answers(person, "nasa_tlx", session, dict.fromkeys(items, 20.0 * session))
    study.write_note(person, 1, "Tired at the end")
    return Person(study, person)


class Drawn:
    """Stands in for the surface of a page."""

    def __init__(self, hud: WatchedHud) -> None:
        self.hud = hud

    def fit(self) -> None:
        pass

    def draw(self) -> None:
        pass

    def release(self) -> None:
        pass

    def place(self, event: InputEvent) -> tuple[float, float]:
        return event.x, event.y


@pytest.mark.parametrize("code", LANGUAGES)
@pytest.mark.parametrize("size", CANVASES)
def test_every_page_fits_in_every_language_and_window(
    code: str, size: tuple[int, int], study: StudyFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    canvas = page_canvas(size)
    monkeypatch.setattr(form_page, "PageSurface", lambda surface: Drawn(canvas))
    person, new = calibrated(study), Person(study, study.find_or_add("P08"))
    broken = study.find_or_add("P09")
    study.write_line(broken, 1, {"run": 1, "attempt": 1, "condition": "wavy_tunnel", "from_trial": 1})
    with speaking(code):
        contents = [
            list_content(studies_in(Path()), study),
            *(person_content(person, group, "HapticMaster") for group in person.curves),
            person_content(new, "", "HapticMaster"),
            person_content(Person(study, broken), "", "HapticMaster"),
            *(form_content(form) for form in study.protocol.forms.values()),
            settings_content(study, person.participant),
            earlier_content(study, person.participant)[0],
        ]
        for content in contents:
            for row in content.rows:
                choices = (
                    [each.value for each in row.choices if not each.value.isdigit()] if isinstance(row, Setting) else []
                )
                for value in choices or [""]:
                    FormPage(None, content, {row.name: value}, row.name).draw()  # type: ignore[arg-type]
    assert not sorted({f"{fault.how}: {fault.text}" for fault in canvas.faults})


def test_a_calibration_comes_first_where_there_is_none(study: StudyFolder) -> None:
    new = person_content(Person(study, study.find_or_add("P08")), "", "")
    first = new.rows[0]
    assert isinstance(first, PageButton) and first.name == "calibrate" and first.main
    later = [row for row in person_content(calibrated(study), "", "").rows if isinstance(row, PageButton)]
    assert [(row.name, row.main) for row in later[:2]] == [("play", True), ("calibrate", False)]


def test_curves_are_what_was_measured_over_the_sessions(study: StudyFolder) -> None:
    person = calibrated(study)
    grip = next(curve for curve in person.curves["other"] if curve.title == "grip strength")
    assert grip.values == pytest.approx([810.0, 820.0, 830.0]) and grip.unit == "cm"
    mental = person.curves["answers"][0]
    assert list(mental.values) == [20.0, 40.0, 60.0] and mental.places[-1] == "session 3"
    assert "Tired at the end" in person.notes[0]


def test_answers_are_checked_and_commas_are_decimal_marks(study: StudyFolder) -> None:
    form = study.protocol.forms["person"]
    good, fault = answers_given(form, {"age": "61,5", "hand": "right", "side": "left"})
    assert good == {"age": 61.5, "hand": "right", "side": "left"} and not fault
    none, fault = answers_given(form, {"age": "old", "hand": "right", "side": "left"})
    assert not none and "Age in years" in fault
    assert "Affected side" in answers_given(form, {"hand": "right"})[1]


def test_the_keys_reach_every_row_and_change_and_choose(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(form_page, "PageSurface", lambda surface: Drawn(page_canvas((1280, 720))))
    field = Setting("code", "Code", "A code.", typed=True)
    rows = [PageButton(f"b{n}", f"Button {n}") for n in range(20)]
    page = FormPage(None, FormContent("Title", "", [*rows, field]), {})  # type: ignore[arg-type]
    for number in range(21):
        page.draw()
        assert page.row_box(page.focus) is not None and page.focus == ("code" if number == 20 else f"b{number}")
        page.handle([DOWN])
    assert page.focus == "b0"
    page.handle([InputEvent("key", "up", True), *typed("P7x"), InputEvent("key", "backspace", True)])
    assert (page.values["code"], page.chosen) == ("P7", "")
    page.handle([ENTER, ENTER])
    assert page.chosen == "b0", "Enter in a field moves on"


def test_two_keys_are_enough(monkeypatch: pytest.MonkeyPatch, study: StudyFolder) -> None:
    """Tab goes on, Enter changes or chooses: for a person with two switches."""
    monkeypatch.setattr(form_page, "PageSurface", lambda surface: Drawn(page_canvas((1280, 720))))
    tab = InputEvent("key", "tab", True)
    page = FormPage(None, settings_content(study, study.find_or_add("P1")), {})  # type: ignore[arg-type]
    for row in ("language", "side", "text", "contrast"):
        assert page.focus == row
        page.handle([ENTER])
        assert page.values[row] and not page.chosen
        page.handle([tab])
    assert page.focus == "avatar"
    page.handle([ENTER, ENTER])
    assert page.chosen == "back"


def test_the_speed_of_a_walk_is_one_axis() -> None:
    """What the hand does sideways changes nothing of it, nor of a kick."""
    throttle = Throttle(0.1, 1.4)
    throttle.start(SimpleNamespace(hip_world=(0.0, 0.3, 0.0), grasp=0.0, pressed=()))  # type: ignore[arg-type]
    shares = []
    for aside in (-0.1, 0.0, 0.1):
        throttle.read(SimpleNamespace(hip_world=(aside, 0.35, 0.0), grasp=0.0, pressed=()), 0.02)  # type: ignore[arg-type]
        shares.append(throttle.speed)
        assert not throttle.kicks
    assert len(set(shares)) == 1 and 0.0 < shares[0] < 1.4


def test_the_mouse_does_what_the_keys_do(monkeypatch: pytest.MonkeyPatch, study: StudyFolder) -> None:
    monkeypatch.setattr(form_page, "PageSurface", lambda surface: Drawn(page_canvas((1280, 720))))
    person = study.find_or_add("P1")
    page = FormPage(None, settings_content(study, person), {})  # type: ignore[arg-type]
    box = page.row_box("side")
    assert box is not None
    page.handle([InputEvent("button", "left", True, x=box[0] + 0.9 * box[2], y=box[1] + 5.0)])
    assert page.values["side"] == "left"
    page.handle([InputEvent("button", "left", True, x=box[0] + 5.0, y=box[1] + 5.0)])
    assert page.values["side"] == ""
    back = page.row_box("back")
    assert back is not None
    page.handle([InputEvent("button", "left", True, x=back[0] + 5.0, y=back[1] + 5.0)])
    assert page.chosen == "back"


class Window:
    """Stands in for the window of the pages: gives the events of a script, page by page."""

    def __init__(self, script: Sequence[Sequence[InputEvent]]) -> None:
        self._script = iter(script)
        self._discards = True
        self.closed = self.should_close = False
        self.title = ""
        self.surface = self

    def poll(self) -> Sequence[InputEvent]:
        """Return nothing where a page discards what was pressed before, then the events for that page."""
        self._discards = not self._discards
        return [] if not self._discards else next(self._script)

    def swap(self) -> None:
        self._discards = False  # polled again by the same page

    def result(self, folder: Path) -> str:
        return "leave"


def test_a_left_sided_person_is_added_asked_calibrated_and_plays_without_a_terminal(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(form_page, "PageSurface", lambda surface: Drawn(page_canvas((1280, 720))))
    played: list[list[str]] = []

    def play(words: Sequence[str], pages: object) -> JourneyEnd:
        played.append([str(word) for word in words])
        run = Path(words[list(words).index("--runs") + 1]) / "20260101T000000Z_00000000"
        run.mkdir()
        (run / "session.json").write_text(json.dumps({"settings": {"participant": "P07"}}))
        row = {"trial": 0, "outcome": "finished", "practice": False, "score": 63.0, "time_s": 12.0}
        row |= {"smoothness": -1.7, "path_m": 0.2}
        (run / "trials.csv").write_bytes(table_text([row]))
        lines = [{"source": "app", "kind": "state", "state": "done"}]
        if "calibration" in words[0]:
            grip = {"name": "grip", "value": 30.0, "unit": "N", "repeats": 3, "spread": 1.0, "at_least": False}
            lines.insert(0, {"source": "app", "kind": "calibrated", **grip})  # type: ignore[dict-item]
        (run / "events.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
        return JourneyEnd(0, "leave")

    monkeypatch.setattr(people_screen, "play_words", play)
    script = [
        [*typed("P07"), ENTER],
        [DOWN, DOWN, ENTER],  # about the participant
        [*typed("61"), DOWN, RIGHT, RIGHT, DOWN, RIGHT, RIGHT, DOWN, ENTER],  # right-handed, left side affected
        [*[DOWN] * 5, ENTER],  # settings
        [RIGHT, RIGHT, LEAVE],  # German
        [*[InputEvent("key", "up", True)] * 7, ENTER],  # calibrate
        [ENTER],  # the first run
        [*[DOWN] * 4, *typed("tired"), ENTER],
        [LEAVE],
        [LEAVE],
    ]
    settings = {setting.name: setting.default for setting in launcher_settings()}
    show_people(Window(script), LauncherChoice(Path("wavy_tunnel.json"), settings))  # type: ignore[arg-type]
    study = StudyFolder(tmp_path / "participants")
    person = study.find("P07")
    assert person.language == "de" and study.answers_of(person)[0]["answers"]["side"] == "left"
    assert [Path(words[0]).stem for words in played] == ["calibration", "wavy_tunnel"]
    assert "--side=left" in played[1] and all("--language=de" in words for words in played)
    assert any(word.endswith("fit.json") for word in played[1]) and study_runs.find_next(study, person).run is not None
    assert [note["note"] for note in study.notes_of(person)] == ["tired"]
    with speaking("de"):
        write_participant_page(study, person, tmp_path / "page.html")
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert "Welliger Tunnel" in page and "Glätte" in page and "Spectral" not in page and "Griffkraft" in page
    assert fit_of_code("P07", tmp_path / "runs") is not None and fit_of_code("P08", tmp_path / "runs") is None


def body(file: Path) -> Path:
    file.parent.mkdir(exist_ok=True)
    file.write_bytes(b"glTF")
    return file


def test_an_own_body_is_chosen_on_the_page_and_used_wherever_the_participant_plays(
    study: StudyFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    person = study.find_or_add("P7")
    model = body(study.folder_of(person) / "body.glb")
    pages = shown(monkeypatch, [*TO_SETTINGS, [*[DOWN] * 4, ENTER, LEAVE], [LEAVE], [LEAVE]])
    person = study.find("P7")
    row = pages[-2].rows[-2]
    assert person.avatar == "sub-P7/body.glb" and isinstance(row, PageButton) and "own body" in row.words
    cord, tunnel = find_scene(Path("avatar_cord")), find_scene(Path("wavy_tunnel"))
    assert f"--avatar={model.resolve()}" in words_of_settings(study, person, cord)
    assert not any("--avatar" in word for word in words_of_settings(study, person, tunnel))
    assert body_of_code("P7", Path("runs"), cord) == (model.resolve(), "")
    assert body_of_code("P8", Path("runs"), cord) == body_of_code("P7", Path("runs"), tunnel) == (None, "")
    study.erase(person)
    assert not model.exists() and body_of_code("P7", Path("runs"), cord) == (None, "")


def test_a_model_that_is_gone_is_told_and_the_body_of_the_scene_is_shown(
    study: StudyFolder, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    person = study.find_or_add("P7")
    pages = shown(monkeypatch, [*TO_SETTINGS, [*[DOWN] * 4, *typed("gone.glb"), LEAVE], [LEAVE], [LEAVE]])
    assert "gone.glb" in pages[3].notice and "gone.glb" not in pages[4].notice
    person, cord = study.find("P7"), find_scene(Path("avatar_cord"))
    assert person.avatar == "gone.glb", "what was typed is kept: the file may come back"
    assert words_of_settings(study, person, cord) == ["--participant=P7", "--fit=none"]
    assert capsys.readouterr().err.count("gone.glb") == 1
    parser = argparse.ArgumentParser()
    add_arguments(parser)
    assert _own_body(parser.parse_args([str(cord), "--participant=P7"])) is None
    assert capsys.readouterr().err.count("gone.glb") == 1
    model = body(study.path / "gone.glb")
    assert _own_body(parser.parse_args([str(cord), "--participant=P7"])) == model.resolve()


def shown(monkeypatch: pytest.MonkeyPatch, script: Sequence[Sequence[InputEvent]]) -> list[FormContent]:
    """Show the participants' pages to a script; return each page that was shown."""
    pages: list[FormContent] = []

    class Page(FormPage):
        def __init__(self, surface: object, content: FormContent, *rest: object) -> None:
            super().__init__(surface, content, *rest)  # type: ignore[arg-type]
            pages.append(content)

    monkeypatch.setattr(form_page, "PageSurface", lambda surface: Drawn(page_canvas((1280, 720))))
    monkeypatch.setattr(people_screen, "FormPage", Page)
    settings = {setting.name: setting.default for setting in launcher_settings()}
    show_people(Window(script), LauncherChoice(Path("wavy_tunnel.json"), settings))  # type: ignore[arg-type]
    return pages


@pytest.mark.parametrize("code", ["add", "back", "close", "leave", "study"])
def test_a_code_may_be_any_word_of_the_pages(monkeypatch: pytest.MonkeyPatch, study: StudyFolder, code: str) -> None:
    study.find_or_add(code)
    pages = shown(monkeypatch, [[ENTER], [LEAVE], [LEAVE]])
    assert [page.title for page in pages][1::2] == [f"Participant {code}"]


@pytest.mark.parametrize(
    ("file", "text"),
    [
        ("study.json", "{"),
        ("participants.jsonl", '{"row": 1}\n'),
        ("sub-P1/notes.jsonl", '{"note": 5}\n'),
        ("sub-P1/answers.jsonl", "[]\n"),
        ("sub-P1/calibrations.jsonl", '{"session": 1}\n'),
        ("sub-P1/ses-001/journal.jsonl", '{"run": 1}\n'),
    ],
)
def test_a_damaged_study_is_said_and_does_not_end_the_launcher(
    monkeypatch: pytest.MonkeyPatch, study: StudyFolder, file: str, text: str
) -> None:
    study.find_or_add("P1")
    (study.path / file).parent.mkdir(exist_ok=True)
    (study.path / file).write_text(text)
    pages = shown(monkeypatch, [[ENTER], [LEAVE]])
    damaged = f"participants/{file}"
    assert {page.title for page in pages} == {"Participants"} and len(pages) == 2
    assert damaged in pages[0].notice or damaged in pages[1].notice
    assert fit_of_code("P1", Path("runs")) is None


def test_a_participant_who_was_erased_meanwhile_is_said(monkeypatch: pytest.MonkeyPatch, study: StudyFolder) -> None:
    person = study.find_or_add("P1")

    def listed(*given: object) -> FormContent:
        content = list_content(*given)  # type: ignore[arg-type]
        if study.participants:
            study.erase(person)
        return content

    monkeypatch.setattr(people_screen, "list_content", listed)
    pages = shown(monkeypatch, [[ENTER], [LEAVE]])
    assert pages[1].notice.startswith('there is no participant "P1"')


def test_an_item_of_a_form_may_have_the_name_of_a_row(monkeypatch: pytest.MonkeyPatch, study: StudyFolder) -> None:
    person = study.find_or_add("P1")
    form = json.loads((study.path / "study.json").read_text())
    form["forms"] = {"school": {"title": "School", "items": {"study": {"label": "Field of study", "kind": "text"}}}}
    (study.path / "study.json").write_text(json.dumps(form))
    shown(monkeypatch, [[ENTER], [DOWN, DOWN, ENTER], typed("la"), [*typed("w"), DOWN, ENTER], [LEAVE], [LEAVE]])
    assert [line["answers"] for line in study.answers_of(person)] == [{"study": "law"}]


def test_what_should_be_fitted_and_cannot_is_not_played(study: StudyFolder) -> None:
    person = calibrated(study)
    (study.folder_of(person.participant) / "fit.json").mkdir()
    settings = {setting.name: setting.default for setting in launcher_settings()} | {"participant": "P07"}
    ended = launch._follow(LauncherChoice(Path("wavy_tunnel.json"), settings), Window([]))  # type: ignore[arg-type]
    assert ended.following == "other" and "fit.json" in ended.error


@pytest.mark.parametrize("typed_code", ["Maria", "P" * 61])
def test_why_a_text_is_no_code_is_said_in_each_language(typed_code: str) -> None:
    why = why_no_code(typed_code)
    for language in set(LANGUAGES) - {"en"}:
        with speaking(language):
            assert translated(why) != why


def test_two_sessions_of_a_person_at_once_keep_their_own_outcomes(study: StudyFolder) -> None:
    person = study.find_or_add("P1")

    def calibrates(words: Sequence[str]) -> int:
        run = Path(words[list(words).index("--runs") + 1]) / "20260101T000000Z_00000000"
        run.mkdir()
        (run / "events.jsonl").write_text('{"source": "app", "kind": "state", "state": "done"}\n')
        return 0

    def plays(words: Sequence[str]) -> int:  # and leaves no run folder, so that it was interrupted
        calibrated = study_runs.calibrate(study, person, [], calibrates)
        assert (calibrated.run, calibrated.outcome) == (0, "done")
        return 0

    played = study_runs.play_next(study, person, "", [], plays)
    assert played is not None and (played.run, played.outcome) == (1, "interrupted")


def test_who_is_erased_during_a_session_is_said(study: StudyFolder) -> None:
    person = study.find_or_add("P1")
    with pytest.raises(UsageError, match="P1 was erased during the session"):
        study_runs.calibrate(study, person, [], lambda words: len(study.erase(person)))


def test_choices_may_have_commas_and_fine_scales_are_typed() -> None:
    form = Form(
        "Home",
        {
            "with": Item("Lives with", "choice", choices=["partner, children", "alone"]),
            "coarse": Item("Steps", "scale", low=1_000_000.0, high=1_000_002.0, step=1.0),
            "fine": Item("Line", "scale", low=0.0, high=1.0, step=1e-12),
        },
    )
    rows = {row.name: row for row in form_content(form).rows}
    values = {name: [each.value for each in row.choices] for name, row in rows.items() if isinstance(row, Setting)}
    assert values["coarse"] == ["", "1000000", "1000001", "1000002"] and rows["fine"].typed  # type: ignore[union-attr]
    given = {"with": "partner, children", "coarse": "1000001", "fine": "0,5"}
    assert answers_given(form, given) == ({"with": "partner, children", "coarse": 1_000_001.0, "fine": 0.5}, "")


def test_a_damaged_study_is_said_in_the_language_of_the_launcher(tmp_path: Path) -> None:
    """File, line, what is wrong with it and what to do: nothing of it in English."""
    study = usual_study(tmp_path)
    study.find_or_add("P1")
    (study.path / "participants.jsonl").write_bytes(b'{"participant": "P1"}\n')
    with pytest.raises(SceneError) as damaged:
        study.find("P1")
    with speaking("de"):
        assert fault_words(damaged.value) == (
            f"{study.path / 'participants.jsonl'}: Zeile 1 ist beschädigt: „row“ fehlt; "
            "die Datei oder diese Zeile wiederherstellen"
        )
