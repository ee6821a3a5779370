"""Instances of the world's materials: the technique of each, with the variant of its shaders."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from operator import is_
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.rendering.visual.materials.material_instance import MaterialInstance, make_pass, pack_material
from mimics_app.rendering.visual.materials.picture_arrays import PictureArrays, encode_srgb
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary, ShaderProgram
from mimics_app.rendering.visual.materials.techniques import SAFE, ChosenTechnique, choose_technique, technique_chain
from mimics_app.rendering.visual.materials.texture_store import TextureStore
from mimics_app.rendering.visual.pictures.live_picture import LivePicture
from mimics_app.rendering.visual.settings import Shading
from mimics_app.rendering.visual.surfaces.capabilities import Capabilities
from mimics_app.world.content.materials.material import IDENTITY, MAPS, MISSING_PICTURE, Material, TextureData
from mimics_app.world.content.materials.technique import Profile, TechniqueSpec
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.technique_library import built_in_techniques

if TYPE_CHECKING:
    import moderngl

__all__ = ["MaterialStore"]

_BINDINGS = {"base": 0, "normal": 5, "surface": 6, "occlusion": 7, "emission": 8}
"""Bindings of the maps' samplers in shaders/common/material.glsl."""

_LINEAR_MAPS = ("normal", "surface", "occlusion")
"""Maps whose texels are numbers, not colours."""

_PLAIN = "plain"
_SIMPLER: Mapping[Shading, str] = {"matt": "lit_matt", "plain": _PLAIN}
"""Simpler technique by shading, for materials that allow it."""

_AT_VERTICES = "lit_at_vertices"
_PER_PIXEL = ("pbr", "lit")
"""Techniques that it replaces for small triangles."""

_FINE_MAPS = ("surface", "occlusion", "emission")
"""Maps without which a surface looks different however far away it is; a normal map becomes flat with the distance."""

_KEPT = ("glass", "mirror")
"""Techniques that are never simplified."""

_MATT = 0.95
"""Roughness from which a dielectric's specular reflection is left out: about 2 % of the incident light."""
_FALLBACK = Material("")

_Pictures = dict[str, TextureData]


@dataclass(frozen=True)
class _Variant:
    """Frame settings that all instances depend on."""

    light_features: frozenset[str] = frozenset()
    shading: Shading = "full"
    profile: Profile = "training"
    vertex_light: bool = False


