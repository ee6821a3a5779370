"""A mesh that is changed while it is drawn: what is sent, what is seen, and what must not be believed any longer."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.rendering.visual.drawing.mesh_arena import MeshArena
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.headless import read_pixels
from mimics_app.rendering.visual.view import View
from mimics_app.rendering.visual.view_matrices import compose_look_at
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.meshes.mesh import MeshData
from mimics_app.world.content.meshes.mesh_buffer import MeshBuffer
from mimics_app.world.content.meshes.primitives import box, plane
from mimics_app.world.content.meshes.vertex_declaration import COLOUR_DECLARATION, VERTEX_DECLARATION
from mimics_app.world.content.world import World

SIZE = (64, 64)
PLAIN = RenderSettings(msaa=0, shadow_size=0, tone_map="none", fog_density=0.0)
PER_VERTEX = VERTEX_DECLARATION.stride


def make_world(*, coloured: bool = False) -> World:
    """A white sheet of 4 x 4 squares under a black sky, another body beside it."""
    world = World()
    world.environment = Sky((0.0,) * 3, (0.0,) * 3, (0.0,) * 3, 0.0)
    world.set_material(Material("white", "unlit", (1.0, 1.0, 1.0, 1.0), double_sided=True))
    sheet = plane(1.0, 1.0, segments=4)
    colours = np.ones((len(sheet.positions), 4), np.float32) if coloured else None
    world.meshes["sheet"] = MeshData(sheet.positions, sheet.normals, sheet.indices, sheet.uvs, colours)
    world.meshes["box"] = box(0.1, 0.1, 0.1)
    world.root.create_child("sheet").create_entity("sheet", "white")
    world.root.create_child("box", (5.0, 0.0, 0.0)).create_entity("box", "white")
    world.update()
    return world


def from_above() -> View:
    """Pixels of 1/16 m: the sheet covers 16 x 16 of them in the middle."""
    pose = compose_look_at((0.0, 4.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    return View(pose, (-0.5, 0.5, -0.5, 0.5), (0, 0, *SIZE))


@pytest.mark.parametrize(("coloured", "stride"), [(False, PER_VERTEX), (True, PER_VERTEX + COLOUR_DECLARATION.stride)])
def test_only_the_range_that_changed_is_sent(coloured, stride):
    world = make_world(coloured=coloured)
    with create_surface("egl", (8, 8)) as surface:
        arena = MeshArena(surface.ctx)
        assert arena.update(world)
        buffer = world.open_mesh("sheet")
        arena.update(world)
        buffer.update(3, 2)
        assert not arena.update(world)
        assert arena.uploaded == 2 * stride and arena.rewritten == ["sheet"]
        buffer.update(0, 1)
        buffer.update_indices(6, 12)
        arena.update(world)
        assert arena.uploaded == stride + 12 * 2
        arena.update(world)
        assert arena.uploaded == 0 and arena.rewritten == []
        arena.release()


def test_the_drivers_buffer_is_what_the_declaration_says():
    world = make_world(coloured=True)
    with create_surface("egl", (8, 8)) as surface:
        arena = MeshArena(surface.ctx)
        arena.update(world)
        buffer = world.open_mesh("sheet")
        buffer.positions[4:6] += (0.0, 0.25, 0.0)
        buffer.normals[4] = (1.0, 0.0, 0.0)
        buffer.colours[5] = (0.25, 0.5, 0.75, 1.0)
        buffer.update(4, 2)
        arena.update(world)
        first = arena.ranges["sheet"].base_vertex
        for declaration, source in zip(buffer.declarations, (arena._vertices, arena._colours), strict=True):
            raw = source.read(declaration.stride * len(buffer.positions), offset=declaration.stride * first)
            for element in declaration.elements:
                words = np.frombuffer(raw, np.uint8).reshape(-1, declaration.stride)
                end = element.offset + 4 * element.components
                values = words[:, element.offset : end].copy().view(element.format)
                assert (values == getattr(buffer, element.name)).all(), element.name
        arena.release()


def test_the_picture_follows_and_so_do_the_bounds():
    world = make_world()
    with create_surface("egl", SIZE) as surface:
        renderer = Renderer(surface, world, PLAIN)

        def lit() -> np.ndarray:
            world.update()
            renderer.draw([from_above()])
            assert surface.ctx.error == "GL_NO_ERROR"
            return read_pixels(surface)[..., 0] > 0

        assert lit()[24:40, 24:40].all() and lit().sum() == 16 * 16
        buffer = world.open_mesh("sheet")
        buffer.positions[:, 0] += 1.0
        buffer.update()
        assert lit()[24:40, 40:56].all() and lit().sum() == 16 * 16
        # Far outside and back again: culled by its own new sphere, and only then.
        buffer.positions[:, 0] += 50.0
        buffer.update()
        renderer.forget_picture()
        assert lit().sum() == 0
        renderer.forget_picture()
        assert renderer.draw([from_above()]).culled == 2
        buffer.positions[:, 0] -= 51.0
        buffer.update()
        assert lit().sum() == 16 * 16
        # A hole: the first square's six indices become one point.
        buffer.indices[:6] = 0
        buffer.update_indices(0, 6)
        assert lit().sum() == 16 * 16 - 4 * 4
        renderer.release()


def test_two_renderers_each_get_what_they_miss():
    world = make_world()
    buffer = world.open_mesh("sheet")
    with create_surface("egl", (8, 8)) as surface:
        often, seldom = MeshArena(surface.ctx), MeshArena(surface.ctx)
        often.update(world), seldom.update(world)
        sent = []
        for vertex in range(3):
            buffer.update(vertex, 1)
            often.update(world)
            sent.append(often.uploaded)
        seldom.update(world)
        assert sent == [PER_VERTEX] * 3 and seldom.uploaded == 3 * PER_VERTEX
        for _ in range(100):
            buffer.update(0, 1)
        seldom.update(world)  # more changes than are remembered: all of it
        assert seldom.uploaded == PER_VERTEX * len(buffer.positions) + 2 * len(buffer.indices)
        often.release(), seldom.release()


def test_a_shadow_map_is_drawn_again_for_a_mesh_that_changed():
    world = make_world()
    world.set_material(Material("floor", base_colour=(0.8, 0.8, 0.8, 1.0), roughness=1.0))
    world.meshes["floor"] = plane(4.0, 4.0)
    world.root.create_child("floor", (0.0, -1.0, 0.0)).create_entity("floor", "floor").subentities[
        0
    ].casts_shadow = False
    sun = world.root.create_child("sun", (0.0, 3.0, 3.0))
    sun.look_at((0.0, 0.0, 0.0))
    sun.create_light("directional", casts_shadow=1)
    world.update()
    buffer = world.open_mesh("sheet")
    side = View(compose_look_at((0.0, 3.0, -4.0), (0.0, -1.0, -1.0)), (-0.5, 0.5, -0.5, 0.5), (0, 0, *SIZE))
    pictures = []
    with create_surface("egl", SIZE) as surface:
        settings = RenderSettings(msaa=0, shadow_size=512, tone_map="none", fog_density=0.0)
        kept = Renderer(surface, world, settings)
        kept.draw([side])
        buffer.positions[:] *= 0.5
        buffer.update()
        world.update()
        kept.draw([side])
        pictures.append(read_pixels(surface))
        fresh = Renderer(surface, world, settings)
        fresh._shadows._box = kept._shadows._box
        fresh.draw([side])
        pictures.append(read_pixels(surface))
        kept.release(), fresh.release()
    assert (pictures[0] == pictures[1]).all()


def test_an_opened_mesh_hides_nothing_behind_it():
    world = make_world()
    with create_surface("egl", (8, 8)) as surface:
        arena = MeshArena(surface.ctx)
        arena.update(world, solid=True)
        assert "box" in arena.solids
        world.open_mesh("box")
        assert arena.update(world, solid=True)
        assert "box" not in arena.solids
        arena.release()


def test_a_mesh_that_is_replaced_is_opened_anew():
    world = make_world()
    buffer = world.open_mesh("sheet")
    assert world.open_mesh("sheet") is buffer
    world.replace_mesh("sheet", plane(2.0, 2.0))
    assert world.opened_mesh("sheet") is None
    assert len(world.open_mesh("sheet").positions) == 4
    buffer.update()  # of a mesh that is gone: nobody is informed
    assert len(world.meshes["sheet"].positions) == 4


def test_what_does_not_fit_is_refused():
    world = make_world()
    with pytest.raises(KeyError, match=r'no mesh "shet".*sheet'):
        world.open_mesh("shet")
    buffer = world.open_mesh("sheet")
    revision = world.mesh_revision("sheet")
    for first, count in ((-1, 2), (24, 2), (3, -1)):
        with pytest.raises(ValueError, match="are not among the 25 there are"):
            buffer.update(first, count)
    buffer.positions[3, 1] = np.nan
    with pytest.raises(ValueError, match="vertices 2 to 4: not all numbers are finite"):
        buffer.update(2, 3)
    buffer.indices[0] = 25
    with pytest.raises(ValueError, match="25 points past the 25 vertices"):
        buffer.update_indices(0, 3)
    assert world.mesh_revision("sheet") == revision


def test_declarations_have_no_holes():
    for declaration in (VERTEX_DECLARATION, COLOUR_DECLARATION):
        ends = [element.offset + 4 * element.components for element in declaration.elements]
        assert [element.offset for element in declaration.elements] == [0, *ends[:-1]]
        assert declaration.stride == ends[-1] == declaration.dtype.itemsize
    assert isinstance(make_world().open_mesh("sheet"), MeshBuffer)
