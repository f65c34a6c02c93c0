"""Renders a model with Blender Cycles as `tessera render --truth` does, and compares both pictures:
    blender -b -P cycles_truth.py -- MODEL ENV.exr EYE LOOK FOV WxH SPP OUT.exr
        [TRUTH.exr EXPOSURE [MATERIAL,... [gltf]]]
EYE and LOOK are X,Y,Z in the units of `tessera bake`; FOV is vertical, in degrees. MODEL is .gltf,
.glb or .obj without materials, which becomes grey metal of roughness 0.1. TRUTH.exr is the
name-truth.exr of `tessera render --rays 1 --write-all`, N times as wide and high as WxH. EXPOSURE
is that of `tessera bake`; it has to be so low that no light is clamped.
Pixels that show one of the MATERIALs are not compared. With `gltf` the diffuse lobe is that of
glTF's appendix B instead of Blender's."""
import math, os, sys

sys.path.insert(0, os.path.dirname(__file__))
from cycles_scene import *

model, environment, eye, look, fov, size, paths, out, *rival = sys.argv[sys.argv.index('--') + 1:]
load_model(model)
omitted = rival[2].split(',') if len(rival) > 2 else ()
for material in bpy.data.materials:
    if material.use_nodes and material.name in omitted:
        hide_from_camera(material)
if len(rival) > 3 and rival[3] == 'gltf':
    use_lobes_of_gltf()
render(set_up(environment, eye, look, fov, size), paths, out)

if rival:
    theirs = pixels(out)
    truth, hit = pixels_of_tessera(rival[0], size, float(rival[1]))
    seen = hit & (theirs[..., 3] > .9999)
    ours, theirs = truth[seen], theirs[seen][:, :3]
    bright = 0.6 / np.mean(ours)
    shown = lambda light: np.clip(light * bright, 0, 1)
    error = np.mean((srgb(ours * bright) - srgb(theirs * bright)) ** 2)
    ratios = ours.mean(1) / np.maximum(theirs.mean(1), 1e-9)
    low, median, high = np.quantile(ratios, (.25, .5, .75))
    print(f'pixels {seen.sum()}; mean light: Tessera {ours.mean():.4f}, Cycles '
          f'{theirs.mean():.4f}, ratio {ours.mean() / theirs.mean():.3f}, up to white '
          f'{shown(ours).mean() / shown(theirs).mean():.3f}; per pixel: median ratio '
          f'{median:.3f}, quartiles {low:.3f} {high:.3f}; PSNR {-10 * math.log10(error):.1f} dB')
