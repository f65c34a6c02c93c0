#!/usr/bin/python3
# Bakes a small model of each kind that people's files have (survey_models.py) into layers, and
# compares two views with path-traced truth. Prints the survey of tests/regression/models.md.
#   tools/lab/scripts/model_survey.py TESSERA ENVIRONMENT OUT [NAME or MODEL...]
import json
import os
import subprocess
import sys

import numpy as np

from survey_models import KINDS, Gltf

tool, environment, out = sys.argv[1:4]
texels, paths, pixels = 20000, 128, '128x96'


def run(*arguments):
    return subprocess.run([tool, *map(str, arguments)], capture_output=True, text=True)


# Two cameras that see all of the file's mesh.
def cameras(path):
    mesh = json.loads(run('info', path, '--json').stdout)['mesh']
    low, high = np.array(mesh['low']), np.array(mesh['high'])
    middle, radius = (low + high) / 2, np.linalg.norm(high - low) / 2
    for name, toward in ('a', (2, 1.5, 2.5)), ('b', (-1.2, 0.5, -3)):
        eye = middle + 2.6 * radius * np.array(toward) / np.linalg.norm(toward)
        yield name, ['--eye', ','.join('%.9g' % x for x in eye),
                     '--look', ','.join('%.9g' % x for x in middle), '--fov', '45']


print('| model | bytes | object, dB | SSIM |\n|---|---|---|---|')
os.makedirs(out, exist_ok=True)
for name in sys.argv[4:] or KINDS:
    model, inside = name, None
    if name in KINDS:
        model = f'{out}/{name}.gltf'
        gltf = Gltf()
        KINDS[name](gltf)
        gltf.write(model)
        inside = getattr(KINDS[name], 'camera', None)
    base = f'{out}/{os.path.basename(name).split(".")[0]}'
    baked = run('bake', model, '-o', base + '.tess', '--texels', texels, '--env', environment, '-q')
    if baked.returncode:
        print(f'| {name} | {baked.stderr.strip()} | | |', flush=True)
        continue
    views = [('a', inside)] if inside else cameras(base + '.tess')
    found = []
    for view, camera in views:
        drawn = run('render', base + '.tess', '-o', f'{base}-{view}.png', *camera, '--pixels', pixels,
                    '--truth', model, '--truth-spp', paths, '--env', environment, '--json', '-q',
                    '--write-all')
        figures = json.loads(drawn.stdout)['views'][0]['compressed_truth']
        found.append((figures['object_psnr'], figures['ssim']))
    psnr = ', '.join('%.1f' % f[0] if f[0] else '-' for f in found)
    ssim = ', '.join('%.3f' % f[1] for f in found)
    print(f'| {name} | {os.path.getsize(base + ".tess"):,} | {psnr} | {ssim} |', flush=True)
