"""Nothing in the documentation is out of reach: every page stands in an index, every decision has its line."""

from __future__ import annotations

import re

from tests.architecture.sources import ROOT

DOCS = ROOT / "docs"
LINK = re.compile(r"\]\(([^)#:]+)\)")


def test_every_decision_has_one_line_with_its_title_in_order() -> None:
    wanted = []
    for page in sorted((DOCS / "decisions").glob("[0-9]*.md")):
        heading = page.read_text(encoding="utf-8").splitlines()[0].removeprefix("# ")
        number, title = heading[:3], heading[4:]
        assert page.name.startswith(f"{number}-"), page.name
        wanted.append(f"- [{number}]({page.name}) {title}")
    lines = (DOCS / "decisions" / "README.md").read_text(encoding="utf-8").splitlines()
    assert [line for line in lines if line.startswith("- ")] == wanted


def test_every_page_stands_in_the_index_and_every_link_leads_somewhere() -> None:
    linked = {(DOCS / target).resolve() for target in LINK.findall((DOCS / "index.md").read_text(encoding="utf-8"))}
    assert all(target.exists() for target in linked)
    pages = {page for page in DOCS.rglob("*.md") if "decisions" not in page.parts and page.name != "index.md"}
    assert {page for page in pages if page.resolve() not in linked} == set()
