"""Drawings as SVG: axes, marks, the plots of a report and the panels of the laboratory, all escaped in one place."""

__all__: list[str] = []