class MaterialStore:
    """Instances by material, made on demand, and again when the world's material or one of its textures changes.

    Attributes:
        issues: What could not be drawn as the world requires, each reported once; the caller removes what it reports.
        live: Textures that are rendered, not uploaded, by key; the world has a placeholder under each key.
    """

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary, has: Capabilities) -> None:
        self._ctx = ctx
        self._shaders = shaders
        self._has = has
        self._instances: dict[tuple[str, bool], MaterialInstance] = {}
        self._small: dict[tuple[str, bool], MaterialInstance | None] = {}
        self._known: dict[str, tuple[Material, _Pictures]] = {}
        self._techniques: dict[str, TechniqueSpec] = dict(built_in_techniques())
        self._broken: dict[str, str] = {}
        self._textures = TextureStore(ctx, shaders, has.texture_size)
        self._arrays = PictureArrays(ctx, shaders, has.texture_size)
        self._held: list[tuple[list[str], list[object]]] = []
        self._variant = _Variant()
        self._reported: set[Issue] = set()
        self.issues: list[Issue] = []
        self.live: Mapping[str, LivePicture] = {}

    def update(
        self,
        world: World,
        *,
        light_features: frozenset[str],
        shading: Shading = "full",
        profile: Profile = "training",
        vertex_light: bool = False,
    ) -> bool:
        """Discard the instances of materials that changed.

        Args:
            world: The world.
            light_features: Features that the frame's light needs, see `light_features`; shaders leave out the rest.
            shading: Techniques of opaque surfaces.
            profile: Purpose of the picture, which techniques may exclude.
            vertex_light: True where small triangles are lit at their vertices.

        Returns:
            True when a material came, went or changed.
        """
        variant = _Variant(light_features, shading, profile, vertex_light)
        techniques = {**built_in_techniques(), **world.techniques}
        if self._is_unchanged(world) and variant == self._variant and techniques == self._techniques:
            return False
        known = {name: (material, _pictures(material, world)) for name, material in world.materials.items()}
        if variant != self._variant or techniques != self._techniques:
            self._variant, self._techniques = variant, techniques
            stale = {name for name, _ in self._instances} | {""}
        elif known == self._known:
            return False  # identical objects compare at once
        else:
            stale = {name for name, was in self._known.items() if not _same(was, known.get(name))}
        changed = bool(stale) or known.keys() != self._known.keys()
        for instances in (self._instances, self._small):
            for key in [key for key in instances if key[0] in stale]:
                _release(instances.pop(key))
        self._known = known
        return changed

    def _is_unchanged(self, world: World) -> bool:
        """Whether materials and textures are the same objects as in the last update; called every frame."""
        held, self._held = self._held, [(list(each), list(each.values())) for each in (world.materials, world.textures)]
        return len(held) == 2 and all(
            was[0] == now[0] and all(map(is_, was[1], now[1])) for was, now in zip(held, self._held, strict=True)
        )

    def instance(self, name: str, *, coloured: bool = False) -> MaterialInstance:
        """Return the instance of a material; plain grey for an unknown name.

        Args:
            name: Name of the material.
            coloured: True for a mesh with vertex colours.
        """
        if name not in self._known:
            name = ""
        if (name, coloured) not in self._instances:
            self._instances[name, coloured] = self._make(name, *self._known.get(name, (_FALLBACK, {})), coloured)
        return self._instances[name, coloured]

    def small_instance(self, name: str, *, coloured: bool = False) -> MaterialInstance | None:
        """Return the instance of a material on small triangles; None where it is that of large ones.

        Args:
            name: Name of the material.
            coloured: True for a mesh with vertex colours.
        """
        key = (name, coloured)
        if not self._variant.vertex_light or name not in self._known:
            return None
        if key not in self._small:
            material, pictures = self._known[name]
            simpler = replace(material, technique=_AT_VERTICES)
            fits = self._fits_vertices(material, pictures)
            self._small[key] = self._make(name, simpler, pictures, coloured) if fits else None
        return self._small[key]

    def _fits_vertices(self, material: Material, pictures: _Pictures) -> bool:
        """Whether light at the vertices shows all of a material that is visible on triangles of a few pixels."""
        drawn = self._wanted(material)
        if drawn not in _PER_PIXEL or self._techniques[drawn] != built_in_techniques()[drawn]:
            return False
        separable = material.metallic == 0.0 or "base" not in pictures
        whole = material.grid == 0.0 and not material.double_sided and not any(each in pictures for each in _FINE_MAPS)
        return separable and whole and "AMBIENT_OCCLUSION" not in self._variant.light_features

    def release(self) -> None:
        """Free all buffers and textures."""
        for instance in (*self._instances.values(), *self._small.values()):
            _release(instance)
        self._textures.release()
        self._arrays.release()
        self._instances.clear()
        self._small.clear()

    def _make(self, name: str, material: Material, pictures: _Pictures, coloured: bool) -> MaterialInstance:
        self._report_textures(material, pictures)
        wanted = self._wanted(material)
        while True:
            choice = choose_technique(wanted, self._techniques, self._has, self._variant.profile, self._broken)
            if choice.fault:
                self._report(f'material "{name}": {choice.why}')
            try:
                if choice.name == _PLAIN:
                    return self._make_plain(name, material, pictures, coloured, choice.spec)
                return self._make_own(name, material, pictures, coloured, choice)
            except SceneError as error:
                if choice.name == SAFE:
                    raise
                self._broken[choice.name] = f"does not compile ({error.issues[0]})"

    def _make_own(
        self, name: str, material: Material, pictures: _Pictures, coloured: bool, choice: ChosenTechnique
    ) -> MaterialInstance:
        """Make an instance with a state of its own."""
        features = self._features(material, pictures, coloured)
        passes = []
        for spec in choice.spec.passes:
            defines = (*spec.defines, *(each for each in features if _name_of(each) in spec.features))
            passes.append(make_pass(spec, self._shaders.program(spec.vertex, spec.fragment, defines), material))
        read = {feature for spec in choice.spec.passes for feature in spec.features}
        textures = tuple(
            (_BINDINGS[which], self._texture(material.textures[which], picture, linear=which in _LINEAR_MAPS))
            for which, picture in pictures.items()
            if _feature_of(which) in read
        )
        block = self._ctx.buffer(pack_material(material, pictures).tobytes())
        shadow_shader = self._shadow_shader(material, pictures, blended=any(each.blend != "none" for each in passes))
        state = (name, coloured, choice.name)
        instance = MaterialInstance(material, tuple(passes), shadow_shader, block, textures, state, state)
        # The depth of an opaque surface does not depend on its material.
        instance.shadow_state = "solid" if instance.solid else state
        return instance

    def _texture(self, key: str, picture: TextureData, *, linear: bool) -> moderngl.Texture | LivePicture:
        return self.live.get(key) or self._textures.get(key, picture, linear=linear)

    def _make_plain(
        self, name: str, material: Material, pictures: _Pictures, coloured: bool, spec: TechniqueSpec
    ) -> MaterialInstance:
        """Make an instance of the plain technique, which shares its state with all others of its kind."""
        textures: tuple[tuple[int, object], ...] = ()
        layer, array, picture = 0, None, pictures.get("base")
        features = ["COLOURED"] if coloured else []
        if picture is not None:
            array, layer = self._arrays.place(material.textures["base"], picture)
            textures = ((_BINDINGS["base"], array),)
            sides = zip(picture.wrap, ("MIRROR_U", "MIRROR_V"), strict=True)
            features += ["TEXTURED", *(feature for wrap, feature in sides if wrap == "mirror")]
        features += sorted(self._variant.light_features)
        first = spec.passes[0]
        defines = (*first.defines, *(each for each in features if _name_of(each) in first.features))
        drawn = make_pass(first, self._shaders.program(first.vertex, first.fragment, defines), material)
        state = (drawn.shader.defines, id(array), drawn.cull, drawn.blend)
        red, green, blue = encode_srgb(np.array(material.base_colour[:3])).tolist()
        number = layer + 1.0 if SAFE not in self._chain(material) else -(layer + 1.0)
        block = self._ctx.buffer(pack_material(material, pictures).tobytes())
        shadow_shader = self._shadow_shader(material, {}, blended=False)  # it shows no holes, and its shadow has none
        instance_params = (red, green, blue, number)
        return MaterialInstance(material, (drawn,), shadow_shader, block, textures, state, "solid", instance_params)  # type: ignore[arg-type]

    def _wanted(self, material: Material) -> str:
        """Return the material's own technique, or a simpler one of its chain that loses nothing visible."""
        chain, simpler = self._chain(material), _SIMPLER.get(self._variant.shading)
        if simpler is None or simpler not in chain or chain[0] in _KEPT or not _shown_by(simpler, material):
            return material.technique
        return simpler

    def _chain(self, material: Material) -> list[str]:
        return technique_chain(material.technique, self._techniques) or ["lit", _PLAIN]

    def _features(self, material: Material, pictures: _Pictures, coloured: bool) -> list[str]:
        """Return the shader features of a material, in a fixed order."""
        has = {
            "COLOURED": coloured,
            **{_feature_of(which): which in pictures for which in MAPS},
            "MASKED": material.alpha_mode == "mask",
            **dict.fromkeys(sorted(self._variant.light_features), True),
            "MATT": material.roughness >= _MATT and material.metallic == 0.0 and "surface" not in pictures,
            "SOFT": material.softness > 0.0,
            "GRID": material.grid > 0.0,
            "EMISSIVE": any(material.emission),
            "UV_TRANSFORMS": any(_is_placed(material, which, picture) for which, picture in pictures.items()),
        }
        second = sum(1 << MAPS.index(which) for which in pictures if which in material.second_uv)
        return [*(feature for feature, wanted in has.items() if wanted), *([f"SECOND_UV={second}"] if second else [])]

    def _shadow_shader(self, material: Material, pictures: _Pictures, *, blended: bool) -> ShaderProgram:
        defines = []
        if "base" in pictures and material.alpha_mode == "mask":
            defines.append("TEXTURED")
            if _is_placed(material, "base", pictures["base"]):
                defines.append("UV_TRANSFORMS")
        if blended:
            defines.append("TRANSLUCENT")
        return self._shaders.program("shadow/shadow.vert", "shadow/shadow.frag", tuple(defines))

    def _report_textures(self, material: Material, pictures: _Pictures) -> None:
        for which, key in material.textures.items():
            if which not in pictures:
                self._report(f'material "{material.name}": no texture "{key}"; drawn without it')
            elif pictures[which] is MISSING_PICTURE:
                self._report(f'material "{material.name}": no texture "{key}"; a checker is drawn in its place')
            elif not self._textures.fits(pictures[which]):
                height, width = pictures[which].pixels.shape[:2]
                size = self._has.texture_size
                self._report(f'texture "{key}": {width} x {height} is more than the driver\'s {size}; drawn smaller')

    def _report(self, what: str) -> None:
        issue = Issue("", "", what)
        if issue not in self._reported:
            self._reported.add(issue)
            self.issues.append(issue)


