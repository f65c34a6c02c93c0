// Tests the npm package as its users see it: names resolve, the shaders of the three.js material
// are valid GLSL ES 3.00, and the types are sound (if tsc is installed).
//   node package_test.mjs PACKAGE-FOLDER TESSERA SCRATCH-FOLDER [GLSLANG-VALIDATOR]
import assert from 'node:assert/strict';
import {execFileSync, spawnSync} from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import {pathToFileURL} from 'node:url';
import {bumpyBox, changedGlb} from './models.mjs';

const [folder, tool, scratch, glslang] = process.argv.slice(2);
fs.rmSync(scratch, {recursive: true, force: true});
fs.mkdirSync(path.join(scratch, 'node_modules'), {recursive: true});
process.on('exit', () => fs.rmSync(scratch, {recursive: true, force: true}));

// The package contains exactly the files to publish, and its name resolves.
const about = JSON.parse(fs.readFileSync(path.join(folder, 'package.json'), 'utf8'));
assert.deepEqual(fs.readdirSync(folder).sort(), [...about.files, 'package.json'].sort());

// WebGPU: the shaders are there, and node has no device. The module prepares tiles: all of a file are in one batch.
{
    const shaders = fs.readdirSync(path.join(folder, 'wgsl'), {recursive: true}).filter(name => name.endsWith('.wgsl'));
    assert.equal(shaders.length, 14);
    const {openGpu, GpuDecoder} = await import(pathToFileURL(path.join(folder, 'tessera_webgpu.js')));
    assert.equal(await openGpu(() => ''), null);
    const written = [], lost = new Promise(() => {});
    globalThis.GPUBufferUsage = {STORAGE: 128, COPY_SRC: 4, COPY_DST: 8, INDIRECT: 256, MAP_READ: 1};
    globalThis.GPUTextureUsage = {};
    const device = {lost, pushErrorScope() {}, popErrorScope: async () => null, createTexture: () => ({destroy() {}}),
        limits: {maxStorageBufferBindingSize: 1000, maxTextureDimension2D: 8192}, createBuffer: ({size}) => ({size}),
        queue: {writeBuffer: (...what) => written.push(what)}};
    const {loadTessera} = await import(pathToFileURL(path.join(folder, 'tessera.js')));
    const codec = await loadTessera(fs.readFileSync(path.join(folder, 'tessera_webgpu.wasm')));
    const golden = new URL('../golden/rgba8.tess', import.meta.url), file = codec.openBytes(fs.readFileSync(golden));
    const box = file.info.gridSize.flatMap(n => [0, n]);
    const small = new GpuDecoder(device, () => '');
    await assert.rejects(small.decode(file, box), /a batch needs a buffer of \d+ bytes, but this device allows only 1000/);
    device.limits = {maxStorageBufferBindingSize: 1 << 27, maxTextureDimension2D: 50};
    await assert.rejects(small.decode(file, box), /needs a texture of 96x72 pixels, but this device allows only 50/);
    await assert.rejects(small.decode(file, [0, 99, 0, 1, 0, 1, 0, 1]), /does not lie inside/);
    assert.equal(written.length, 1); // the tables, once
}
fs.cpSync(folder, path.join(scratch, 'node_modules', about.name), {recursive: true});
fs.writeFileSync(path.join(scratch, 'user.mjs'), `
    import fs from 'node:fs';
    import {createRequire} from 'node:module';
    import {loadTessera} from '${about.name}';
    import * as three from '${about.name}/three';
    import * as surfaceModule from '${about.name}/surface';
    import '${about.name}/gltf/three';
    import '${about.name}/gltf/babylon';
    const wasm = createRequire(import.meta.url).resolve('${about.name}/tessera.wasm');
    export const codec = await loadTessera(fs.readFileSync(wasm));
    export {surfaceModule, three};`);
const {codec, surfaceModule, three} = await import(pathToFileURL(path.join(scratch, 'user.mjs')).href);

function bake(name, ...words) {
    const file = path.join(scratch, name);
    execFileSync(tool, ['bake', 'composed', '-o', file, '--spp', '1', '-q', '--effort', '0', ...words]);
    return codec.openBytes(fs.readFileSync(file));
}

// Stands in for the classes of three.js that the material uses, and records their arguments.
class Recorded {
    constructor(...given) {
        this.given = given;
        this.position = {set: (...at) => { this.at = at; }};
    }
}
const THREE = {DataTexture: Recorded, RawShaderMaterial: Recorded, SphereGeometry: Recorded, Mesh: Recorded,
               GLSL3: '300 es'};

