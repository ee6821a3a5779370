"""Nothing in the documentation is out of reach: every page stands in an index, every decision has its line."""

from __future__ import annotations

import re
import runpy

from tests.architecture.sources import PACKAGE, ROOT, repository_files

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


def test_every_page_stands_in_the_navigation_of_the_website() -> None:
    navigation = (ROOT / ".ci" / "mkdocs.yml").read_text(encoding="utf-8").partition("\nnav:")[2]
    named = re.findall(r"^ +- .+: (\S+)$", navigation, re.MULTILINE)
    written = {f"reference/{name}.md" for name in ("commands", "components", "columns", "python")}
    assert {name for name in named if not (ROOT / name).exists()} == written
    pages = {page.relative_to(ROOT).as_posix() for page in DOCS.rglob("*.md") if "decisions" not in page.parts}
    assert pages <= set(named)


def test_the_website_takes_every_fence_of_the_pages_for_code() -> None:
    hook = runpy.run_path(str(ROOT / ".ci" / "fences.py"))["on_page_markdown"]
    lines = [line for page in DOCS.rglob("*.md") for line in hook(page.read_text("utf-8")).splitlines()]
    fences = [line.strip() for line in lines if line.lstrip().startswith("```")]
    assert len(fences) > 100 and [fence for fence in fences if not re.fullmatch(r"```\w*", fence)] == []


def test_the_reference_is_of_the_sources() -> None:
    pages = {
        name: "\n".join(write()) for name, write in runpy.run_path(str(ROOT / ".ci" / "reference.py"))["PAGES"].items()
    }
    assert "--headless" in pages["commands"].partition("## run\n")[2].partition("## render\n")[0]
    assert "| `radius` | number 0 to 10 or array | `0.04` |" in pages["components"]
    assert "| `f_user_world` | N | 3 |" in pages["columns"] and "SetParameter(" in pages["python"]


def _absent(page: str) -> list[str]:
    """Files, and functions, classes and tables of them ("file.py: name"), that a page names and that do not exist."""
    stubs = PACKAGE.rglob("*.pyi")
    texts = {path.relative_to(ROOT).as_posix(): path for path in (*repository_files(), *stubs)}
    found = []
    for place, name in re.findall(r"`([\w/]*/[\w./]*|\w+\.pyi?)(?:: (\w+)[^`]*)?`", page):
        ending = re.compile(rf"(^|/){re.escape(place.rstrip('/'))}(/|$)")
        files = [path for where, path in texts.items() if ending.search(where)]
        defines = re.compile(rf"(?:def|class) {name}\b|^{name}\b.*=", re.MULTILINE)
        defined = any(defines.search(file.read_text(encoding="utf-8")) for file in files if name)
        if "NAME" not in place and (not files or (name and not defined)):
            found.append(f"{place}: {name}")
    return found


def test_every_file_and_function_that_the_page_of_the_architecture_names_exists() -> None:
    assert not _absent((DOCS / "architecture.md").read_text(encoding="utf-8"))


def test_a_file_or_a_function_that_is_gone_is_found() -> None:
    page = "`kernels/tick.py: tick`, `kernels/tick.py: tock`, `kernels/tock.py`, `loop_tick.py`, `app/cues/`, `clues/`"
    assert _absent(page) == ["kernels/tick.py: tock", "kernels/tock.py: ", "clues/: "]
