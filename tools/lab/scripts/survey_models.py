# Small models, one for each kind of thing that people's files have: what model_survey.py measures.
import base64, io, json, math, os, struct
import numpy as np

def sphere(rows=16, columns=24, radius=1.0, centre=(0, 0, 0)):
    t, p = np.meshgrid(np.pi * np.arange(rows + 1) / rows, 2 * np.pi * np.arange(columns + 1) / columns, indexing='ij')
    n = np.stack([np.sin(t) * np.cos(p), np.cos(t), -np.sin(t) * np.sin(p)], -1).reshape(-1, 3)
    uv = np.stack([p / (2 * np.pi), t / np.pi], -1).reshape(-1, 2)
    faces = []
    for i in range(rows):
        for j in range(columns):
            a = i * (columns + 1) + j
            b = a + columns + 1
            if i > 0: faces.append((a, b, a + 1))
            if i < rows - 1: faces.append((a + 1, b, b + 1))
    return dict(p=n * radius + np.array(centre), n=n, uv=uv, f=np.array(faces))

def quad(corner, side, up):
    corner, side, up = (np.array(v, float) for v in (corner, side, up))
    n = np.cross(side, up)
    n /= np.linalg.norm(n)
    return dict(p=np.array([corner, corner + side, corner + side + up, corner + up]), n=np.tile(n, (4, 1)),
                uv=np.array([(0, 1), (1, 1), (1, 0), (0, 0)], float), f=np.array([(0, 1, 2), (0, 2, 3)]))

def box(least=(-1, -1, -1), most=(1, 1, 1), inside=False):
    a, b = np.array(least, float), np.array(most, float)
    d = b - a
    x, y, z = np.diag(d)
    q = [quad(a + z, x, y), quad(b - y, -z, y) , quad(a + x, -x, y), quad(a, z, y), quad(a + y + z, x, -z), quad(a, x, z)]
    q[1] = quad(a + x + z, -z, y)
    m = join(q)
    if inside:
        m['n'] = -m['n']
        m['f'] = m['f'][:, ::-1]
    return m

def join(parts):
    out = {}
    base = 0
    faces = []
    for m in parts:
        faces.append(m['f'] + base)
        base += len(m['p'])
    keys = set(parts[0]) - {'f'}
    for k in keys: out[k] = np.concatenate([m[k] for m in parts])
    out['f'] = np.concatenate(faces)
    return out

def moved(m, by): return {**m, 'p': m['p'] + np.array(by)}

def torus(rows=48, columns=24, big=0.7, small=0.3):
    a, b = np.meshgrid(2 * np.pi * np.arange(rows + 1) / rows, 2 * np.pi * np.arange(columns + 1) / columns, indexing='ij')
    n = np.stack([np.cos(a) * np.cos(b), np.sin(b), -np.sin(a) * np.cos(b)], -1).reshape(-1, 3)
    p = np.stack([np.cos(a) * (big + small * np.cos(b)), small * np.sin(b), -np.sin(a) * (big + small * np.cos(b))], -1).reshape(-1, 3)
    uv = np.stack([a, b], -1).reshape(-1, 2) / (2 * np.pi)
    faces = []
    for i in range(rows):
        for j in range(columns):
            k = i * (columns + 1) + j
            faces += [(k, k + columns + 1, k + 1), (k + 1, k + columns + 1, k + columns + 2)]
    return dict(p=p, n=n, uv=uv, f=np.array(faces))

