"""Sets up Blender Cycles so that it draws a model as `tessera render --truth` does. For
cycles_truth.py and cycles_speed.py, which Blender runs."""
import bpy, math
from mathutils import Vector
import numpy as np

np.bool = bool  # The importer of Blender 3.4 uses this name, which NumPy 1.24 lacks.
blender_axes = lambda v: Vector((v[0], -v[2], v[1]))  # z is up
place = lambda text: blender_axes([float(x) for x in text.split(',')])


def load_model(path):
    """.obj files, without materials, become grey metal of roughness 0.1."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if path.endswith('.obj'):
        bpy.ops.wm.obj_import(filepath=path)
        metal = bpy.data.materials.new('')
        metal.use_nodes = True
        inputs = metal.node_tree.nodes['Principled BSDF'].inputs
        inputs['Base Color'].default_value = (.3185, .3185, .3185, 1)  # sRGB 0.6
        inputs['Metallic'].default_value, inputs['Roughness'].default_value = 1, .1
        for mesh in bpy.data.meshes:
            mesh.materials.clear()
            mesh.materials.append(metal)
            mesh.polygons.foreach_set('use_smooth', [True] * len(mesh.polygons))
    else:
        bpy.ops.import_scene.gltf(filepath=path)
    for image in bpy.data.images:
        image.alpha_mode = 'CHANNEL_PACKED'  # Otherwise opaque materials show colours times alpha.
    for material in bpy.data.materials:
        if material.use_nodes:
            cut_masks(material)


def cut_masks(material):
    """Cycles ignores that a material is a mask."""
    tree = material.node_tree
    alphas = [link for link in tree.links if link.to_socket.name == 'Alpha']
    if material.blend_method == 'CLIP' and alphas:
        clip = tree.nodes.new('ShaderNodeMath')
        clip.operation = 'GREATER_THAN'
        clip.inputs[1].default_value = material.alpha_threshold
        source, alpha = alphas[0].from_socket, alphas[0].to_socket
        tree.links.new(source, clip.inputs[0])
        tree.links.new(clip.outputs[0], alpha)


def hide_from_camera(material):
    tree = material.node_tree
    surface = tree.get_output_node('CYCLES').inputs['Surface']
    path, mix = tree.nodes.new('ShaderNodeLightPath'), tree.nodes.new('ShaderNodeMixShader')
    tree.links.new(path.outputs['Is Camera Ray'], mix.inputs[0])
    tree.links.new(surface.links[0].from_socket, mix.inputs[1])
    tree.links.new(tree.nodes.new('ShaderNodeHoldout').outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], surface)


def with_lobes_of_gltf(tree, shader):
    """Replaces a Principled BSDF by the same mirror and by the diffuse lobe of glTF: Principled
    brightens rough surfaces at grazing views and takes nothing from diffuse light for the mirror."""
    nodes, links = tree.nodes, tree.links
    def connect(source, target):
        """Lets the input `target` have the value of the input `source`."""
        if source.is_linked:
            links.new(source.links[0].from_socket, target)
        else:
            target.default_value = source.default_value
    def joined(kind, first, second, factor=None):
        node = nodes.new(kind)
        for socket, part in zip(node.inputs[-2:], (first, second)):
            links.new(part.outputs[0], socket)
        if factor:
            connect(factor, node.inputs[0])
        return node
    mirror, diffuse, dark = (nodes.new('ShaderNodeBsdf' + kind)
                             for kind in ('Principled', 'Diffuse', 'Principled'))
    emission, gone = nodes.new('ShaderNodeEmission'), nodes.new('ShaderNodeBsdfTransparent')
    scale = nodes.new('ShaderNodeVectorMath')
    scale.operation, scale.inputs[3].default_value = 'SCALE', .96
    old = shader.inputs
    for node in (mirror, dark):
        for name in ('Roughness', 'Normal', 'Specular'):
            if name != 'Normal' or old[name].is_linked:
                connect(old[name], node.inputs[name])
    if old['Normal'].is_linked:
        connect(old['Normal'], diffuse.inputs['Normal'])
    connect(old['Base Color'], mirror.inputs['Base Color'])
    mirror.inputs['Metallic'].default_value = 1
    dark.inputs['Base Color'].default_value = (0, 0, 0, 1)  # leaves the mirror
    if old['Base Color'].is_linked:
        links.new(old['Base Color'].links[0].from_socket, scale.inputs[0])
    else:
        scale.inputs[0].default_value = old['Base Color'].default_value[:3]
    links.new(scale.outputs[0], diffuse.inputs['Color'])
    connect(old['Emission'], emission.inputs['Color'])
    connect(old['Emission Strength'], emission.inputs['Strength'])
    whole = joined('ShaderNodeMixShader', joined('ShaderNodeAddShader', dark, diffuse), mirror,
                   old['Metallic'])
    whole = joined('ShaderNodeAddShader', whole, emission)
    whole = joined('ShaderNodeMixShader', gone, whole, old['Alpha'])
    for link in list(shader.outputs[0].links):
        links.new(whole.outputs[0], link.to_socket)


def use_lobes_of_gltf():
    for material in bpy.data.materials:
        if material.use_nodes:
            for node in [n for n in material.node_tree.nodes if n.type == 'BSDF_PRINCIPLED']:
                with_lobes_of_gltf(material.node_tree, node)


def set_up(environment, eye, look, fov, size):
    """The camera, the light and the settings of Cycles. Returns the scene."""
    scene = bpy.context.scene
    bpy.context.view_layer.update()
    start, target = (place(text) for text in (eye, look))
    unit = (target - start).length / 10
    camera = bpy.data.cameras.new('camera')
    camera.sensor_fit, camera.angle = 'VERTICAL', math.radians(float(fov))
    camera.clip_start, camera.clip_end = .01 * unit, 1000 * unit
    scene.camera = bpy.data.objects.new('camera', camera)
    scene.camera.location = start
    scene.camera.rotation_euler = (target - start).to_track_quat('-Z', 'Y').to_euler()
    scene.collection.objects.link(scene.camera)

    # Blender's longitude of these axes is that of corpus/trace/environment.cpp.
    scene.world = bpy.data.worlds.new('')
    scene.world.use_nodes = True
    tree = scene.world.node_tree
    sky = tree.nodes.new('ShaderNodeTexEnvironment')
    sky.image = bpy.data.images.load(environment)
    tree.links.new(sky.outputs[0], tree.nodes['Background'].inputs[0])

    scene.render.engine, cycles = 'CYCLES', scene.cycles
    scene.render.resolution_x, scene.render.resolution_y = map(int, size.split('x'))
    scene.render.film_transparent = True
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.pixel_filter_type = 'BOX'
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = 8  # as tracer.cpp
    cycles.transmission_bounces = cycles.transparent_max_bounces = 8
    cycles.sample_clamp_indirect = cycles.blur_glossy = cycles.light_sampling_threshold = 0
    scene.render.image_settings.file_format = 'OPEN_EXR'
    scene.render.image_settings.color_mode = 'RGBA'
    scene.render.image_settings.color_depth = '32'
    return scene


def render(scene, paths, out):
    scene.cycles.samples, scene.render.filepath = int(paths), out
    bpy.ops.render.render(write_still=True)


def pixels(path):
    image = bpy.data.images.load(path)
    image.colorspace_settings.is_data = True
    return np.array(image.pixels).reshape(image.size[1], image.size[0], 4).astype(float)


def pixels_of_tessera(path, size, exposure):
    """A picture of `render --rays 1`, N times as wide and high as `size`: its light, and where all
    of a pixel shows the object. The background may be white."""
    width, height = map(int, size.split('x'))
    light = pixels(path)[..., :3]
    blocks = (height, light.shape[0] // height, width, light.shape[1] // width)
    hit = (light < 1).any(-1).reshape(blocks).all((1, 3))
    return light.reshape(*blocks, 3).mean((1, 3)) / exposure, hit


def srgb(light):
    x = np.clip(light, 0, 1)
    return np.where(x < .0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - .055)
