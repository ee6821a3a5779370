"""The page of other people's packages says what is installed."""

from __future__ import annotations

import runpy

from mimics_app.contracts.system.resources import root


def test_the_page_is_that_of_the_installed_packages() -> None:
    written = runpy.run_path(str(root() / ".ci" / "third_party.py"))["page"]()
    assert (root() / "docs" / "third_party.md").read_text(encoding="utf-8") == written, "run .ci/third_party.py"
    assert written.count("\n| ") > 25
