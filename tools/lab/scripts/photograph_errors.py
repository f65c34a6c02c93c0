# Makes a copy of a NeRF-synthetic training set with one kind of the errors that real photographs have:
#   photograph_errors.py SET KIND OUT
# SET holds transforms_train.json, its pictures and a mesh NAME.obj, where NAME is the folder's name. Kinds: poses
# (turned by half a pixel), exposure (changed by up to 10 %), wrong (every tenth picture is another one), jpeg
# (quality 85), mesh (a quarter of the triangles, by clustering of vertices). Needs NumPy and Pillow.
import sys, json, os, shutil
import numpy as np
from PIL import Image
src, kind, out = sys.argv[1:4]
rng = np.random.default_rng(7)
os.makedirs(out + '/train', exist_ok=True)
d = json.load(open(src + '/transforms_train.json'))
name = os.path.basename(src.rstrip('/'))
focal = 0.5 * d['w'] / np.tan(0.5 * d['camera_angle_x'])
for i, f in enumerate(d['frames']):
    im = Image.open(f'{src}/{f["file_path"]}.png').convert('RGB')
    to = f'{out}/{f["file_path"]}.png'
    if kind == 'poses':  # a rotation that moves the picture by half a pixel
        a = rng.normal(size=2) * 0.5 / focal
        m = np.array(f['transform_matrix'])
        rx = np.array([[1,0,0],[0,np.cos(a[0]),-np.sin(a[0])],[0,np.sin(a[0]),np.cos(a[0])]])
        ry = np.array([[np.cos(a[1]),0,np.sin(a[1])],[0,1,0],[-np.sin(a[1]),0,np.cos(a[1])]])
        m[:3,:3] = m[:3,:3] @ rx @ ry
        f['transform_matrix'] = m.tolist()
    if kind == 'exposure':
        x = np.asarray(im) / 255.0
        lin = np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4) * (1 + 0.1 * rng.uniform(-1, 1))
        y = np.where(lin <= 0.0031308, 12.92 * lin, 1.055 * np.clip(lin, 0, 1) ** (1 / 2.4) - 0.055)
        im = Image.fromarray(np.clip(y * 255 + 0.5, 0, 255).astype(np.uint8))
    if kind == 'wrong' and i % 10 == 4:
        im = Image.open(f'{src}/{d["frames"][(i + 37) % len(d["frames"])]["file_path"]}.png').convert('RGB')
    if kind == 'jpeg':
        f['file_path'] += '.jpg'
        im.save(to[:-4] + '.jpg', quality=85)
    else:
        im.save(to)
json.dump(d, open(out + '/transforms_train.json', 'w'))
if kind == 'mesh':  # vertex clustering to about a quarter of the triangles
    v, n, faces = [], [], []
    for line in open(f'{src}/{name}.obj'):
        t = line.split()
        if t and t[0] == 'v': v.append([float(x) for x in t[1:4]])
        if t and t[0] == 'f': faces.append([int(x.split('/')[0]) - 1 for x in t[1:4]])
    v = np.array(v); faces = np.array(faces)
    low, high = 1e-4, 1.0
    for _ in range(30):
        h = (low * high) ** 0.5
        key = np.floor(v / h).astype(int)
        _, inv = np.unique(key, axis=0, return_inverse=True); inv = inv.reshape(-1)
        g = inv[faces]
        ok = (g[:,0] != g[:,1]) & (g[:,1] != g[:,2]) & (g[:,0] != g[:,2])
        if ok.sum() > len(faces) / 4: low = h
        else: high = h
    c = np.zeros((inv.max() + 1, 3)); k = np.zeros(inv.max() + 1)
    np.add.at(c, inv, v); np.add.at(k, inv, 1); c /= k[:, None]
    with open(f'{out}/{name}.obj', 'w') as o:
        for p in c: o.write('v %.7f %.7f %.7f\n' % tuple(p))
        for t in np.unique(np.sort(g[ok], axis=1), axis=0, return_index=True)[1]:
            o.write('f %d %d %d\n' % tuple(g[ok][t] + 1))
else:
    shutil.copy(f'{src}/{name}.obj', f'{out}/{name}.obj')
