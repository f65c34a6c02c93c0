"""Saves a scene whose photographs have enough detail for COLMAP (tests/regression/photographs.md):
    blender -b -P photo_scene.py -- OUT.blend
Three glossy bodies with patterns stand on a board with another pattern, in the light of two lamps and a sky."""
import bpy, os, sys
from mathutils import Vector

bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.engine = 'CYCLES'
scene.cycles.samples = 12
scene.camera = bpy.data.objects.new('camera', bpy.data.cameras.new('camera'))
scene.collection.objects.link(scene.camera)
scene.world = bpy.data.worlds.new('sky')
scene.world.use_nodes = True
scene.world.node_tree.nodes['Background'].inputs['Color'].default_value = (0.6, 0.7, 0.9, 1)

# A material with spots of the colours. A higher scale makes them smaller.
def pattern(name, scale, roughness, colours):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    place, noise, ramp = (nodes.new('ShaderNode' + kind) for kind in ('TexCoord', 'TexNoise', 'ValToRGB'))
    noise.inputs['Scale'].default_value, noise.inputs['Detail'].default_value = scale, 4
    ramp.color_ramp.interpolation = 'CONSTANT'
    for i, colour in enumerate(colours):
        at = 0.35 + 0.3 * i / len(colours)
        stop = ramp.color_ramp.elements[i] if i < 2 else ramp.color_ramp.elements.new(at)
        stop.position, stop.color = at if i else 0, (*colour, 1)
    links.new(place.outputs['Object'], noise.inputs['Vector'])
    links.new(noise.outputs['Fac'], ramp.inputs['Fac'])
    surface = nodes['Principled BSDF']
    links.new(ramp.outputs['Color'], surface.inputs['Base Color'])
    surface.inputs['Roughness'].default_value = roughness
    return material

# Adds a mesh of Blender's kind.
def add(kind, material, smooth=False, **where):
    getattr(bpy.ops.mesh, 'primitive_%s_add' % kind)(**where)
    body = bpy.context.object
    body.data.materials.append(material)
    if smooth:
        bpy.ops.object.shade_smooth()
    return body

red = [(0.02, 0.02, 0.05), (0.6, 0.05, 0.03), (0.9, 0.7, 0.2), (0.1, 0.3, 0.6), (0.8, 0.8, 0.75)]
green = [(0.05, 0.25, 0.1), (0.7, 0.8, 0.3), (0.02, 0.05, 0.1), (0.85, 0.4, 0.2), (0.3, 0.6, 0.7)]
grey = [(0.1, 0.09, 0.08), (0.6, 0.55, 0.5), (0.25, 0.15, 0.1), (0.75, 0.75, 0.7)]
add('cube', pattern('board', 6, 0.5, grey), location=(0, 0, -0.05), scale=(1.2, 1.2, 0.05))
head = add('monkey', pattern('head', 5, 0.15, red), smooth=True, location=(-0.4, 0.1, 0.4), size=0.85)
head.rotation_euler = (-0.3, 0, 0.5)
subdivision = head.modifiers.new('smooth', 'SUBSURF')
subdivision.levels = subdivision.render_levels = 2
add('torus', pattern('ring', 6, 0.3, green), smooth=True, location=(0.55, -0.35, 0.13), major_radius=0.32,
    minor_radius=0.13)
add('cube', pattern('block', 8, 0.4, red[::-1]), location=(0.5, 0.55, 0.25), rotation=(0, 0, 0.4),
    scale=(0.25, 0.25, 0.25))
for place, power in (((3, -2, 4), 250), ((-3, -3, 2), 80)):
    lamp = bpy.data.objects.new('lamp', bpy.data.lights.new('lamp', 'AREA'))
    lamp.data.energy, lamp.data.size, lamp.location = power, 1, place
    lamp.rotation_euler = Vector(place).to_track_quat('Z', 'Y').to_euler()
    scene.collection.objects.link(lamp)
bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(sys.argv[-1]))
