"""Words that are no names: docs/glossary.md lists them with the packages that are exempt, and the field's word."""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterator, Mapping
from functools import cache

import pytest

from tests.architecture.sources import ROOT, modules, nodes, texts

EVERYWHERE = "everywhere"
EXCEPT = "all but "


def _table(title: str) -> dict[str, tuple[str, ...]]:
    """First column of a table of the glossary -> the rooms that its second exempts."""
    page = (ROOT / "docs" / "glossary.md").read_text(encoding="utf-8")
    section = page.split(f"## {title}\n")[1].split("\n## ")[0]
    rows = re.findall(r"^\| ([^|]+?) \| ([^|]+?) \| [^|]+\|$", section, flags=re.MULTILINE)[1:]
    assert all(rooms == EVERYWHERE or rooms.startswith(EXCEPT) for _, rooms in rows)
    return {word: tuple(rooms.removeprefix(EXCEPT).split(", ")) for word, rooms in rows}


def identifiers(tree: ast.Module) -> set[str]:
    """Names that a module defines or uses."""
    return {
        str(getattr(node, key))
        for node in nodes(tree)
        for kinds, key in (
            ((ast.FunctionDef, ast.ClassDef), "name"),
            (ast.Name, "id"),
            (ast.arg, "arg"),
            (ast.Attribute, "attr"),
        )
        if isinstance(node, kinds)
    }


@cache
def _parts(name: str) -> str:
    """Return an identifier as "_parts_in_lower_case_", in whichever way it is written."""
    return f"_{re.sub(r'(?<=[a-z0-9])(?=[A-Z])', '_', name).lower()}_"


def is_in(words: str, name: str) -> bool:
    """Whether one of some words is a part of an identifier, in either way of writing it."""
    return any(f"_{word}_" in _parts(name) for word in words.split(", "))


def messages(tree: ast.Module) -> Iterator[str]:
    """Strings of a module that are no docstrings."""
    docstrings = {
        id(line.value)
        for node in nodes(tree)
        if isinstance(node, ast.Module | ast.FunctionDef | ast.ClassDef)
        for line in node.body
        if isinstance(line, ast.Expr)
    }
    for node in nodes(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in docstrings:
            yield node.value


def prose(tree: ast.Module, text: str) -> Iterator[str]:
    """Docstrings, strings below a value, and comments of a module, each on one line."""
    for node in nodes(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            yield " ".join(node.value.value.split())
    comments = [line.partition("#")[2].strip() for line in text.splitlines() if "#" in line]
    yield " ".join(comments)


@cache
def _identifiers() -> dict[str, set[str]]:
    """Path of a module -> its identifiers."""
    return {path: identifiers(tree) for path, tree in modules().items()}


@cache
def _messages() -> dict[str, list[str]]:
    """Path of a module -> its messages."""
    return {path: list(messages(tree)) for path, tree in modules().items()}


@cache
def _prose() -> dict[str, list[str]]:
    """Path of a module -> its docstrings and comments."""
    return {path: list(prose(tree, texts()[path])) for path, tree in modules().items()}


def _outside(exempt: tuple[str, ...], texts: Mapping[str, Collection[str]]) -> Iterator[tuple[str, str]]:
    for path, found in texts.items():
        if not any(path.startswith(f"{room}/") for room in exempt):
            yield from ((path, text) for text in found)


NAMES = _table("Words that are no names")
PHRASES = _table("Phrases that no message has")
PROSE = _table("Words that no text of the code has")


@pytest.mark.parametrize("words", NAMES)
def test_a_word_of_the_list_is_no_part_of_a_name(words: str) -> None:
    found = {f"{path}: {name}" for path, name in _outside(NAMES[words], _identifiers()) if is_in(words, name)}
    assert not found, "docs/glossary.md has the field's word"


@pytest.mark.parametrize("phrase", PHRASES)
def test_a_phrase_of_the_list_is_in_no_message(phrase: str) -> None:
    words = re.compile(rf"(?<!there )\b{phrase}\b")
    found = {f"{path}: {text}" for path, text in _outside(PHRASES[phrase], _messages()) if words.search(text)}
    assert not found, "docs/glossary.md has the words to use"


@pytest.mark.parametrize("words", PROSE)
def test_a_word_of_the_list_is_in_no_docstring_and_in_no_comment(words: str) -> None:
    pattern = re.compile(rf"\b(?:{words.replace(', ', '|')})\b", re.IGNORECASE)
    found = {
        f"{path}: {text[max(0, at.start() - 40) : at.end() + 20]}"
        for path, text in _outside(PROSE[words], _prose())
        for at in pattern.finditer(text)
    }
    assert not found, "docs/glossary.md has the words to use"


@pytest.mark.parametrize("table", [NAMES, PHRASES, PROSE], ids=["names", "phrases", "prose"])
def test_every_exempt_room_of_the_list_is_one(table: dict[str, tuple[str, ...]]) -> None:
    rooms = {"/".join(path.split("/")[:depth]) for path in modules() for depth in (1, 2)}
    assert table and not {room for places in table.values() for room in places} - {*rooms, EVERYWHERE}


def test_planted_words_are_found() -> None:
    tree = ast.parse('class FarSight:\n    """goes on"""\n    def put_off(self, x): x.let_go = "it goes on"\n')
    assert {name for name in identifiers(tree) if is_in("sight, put_off, let_go", name)} == {
        "FarSight",
        "put_off",
        "let_go",
    }
    assert not is_in("sight", "insight")
    assert list(messages(tree)) == ["it goes on"]


def test_planted_prose_is_found() -> None:
    text = '"""It goes\\non."""\nx = 1  # as told\n"""Was judged."""\ny = "settled"\n'
    assert list(prose(ast.parse(text), text)) == ["It goes on.", "Was judged.", "as told"]
