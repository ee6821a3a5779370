"""OGRE's particle system with the parameters of `particles_workload`, run by the interpreter that has OGRE's binding.

/usr/bin/python3 -m mimics_app.app.bench.ogre_particles FOLDER WIDTHxHEIGHT FRAMES WARMUP

FOLDER has particles.json and dot.png. It prints one line `RESULT {...}`, as the peers' harness does, and imports only
the standard library and OGRE, since that interpreter has no other packages.
"""

from __future__ import annotations

import json
import math
import os
import shutil
import statistics
import sys

from mimics_app.contracts.clock import MonotonicClock, process_seconds

__all__ = ["main"]

_PLUGINS = "/usr/lib/x86_64-linux-gnu/OGRE"
_SHADERS = "/usr/share/OGRE/Media/RTShaderLib/"
_MATERIAL = os.path.join(os.path.dirname(__file__), "dot.material")
_SCHEME = "ShaderGeneratorDefaultScheme"


def main(folder: str, size: str, frames: int, warmup: int) -> None:
    """Draw and time."""
    width, height = map(int, size.split("x"))
    with open(os.path.join(folder, "particles.json"), encoding="utf-8") as file:
        numbers = json.load(file)
    root, window, manager = _open(folder, width, height)
    _place_camera(numbers, window, manager, width / height)
    system = _fill(numbers, manager)
    system.fastForward(numbers["life_s"], numbers["step_s"])
    clock, times, processor = MonotonicClock(), list[float](), 0.0
    for frame in range(warmup + frames):
        if frame == warmup:
            processor = process_seconds()
        began = clock.now_ns()
        root.renderOneFrame(numbers["step_s"])
        if frame >= warmup:
            times.append(1e-6 * (clock.now_ns() - began))
    processor = 1e3 * (process_seconds() - processor) / frames
    row = {"ms_median": statistics.median(times), "ms_cpu": processor, "particles": system.getNumParticles()}
    print("RESULT " + json.dumps(row), flush=True)
    os._exit(0)  # the binding crashes in an orderly exit


def _open(folder, width, height):
    """Create root, window and scene manager, with the shader generator."""
    import Ogre
    from Ogre import RTShader

    plugins = ("RenderSystem_GL3Plus", "Plugin_OctreeSceneManager", "Plugin_ParticleFX", "Codec_STBI")
    with open(os.path.join(folder, "plugins.cfg"), "w", encoding="utf-8") as file:
        file.write(f"PluginFolder={_PLUGINS}\n" + "".join(f"Plugin={name}\n" for name in plugins))
    shutil.copy(_MATERIAL, folder)
    root = Ogre.Root(*(os.path.join(folder, name) for name in ("plugins.cfg", "ogre.cfg", "ogre.log")))
    system = root.getAvailableRenderers()[0]
    for key, value in (("Full Screen", "No"), ("FSAA", "0"), ("VSync", "No"), ("Video Mode", f"{width} x {height}")):
        system.setConfigOption(key, value)
    root.setRenderSystem(system)
    root.initialise(False)
    window = root.createRenderWindow("particles", width, height, False)
    groups = Ogre.ResourceGroupManager.getSingleton()
    groups.addResourceLocation(folder, "FileSystem", "General")
    for part in ("materials", "GLSL"):
        groups.addResourceLocation(_SHADERS + part, "FileSystem", "OgreInternal")
    groups.addResourceLocation("/usr/share/OGRE/Media/ShadowVolume", "FileSystem", "OgreInternal")
    RTShader.ShaderGenerator.initialize()
    shaders = RTShader.ShaderGenerator.getSingleton()
    manager = root.createSceneManager("OctreeSceneManager")
    shaders.addSceneManager(manager)
    groups.initialiseAllResourceGroups()
    material = Ogre.MaterialManager.getSingleton().getByName("Dot")
    shaders.createShaderBasedTechnique(material.getTechnique(0), _SCHEME)
    return root, window, manager


def _place_camera(numbers, window, manager, aspect):
    """Create the camera and the background."""
    import Ogre

    camera = manager.createCamera("eye")
    camera.setNearClipDistance(0.1)
    camera.setFarClipDistance(2000.0)
    camera.setAspectRatio(aspect)
    camera.setFOVy(Ogre.Radian(math.radians(60.0)))
    node = manager.getRootSceneNode().createChildSceneNode()
    node.attachObject(camera)
    node.setPosition(Ogre.Vector3(*numbers["eye"]))
    node.lookAt(Ogre.Vector3(*numbers["target"]), Ogre.Node.TS_WORLD)
    viewport = window.addViewport(camera)
    viewport.setBackgroundColour(Ogre.ColourValue(0.5, 0.6, 0.7))
    viewport.setMaterialScheme(_SCHEME)


def _fill(numbers, manager):
    """Create the particle system."""
    import Ogre

    system = manager.createParticleSystem("fountain", numbers["count"])
    system.setMaterialName("Dot")
    system.setDefaultDimensions(numbers["size"], numbers["size"])
    emitter = system.addEmitter("Box")
    emitter.setDirection(Ogre.Vector3(0.0, 1.0, 0.0))
    for name, value in (("width", numbers["side"]), ("height", numbers["side"]), ("depth", 1e-3)):
        emitter.setParameter(name, str(value))
    emitter.setAngle(Ogre.Radian(numbers["cone"]))
    emitter.setEmissionRate(numbers["count"] / numbers["life_s"])
    emitter.setTimeToLive(numbers["life_s"])
    emitter.setParticleVelocity(*numbers["speed"])
    emitter.setColour(Ogre.ColourValue(*numbers["colour"]))
    pull = system.addAffector("LinearForce")
    pull.setParameter("force_vector", f"0 {-numbers['gravity']} 0")
    pull.setParameter("force_application", "add")
    manager.getRootSceneNode().attachObject(system)
    return system


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4]))
