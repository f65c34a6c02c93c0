// Tests .glb files with a Tessera texture as others see them: Khronos' validator, and three.js and Babylon.js in a real
// browser, with and without our plugins.
//   node gltf_test.mjs PACKAGE-FOLDER TESSERA CHROMIUM NODE-MODULES [FOLDER FOR PICTURES]
// NODE-MODULES holds gltf-validator, three, babylonjs and babylonjs-loaders; tools/gltf/README.md says how to get them.
// Exit codes: 0 all tests pass, 1 a test fails, 77 something is missing.
import assert from 'node:assert/strict';
import {execFileSync, spawnSync} from 'node:child_process';
import fs from 'node:fs';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import path from 'node:path';
import {fileURLToPath} from 'node:url';
import {GltfScene} from './gltf_scene.mjs';
import {bumpyBox, changedGlb, fitBox, shinyBox} from './models.mjs';
import {compared, readPng} from './png.mjs';

const [packageFolder, tool, chromium, modules, pictures] =
    process.argv.slice(2).map((word, i) => i === 2 ? word : path.resolve(word));
for (const name of ['gltf-validator', 'three', 'babylonjs', 'babylonjs-loaders'])
    if (!fs.existsSync(path.join(modules, name))) {
        console.log(`skipped: needs the npm package ${name} in ${modules}`);
        process.exit(77);
    }
if (spawnSync(chromium, ['--version']).status !== 0) {
    console.log('skipped: needs Chromium');
    process.exit(77);
}

const near = 0.99; // share of pixels that must be within one step of 255: edges are drawn by other rules
const here = path.dirname(fileURLToPath(import.meta.url));
const folder = fs.mkdtempSync(path.join(tmpdir(), 'tessera-gltf-'));
const at = name => path.join(folder, name);
const tessera = (...words) => execFileSync(tool, words, {cwd: folder, stdio: ['ignore', 'pipe', 'pipe']});

const extensionOf = json => json.textures[0].extensions.TESSERA_texture_light_field;

function makeFiles() {
    fs.writeFileSync(at('box.gltf'), bumpyBox());
    tessera('bake', 'box.gltf', '-o', 'layered.glb', '--layered', '--texels', '20000', '--lights', '6', '--spp', '1',
            '--quality', '90', '-q');
    tessera('convert', 'layered.glb', '-o', 'layered.tess', '-q');
    // 128x320 texels, five tiles of 64 along v, which begin at multiples of 16. Those of 128x288 have no mips.
    tessera('bake', 'box.gltf', '-o', 'mips.glb', '--layered', '--texels', '24000', '--lights', '6', '--spp', '1',
            '--quality', '90', '-q');
    tessera('convert', 'mips.glb', '-o', 'mips.tess', '-q');
    fs.writeFileSync(at('shiny.gltf'), shinyBox());
    tessera('bake', 'shiny.gltf', '-o', 'shiny.glb', '--layered', '--texels', '8000', '--lights', '6', '--spp', '1',
            '--quality', '90', '-q');
    tessera('convert', 'shiny.glb', '-o', 'shiny.tess', '-q');
    fitBox(tessera, at, 'box.gltf', 'fitted.tess');
    tessera('convert', 'fitted.tess', '-o', 'fitted.glb', '-q');
    tessera('convert', 'layered.tess', '-o', 'draco.glb', '--mesh-compression', 'draco', '--jpeg', '90', '--picture-side', '64', '-q');
    tessera('bake', 'composed', '-o', 'single.tess', '--proxy', 'mesh', '--density', '6', '--directions', '8x8',
            '--angular-map', 'octahedral-hemisphere', '--spp', '1', '--effort', '0', '-q');
    tessera('convert', 'single.tess', '-o', 'single.glb', '-q');
    tessera('bake', 'composed', '-o', 'mirrored.tess', '--proxy', 'mesh', '--density', '6', '--directions', '8x8',
            '--angular-map', 'octahedral-mirrored', '--spp', '1', '--effort', '0', '-q');
    tessera('convert', 'mirrored.tess', '-o', 'mirrored.glb', '-q');
    tessera('bake', 'composed', '-o', 'sphere.tess', '--size', '64x32x8x8', '--spp', '1', '--effort', '0', '-q');
    tessera('bake', 'composed', '-o', 'inside.tess', '--proxy', 'sphere-inside:0,1.1,0,0.4', '--size', '64x32x8x8', '--spp', '1',
            '--effort', '0', '-q');
    tessera('convert', 'layered.tess', '-o', 'meshopt.glb', '--mesh-compression', 'meshopt', '-q');
    fs.writeFileSync(at('blended.gltf'), bumpyBox(0.5));
    tessera('bake', 'blended.gltf', '-o', 'blended.glb', '--layered', '--texels', '8000', '--lights', '6', '--spp', '1',
            '--quality', '90', '-q');
    tessera('convert', 'blended.glb', '-o', 'blended.tess', '-q');
    tessera('convert', 'blended.tess', 'single.tess', '-o', 'two.glb', '-q');
    const glb = fs.readFileSync(at('layered.glb'));
    fs.writeFileSync(at('damaged.glb'), changedGlb(glb, (json, chunk) => {
        const {byteOffset, byteLength} = json.bufferViews[extensionOf(json).bufferView];
        chunk[byteOffset + byteLength - 40] ^= 1;
    }));
    fs.writeFileSync(at('beyond.glb'), changedGlb(glb, json => {
        json.bufferViews[extensionOf(json).bufferView].byteOffset += 1e6;
    }));
    fs.writeFileSync(at('outside.glb'), changedGlb(glb, json => { extensionOf(json).bufferView = 99; }));
}

