"""What a person sees goes through the look-up: no literal is drawn, or made to be drawn, that is not a phrase."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.architecture.sources import ROOT

PACKAGE = ROOT / "mimics_app"
LEFT_OUT = ("app/bench/", "app/viewer/", "app/replay_view/", "app/commands/", "lab/", "rendering/visual/overlay/")
"""Rooms of developers: their windows and files are English."""

LOOKED_UP = {"phrase", "counted_phrase", "translated"}
ARGUMENTS = {
    "Card": (0, 1, "label", "text", "remark"),
    "count_card": (0, "label"),
    "Cue": (0, "prompt"),
    "Setting": (1, 2, "label", "help", "empty"),
    "Button": (1, "label"),
    "KeyPage": (1, 2, 3, "title", "words", "foot"),
    "ScenarioCard": (0, 1, "title", "description", "group", "facts", "badge", "limits"),
    "Announcement": (0,),
    "text": (2, "text"),
    "fitted": (2, "text"),
    "wrap": (0, "text"),
    "doing": (0,),
    "_choices": (0,),
    "Axis": (0,),
}
"""Functions and classes that are given what a person sees, and in which arguments: places, or names."""

RETURNED = {
    "tasks/": ("prompt", "outcome_words", "what_happened", "result_lines", "largest_losses", "which"),
    "tasks/kinds/avatar_cord/questions.py": ("text",),
    "app/play/launching.py": ("cut_off_notice", "_beyond", "_how_it_went"),
    "app/scenes/shipped.py": ("_takes", "_lasts"),
    "app/picture/": ("stability_card", "gait_card"),
    "recording/result_words.py": ("result_sentence", "_outcome", "_against_last"),
}
"""Functions that return what a person sees, by file or folder."""

KEYS = ("tiles", "_cards", "_trial_cards")
"""Functions that return captions as the keys of a mapping."""

NO_WORDS = {"mm", "cm", "mJ", "dB", "mimics", "png", "jpg", "time_s", "path_m"}
"""Units, the program's own name, and names of columns."""

OWN_FIGURES = ("recording/report_", "recording/report.py", "plotting/", "recording/run.py")
"""Pages of a report beyond page one, whose axes are English."""


def test_what_a_person_sees_is_a_phrase() -> None:
    found = []
    for file in sorted(PACKAGE.rglob("*.py")):
        place = file.relative_to(PACKAGE).as_posix()
        if not place.startswith(LEFT_OUT):
            found += [f"{place}:{line}: {text!r}" for line, text in plain_texts(file.read_text("utf-8"), place)]
    assert not found, "write phrase(...), or translate it where it is drawn"


def plain_texts(source: str, place: str) -> Iterator[tuple[int, str]]:
    """Yield line and words of each literal that a person sees and that is not looked up."""
    returned = {name for where, names in RETURNED.items() if place.startswith(where) for name in names}
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Call):
            for given in shown_arguments(node, place):
                yield from words_in(given)
        elif isinstance(node, ast.FunctionDef) and node.name in returned | set(KEYS):
            for inner in ast.walk(node):
                if isinstance(inner, ast.Return) and inner.value is not None:
                    yield from words_in(inner.value) if node.name in returned else keys_in(inner.value)


def shown_arguments(call: ast.Call, place: str) -> Iterator[ast.expr]:
    name = call.func.id if isinstance(call.func, ast.Name) else getattr(call.func, "attr", "")
    if name == "Axis" and ((place.startswith(OWN_FIGURES) and "front" not in place) or "recording" not in place):
        return
    wanted = ARGUMENTS.get(name, ())
    yield from (given for number, given in enumerate(call.args) if number in wanted)
    yield from (word.value for word in call.keywords if word.arg in wanted)


def keys_in(mapping: ast.expr) -> Iterator[tuple[int, str]]:
    for node in ast.walk(mapping):
        if isinstance(node, ast.Dict):
            for key in node.keys:
                if key is not None:
                    yield from words_in(key)


def words_in(shown: ast.AST) -> Iterator[tuple[int, str]]:
    """Yield the words of literals in an expression, without what is looked up, compared, or a key."""
    if isinstance(shown, ast.Call):
        name = shown.func.id if isinstance(shown.func, ast.Name) else getattr(shown.func, "attr", "")
        if name in LOOKED_UP | set(ARGUMENTS) | {"get", "endswith", "startswith", "strftime", "split", "replace"}:
            return
        children = [*shown.args, *(word.value for word in shown.keywords)]
        children += [shown.func.value] if isinstance(shown.func, ast.Attribute) else []
    elif isinstance(shown, ast.Dict):
        children = list(shown.values)
    elif isinstance(shown, ast.IfExp):
        children = [shown.body, shown.orelse]
    elif isinstance(shown, ast.FormattedValue):
        children = [shown.value]
    elif isinstance(shown, ast.Compare | ast.Subscript):
        children = []
    else:
        children = list(ast.iter_child_nodes(shown))
    if isinstance(shown, ast.Constant) and isinstance(shown.value, str):
        words = [word for word in re.findall(r"[^\W\d_]\w+", shown.value) if word not in NO_WORDS]
        if words:
            yield shown.lineno, shown.value
    for child in children:
        yield from words_in(child)


@pytest.mark.parametrize(
    ("source", "place"),
    [
        ('Card("Speed", f"{v:.1f} m/s")', "tasks/kinds/a/kind.py"),
        ('Card(phrase("Speed"), f"{v:.1f} of {w}")', "tasks/kinds/a/kind.py"),
        ('def prompt(self):\n    return "" if a else "Walk"', "tasks/kinds/a/kind.py"),
        ('def outcome_words(self, row):\n    return f"{row[0]} m left"', "tasks/kinds/a/kind.py"),
        ('def tiles(self):\n    return {"goals": (task.get("goals"), "")}', "tasks/kinds/a/kind.py"),
        ('hud.text(x, y, "Start", 20.0)', "rendering/visual/launcher/a.py"),
        ('hud.text(x, y, f"and {n} before", 20.0)', "rendering/visual/launcher/a.py"),
        ('Setting("a", "Who plays", phrase("Who."))', "app/play/a.py"),
        ('Setting("a", phrase("Who"), phrase("Who."), empty="none")', "app/play/a.py"),
        ('_choices({"": "usual"})', "app/play/a.py"),
        ('Button("again", "Again", "n")', "app/play/a.py"),
        ('log.doing("Reading")', "app/play/a.py"),
        ('ScenarioCard("a", "b", facts=" · ".join(["one hand"]))', "app/play/a.py"),
    ],
)
def test_a_plain_text_is_found(source: str, place: str) -> None:
    assert list(plain_texts(source, place))


@pytest.mark.parametrize(
    "source",
    [
        'Card(phrase("Speed"), f"{v:.1f} m/s", width=220.0)',
        'def prompt(self):\n    return phrase("Walk") if self.state == "walk" else self.words["more"]',
        'hud.text(x, y, translated(card.label), 15.0)\nhud.text(x, y, "◀", 15.0)',
        'count_card(phrase("Taps of {taps:d}", taps=3), 4)',
        'def outcome_words(self):\n    return phrase("a {b}", b=row["time_s"])',
    ],
)
def test_a_phrase_is_not_found(source: str) -> None:
    assert not list(plain_texts(source, "tasks/kinds/a/kind.py"))


def test_the_rooms_are_there() -> None:
    assert all((PACKAGE / place).exists() for place in (*LEFT_OUT, *RETURNED))
    assert Path(ROOT / "assets" / "builders" / "texts").is_dir()
