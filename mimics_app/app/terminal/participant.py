"""Code of a participant: its form, and what looks like a name instead."""

from __future__ import annotations

import re
import unicodedata

from mimics_app.contracts.system.phrases import phrase

__all__ = ["LONGEST_CODE", "canonical_code", "why_no_code"]

LONGEST_CODE = 60
"""Largest length of a participant code [characters]."""

_A_NAME = phrase("this looks like a name; write a code such as P07, with a digit or without capitals")
_LEAST_WORD = 3
"""Letters of a word from which it may be a name."""


def canonical_code(text: str) -> str:
    """Return a code without surrounding blanks, letters with accents composed (NFC)."""
    return unicodedata.normalize("NFC", text).strip()


def why_no_code(code: str) -> str:
    """Return why a canonical code is none, in words; "" where it is one, or empty.

    One capitalised word, or several words of letters, look like a name, which must not be in a recording.
    """
    if not code.isprintable() or len(code) > LONGEST_CODE:
        return phrase("a participant code is one line, of length {n:d} at most", n=LONGEST_CODE)
    words = [word for word in re.split(r"[\W\d_]+", code) if word]
    several = len(words) > 1 and any(len(word) >= _LEAST_WORD for word in words) and re.search(r"[\s,]", code)
    alone = code.isalpha() and code.istitle() and len(code) >= _LEAST_WORD
    return _A_NAME if several or alone else ""
