// Models for tests.
import fs from 'node:fs';
import {pngOf} from './png.mjs';

// A metal box above a floor, both with a normal map, as the text of a glTF file. The box blends with this opacity, and a
// smaller one is within it.
export function bumpyBox(opacity = 1) {
    const positions = [], normals = [], uv = [];
    const side = (centre, right, up, normal) => {
        for (const [a, b] of [[-1, -1], [1, -1], [1, 1], [-1, -1], [1, 1], [-1, 1]]) {
            positions.push(...centre.map((x, i) => x + a * right[i] + b * up[i]));
            normals.push(...normal);
            uv.push((a + 1) / 2, (b + 1) / 2);
        }
    };
    side([0, -1, 0], [2.5, 0, 0], [0, 0, -2.5], [0, 1, 0]);
    for (const size of opacity < 1 ? [1, 0.5] : [1])
        for (let axis = 0; axis < 3; ++axis)
            for (const sign of [-1, 1]) {
                const [normal, right, up] =
                    [0, 1, 2].map(turn => [0, 1, 2].map(i => i === (axis + turn) % 3 ? sign : 0));
                const [at, across, upwards] = [normal, sign < 0 ? up : right, sign < 0 ? right : up].map(
                    vector => vector.map(x => x * size));
                side(at, across, upwards, normal);
            }
    const bytes = Buffer.from(new Float32Array([...positions, ...normals, ...uv]).buffer);
    const count = positions.length / 3, at = [0, positions.length * 4, (positions.length + normals.length) * 4, bytes.length];
    const bump = pngOf(32, 32, (x, y) => [128 + 60 * Math.sin(x * Math.PI / 8), 128 + 60 * Math.cos(y * Math.PI / 4), 230]);
    const inline = (kind, data) => `data:${kind};base64,${data.toString('base64')}`;
    const accessor = (bufferView, type, first, count, more) =>
        ({bufferView, type, componentType: 5126, count, byteOffset: first * (type === 'VEC2' ? 8 : 12), ...more});
    const part = (first, count, low, high) => [
        accessor(0, 'VEC3', first, count, {min: low, max: high}), accessor(1, 'VEC3', first, count),
        accessor(2, 'VEC2', first, count)];
    const primitive = (first, material) =>
        ({attributes: {POSITION: first, NORMAL: first + 1, TEXCOORD_0: first + 2}, material});
    const material = (baseColorFactor, metallicFactor, roughnessFactor) =>
        ({pbrMetallicRoughness: {baseColorFactor, metallicFactor, roughnessFactor}, normalTexture: {index: 0}});
    return JSON.stringify({
        asset: {version: '2.0'}, scene: 0, scenes: [{nodes: [0]}], nodes: [{mesh: 0}],
        meshes: [{primitives: [primitive(0, 0), primitive(3, 1)]}],
        materials: [material([0.2, 0.5, 0.3, 1], 0, 0.4),
                    {...material([0.9, 0.7, 0.4, opacity], 1, 0.25), alphaMode: opacity < 1 ? 'BLEND' : 'OPAQUE'}],
        textures: [{source: 0}], images: [{uri: inline('image/png', bump)}],
        accessors: [...part(0, 6, [-2.5, -1, -2.5], [2.5, -1, 2.5]), ...part(6, count - 6, [-1, -1, -1], [1, 1, 1])],
        bufferViews: [0, 1, 2].map(i => ({buffer: 0, byteOffset: at[i], byteLength: at[i + 1] - at[i]})),
        buffers: [{byteLength: bytes.length, uri: inline('application/octet-stream', bytes)}]});
}

// The same with holes in the floor, which also emits light, and with a mirror of a box: baked, it has the layers of
// coverage, emission and the environment besides.
export function shinyBox() {
    const model = JSON.parse(bumpyBox()), [floor, box] = model.materials;
    const holes = pngOf(16, 16, (x, y) => [200, 220, 200, x >> 2 & y >> 2 & 1 ? 0 : 255]);
    model.images.push({uri: `data:image/png;base64,${holes.toString('base64')}`});
    model.textures.push({source: 1});
    Object.assign(floor, {emissiveFactor: [0.3, 0.1, 0.05], alphaMode: 'MASK'});
    floor.pbrMetallicRoughness.baseColorTexture = {index: 1};
    box.pbrMetallicRoughness.roughnessFactor = 0.05;
    return JSON.stringify(model);
}

// Fits layers to plain pictures of `box`, each of another colour, so that its colours change with the direction.
// tessera(...words) runs the tool, at(name) is a path in a folder for the pictures.
export function fitBox(tessera, at, box, output) {
    const frames = Array.from({length: 6}, (_, i) => {
        const angle = 0.4 + i * Math.PI / 3, s = Math.sin(angle), c = Math.cos(angle), name = `photo${i}.png`;
        const pixel = String.fromCharCode(40 + 30 * i, 200 - 25 * i, 128);
        fs.writeFileSync(at(name), 'P6 32 32 255\n' + pixel.repeat(32 * 32), 'latin1');
        return {file_path: name, transform_matrix: [[c, 0, s, 6 * s], [0, 1, 0, 0], [-s, 0, c, 6 * c], [0, 0, 0, 1]]};
    });
    fs.writeFileSync(at('transforms.json'), JSON.stringify({w: 32, h: 32, fl_x: 40, frames}));
    tessera('fit', at('transforms.json'), '--mesh', at(box), '-o', at(output), '--background', 'black', '--texels', '2000',
            '--directions', '4', '--shared-directions', '8', '--smoothness', '1', '--no-corrections', '--quality', '90', '-q');
}

// A .glb after change(json, chunk) has changed its JSON and the bytes of its binary chunk.
export function changedGlb(glb, change) {
    const length = glb.readUInt32LE(12), json = JSON.parse(glb.toString('utf8', 20, 20 + length));
    const chunk = Buffer.from(glb.subarray(28 + length));
    change(json, chunk);
    const text = Buffer.from(JSON.stringify(json)), padded = Buffer.concat([text, Buffer.alloc(-text.length & 3, ' ')]);
    const head = Buffer.alloc(20), middle = Buffer.alloc(8);
    [0x46546C67, 2, 28 + padded.length + chunk.length, padded.length, 0x4E4F534A].forEach(
        (word, i) => head.writeUInt32LE(word, 4 * i));
    [chunk.length, 0x004E4942].forEach((word, i) => middle.writeUInt32LE(word, 4 * i));
    return Buffer.concat([head, padded, middle, chunk]);
}
