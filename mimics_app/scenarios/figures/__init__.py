"""Figures of people in scenarios: who walks, who is tracked."""

__all__: list[str] = []