def picture(kind, side=256):
    from PIL import Image
    y, x = np.mgrid[0:side, 0:side]
    rgb = np.full((side, side, 4), 255, np.uint8)
    if kind == 'checks':
        c = ((x // 32 + y // 32) % 2)[..., None]
        rgb[..., :3] = np.where(c, (220, 200, 160), (60, 40, 120))
        rgb[(x - 128) ** 2 + (y - 64) ** 2 < 900, :3] = (200, 30, 30)
    elif kind == 'leaf':
        rgb[..., :3] = (60, 120, 30)
        inside = ((x - 128) / 50.0) ** 2 + ((y - 128) / 120.0) ** 2 < 1
        vein = abs(x - 128) < 4
        rgb[vein, :3] = (160, 180, 90)
        rgb[..., 3] = np.where(inside, 255, 0)
    elif kind == 'rough': # green roughness, blue metal
        rgb[..., 0] = 0
        rgb[..., 1] = 40 + 180 * ((x // 64) % 2)
        rgb[..., 2] = 255 * ((y // 64) % 2)
    elif kind == 'bumps':
        h = np.sin(x * 2 * np.pi / 32), np.sin(y * 2 * np.pi / 32)
        n = np.stack([h[0] * .4, h[1] * .4, np.ones_like(h[0])], -1)
        n /= np.linalg.norm(n, axis=-1, keepdims=True)
        rgb[..., :3] = np.round(127.5 + 127.5 * n)
    elif kind == 'gloss':
        rgb[..., :3] = np.where(((x // 64) % 2)[..., None], (230, 180, 60), (40, 40, 40))
        rgb[..., 3] = 80 + 150 * ((y // 64) % 2)
    elif kind == 'stripes': # a map of factors
        rgb[..., :3] = (255 * ((x // 32) % 2))[..., None]
    f = io.BytesIO()
    Image.fromarray(rgb).save(f, 'png')
    return f.getvalue()

class Gltf:
    def __init__(self):
        self.j = dict(asset=dict(version='2.0'), scene=0, scenes=[dict(nodes=[])], nodes=[], meshes=[], materials=[],
                      buffers=[{}], bufferViews=[], accessors=[])
        self.b = bytearray()
        self.used = set()
    def view(self, data):
        self.b += b'\0' * (-len(self.b) % 4)
        self.j['bufferViews'].append(dict(buffer=0, byteOffset=len(self.b), byteLength=len(data)))
        self.b += data
        return len(self.j['bufferViews']) - 1
    def accessor(self, a, kind=None):
        a = np.asarray(a)
        kind = kind or {1: 'SCALAR'}.get(a.ndim) or {2: 'VEC2', 3: 'VEC3', 4: 'VEC4', 16: 'MAT4'}[a.shape[1]]
        if a.dtype.kind == 'f': a, c = a.astype('<f4'), 5126
        elif a.dtype == np.uint8: c = 5121
        else: a, c = (a.astype('<u2'), 5123) if a.max() < 65535 else (a.astype('<u4'), 5125)
        acc = dict(bufferView=self.view(a.tobytes()), componentType=c, count=len(a), type=kind)
        if kind == 'VEC3': acc.update(min=a.min(0).tolist(), max=a.max(0).tolist())
        self.j['accessors'].append(acc)
        return len(self.j['accessors']) - 1
    def texture(self, kind):
        for key in ('images', 'textures'): self.j.setdefault(key, [])
        for i, image in enumerate(self.j['images']):
            if image['name'] == kind: return dict(index=i)
        self.j['images'].append(dict(bufferView=self.view(picture(kind)), mimeType='image/png', name=kind))
        self.j['textures'].append(dict(source=len(self.j['images']) - 1))
        return dict(index=len(self.j['textures']) - 1)
    def use(self, name):
        self.used.add(name)
        return name
    def material(self, colour=(.6, .5, .4, 1), m=0, r=.5, ext=None, **rest):
        mat = dict(pbrMetallicRoughness=dict(baseColorFactor=list(colour), metallicFactor=m, roughnessFactor=r), **rest)
        for k, t in list(mat.items()):
            if k == 'picture':
                mat['pbrMetallicRoughness']['baseColorTexture'] = mat.pop(k)
            if k == 'rough_picture':
                mat['pbrMetallicRoughness']['metallicRoughnessTexture'] = mat.pop(k)
        if ext:
            mat['extensions'] = {self.use(k): v for k, v in ext.items()}
        self.j['materials'].append(mat)
        return len(self.j['materials']) - 1
    def mesh(self, m, material, mode=4, normals=True, colours=None, targets=None, uv1=None, indexed=True, extra=None):
        at = dict(POSITION=self.accessor(m['p'].astype(float)))
        if normals and 'n' in m: at['NORMAL'] = self.accessor(m['n'])
        if 'uv' in m: at['TEXCOORD_0'] = self.accessor(m['uv'])
        if uv1 is not None: at['TEXCOORD_1'] = self.accessor(uv1)
        if colours is not None: at['COLOR_0'] = self.accessor(colours)
        at.update(extra or {})
        prim = dict(attributes=at, material=material, mode=mode)
        if indexed: prim['indices'] = self.accessor(m['f'].reshape(-1))
        if targets: prim['targets'] = targets
        self.j['meshes'].append(dict(primitives=[prim]))
        return len(self.j['meshes']) - 1
    def node(self, mesh=None, root=True, **k):
        self.j['nodes'].append({**({} if mesh is None else dict(mesh=mesh)), **k})
        if root: self.j['scenes'][0]['nodes'].append(len(self.j['nodes']) - 1)
        return len(self.j['nodes']) - 1
    def add(self, m, material, **k): return self.node(self.mesh(m, material, **k))
    def lamp(self, place, **k):
        self.use('KHR_lights_punctual')
        lights = self.j.setdefault('extensions', {}).setdefault('KHR_lights_punctual', dict(lights=[]))['lights']
        lights.append(k)
        self.node(translation=list(place), extensions=dict(KHR_lights_punctual=dict(light=len(lights) - 1)))
    def write(self, path):
        self.j['buffers'][0] = dict(uri='data:application/octet-stream;base64,' + base64.b64encode(bytes(self.b)).decode(), byteLength=len(self.b))
        if self.used: self.j['extensionsUsed'] = sorted(self.used)
        json.dump(self.j, open(path, 'w'))

KINDS = {}
def kind(f):
    KINDS[f.__name__] = f
    return f

def material_kind(name, **k):
    def make(g):
        kk = {a: (g.texture(b[1:]) if isinstance(b, str) and b[0] == '@' else b) for a, b in k.items()}
        def textures(x):
            if isinstance(x, dict): return {a: textures(b) for a, b in x.items()}
            return g.texture(x[1:]) if isinstance(x, str) and x[0] == '@' else x
        if 'ext' in kk: kk['ext'] = textures(kk['ext'])
        if 'normalTexture' in kk: kk['normalTexture'] = {**kk['normalTexture']}
        g.add(torus() if kk.pop('torus', False) else sphere(32, 48), g.material(**kk))
    KINDS[name] = make
K = 'KHR_materials_'
material_kind('plain')
material_kind('rough', r=1)
material_kind('coat', r=.8, ext={K + 'clearcoat': dict(clearcoatFactor=1, clearcoatRoughnessFactor=.1)})
material_kind('coat0', r=.8, ext={K + 'clearcoat': dict(clearcoatFactor=1, clearcoatRoughnessFactor=0)})
material_kind('coat_car', colour=(.6, .05, .05, 1), m=1, r=.5, ext={K + 'clearcoat': dict(clearcoatFactor=1, clearcoatRoughnessFactor=.05)})
material_kind('coat_half', r=.6, ext={K + 'clearcoat': dict(clearcoatFactor=.5, clearcoatRoughnessFactor=.2)})
material_kind('coat_picture', r=.6, ext={K + 'clearcoat': dict(clearcoatFactor=1, clearcoatTexture='@stripes', clearcoatRoughnessFactor=.2)})
material_kind('sheen', r=1, ext={K + 'sheen': dict(sheenColorFactor=[.8, .2, .2], sheenRoughnessFactor=.5)})
material_kind('sheen_cloth', colour=(.05, .05, .2, 1), r=1, ext={K + 'sheen': dict(sheenColorFactor=[1, 1, 1], sheenRoughnessFactor=.3)})
material_kind('volume', colour=(1, 1, 1, 1), r=.1, ext={K + 'transmission': dict(transmissionFactor=1), K + 'volume': dict(thicknessFactor=1)})
material_kind('volume_tint', colour=(1, 1, 1, 1), r=0, ext={K + 'transmission': dict(transmissionFactor=1), K + 'volume': dict(thicknessFactor=1, attenuationDistance=.5, attenuationColor=[.2, .7, .9])})
material_kind('glass', colour=(1, 1, 1, 1), r=0, ext={K + 'transmission': dict(transmissionFactor=1)})
material_kind('glass_rough', colour=(1, 1, 1, 1), r=.5, ext={K + 'transmission': dict(transmissionFactor=1)})
material_kind('glass_half', colour=(.4, .6, .9, 1), r=.2, ext={K + 'transmission': dict(transmissionFactor=.5)})
material_kind('irid', m=1, r=.2, ext={K + 'iridescence': dict(iridescenceFactor=1)})
material_kind('irid_plastic', colour=(.1, .1, .1, 1), r=.2, ext={K + 'iridescence': dict(iridescenceFactor=1)})
material_kind('aniso', torus=True, m=1, r=.4, ext={K + 'anisotropy': dict(anisotropyStrength=.7)})
material_kind('specgloss', ext={K + 'pbrSpecularGlossiness': dict(diffuseFactor=[.5, .3, .2, 1], specularFactor=[.3, .3, .2], glossinessFactor=.6)})
material_kind('specgloss_picture', ext={K + 'pbrSpecularGlossiness': dict(diffuseTexture='@checks', specularGlossinessTexture='@gloss')})
material_kind('picture', colour=(1, 1, 1, 1), picture='@checks', torus=True)
material_kind('rough_picture', colour=(1, .9, .7, 1), m=1, r=1, rough_picture='@rough')
material_kind('bumps', r=.3, normalTexture='@bumps', torus=True)
material_kind('blend', colour=(.6, .5, .4, .5), alphaMode='BLEND')
material_kind('blend_both', colour=(.6, .5, .4, .5), alphaMode='BLEND', doubleSided=True)
material_kind('unlit', colour=(1, 1, 1, 1), picture='@checks', ext={K + 'unlit': {}})
material_kind('emissive', emissiveFactor=[.3, .1, 0])
material_kind('emissive_strong', emissiveFactor=[.3, .1, 0], ext={K + 'emissive_strength': dict(emissiveStrength=5)})
material_kind('specular_colour', r=.3, ext={K + 'specular': dict(specularColorFactor=[1, .2, .1])})
material_kind('ior', r=.2, ext={K + 'ior': dict(ior=2.2)})
material_kind('metal_default', m=1, r=1)
material_kind('mirror', m=1, r=0)
material_kind('dispersion', colour=(1, 1, 1, 1), r=0, ext={K + 'transmission': dict(transmissionFactor=1), K + 'volume': dict(thicknessFactor=1), K + 'dispersion': dict(dispersion=2)})
material_kind('diffuse_transmission', r=1, ext={K + 'diffuse_transmission': dict(diffuseTransmissionFactor=.8)}, doubleSided=True)

floor = lambda g, y=-1, s=4, **k: g.add(quad((-s / 2, y, s / 2), (s, 0, 0), (0, 0, -s)), g.material(**{**dict(colour=(1, 1, 1, 1), r=.7, picture=g.texture('checks')), **k}))

@kind
def no_normals(g): g.add(torus(), g.material(), normals=False)
@kind
def flat_soup(g): # no indices, no normals: flat, says glTF
    m = torus(20, 10)
    t = m['p'][m['f'].reshape(-1)]
    g.add(dict(p=t, f=np.arange(len(t))), g.material(), normals=False, indexed=False)
@kind
def mirrored(g):
    m = g.mesh(torus(), g.material(colour=(1, 1, 1, 1), picture=g.texture('checks'), normalTexture=g.texture('bumps')))
    g.node(m, translation=[-1.2, 0, 0])
    g.node(m, translation=[1.2, 0, 0], scale=[-1, 1, 1])
@kind
def squashed(g): g.node(g.mesh(torus(), g.material()), scale=[1, 3, .4], rotation=[.38, 0, 0, .92])
def add_leaves(g, **sides):
    m = g.material(colour=(1, 1, 1, 1), r=.6, picture=g.texture('leaf'), alphaMode='MASK', **sides)
    q = []
    for i in range(12):
        a = i * 2 * np.pi / 12
        d = np.array((np.cos(a), .35 + .2 * (i % 3), np.sin(a)))
        s = np.array((-np.sin(a), 0, np.cos(a))) * .6
        q.append(quad(-s / 2, s, d))
    g.add(join(q), m)
    floor(g, y=-.3, s=2.5)
@kind
def leaves(g): add_leaves(g, doubleSided=True)
@kind
def leaves_once(g): add_leaves(g) # seen from one side only
@kind
def cards_blend(g): # hair
    m = g.material(colour=(1, 1, 1, 1), r=.6, picture=g.texture('leaf'), alphaMode='BLEND', doubleSided=True)
    g.add(join([quad((-.3 + .1 * i, -.5, -.5 + .1 * i), (.8, 0, 0), (0, 1, 0)) for i in range(8)]), m)
    floor(g, y=-.5, s=2.5)
@kind
def curtain(g): # a thin wall seen from behind
    g.add(quad((-1, -1, 0), (2, 0, 0), (0, 2, 0)), g.material(colour=(.8, .2, .2, 1), doubleSided=True))
    floor(g)
@kind
def curtain_back(g):
    g.add(quad((1, -1, 0), (-2, 0, 0), (0, 2, 0)), g.material(colour=(.8, .2, .2, 1), doubleSided=True))
    floor(g)
@kind
def culled_back(g): # the front faces away: invisible
    g.add(quad((1, -1, 0), (-2, 0, 0), (0, 2, 0)), g.material(colour=(.8, .2, .2, 1)))
    floor(g)
@kind
def vertex_colours(g):
    s = sphere(32, 48)
    g.add(s, g.material(colour=(1, 1, 1, 1)), colours=np.concatenate([.5 + .5 * s['n'], np.ones((len(s['n']), 1))], 1))
@kind
def vertex_alpha(g):
    s = sphere(32, 48)
    g.add(s, g.material(colour=(1, 1, 1, 1), alphaMode='BLEND'), colours=np.concatenate([.5 + .5 * s['n'], (s['uv'][:, 1:] > .5) * .7 + .3], 1))
    floor(g)
@kind
def second_uv(g):
    s = box()
    t = g.texture('checks')
    g.use('KHR_texture_transform')
    m = g.material(colour=(1, 1, 1, 1), picture={**t, 'texCoord': 1, 'extensions': dict(KHR_texture_transform=dict(scale=[2, 2], rotation=.5, offset=[.1, .2]))},
                   occlusionTexture=g.texture('stripes'), rough_picture=g.texture('rough'))
    g.add(s, m, uv1=s['uv'][:, ::-1].copy())
@kind
def nodes_1000(g):
    m = g.mesh(box((-.4, -.4, -.4), (.4, .4, .4)), g.material())
    parent = None
    order = []
    for i in range(1000):
        order.append(g.node(m if i % 2 else None, root=i == 0, translation=[.8, .02, 0] if i else [0, 0, 0],
                            rotation=[0, math.sin(.02), 0, math.cos(.02)]))
    for a, b in zip(order, order[1:]): g.j['nodes'][a]['children'] = [b]
@kind
def instances(g):
    g.use('EXT_mesh_gpu_instancing')
    r = np.random.default_rng(1)
    t = r.uniform(-3, 3, (60, 3)); t[:, 1] *= .2
    q = r.normal(size=(60, 4)); q /= np.linalg.norm(q, axis=1, keepdims=True)
    s = r.uniform(.2, .6, (60, 3))
    at = dict(TRANSLATION=g.accessor(t), ROTATION=g.accessor(q), SCALE=g.accessor(s))
    g.node(g.mesh(torus(24, 12), g.material(colour=(1, 1, 1, 1), picture=g.texture('checks'))), extensions=dict(EXT_mesh_gpu_instancing=dict(attributes=at)))
@kind
def skinned(g): # the rest pose of the skeleton moves the vertices elsewhere than their node
    s = sphere(24, 32)
    s['p'] = s['p'] * (.4, 1.5, .4)
    n = len(s['p'])
    w = np.clip(.5 + s['p'][:, 1] / 2, 0, 1)
    joints = np.tile(np.array([0, 1, 0, 0], np.uint8), (n, 1))
    weights = np.stack([1 - w, w, 0 * w, 0 * w], 1)
    mesh = g.mesh(s, g.material(), extra=dict(JOINTS_0=g.accessor(joints), WEIGHTS_0=g.accessor(weights)))
    child = g.node(root=False, translation=[0, 0, 0], rotation=[0, 0, math.sin(.4), math.cos(.4)])
    top = g.node(children=[child])
    g.j['skins'] = [dict(joints=[top, child])]
    g.node(mesh, skin=0, translation=[5, 0, 0])
    floor(g, y=-1.6)
@kind
def morphed(g):
    s = sphere(24, 32)
    d = g.accessor((s['n'] * .5 * (s['n'][:, :1] > 0)))
    m = g.mesh(s, g.material(), targets=[dict(POSITION=d)])
    g.j['meshes'][m]['weights'] = [1.0]
    g.node(m)
    floor(g)
@kind
def with_lines(g):
    s = sphere(8, 12)
    g.add(s, g.material())
    g.add(dict(p=s['p'] * 1.3, f=np.stack([np.arange(len(s['p']) - 1), np.arange(1, len(s['p']))], 1)), g.material(), mode=1)
    g.add(dict(p=s['p'] * 1.5, f=np.arange(len(s['p']))), g.material(), mode=0)
@kind
def one_triangle(g): g.add(dict(p=np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)], float), f=np.array([(0, 1, 2)])), g.material(), normals=False)
@kind
def fine_bumps(g): # 10^5 triangles
    s = sphere(200, 256)
    s['p'] = s['p'] * (1 + .02 * np.sin(40 * s['p'][:, :1]) * np.sin(40 * s['p'][:, 1:2]))
    g.add(s, g.material(), normals=False)
@kind
def tiny(g): g.node(g.mesh(torus(), g.material()), scale=[1e-4] * 3)
@kind
def huge(g): g.node(g.mesh(torus(), g.material()), scale=[1e5] * 3)
@kind
def far_away(g): g.add(moved(torus(), (1000, 500, -2000)), g.material())
@kind
def intersecting(g):
    g.add(box((-.5, -1.2, -.5), (.5, 1.2, .5)), g.material(colour=(.8, .7, .2, 1)))
    g.add(sphere(32, 48, .8), g.material(colour=(.2, .4, .8, 1), r=.2))
@kind
def doubled(g): # every face twice
    g.add(torus(), g.material(colour=(.8, .3, .2, 1)))
    g.add(torus(), g.material(colour=(.8, .3, .2, 1)))
@kind
def coplanar(g): # a decal in the plane of the floor
    floor(g)
    g.add(quad((-.7, -1, .7), (1.4, 0, 0), (0, 0, -1.4)), g.material(colour=(.1, .6, .2, 1)))
@kind
def decal(g): # a decal a hair above a wall
    floor(g)
    g.add(quad((-.7, -.999, .7), (1.4, 0, 0), (0, 0, -1.4)), g.material(colour=(1, 1, 1, 1), picture=g.texture('leaf'), alphaMode='BLEND'))
@kind
def inside_out(g):
    m = torus()
    m['f'] = m['f'][:, ::-1]
    g.add(m, g.material(doubleSided=True))
@kind
def inside_out_once(g):
    m = torus()
    m['f'] = m['f'][:, ::-1]
    g.add(m, g.material())
@kind
def bowl(g): # open, double-sided
    m = sphere(24, 32)
    m['f'] = m['f'][(m['p'][m['f']][:, :, 1] < .1).all(1)]
    g.add(m, g.material(doubleSided=True, r=.3))
@kind
def bowl_once(g):
    m = sphere(24, 32)
    m['f'] = m['f'][(m['p'][m['f']][:, :, 1] < .1).all(1)]
    g.add(m, g.material(r=.3))
def room(g, wall=(.7, .7, .7, 1)):
    m = box((-3, -1.5, -3), (3, 1.5, 3), inside=True)
    g.add(m, g.material(colour=wall, r=.8))
    g.add(box((-1, -1.5, -1.5), (0, -.3, -.5)), g.material(colour=(.2, .5, .7, 1), r=.4))
    g.add(sphere(24, 32, .6, (1, -.9, -1)), g.material(colour=(1, 1, 1, 1), picture=g.texture('checks'), r=.3))
inside = '--eye 1.5,.5,2.5 --look 0,-.4,-1 --fov 60'.split()
@kind
def room_lamp(g):
    room(g)
    g.lamp((0, 1, 0), type='point', intensity=60)
room_lamp.camera = inside
@kind
def room_spot(g):
    room(g)
    g.lamp((1.5, 1.2, 1), type='spot', intensity=200, color=[1, .8, .6], spot=dict(innerConeAngle=.3, outerConeAngle=.6))
room_spot.camera = inside
@kind
def room_emitter(g):
    room(g)
    g.add(quad((-.8, 1.45, -.8), (1.6, 0, 0), (0, 0, 1.6)), g.material(colour=(0, 0, 0, 1), emissiveFactor=[1, 1, 1], ext={K + 'emissive_strength': dict(emissiveStrength=8)}))
room_emitter.camera = inside
@kind
def sun_lamp(g):
    floor(g)
    g.add(torus(), g.material(r=.3))
    g.use('KHR_lights_punctual')
    g.j['extensions'] = dict(KHR_lights_punctual=dict(lights=[dict(type='directional', intensity=3)]))
    g.node(rotation=[-.5, .2, 0, .84], extensions=dict(KHR_lights_punctual=dict(light=0)))
@kind
def room_window(g): # lit by the environment through an opening
    m = box((-3, -1.5, -3), (3, 1.5, 3), inside=True)
    m['f'] = m['f'][2:]
    g.add(m, g.material(colour=(.7, .7, .7, 1), r=.8))
    g.add(sphere(24, 32, .6, (1, -.9, -1)), g.material(colour=(1, 1, 1, 1), picture=g.texture('checks'), r=.3))
room_window.camera = inside
@kind
def glass_print(g): # BLEND above a picture
    floor(g)
    g.add(quad((-1, -.8, 1), (2, 0, 0), (0, 0, -2)), g.material(colour=(.8, .9, 1, .25), r=.05, alphaMode='BLEND'))
@kind
def window_pane(g): # transmission before things
    floor(g)
    g.add(sphere(24, 32, .5, (0, -.5, -.6)), g.material(colour=(.8, .2, .1, 1)))
    g.add(quad((-1, -1, .5), (2, 0, 0), (0, 1.6, 0)), g.material(colour=(.7, .9, .8, 1), r=0, ext={K + 'transmission': dict(transmissionFactor=1)}, doubleSided=True))
@kind
def bottle(g): # a volume before things
    floor(g)
    g.add(sphere(24, 32, .4, (.2, -.6, -.9)), g.material(colour=(.8, .2, .1, 1)))
    g.add(sphere(32, 48, .7, (-.2, -.3, .4)), g.material(colour=(1, 1, 1, 1), r=0, ext={K + 'transmission': dict(transmissionFactor=1), K + 'volume': dict(thicknessFactor=1)}))
@kind
def stick(g): g.add(box((-.01, -.01, -2), (.01, .01, 2)), g.material())
@kind
def needle_field(g): g.add(join([box((x * .2 - 1, -1, z * .2 - 1), (x * .2 - .99, .2, z * .2 - .99)) for x in range(10) for z in range(10)]), g.material()); floor(g, s=3)
@kind
def pages(g): # layers one close above the other
    for i in range(8):
        g.add(quad((-1 + .05 * i, -.5 + .004 * i, 1), (1.5, 0, 0), (0, 0, -1.5)), g.material(colour=(.9 - .08 * i, .5, .1 * i, 1), doubleSided=True))
@kind
def terrain(g): # a height field with a picture that repeats 20 times
    n = 100
    x, z = np.meshgrid(np.linspace(-5, 5, n), np.linspace(-5, 5, n), indexing='ij')
    y = .4 * np.sin(x * 1.3) * np.cos(z) + .1 * np.sin(x * 5 + z * 4)
    p = np.stack([x, y, z], -1).reshape(-1, 3)
    k = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).reshape(-1)
    f = np.concatenate([np.stack([k, k + 1, k + n], 1), np.stack([k + 1, k + n + 1, k + n], 1)])
    g.add(dict(p=p, uv=np.stack([x, z], -1).reshape(-1, 2) * 2, f=f), g.material(colour=(1, 1, 1, 1), picture=g.texture('checks'), r=.9), normals=False)
@kind
def black(g): g.add(torus(), g.material(colour=(0, 0, 0, 1), r=1)) 
@kind
def white(g): g.add(torus(), g.material(colour=(1, 1, 1, 1), r=1))
@kind
def cavity(g): # a pot, dark inside
    m = sphere(32, 48)
    m['f'] = m['f'][(m['p'][m['f']][:, :, 1] < .8).all(1)]
    g.add(m, g.material(doubleSided=True, colour=(.8, .8, .8, 1), r=.9))
@kind
def gold_chain(g):
    m = g.mesh(torus(32, 16, .35, .09), g.material(colour=(1, .77, .34, 1), m=1, r=.25))
    for i in range(8): g.node(m, translation=[i * .5 - 2, 0, 0], rotation=[0, 0, 0, 1] if i % 2 else [.7071, 0, 0, .7071])
