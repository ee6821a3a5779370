"""The guide to estimators and policies: its package is written as it stands, and plays."""

from __future__ import annotations

import json
import re
from pathlib import Path

from mimics_app.contracts.system.resources import root
from mimics_app.recording.run import Run
from tests.support.command import mimics_with
from tests.support.guide import pieces, written_module
from tests.support.plugin_site import write_package
from tests.support.policy_kit import check_policy

PAGE = root() / "docs" / "guide" / "estimators_and_policies.md"


def test_the_package_of_the_guide_plays_with_its_estimator_and_its_policy(tmp_path: Path) -> None:
    found = pieces(PAGE)
    source = next(piece for piece in found if piece.purpose == "plugin")
    points = next(piece.text for piece in found if piece.purpose == "entry")
    (words,) = [piece.text.split() for piece in found if piece.language == "sh"]
    installed = re.sub(r'\[project\.entry-points\."([^"]+)"\]', r"[\1]", points).replace('"', "")
    (tmp_path / "site").mkdir()
    site = write_package(tmp_path / "site", "my_lab", source.text, installed)
    (done,) = mimics_with(site, (*words[1:], "--pictures", 0, "--sound", "off", "--runs", tmp_path / "runs", "--json"))
    assert done.returncode == 0, done.stderr
    run = Run.open(json.loads(done.stdout)["run_dir"])
    efforts = [line.get("effort") for line in run.lines_of("app", "person")]
    assert any(effort is not None for effort in efforts), "the heart is heard"
    assert run.lines_of("app", "choice")
    check_policy(written_module(tmp_path, source).OneUpTwoDown)