def _release(instance: MaterialInstance | None) -> None:
    if instance is not None:
        instance.block.release()


def _name_of(feature: str) -> str:
    """Return a feature without its value."""
    return feature.partition("=")[0]


def _feature_of(which: str) -> str:
    return "TEXTURED" if which == "base" else f"{which.upper()}_MAP"


def _is_placed(material: Material, which: str, picture: TextureData) -> bool:
    """Whether a map has other texture coordinates than the mesh, as a mirrored one has; see `unfolded`."""
    return material.uv_transforms[MAPS.index(which)] != IDENTITY or "mirror" in picture.wrap


def _pictures(material: Material, world: World) -> _Pictures:
    """Return a material's textures by map; a missing base texture is replaced by a conspicuous checker."""
    found = {which: world.textures[key] for which, key in material.textures.items() if key in world.textures}
    if "base" in material.textures:
        found.setdefault("base", MISSING_PICTURE)
    return found


def _same(was: tuple[Material, _Pictures], now: tuple[Material, _Pictures] | None) -> bool:
    if now is None or was[0] is not now[0] or was[1].keys() != now[1].keys():
        return False
    return all(picture is now[1][which] for which, picture in was[1].items())


def _shown_by(simpler: str, material: Material) -> bool:
    """Whether a simpler technique draws a material without losing holes, grid lines or emission."""
    if simpler == _PLAIN:
        whole = material.alpha_mode == "opaque" and material.uv_transforms[0] == IDENTITY
        return whole and material.grid == 0.0 and not any(material.emission)
    return material.grid == 0.0 and "emission" not in material.textures