const tests = {
    async 'the validator of Khronos has no error and no warning'() {
        const validator = createRequire(path.join(modules, 'x.js'))('gltf-validator');
        for (const name of ['layered.glb', 'draco.glb', 'meshopt.glb', 'single.glb', 'blended.glb', 'two.glb']) {
            const {issues} = await validator.validateBytes(new Uint8Array(fs.readFileSync(at(name))));
            console.log(`   ${name}: ${issues.numErrors} errors, ${issues.numWarnings} warnings, ${issues.numInfos} ` +
                        `infos, ${issues.numHints} hints`);
            assert.deepEqual([issues.numErrors, issues.numWarnings], [0, 0], JSON.stringify(issues.messages));
        }
    },
    'the extension follows its schema'() {
        const schema = JSON.parse(fs.readFileSync(path.join(
            here, '../../format/gltf/schema/texture.TESSERA_texture_light_field.schema.json')));
        const glb = fs.readFileSync(at('layered.glb')), json = JSON.parse(glb.toString('utf8', 20, 20 + glb.readUInt32LE(12)));
        const extension = extensionOf(json);
        assert.deepEqual(Object.keys(extension).sort(), [...schema.required].sort());
        assert.equal(extension.mimeType, schema.properties.mimeType.const);
        assert(Number.isInteger(extension.bufferView) && json.bufferViews[extension.bufferView]);
    },
    'JavaScript opens the file inside'() {
        return inPackage(`
            const codec = await loadTessera(fetch('/package/tessera.wasm'));
            const tess = codec.openBytes(await (await fetch('/files/layered.tess')).arrayBuffer());
            const inside = codec.openBytes(await (await fetch('/files/layered.glb')).arrayBuffer());
            const ranged = await codec.openUrl('/files/layered.glb');
            const [U, V] = tess.info.size, box = [0, U, 0, V, 0, 1, 0, 1];
            return [tess.box(box), inside.box(box), await ranged.fetchBox(box)].map(String);`).then(([a, b, c]) => {
                assert(a.length > 1000);
                assert.equal(a, b);
                assert.equal(a, c);
            });
    },
    async 'plugins draw what tessera render draws'() {
        for (const name of ['layered', 'single', 'shiny', 'fitted'])
            for (const engine of ['three', 'babylon']) {
                const view = views[name], png = reference(name, view);
                const [picture, shown] = await draw(engine, `${name}.glb`, true, view, [...png.pixels.subarray(0, 3)]);
                assert.deepEqual(shown.warnings, []);
                const {share, psnr} = compared(picture, png);
                console.log(`   ${name} in ${engine}: ${(100 * share).toFixed(2)} % of the pixels, ${psnr.toFixed(1)} dB`);
                assert(share >= near, `${share} of the pixels are equal`);
                assert(shown.materials.every(type => type === 'RawShaderMaterial' || type === 'ShaderMaterial'));
            }
    },
    async 'node materials draw the same with WebGPU and WebGL2'() {
        for (const name of ['single', 'mirrored', 'layered', 'shiny', 'fitted', 'sphere', 'inside'])
            for (const [engine, backend] of [['threeWebgpu', 'WebGPU'], ['threeNodes', 'WebGL2']]) {
                const view = views[name] ?? views.single, png = reference(name, view);
                const file = fs.existsSync(at(`${name}.glb`)) ? `${name}.glb` : `${name}.tess`;
                const [picture, shown] = await draw(engine, file, true, view, [...png.pixels.subarray(0, 3)]);
                assert.deepEqual(shown.warnings, []);
                assert.equal(shown.backend, backend);
                const {share, psnr} = compared(picture, png);
                console.log(`   ${name}, ${backend}: ${(100 * share).toFixed(2)} % of the pixels, ${psnr.toFixed(1)} dB`);
                assert(share >= near, `${share} of the pixels are equal`);
                assert(shown.materials.every(type => type === 'MeshBasicNodeMaterial'), shown.materials);
            }
        for (const engine of ['threeWebgpu', 'threeNodes']) {
            const [picture, shown] = await draw(engine, 'blended.glb', true, views.layered);
            const {psnr} = compared(picture, reference('blended', views.layered));
            console.log(`   blended, ${shown.backend}: ${psnr.toFixed(1)} dB`);
            assert.deepEqual(shown.warnings, []);
            assert(psnr > 25, `${psnr} dB`);
        }
    },
    async 'plugins use the mips that tessera render uses'() {
        for (const name of ['layered', 'mips'])
            for (const engine of ['three', 'babylon', 'threeWebgpu', 'threeNodes']) {
                const [picture] = await draw(engine, `${name}.glb`, true, far), {share, psnr} = compared(picture, reference(name, far));
                console.log(`   ${name} in ${engine}: ${(100 * share).toFixed(2)} % of the pixels, ${psnr.toFixed(1)} dB`);
                assert(share >= near, `${share} of the pixels are equal`);
            }
    },
    async 'meshes may be compressed'() {
        for (const name of ['draco', 'meshopt'])
            for (const engine of ['three', 'babylon']) {
                const [picture, {warnings}] = await draw(engine, `${name}.glb`, true, views.layered);
                const {psnr} = compared(picture, reference('layered', views.layered));
                console.log(`   ${name} in ${engine}: ${psnr.toFixed(1)} dB`);
                assert.deepEqual(warnings, []);
                assert(psnr > 35);
            }
    },
    async 'surfaces with a layer of opacity blend'() {
        // Both engines blend display values, tessera render linear light.
        for (const engine of ['three', 'babylon']) {
            const [picture, {warnings}] = await draw(engine, 'blended.glb', true, views.layered);
            const {share, psnr} = compared(picture, reference('blended', views.layered));
            console.log(`   ${engine}: ${(100 * share).toFixed(2)} % of the pixels, ${psnr.toFixed(1)} dB`);
            assert.deepEqual(warnings, []);
            assert(psnr > 25, `${psnr} dB`); // 27.0
        }
    },
    async 'several textures are drawn'() {
        for (const engine of ['three', 'babylon']) {
            const [, {warnings, materials}] = await draw(engine, 'two.glb', true, views.layered);
            assert.deepEqual(warnings, []);
            assert.equal(materials.length, 3); // what hides, what blends, and the other file
            assert(materials.every(type => type === 'RawShaderMaterial' || type === 'ShaderMaterial'), materials);
        }
    },
    async 'without the plugin the picture shows'() {
        for (const engine of ['three', 'babylon']) {
            const [plain, shown] = await draw(engine, 'layered.glb', false, views.layered);
            assert(shown.materials.every(type => type === 'MeshBasicMaterial' || type === 'PBRMaterial'), shown.materials);
            // The mean over the directions is near the view itself, and not equal to it.
            const {psnr} = compared(plain, reference('layered', views.layered));
            console.log(`   picture in ${engine}: ${psnr.toFixed(1)} dB to the texture`);
            assert(psnr > 15 && psnr < 35);
            for (const [name, reason] of [['damaged.glb', /checksum|damaged/], ['outside.glb', /buffer view 99/],
                                          ['beyond.glb', /./]]) {
                const [replaced, {warnings}] = await draw(engine, name, true, views.layered);
                assert.equal(warnings.length, 1);
                assert.match(warnings[0], reason);
                assert.match(warnings[0], /the picture is shown instead/);
                assert(replaced.rgba.equals(plain.rgba));
            }
        }
    },
};

