"""Renders a Blender scene as input for `tessera encode` (tools/README.md). Runs Cycles without a window:
    blender -b x.blend -P blender_views.py -- planar OUT/ 9x9 SPACING FOCUS WIDTHxHEIGHT
    blender -b x.blend -P blender_views.py -- sphere OUT.exr UxVxSxT RADIUS
    blender -b x.blend -P blender_views.py -- photos OUT/ TRAIN TEST WIDTHxHEIGHT DISTANCE [LOWEST]
planar renders a grid of cameras around the camera of the scene and writes one PNG per view to OUT/. SPACING is the
distance between neighbouring cameras. Objects at distance FOCUS are at the same pixels in all views.
sphere renders the light that leaves a sphere around the origin and writes it as an EXR mosaic.
photos renders TRAIN and TEST photographs from all around the meshes, DISTANCE from their middle, and writes them with
their cameras as NeRF-synthetic does (OUT/transforms_train.json, OUT/train/r_0.png, ...), and the meshes to OUT/mesh.obj.
No camera is less than LOWEST degrees above the horizon: -90 by default, 0 for what stands on a table.
Lengths are in Blender's units. Blender's z axis is Tessera's y axis."""
import bpy, json, math, os, sys, tempfile
from mathutils import Matrix, Vector

scene = bpy.context.scene
scene.render.engine, scene.render.use_persistent_data = 'CYCLES', True
scene.cycles.use_denoising = False  # denoised views would not be consistent, and Debian's Blender has no denoiser

def shoot(path, width, height, kind, colours='RGB'):
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format, scene.render.filepath = kind, path
    scene.render.image_settings.color_mode = colours
    bpy.ops.render.render(write_still=True)

def planar(out, grid, spacing, focus, size):
    (columns, rows), (width, height) = map(int, grid.split('x')), map(int, size.split('x'))
    camera, home = scene.camera.data, scene.camera.matrix_world.copy()
    camera.sensor_fit = 'HORIZONTAL'
    window = float(focus) * camera.sensor_width / camera.lens  # width of a view at the focus
    for t in range(rows):
        for s in range(columns):
            x, y = (s - (columns - 1) / 2) * float(spacing), ((rows - 1) / 2 - t) * float(spacing)
            scene.camera.matrix_world = home @ Matrix.Translation((x, y, 0))
            camera.shift_x, camera.shift_y = -x / window, -y / window
            shoot(os.path.join(out, 'view_t%03d_s%03d.png' % (t, s)), width, height, 'PNG')

def sphere(out, size, radius):
    U, V, S, T = map(int, size.split('x'))
    eye, half, radius = bpy.data.cameras.new('place'), math.pi / 2, float(radius)
    eye.type, eye.clip_start, eye.clip_end = 'PANO', 1e-4 * radius, 2 * radius
    eye.cycles.panorama_type = 'EQUIRECTANGULAR'  # a hemisphere: alpha to the right, beta upwards
    eye.cycles.longitude_min, eye.cycles.longitude_max = -half, half
    eye.cycles.latitude_min, eye.cycles.latitude_max = -half, half
    scene.camera = bpy.data.objects.new('place', eye)
    scene.collection.objects.link(scene.camera)
    mosaic, one = [0.0] * (U * S * V * T * 4), os.path.join(tempfile.mkdtemp(), 'place.exr')
    for v, u in ((v, u) for v in range(V) for u in range(U)):
        lon, lat = 2 * math.pi * (u + 0.5) / U - math.pi, math.pi * (v + 0.5) / V - half
        ez = Vector((math.sin(lon) * math.cos(lat), -math.cos(lon) * math.cos(lat), math.sin(lat)))
        ex = Vector((0, 0, 1)).cross(ez).normalized()
        turn = Matrix((-ex, -ez.cross(ex), ez)).transposed().to_4x4()  # the camera looks along -ez
        scene.camera.matrix_world = Matrix.Translation(ez * radius) @ turn
        shoot(one, S, T, 'OPEN_EXR')
        image = bpy.data.images.load(one)
        for t in range(T):  # row 0 is at the bottom in Blender's images and for t, and at the top in the mosaic
            to = ((V * T - 1 - v * T - t) * U + u) * S * 4
            mosaic[to:to + 4 * S] = image.pixels[t * S * 4:(t + 1) * S * 4]
        bpy.data.images.remove(image)
    whole = bpy.data.images.new('mosaic', U * S, V * T, float_buffer=True)
    whole.pixels, whole.filepath_raw, whole.file_format = mosaic, out, 'OPEN_EXR'
    whole.save()

def photos(out, train, test, size, distance, lowest='-90'):
    (width, height), camera = map(int, size.split('x')), scene.camera.data
    meshes = [thing for thing in scene.objects if thing.type == 'MESH']
    corners = [thing.matrix_world @ Vector(corner) for thing in meshes for corner in thing.bound_box]
    middle = Vector([(min(axis) + max(axis)) / 2 for axis in zip(*corners)])
    camera.sensor_fit, camera.shift_x, camera.shift_y = 'HORIZONTAL', 0, 0
    scene.render.film_transparent = True  # alpha is the coverage
    scene.view_settings.view_transform = 'Standard'  # plain sRGB
    part = 1 - math.sin(math.radians(float(lowest)))
    for name, count, turn in (('train', int(train), 0), ('test', int(test), 1)):
        frames = []
        for i in range(count):  # a spiral of even steps over the sphere
            z, angle = 1 - (i + 0.5) / count * part, i * math.pi * (3 - math.sqrt(5)) + turn
            away = Vector((math.cos(angle) * math.sqrt(1 - z * z), math.sin(angle) * math.sqrt(1 - z * z), z))
            pose = Matrix.Translation(middle + away * float(distance)) @ away.to_track_quat('Z', 'Y').to_matrix().to_4x4()
            scene.camera.matrix_world = pose
            shoot(os.path.join(out, name, 'r_%d.png' % i), width, height, 'PNG', 'RGBA')
            frames.append({'file_path': './%s/r_%d' % (name, i), 'transform_matrix': [list(row) for row in pose]})
        with open(os.path.join(out, 'transforms_%s.json' % name), 'w') as file:
            json.dump({'camera_angle_x': camera.angle_x, 'w': width, 'h': height, 'frames': frames}, file, indent=1)
    bpy.ops.object.select_all(action='DESELECT')
    for thing in meshes:
        thing.select_set(True)
    bpy.ops.wm.obj_export(filepath=os.path.join(out, 'mesh.obj'), export_selected_objects=True, forward_axis='Y',
                          up_axis='Z')  # the frame of the cameras

arguments = sys.argv[sys.argv.index('--') + 1:]
{'planar': planar, 'sphere': sphere, 'photos': photos}[arguments[0]](*arguments[1:])
