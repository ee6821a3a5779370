"""What the checks of components ask of the scene they are part of; `world.files.scene.scene.Scene` answers."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Literal, Protocol, TypeVar

import msgspec

from mimics_app.contracts.errors import Issue

__all__ = ["AssetKind", "CheckedScene", "Named", "Owner", "ShownModel"]

AssetKind = Literal["model", "picture", "sound", "head", "path"]
"""Kinds of files that a scene names as assets."""

C = TypeVar("C", bound=msgspec.Struct)


class Named(Protocol):
    """A clip or node of a model."""

    @property
    def name(self) -> str:
        """Its name in the model; "" for none."""
        ...


class ShownModel(Protocol):
    """A model that an entity shows."""

    @property
    def clips(self) -> Sequence[Named]:
        """Its animations."""
        ...

    @property
    def nodes(self) -> Sequence[Named]:
        """Its nodes."""
        ...


class Owner(Protocol):
    """An entity of the scene."""

    @property
    def parent(self) -> str | None:
        """Id of the entity it moves with, or None."""
        ...


class CheckedScene(Protocol):
    """A decoded scene. Pointers are of the resolved document; each check returns the faults it finds."""

    @property
    def by_id(self) -> Mapping[str, object]:
        """Entities by id."""
        ...

    def components(self, wanted: type[C]) -> list[tuple[str, C, str]]:
        """Return (entity id, component, pointer) of every component of a type."""
        ...

    def owner(self, pointer: str) -> Owner:
        """Return the entity that contains a pointer."""
        ...

    def model_of(self, pointer: str) -> ShownModel | None:
        """Return the model that the entity of a component shows; None where it is missing or broken."""
        ...

    def place(self, pointer: str) -> str:
        """Return the origin of a value as `file#pointer`."""
        ...

    def issue(self, pointer: str, what: str, fix: str = "") -> Issue:
        """Return a fault at a pointer."""
        ...

    def check_file(self, pointer: str, uri: str) -> list[Issue]:
        """Check a URI."""
        ...

    def check_asset(self, pointer: str, name: str | None, kind: AssetKind) -> list[Issue]:
        """Check the id of an asset of a kind; None: there is none."""
        ...

    def check_material(self, pointer: str, name: str | None) -> list[Issue]:
        """Check the id of a material; None: there is none."""
        ...

    def check_entity(self, pointer: str, name: str | None) -> list[Issue]:
        """Check the id of an entity; None: there is none."""
        ...

    def check_entity_with(self, wanted: type[msgspec.Struct], pointer: str, name: str | None) -> list[Issue]:
        """Check the id of an entity that must have a component of a type; None: there is none."""
        ...

    def check_model_reference(self, pointer: str, reference: str) -> list[Issue]:
        """Check a reference into a model."""
        ...

    def check_names(
        self, names: Mapping[str, str | None], what: str, known: Collection[str], otherwise: str = "the scene has none"
    ) -> list[Issue]:
        """Return a fault for each name that is not known."""
        ...
