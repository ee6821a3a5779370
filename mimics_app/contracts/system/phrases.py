"""Phrases for a person: English texts with named values, which are translated as they are shown.

Everything that is made, recorded and sent is English, so that no recording depends on a language. A phrase is written
as the key of its translations (a msgid of gettext): what is written here is found by the builder of the catalogues,
`assets/builders/texts`, and looked up by `contracts.system.language.translated` where it is shown.
"""

from __future__ import annotations

__all__ = ["counted_phrase", "phrase"]


def phrase(msgid: str, /, **values: object) -> str:
    """Return a text in English with its values.

    Args:
        msgid: A literal, with `{name:.1f}` for a number, `{name}` for words, which are phrases themselves, and
            `{name:s}` for words without a comma; `{code}`, `{condition}`, `{file}` and `{folder}` are names as given.
        values: Values by name; without any the text is returned as it is, with its names.
    """
    return msgid.format(**values) if values else msgid


def counted_phrase(one: str, many: str, number: int, /, **values: object) -> str:
    """Return `one` for the number 1, else `many`, in English with its values; `{n:d}` is the number."""
    return (one if number == 1 else many).format(n=number, **values)