function checkShaders(material) {
    const [{vertexShader, fragmentShader, uniforms}] = material.given;
    for (const [stage, text] of [['vert', vertexShader], ['frag', fragmentShader]]) {
        const file = path.join(scratch, `shader.${stage}`);
        fs.writeFileSync(file, '#version 300 es\n' + text);
        if (glslang !== undefined) {
            const run = spawnSync(glslang, [file], {encoding: 'utf8'});
            assert.equal(run.status, 0, run.stdout);
        }
    }
    for (const name of Object.keys(uniforms))
        assert.match(fragmentShader, new RegExp(`uniform \\w+ ${name};`));
}

const sphere = bake('sphere.tess', '--size', '16x8x4x4');
const rgba = sphere.atlas([0, 16, 0, 8]);
const mesh = three.tesseraSphere(THREE, sphere.info, rgba);
assert.deepEqual(mesh.at, sphere.info.centre);
assert(mesh.given[0].given[0] > sphere.info.radius);
const [texture, width, height] = mesh.given[1].given[0].uniforms.atlas.value.given;
assert(texture === rgba && width === 64 && height === 32);
checkShaders(mesh.given[1]);
assert.throws(() => three.tesseraMaterial(THREE, sphere.info, new Uint8Array(4)), /16x8x4x4/);
assert.throws(() => three.tesseraSurface(THREE, sphere.info, rgba, {}), /not a mesh/);

const surface = bake('mesh.tess', '--proxy', 'mesh', '--density', '0.25', '--directions', '4x4');
const [U, V] = surface.info.size, pixels = surface.atlas([0, U, 0, V]);
const geometry = {attributes: {position: 1, normal: 1, uv: 1, tangent: 1}};
checkShaders(three.tesseraSurface(THREE, surface.info, pixels, geometry).given[1]);
assert.throws(() => three.tesseraSurface(THREE, surface.info, pixels, {attributes: {position: 1}}), /no normal/);
assert.throws(() => three.tesseraSphere(THREE, surface.info, pixels), /not a sphere/);

// A model with layers of all kinds that a bake makes.
fs.writeFileSync(path.join(scratch, 'box.gltf'), bumpyBox());
execFileSync(tool, ['bake', path.join(scratch, 'box.gltf'), '-o', path.join(scratch, 'box.glb'), '--layered', '--texels',
                    '2000', '--lights', '5', '--spp', '1', '-q']);
const glb = fs.readFileSync(path.join(scratch, 'box.glb'));
const layered = surfaceModule.readSurface(codec.openBytes(glb));
assert(layered.layers.length > 4 && layered.lights.count === 8);
// Three of the eight only fill the table. A direction of length 0 would draw black surfaces.
for (let i = 0; i < layered.lights.count; ++i) {
    const [x, y, z, , ...rest] = layered.lights.pixels.subarray(8 * i, 8 * i + 8);
    assert(Math.abs(Math.hypot(x, y, z) - 1) < 1e-3, `light ${i}`);
    assert(i < 5 || rest.every(value => value === 0), `light ${i}`);
}
assert.deepEqual(surfaceModule.attributesOf(layered), ['normal', 'uv', 'tangent']);
checkShaders(three.surfaceMaterial(THREE, layered));
assert.throws(() => surfaceModule.readSurface(sphere), /mesh/);
assert.throws(() => surfaceModule.readSurface(surface, 32), /needs a picture of .* allows only 32 a side/);
const later = {info: surface.info, layers: () => ({scale: 1, further: [{role: 31, scale: 1, file: surface}], lights: []}),
               box: (...box) => surface.box(...box)};
assert.throws(() => surfaceModule.readSurface(later), /does not know layers of the role 31/);
const viewOf = json => json.bufferViews[json.textures[0].extensions.TESSERA_texture_light_field.bufferView];
for (const [change, reason] of [[json => { viewOf(json).byteLength += 1000; }, /not within the glTF file/],
                                [json => { viewOf(json).byteOffset = -4; }, /not within the glTF file/],
                                [json => { json.bufferViews = []; }, /not within the glTF file/],
                                [json => { delete json.textures[0].extensions; }, /no Tessera texture/],
                                [(json, chunk) => { chunk[viewOf(json).byteOffset] = 0; }, /./]])
    assert.throws(() => codec.openBytes(changedGlb(glb, change)), reason);
assert.throws(() => codec.openBytes(glb.subarray(0, 200)), Error);
// Two textures, of which the second is the same file.
const twice = changedGlb(glb, json => json.textures.push({source: 0}, json.textures[0]));
assert.throws(() => codec.openBytes(twice), /has 2 Tessera textures: choose one by its number, 0 to 1/);
assert.throws(() => codec.openBytes(twice, {texture: 2}), /choose one/);
for (const texture of [0, 1])
    assert.deepEqual(codec.openBytes(twice, {texture}).info, codec.openBytes(glb).info);

