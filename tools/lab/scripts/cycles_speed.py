"""Compares the time that `tessera render --truth` and Blender Cycles take for equal noise:
    blender -b -P cycles_speed.py -- TESSERA X.tess MODEL ENV.exr EYE LOOK EXPOSURE [PATHS]
X.tess is a bake of MODEL in ENV.exr with this EXPOSURE, which has to be so low that no light is
clamped. Noise is the mean square error against the same renderer with 16 times PATHS, of sRGB
pixels that show the object where its mean light is 0.6. Times are CPU seconds, less what one path
a pixel takes: loading, the acceleration structure, and the picture of the layers."""
import math, os, resource, subprocess, sys

sys.path.insert(0, os.path.dirname(__file__))
from cycles_scene import *

tessera, tess, model, environment, eye, look, exposure, *rest = sys.argv[sys.argv.index('--') + 1:]
paths = int(rest[0]) if rest else 64
width, height, side, fov = 100, 75, 2, 45  # side: of the rays of a pixel
size, out = f'{width}x{height}', os.path.splitext(tess)[0]


def seconds(who, draw):
    before = resource.getrusage(who)
    draw()
    after = resource.getrusage(who)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def of_tessera(count):
    """The light of `count` paths a pixel, where the object is, and the CPU seconds."""
    command = [tessera, 'render', tess, '-o', out + '.exr', '--eye', eye, '--look', look, '--fov',
               str(fov), '--pixels', f'{side * width}x{side * height}', '--rays', '1', '--truth', model,
               '--truth-spp', str(count // side**2), '--write-all', '-q']
    spent = seconds(resource.RUSAGE_CHILDREN, lambda: subprocess.run(command, check=True))
    return *pixels_of_tessera(out + '-truth.exr', size, float(exposure)), spent


load_model(model)
use_lobes_of_gltf()
scene = set_up(environment, eye, look, fov, size)


def of_cycles(count):
    spent = seconds(resource.RUSAGE_SELF, lambda: render(scene, count, out + '-cycles.exr'))
    drawn = pixels(out + '-cycles.exr')
    return drawn[..., :3], drawn[..., 3] > .9999, spent


results = {}
for name, draw, least in (('Tessera', of_tessera, side**2), ('Cycles', of_cycles, 1)):
    start = draw(least)[2]
    results[name] = [(n, *draw(n)) for n in (paths // 2, paths, 2 * paths, 16 * paths)], start, least
seen = np.logical_and(*(drawn[-1][2] for drawn, _, _ in results.values()))
per_path, needed = {}, {}
for name, (drawn, start, least) in results.items():
    best = drawn[-1][1][seen]
    show = lambda light: srgb(light * .6 / best.mean())
    noise = [np.mean((show(light[seen]) - show(best)) ** 2) for _, light, _, _ in drawn[:-1]]
    count, _, _, spent = drawn[-1]
    per_path[name] = (spent - start) / ((count - least) * width * height)
    needed[name] = noise
    print(f'{name}: noise of {paths // 2}, {paths}, {2 * paths} paths a pixel: ' +
          ', '.join(f'{-10 * math.log10(x):.2f}' for x in noise) +
          f' dB; {1e-3 / per_path[name]:.0f} thousand paths per CPU second')
# Paths that give Cycles the noise that Tessera has with PATHS: a line of logarithms.
half, one, twice = (math.log2(x) for x in needed['Cycles'])
wanted = math.log2(needed['Tessera'][1])
equal = paths * 2 ** ((one - wanted) / ((half - twice) / 2))
print(f'equal noise: {equal:.0f} paths of Cycles; time of Tessera divided by that of Cycles: '
      f'{per_path["Tessera"] * paths / (per_path["Cycles"] * equal):.2f}')
