"""Imports a .glb with a Tessera texture into Blender, and renders it.

    blender -b -P blender_gltf.py -- FILE.glb OUT.png [EYE [LOOK [WIDTHxHEIGHT [eevee|cycles]]]]
    blender -P blender_gltf.py -- FILE.glb            # opens the model in Blender's window

EYE and LOOK are X,Y,Z in the coordinates of the file, whose y axis is up, as for `tessera render`.

Blender shows the picture that the file has for programs without the extension
TESSERA_texture_light_field: the mean over all directions. Neither Eevee nor Cycles shows more, because
Blender's materials cannot look up a texture by direction; gloss and mirrors are missing.
"""
import math
import sys

import bpy
import numpy
from mathutils import Vector

if not hasattr(numpy, "bool"):
    numpy.bool = bool  # which the importer of Debian 12's Blender 3.4 needs, and its numpy 1.24 lacks


def upright(text):
    """A point of the file in Blender, whose z axis is up."""
    x, y, z = map(float, text.split(","))
    return Vector((x, -z, y))


def main(words):
    if not words:
        sys.exit(__doc__)
    usual = ["", "", "10,0,0", "0,0,0", "640x480", "eevee"]
    glb, out, eye, look, size, engine = words + usual[len(words):]
    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=glb)
    meshes = [x for x in bpy.data.objects if x.type == "MESH"]
    if not any(slot.material and slot.material.use_nodes and
               any(node.type == "TEX_IMAGE" for node in slot.material.node_tree.nodes)
               for mesh in meshes for slot in mesh.material_slots):
        sys.exit(f"{glb}: there is no mesh with a picture")
    print(f"{glb}: {len(meshes)} mesh(es) with the picture of the file; its light field is not shown")
    scene = bpy.context.scene
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    camera.location = upright(eye)
    camera.rotation_euler = (upright(look) - upright(eye)).to_track_quat("-Z", "Y").to_euler()
    camera.data.sensor_fit = "VERTICAL"
    camera.data.angle = math.radians(45)
    scene.view_settings.view_transform = "Standard"  # shows colours as the picture has them
    scene.world = bpy.data.worlds.new("black")
    scene.world.color = (0, 0, 0)
    if not out:
        return
    scene.render.resolution_x, scene.render.resolution_y = map(int, size.split("x"))
    scene.render.engine = "CYCLES" if engine == "cycles" else "BLENDER_EEVEE"
    scene.cycles.samples = scene.eevee.taa_render_samples = 16
    scene.cycles.use_denoising = False  # Debian's Blender has no denoiser
    scene.render.image_settings.color_mode = "RGB"
    scene.render.filepath = out
    bpy.ops.render.render(write_still=True)


main(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else [])