const whole = {eye: [4.5, 2.5, 3.5], look: [0, 0, 0], fov: 45, far: 50};
const far = {eye: [18, 10, 14], look: [0, 0, 0], fov: 30, far: 100};
const views = {layered: whole, shiny: whole, fitted: whole,
               single: {eye: [7, 2, 2], look: [0, 0, 0], fov: 30, far: 50},
               sphere: {eye: [10, 3, 1], look: [0, 0, 0], fov: 45, far: 50},
               inside: {eye: [0.1, 1.15, 0.05], look: [1, 0.3, 1.2], fov: 80, far: 50}};

// One ray per pixel, like the GPU.
function reference(name, {eye, look, fov}) {
    tessera('render', `${name}.tess`, '-o', `${name}.png`, '--eye', `${eye}`, '--look', `${look}`, '--fov', `${fov}`, '--pixels',
            '320x240', '--rays', '1', '-q');
    return readPng(fs.readFileSync(at(`${name}.png`)));
}

const inPackage = code => scene.run(`import('/package/tessera.js').then(async ({loadTessera}) => { ${code} })`);

async function draw(engine, name, plugin, view, background) {
    const drawn = await scene.draw(engine, name, plugin, {...view, background});
    if (pictures)
        fs.writeFileSync(path.join(pictures, `${name}-${engine}-${plugin ? 'with' : 'without'}.png`), drawn.png);
    return [drawn.picture, drawn];
}

let failed = 0, scene;
try {
    makeFiles();
    scene = await GltfScene.open(chromium, {package: packageFolder, npm: modules, files: folder});
    for (const [name, test] of Object.entries(tests))
        try {
            await test();
            console.log(`ok ${name}`);
        } catch (error) {
            ++failed;
            console.log(`FAILED ${name}: ${error.stack}\n${scene.said}`);
        }
} finally {
    await scene?.close();
    fs.rmSync(folder, {recursive: true, force: true});
}
process.exit(failed ? 1 : 0);
