#!/usr/bin/python3
# Bakes a small model of each kind that people's files have (survey_models.py), or the given files, into
# layers, and compares two views with path-traced truth. Prints the tables of tests/regression/models.md.
#   tools/lab/scripts/model_survey.py TESSERA ENVIRONMENT OUT [NAME or MODEL...] [options]
import argparse
import json
import os
import subprocess

import numpy as np

from survey_models import KINDS, Gltf

parser = argparse.ArgumentParser()
for name in 'tool', 'environment', 'out':
    parser.add_argument(name)
parser.add_argument('models', nargs='*', metavar='MODEL', default=list(KINDS))
parser.add_argument('--texels', default='20000', help="'default' for those of the tool")
parser.add_argument('--paths', default='128', help='of a ray of the truth')
parser.add_argument('--pixels', default='128x96')
parser.add_argument('--near', type=float, default=2.6, help='how far the second camera is, in radii')
options = parser.parse_intermixed_args()
out, environment = options.out, options.environment


def run(*arguments):
    return subprocess.run([options.tool, *map(str, arguments)], capture_output=True, text=True)


# Two cameras that see all of the file's mesh, the second one unless it is near.
def cameras(path):
    mesh = json.loads(run('info', path, '--json').stdout)['mesh']
    low, high = np.array(mesh['low']), np.array(mesh['high'])
    middle, radius = (low + high) / 2, np.linalg.norm(high - low) / 2
    for name, toward, far in ('a', (2, 1.5, 2.5), 2.6), ('b', (-1.2, 0.5, -3), options.near):
        eye = middle + far * radius * np.array(toward) / np.linalg.norm(toward)
        yield name, ['--eye', ','.join('%.9g' % x for x in eye),
                     '--look', ','.join('%.9g' % x for x in middle), '--fov', '45']


print('| model | bytes | object, dB | SSIM |\n|---|---|---|---|')
os.makedirs(out, exist_ok=True)
for name in options.models:
    model, inside = name, None
    if name in KINDS:
        model = f'{out}/{name}.gltf'
        gltf = Gltf()
        KINDS[name](gltf)
        gltf.write(model)
        inside = getattr(KINDS[name], 'camera', None)
    # Files of one name may lie in several folders.
    base = f'{out}/' + '_'.join(os.path.splitext(name)[0].split('/')[-2:])
    texels = [] if options.texels == 'default' else ['--texels', options.texels]
    baked = run('bake', model, '-o', base + '.tess', *texels, '--env', environment, '-q')
    if baked.returncode:
        print(f'| {name} | {baked.stderr.strip()} | | |', flush=True)
        continue
    views = [('a', inside)] if inside else cameras(base + '.tess')
    found = []
    for view, camera in views:
        drawn = run('render', base + '.tess', '-o', f'{base}-{view}.png', *camera, '--pixels', options.pixels,
                    '--truth', model, '--truth-spp', options.paths, '--env', environment, '--json', '-q',
                    '--write-all')
        figures = json.loads(drawn.stdout)['views'][0]['compressed_truth']
        found.append((figures['object_psnr'], figures['ssim']))
    psnr = ', '.join('%.1f' % f[0] if f[0] else '-' for f in found)
    ssim = ', '.join('%.3f' % f[1] for f in found)
    print(f'| {name} | {os.path.getsize(base + ".tess"):,} | {psnr} | {ssim} |', flush=True)