// Opacity: alpha only where the material blends, with triangles from back to front.
fs.writeFileSync(path.join(scratch, 'glass.gltf'), bumpyBox(0.5));
execFileSync(tool, ['bake', path.join(scratch, 'glass.gltf'), '-o', path.join(scratch, 'glass.tess'), '--layered', '--texels',
                    '2000', '--lights', '5', '--spp', '1', '-q']);
const glass = surfaceModule.readSurface(codec.openBytes(fs.readFileSync(path.join(scratch, 'glass.tess'))));
assert(surfaceModule.isTranslucent(glass) && !surfaceModule.isTranslucent(layered));
for (const blends of [false, true]) {
    const material = three.surfaceMaterial(THREE, glass, {blends});
    checkShaders(material);
    assert.equal(material.transparent ?? false, blends);
    assert.equal(/colour\.a = hidden/.test(material.given[0].fragmentShader), blends);
}
// Mips: means of each chart. The left and the right half of 4x2 texels are charts.
const {withMips} = await import(pathToFileURL(path.join(folder, 'mips.js')));
const square = (left, right) => [[left, 0], [right, 0], [right, 1], [left, 1]];
const uv = [...square(0.01, 0.49), ...square(0.51, 0.99)], meshes = [
    {indices: [0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7], vertices: 8, uvOf: i => uv[i]}];
const pixel = x => [x, 2 * x, 0, 255], row = [10, 20, 30, 41].flatMap(pixel);
const flat = {angularMap: 4, lights: {count: 0}, layers: [
    {name: 'texture', size: [4, 2, 1, 1], columns: 1, srgb: false, scale: 1, mips: 1,
     picture: {width: 4, height: 2, half: false, pixels: Uint8Array.from([...row, ...row])}}]};
const [{picture: mipped}] = withMips(flat, meshes).layers;
assert.deepEqual([mipped.width, mipped.height], [6, 2]);
assert.deepEqual([...mipped.pixels.subarray(16, 24)], [15, 30, 0, 255, 36, 71, 0, 255]);
assert.deepEqual([...mipped.pixels.subarray(0, 16)], row);
assert.equal(withMips(flat, meshes, 5), flat); // too large for the device
assert.equal(withMips({...flat, layers: [{...flat.layers[0], mips: 0}]}, meshes).charts, undefined);
const withCharts = withMips(glass, meshes);
assert(withCharts.charts.pixels.some(x => x));
checkShaders(three.surfaceMaterial(THREE, withCharts));
const {TriangleOrder} = await import(pathToFileURL(path.join(folder, 'triangle_order.js')));
const order = new TriangleOrder(Uint16Array.of(0, 1, 2, 3, 4, 5), i => [0, i % 3, i < 3 ? 1 : 2]);
assert.deepEqual([...order.seenFrom([0, 0, 9])], [0, 1, 2, 3, 4, 5]);
assert.equal(order.seenFrom([0, 0, 9]), null);
assert.deepEqual([...order.seenFrom([0, 0, -9])], [3, 4, 5, 0, 1, 2]);
console.log(`ok material${glslang === undefined ? ' (no glslangValidator: shaders are not checked)' : ''}`);

fs.writeFileSync(path.join(scratch, 'user.ts'), `
    import {loadTessera, PROXY, type Info, type TessFile} from '${about.name}';
    import {tesseraSphere} from '${about.name}/three';
    import {tesseraGltf} from '${about.name}/gltf/three';
    import {GLB_EXTENSION, tesseraBabylon} from '${about.name}/gltf/babylon';
    export const plugins = (THREE: {[name: string]: any}) =>
        [GLB_EXTENSION, tesseraGltf(THREE, fetch('x'), text => text.length), tesseraBabylon(THREE, fetch('x'))];
    export async function show(THREE: {[name: string]: any}, url: string): Promise<unknown> {
        const file: TessFile = await (await loadTessera(fetch('tessera.wasm'))).openUrl(url, {tries: 2});
        const info: Info = file.info;
        if (info.proxy !== PROXY.sphere)
            throw new Error(info.names.proxy);
        // @ts-expect-error: four numbers are needed
        await file.fetchAtlas([0, 1]);
        return tesseraSphere(THREE, info, await file.fetchAtlas([0, info.size[0], 0, info.size[1]]));
    }`);
const tscOptions = ['--noEmit', '--strict', '--target', 'es2022', '--module', 'nodenext', '--moduleResolution',
                    'nodenext', '--lib', 'es2022,dom'];
const tsc = spawnSync('tsc', [...tscOptions, 'user.ts'], {cwd: scratch, encoding: 'utf8'});
if (tsc.error)
    console.log('types were not checked: there is no tsc');
else
    assert.equal(tsc.status, 0, tsc.stdout);
