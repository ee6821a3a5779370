"""Values of the fields that two types have in common: from what a scene says to what a part works with."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

__all__ = ["shared_fields"]


def shared_fields(source: object, kind: type) -> dict[str, Any]:
    """Return the attributes of an object that are fields of a dataclass, too: the same name means the same."""
    return {field.name: getattr(source, field.name) for field in fields(kind) if hasattr(source, field.name)}
