"""What the program says reaches the operator in the language of the browser: the page's script beside the program's."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import playwright
import pytest

from mimics_app.console import page_server
from mimics_app.contracts.system.language import speaking, translated

NODE = Path(playwright.__file__).parent / "driver" / "node"
SCRIPT = Path(page_server.__file__).parent / "page" / "texts.js"
SAID = [
    "Goal reached in 8.3 s",
    "Time is over: the apple was not set down at its mark",
    "Force on the right foot",
    "12.3 s",
    "63 of 100 points",
    "Trial 2 of 6: get ready",
    "Go!",
    "one hand · a sentence of nobody",
    "A text of somebody's own scene",
    "two\nGo!",
    "/tmp/a_1.5/b",
    "The session is over: 3 of 5 trials finished",
    "Time is over: the hand moved 0.8 m, 1 contact",
    *(f"Across in 8 s, {n} steps beside the beam" for n in (2, 4, 5, 101, 112)),
    "Range measured: right 30 cm or more, left 20.5 cm",
    "63 of 100 points. Lost: 20 by distance from the line (12.0 mm), 10 by contacts",
    "a sentence of nobody, right 30 cm",
    "constructor",
    "run 2 of session 1: walking",
]
RUN = """
const [script, texts, said] = process.argv.slice(2).map((text, i) => (i ? JSON.parse(text) : text));
globalThis.fetch = async () => ({ ok: true, json: async () => texts });
globalThis.document = { documentElement: {}, querySelectorAll: () => [] };
const page = await import(script);
await page.loadTexts();
console.log(JSON.stringify(said.map(page.told)));
"""


@pytest.mark.skipif(not NODE.is_file(), reason="playwright brings no node here")
@pytest.mark.parametrize("code", ["en", "de", "sl", "ca", "es"])
def test_the_page_says_it_as_the_program_does(code: str, tmp_path: Path) -> None:
    (tmp_path / "run.mjs").write_text(RUN)
    (tmp_path / "texts.mjs").write_bytes(SCRIPT.read_bytes())
    texts = json.dumps(page_server.catalogue(code))
    words = [str(NODE), str(tmp_path / "run.mjs"), (tmp_path / "texts.mjs").as_uri(), texts, json.dumps(SAID)]
    done = subprocess.run(words, capture_output=True, text=True, check=True, timeout=60)
    with speaking(code):
        assert json.loads(done.stdout) == [translated(text) for text in SAID]
