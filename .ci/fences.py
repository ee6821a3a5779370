"""Hook of the website: a fence has one word, its language; the second one tells a test what to do with it."""

import re

__all__ = ["on_page_markdown"]


def on_page_markdown(markdown: str, **_: object) -> str:
    """Return a page whose fences the builder takes for code."""
    return re.sub(r"^(\s*```\w+) [\w=]+$", r"\1", markdown, flags=re.MULTILINE)
