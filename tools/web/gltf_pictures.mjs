// Draws a .glb with a Tessera texture in three.js and Babylon.js, with and without our plugins, next to each other:
//   node gltf_pictures.mjs PACKAGE-FOLDER CHROMIUM NODE-MODULES FILE.glb OUT.png EYE LOOK [FOV [WIDTHxHEIGHT]]
// EYE and LOOK are X,Y,Z. NODE-MODULES holds three, babylonjs and babylonjs-loaders.
import fs from 'node:fs';
import path from 'node:path';
import {GltfScene} from '../../tests/web/gltf_scene.mjs';
import {pngOf} from '../../tests/web/png.mjs';

const [folder, chromium, modules, file, out, eye, look, fov = '45', pixels = '320x240'] = process.argv.slice(2);
const numbers = text => text.split(',').map(Number), size = pixels.split('x').map(Number);
const view = {eye: numbers(eye), look: numbers(look), fov: +fov, far: 1000, size, background: [40, 40, 44]};
const scene =
    await GltfScene.open(chromium, {package: path.resolve(folder), npm: path.resolve(modules), files: path.dirname(path.resolve(file))});
const drawn = [];
for (const engine of ['three', 'babylon'])
    for (const plugin of [false, true]) {
        drawn.push(await scene.draw(engine, path.basename(file), plugin, view));
        console.log(`${engine} ${plugin ? 'with' : 'without'} the plugin: ${drawn.at(-1).materials[0]} ${drawn.at(-1).warnings}`);
    }
await scene.close();
const [width, height] = size;
fs.writeFileSync(out, pngOf(2 * width, 2 * height, (x, y) => {
    const {rgba} = drawn[2 * Math.floor(y / height) + Math.floor(x / width)].picture;
    const at = 4 * (y % height * width + x % width);
    return rgba.subarray(at, at + 3);
}));
