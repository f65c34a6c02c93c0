"""Creates the scenes of tests/regression/rd_captured.md, for blender_views.py:
    blender -b -P blender_scenes.py -- glossy|clutter|grass OUT.blend"""
import bpy, math, random, sys

kind, out = sys.argv[sys.argv.index('--') + 1:]
random.seed({'glossy': 1, 'clutter': 2, 'grass': 3}[kind])
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.engine = 'CYCLES'
scene.cycles.samples = 64 if kind == 'grass' else 32

def paint(colour, metal=0.0, rough=0.5, spots=0):
    material = bpy.data.materials.new('')
    material.use_nodes = True
    tree = material.node_tree
    surface = tree.nodes['Principled BSDF'].inputs
    surface['Base Color'].default_value = (*colour, 1)
    surface['Metallic'].default_value, surface['Roughness'].default_value = metal, rough
    if spots:
        noise, ramp = tree.nodes.new('ShaderNodeTexNoise'), tree.nodes.new('ShaderNodeValToRGB')
        noise.inputs['Scale'].default_value, noise.inputs['Detail'].default_value = spots, 6
        ramp.color_ramp.elements[0].color = (*colour, 1)
        ramp.color_ramp.elements[1].color = (1 - colour[0], colour[1] * .5, 1 - colour[2], 1)
        tree.links.new(noise.outputs['Fac'], ramp.inputs['Fac'])
        tree.links.new(ramp.outputs['Color'], surface['Base Color'])
    bpy.context.object.data.materials.append(material)

def add(name, data, place, turn):
    thing = bpy.data.objects.new(name, data)
    thing.location, thing.rotation_euler = place, [math.radians(a) for a in turn]
    scene.collection.objects.link(thing)
    return thing

scene.world = bpy.data.worlds.new('')
scene.world.use_nodes = True
sky = scene.world.node_tree.nodes['Background'].inputs
sky[0].default_value, sky[1].default_value = (.6, .7, .9, 1), .8
camera, lamp = bpy.data.cameras.new('camera'), bpy.data.lights.new('lamp', 'AREA')
camera.lens, lamp.energy, lamp.size = 50, 900, 3
scene.camera = add('camera', camera, (0, -11, 1.2), (88, 0, 0))
add('lamp', lamp, (4, -6, 7), (45, 0, 30))
mesh = bpy.ops.mesh
mesh.primitive_plane_add(size=60, location=(0, 0, -1))
paint((.35, .25, .18), 0, .25 if kind == 'glossy' else .7, 3)
mesh.primitive_plane_add(size=60, location=(0, 9, 0), rotation=(math.pi / 2, 0, 0))
paint((.7, .65, .5), 0, .8, 1.5)
for i in range({'glossy': 14, 'clutter': 110, 'grass': 260}[kind]):
    x, y = random.uniform(-4.5, 4.5), random.uniform(-5, 7)
    r = random.uniform(.3, .9) if kind == 'glossy' else random.uniform(.1, .45)
    z = random.uniform(-1 + r, 2.5) if kind == 'clutter' else -1 + r
    colour = (random.random(), random.random(), random.random())
    if kind == 'grass':
        mesh.primitive_cone_add(vertices=5, radius1=.06 + .1 * random.random(), depth=1.2 + random.random(),
                                location=(x, y, -.3), rotation=(random.uniform(-.6, .6), random.uniform(-.6, .6), 0))
        paint((colour[0] * .3, .3 + .5 * colour[1], colour[2] * .2))
        continue
    shape = random.randrange(4)
    if shape == 0:
        mesh.primitive_uv_sphere_add(radius=r, location=(x, y, z))
    elif shape == 1:
        mesh.primitive_cube_add(size=1.6 * r, location=(x, y, z),
                                rotation=(random.random() * 3, random.random() * 3, random.random() * 3))
    elif shape == 2:
        mesh.primitive_torus_add(major_radius=r * .8, minor_radius=r * .25, location=(x, y, z),
                                 rotation=(random.random() * 3, random.random() * 3, 0))
    else:
        mesh.primitive_monkey_add(size=2 * r, location=(x, y, z), rotation=(0, 0, random.random() * 3))
    if shape in (0, 2):
        bpy.ops.object.shade_smooth()
    if kind == 'glossy':
        paint(colour, float(i % 2), .08, random.choice([0, 5]))
    else:
        paint(colour, 0, .5, random.choice([0, 0, 4, 9]))
bpy.ops.wm.save_as_mainfile(filepath=out)
