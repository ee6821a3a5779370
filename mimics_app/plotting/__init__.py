"""Drawings as SVG: axes, marks and the plots of a report, all escaped in one place."""

__all__: list[str] = []
