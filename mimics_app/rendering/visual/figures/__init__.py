"""Heads-up display content: text, bars, images and their colours."""

__all__: list[str] = []
