"""The guide to the laboratory states what the shipped charts hold."""

from __future__ import annotations

import json

import pytest

from mimics_app.contracts.system.resources import root

PAGE = " ".join((root() / "docs" / "guide" / "laboratory.md").read_text(encoding="utf-8").split())


def rows(name: str) -> list[dict[str, float | str]]:
    return list(json.loads((root() / "docs" / "charts" / f"{name}.json").read_text(encoding="utf-8"))["rows"])


def at(name: str, method: str, x: float) -> float:
    return next(float(row["y"]) for row in rows(name) if row["method"] == method and row["x"] == x)


def test_the_limit_of_a_wall() -> None:
    assert at("S3", "simulated", 0.0) == pytest.approx(10_080, abs=10) and "10,080 N/m" in PAGE


def test_the_damping_that_late_ticks_need() -> None:
    more = at("S15", "simulated", 9.0) / at("S15", "simulated", 0.0)
    assert more == pytest.approx(2.7, abs=0.05) and "2.7 times the damping" in PAGE


def test_the_costs_of_the_projection() -> None:
    costs = {str(row["method"]): float(row["cost_ns"]) for row in rows("tunnel_projection")}
    stated = {"newton warm": 108, "newton one step": 45, "golden section": 1520, "brute force": 14_700}
    for method, cost in stated.items():
        assert costs[method] == pytest.approx(cost, rel=0.01) and f"{cost:,} ns" in PAGE
