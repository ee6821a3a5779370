"""Builders beside the assets are found without being imported, and build through the command line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from mimics_app.app import cli
from mimics_app.app.installation import asset_builders
from mimics_app.app.installation.asset_builders import find_builder, find_builders
from mimics_app.contracts.errors import UsageError


def test_builders_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["assets", "list", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["builders"]
    assert {"city", "sounds"} <= {row["name"] for row in rows}
    assert all(row["what"] for row in rows)


def test_sounds_are_built(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["assets", "build", "sounds", "--out", str(tmp_path / "new"), "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["files"]
    assert len(rows) > 5
    assert all(Path(row["file"]).stat().st_size == row["bytes"] for row in rows)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["build"], "build what?"),
        (["build", "citty"], "city"),
        (["build", "city", "--seed", "-1"], "-1 is no whole number"),
    ],
)
def test_wrong_use_is_one_line(arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["assets", *arguments]) == 2
    assert said in capsys.readouterr().err


def test_a_builder_imports_what_lies_beside_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "assets" / "toys"
    folder.mkdir(parents=True)
    (folder / "toy_parts.py").write_text("WORD = 'brick'\n")
    code = '"""Builds a toy."""\nfrom toy_parts import WORD\n\ndef build(folder, seed):\n'
    code += "    file = folder / 'toy.txt'\n    file.write_text(f'{WORD} {seed}')\n    return [file]\n"
    (folder / "build_toy.py").write_text(code)
    (folder / "build_nothing.py").write_text('"""Has no build."""\n')
    monkeypatch.setattr(asset_builders, "root", lambda: tmp_path)
    assert [builder.name for builder in find_builders()] == ["toy"]
    assert [file.read_text() for file in find_builder("toy").build(tmp_path, 5)] == ["brick 5"]
    with pytest.raises(UsageError):
        find_builder("nothing")
