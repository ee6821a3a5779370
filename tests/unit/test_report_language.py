"""The report in the language of the participant: no text of plots, trials, contacts and safety stays English."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from mimics_app.contracts.system.language import catalogue, speaking
from mimics_app.plotting.axis import Axis
from mimics_app.plotting.page_templates import load_templates
from mimics_app.plotting.plot import Plot
from mimics_app.recording import report as report_module
from mimics_app.recording.report_tables import Table

MARKUP = r"\{#.*?#\}|\{%.*?%\}|\{\{.*?\}\}|<style>.*?</style>|<[^>]*>"
TEMPLATES = Path(report_module.__file__).parent / "templates"


def test_a_plot_translates_all_that_it_draws() -> None:
    x, y = Axis("time [s]", 0.0, 1.5), Axis("force [N]", 0.0, 2.5)
    with speaking("de"):
        plot = Plot(x, y, "force [N] over time, Trial 1 · wide")
        plot.line(np.array([0.0, 1.0]), np.array([0.0, 2.0]), "robot", "speed of the robot")
        shown = str(plot.__html__())
    for words in ("Zeit [s]", "Kraft [N]", "Kraft [N] über die Zeit, Durchgang 1", "Tempo des Roboters", "0,5"):
        assert words in shown, words
    assert "force" not in shown and "speed" not in shown


def test_every_word_of_the_template_is_looked_up() -> None:
    """What is left between tags and expressions is markup, not language."""
    for file in TEMPLATES.glob("*.j2"):
        text = re.sub(
            r"\{#.*?#\}|\{%.*?%\}|\{\{.*?\}\}|<style>.*?</style>|<[^>]*>", " ", file.read_text("utf-8"), flags=re.S
        )
        assert re.findall(r"[A-Za-z]{3,}", text) == [], file.name


def test_cells_are_words_only_where_a_table_says_so() -> None:
    templates = load_templates(TEMPLATES, shown=str)
    source = '{% from "parts.html.j2" import show_table with context %}{{ show_table(table) }}'
    with speaking("de"):
        known = catalogue("de")
        for words, cell in ((True, known["yes"]), (False, "yes")):
            table = Table(["outcome"], [["yes"]], words=words)
            page = templates.from_string(source).render(table=table, translated=lambda text: known.get(text, text))
            assert f">{cell}<" in page and known["outcome"] in page
