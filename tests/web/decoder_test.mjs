// Tests that the browser's decoder gives the library's texels, from a file in memory and from byte
// ranges, and reports damage as an Error.
//   node decoder_test.mjs MODULE.js DECODER.wasm TESSERA GOLDEN-FOLDER SCRATCH-FOLDER [TEST]
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {createHash} from 'node:crypto';
import fs from 'node:fs';
import path from 'node:path';
import {pathToFileURL} from 'node:url';
import {Worker} from 'node:worker_threads';
import {bumpyBox} from './models.mjs';
import {movingColour, texelsOf} from './textures.mjs';

const [modulePath, wasmPath, tool, goldenFolder, scratch] = process.argv.slice(2);
const moduleUrl = pathToFileURL(path.resolve(modulePath)).href;
const {loadTessera, httpSource, ALPHA, ANGULAR_MAP, LAYER_ROLE, PRIMARIES, PROXY, SAMPLE_TYPE, SURFACE_MAP, TRANSFER} =
    await import(moduleUrl);
const wasm = fs.readFileSync(wasmPath);
const codec = await loadTessera(wasm);

fs.rmSync(scratch, {recursive: true, force: true});
fs.mkdirSync(scratch, {recursive: true});
process.on('exit', () => fs.rmSync(scratch, {recursive: true, force: true}));

const sha1 = bytes => createHash('sha1').update(bytes).digest('hex');
const run = (...words) => execFileSync(tool, words, {stdio: ['ignore', 'pipe', 'inherit']});
// FNV-1a-64, the hash of tests/golden/manifest.txt.
function fnv(bytes) {
    let high = 0xcbf29ce4, low = 0x84222325;
    for (const byte of bytes) {
        low = (low ^ byte) >>> 0;
        const product = low * 0x1b3;
        high = (Math.imul(high, 0x1b3) + Math.floor(product / 2 ** 32) + (low << 8)) >>> 0;
        low = product >>> 0;
    }
    return high.toString(16) + low.toString(16).padStart(8, '0');
}
const everything = file => file.info.size.flatMap(n => [0, n]);
const allPlaces = file => everything(file).slice(0, 4);

function nativeTexels(file) {
    const raw = path.join(scratch, 'texels.raw');
    run('decode', file, '-o', raw, '-q');
    return fs.readFileSync(raw);
}

// An asynchronous source that counts its reads and bytes.
function slowSource(bytes) {
    const source = {size: bytes.length, reads: 0, sent: 0, async read(offset, length) {
        await new Promise(setImmediate);
        ++source.reads;
        source.sent += length;
        return bytes.subarray(offset, offset + length);
    }};
    return source;
}

function bake(name, ...words) {
    const file = path.join(scratch, name);
    run('bake', 'composed', '-o', file, '--spp', '1', '-q', ...words);
    return file;
}
const layered = bake('layered.tess', '--size', '40x24x12x10', '--tile', '16x16x4x4', '--layers', '--max-error', '0',
                     '--effort', '1');
const mesh = bake('mesh.tess', '--proxy', 'mesh', '--density', '0.5', '--directions', '4x4', '--effort', '2');
// A file of several textures. It is larger than one read.
const lit = path.join(scratch, 'lit.tess');
fs.writeFileSync(path.join(scratch, 'box.gltf'), bumpyBox());
run('bake', path.join(scratch, 'box.gltf'), '-o', lit, '--layered', '--texels', '20000', '--lights', '8', '--spp', '1',
    '--quality', '100', '-q');

// The layers after the first one as files of their own (FORMAT.md 1.7): {role, scale, begin, end, bytes}, where begin
// and end are those of their DATA.
function cutLayers(bytes) {
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
    let at = 92 + 12 * bytes[36], section = 0;
    for (let i = 0; i < bytes[36]; ++i) {
        if (bytes.toString('latin1', 92 + 12 * i, 96 + 12 * i) === 'LAYR')
            section = at;
        at += view.getUint32(100 + 12 * i, true);
    }
    at += view.getUint32(32, true);
    const layers = Array.from({length: bytes[section]}, (_, i) => {
        const entry = section + 8 + 20 * i, first = view.getUint32(entry + 8, true);
        const layer = {role: bytes[entry], scale: view.getFloat32(entry + 4, true), data: view.getUint32(entry + 12, true),
                       first: bytes.subarray(at, at + first)};
        at += first;
        return layer;
    });
    let end = bytes.length;
    for (const layer of layers.toReversed()) {
        Object.assign(layer, {begin: end - layer.data, end});
        layer.bytes = Buffer.concat([layer.first, bytes.subarray(layer.begin, end)]);
        end = layer.begin;
    }
    return layers;
}

// Moving views with noise, so that the file is larger than one read.
function movingViews(name, size) {
    let seed = 1;
    const texels = texelsOf(size, (...place) => movingColour(...place).map(x => {
        seed = (Math.imul(seed, 1103515245) + 12345) >>> 0;
        return x + (seed >>> 28) / 2;
    }));
    const raw = path.join(scratch, 'views.rgb'), file = path.join(scratch, name);
    fs.writeFileSync(raw, texels);
    run('encode', raw, '--size', size.join('x'), '--tile', '16x16x4x3', '--max-error', '0', '--effort', '2', '-o', file,
        '-q');
    return file;
}
const aligned = movingViews('aligned.tess', [48, 40, 4, 3]);
// Files with the hash of their texels. The library's own tests check those of the golden files.
const golden = fs.readFileSync(path.join(goldenFolder, 'manifest.txt'), 'utf8').trim().split('\n')
                   .map(line => line.split(' ')).map(([name, hash]) => [path.join(goldenFolder, name), hash]);
const files = golden.concat([aligned, layered, mesh].map(name => [name, fnv(nativeTexels(name))]));
assert(files.length >= 15);

// The picture that WebGL samples, built texel by texel. Null for half floats.
function expectedAtlas(file, texels) {
    const {size: [U, V, S, T], channels, sampleType} = file.info;
    const out = new Uint8Array(U * V * S * T * 4);
    let at = 0;
    for (let v = 0; v < V; ++v)
        for (let u = 0; u < U; ++u)
            for (let t = 0; t < T; ++t)
                for (let s = 0; s < S; ++s, at += channels) {
                    const to = ((v * T + t) * U * S + u * S + s) * 4;
                    for (let c = 0; c < 3; ++c)
                        out[to + c] = texels[at + (channels > 2 ? c : 0)];
                    out[to + 3] = channels % 2 === 0 ? texels[at + channels - 1] : 255;
                }
    return sampleType === SAMPLE_TYPE.unorm8 ? out : null;
}

const tests = {
    async texelsEqualThoseOfTheLibrary() {
        for (const [name, hash] of files) {
            const bytes = fs.readFileSync(name);
            const file = codec.openBytes(bytes), texels = file.box(everything(file));
            assert.equal(fnv(texels), hash, name);
            const atlas = file.atlas(allPlaces(file)), picture = expectedAtlas(file, texels);
            assert(picture === null || sha1(atlas) === sha1(picture), `${name}: atlas`);
            file.close();
            assert.throws(() => file.atlas([0, 1, 0, 1]), /closed/);

            const far = await codec.openSource(slowSource(bytes));
            assert.equal(sha1(await far.fetchBox(everything(far))), sha1(texels), `${name} by ranges`);
            assert.equal(sha1(await far.fetchAtlas(allPlaces(far))), sha1(atlas), `${name} by ranges`);
        }
    },

    // FORMAT.md part 2 defines where texels of aligned views lie in the tile grid.
    async tilesOfAlignedViews() {
        const bytes = fs.readFileSync(aligned), source = slowSource(bytes);
        const file = await codec.openSource(source), {info} = file, [U, V, S, T] = info.size;
        assert.deepEqual(info.size, [48, 40, 4, 3]);
        assert.deepEqual(info.alignment, [-2, 2]);
        assert.deepEqual(info.gridSize, [54, 44, 4, 3]);
        assert.deepEqual(info.tiles, [4, 3, 1, 1]);
        assert.deepEqual(info.levels[0].size, info.size);
        const at = (u, v, s, t) => 3 * (((v * U + u) * T + t) * S + s);
        const sides = [[0, 14, 28, 41, 54], [0, 15, 30, 44]]; // where tiles begin and end along u and v

        const part = [17, 31, 9, 30, 1, 3, 2, 3], read = source.sent;
        assert.throws(() => file.box(part), /have not been fetched/);
        const corner = await file.fetchBox(part);
        assert(source.sent > read && source.sent < bytes.length, `${source.sent} of ${bytes.length} bytes`);
        const last = await file.fetchGridBox([41, 54, 30, 44, 0, S, 0, T]);
        assert(source.sent < bytes.length);
        const texels = await file.fetchBox(everything(file));
        let next = 0;
        for (let v = 9; v < 30; ++v)
            for (let u = 17; u < 31; ++u)
                for (let s = 1; s < 3; ++s, next += 3)
                    assert(!corner.subarray(next, next + 3).some((c, i) => c !== texels[at(u, v, s, 2) + i]));
        let found = 0;
        for (let i = 0; i < 4; ++i)
            for (let j = 0; j < 3; ++j) {
                const [u0, u1] = sides[0].slice(i), [v0, v1] = sides[1].slice(j);
                const tile = await file.fetchGridBox([u0, u1, v0, v1, 0, S, 0, T]);
                assert.equal(tile.length, (u1 - u0) * (v1 - v0) * S * T * 3);
                assert(i < 3 || j < 2 || sha1(tile) === sha1(last));
                next = 0;
                for (let v = v0; v < v1; ++v)
                    for (let u = u0; u < u1; ++u)
                        for (let t = 0; t < T; ++t)
                            for (let s = 0; s < S; ++s, next += 3) {
                                const x = u - 2 * (S - 1 - s), y = v - 2 * t;
                                if (x < 0 || y < 0 || x >= U || y >= V)
                                    continue;
                                ++found;
                                assert(!tile.subarray(next, next + 3).some((c, i) => c !== texels[at(x, y, s, t) + i]));
                            }
            }
        assert.equal(found, U * V * S * T);
        await assert.rejects(file.fetchGridBox([0, 55, 0, 1, 0, 1, 0, 1]), /54x44x4x3/);
        await assert.rejects(file.fetchBox([0, 49, 0, 1, 0, 1, 0, 1]), /48x40x4x3/);

        // Without alignment the grid equals the texture.
        const plain = codec.openBytes(fs.readFileSync(layered));
        assert.deepEqual([plain.info.alignment, plain.info.gridSize], [[0, 0], plain.info.size]);
        const box = [3, 20, 5, 17, 2, 9, 1, 6];
        assert.equal(sha1(await plain.fetchGridBox(box)), sha1(plain.box(box)));
    },

    async halfFloatsAreToneMapped() {
        const file = codec.openBytes(fs.readFileSync(path.join(goldenFolder, 'rgb_half.tess')));
        const texels = file.box([3, 4, 5, 6, 0, 4, 0, 4]), atlas = file.atlas([3, 4, 5, 6]);
        for (let i = 0; i < 16; ++i)
            for (let c = 0; c < 3; ++c) {
                const half = texels[6 * i + 2 * c] + 256 * texels[6 * i + 2 * c + 1];
                assert(half < 0x7C00); // finite, not negative
                const exponent = half >> 10, mantissa = half & 1023;
                const x = exponent === 0 ? mantissa * 2 ** -24 : (1024 + mantissa) * 2 ** (exponent - 25);
                const y = x / (1 + x), code = y <= 0.0031308 ? 12.92 * y : 1.055 * y ** (1 / 2.4) - 0.055;
                assert(Math.abs(atlas[4 * i + c] - 255 * code) < 0.51);
            }
    },

    async aBoxReadsOnlyPartOfTheFile() {
        const bytes = fs.readFileSync(layered), source = slowSource(bytes);
        assert(bytes.length > 2 * 8192);
        const file = await codec.openSource(source);
        assert.throws(() => file.box([0, 40, 0, 24, 0, 12, 0, 10]), /have not been fetched/);
        const box = [37, 39, 20, 21, 9, 12, 7, 8];
        const [part, again] = await Promise.all([file.fetchBox(box), file.fetchBox(box)]);
        assert(source.sent < bytes.length && source.reads <= 3, `${source.reads} reads, ${source.sent} bytes`);
        assert.equal(sha1(part), sha1(codec.openBytes(bytes).box(box)));
        assert.equal(sha1(part), sha1(again));
    },

    async coarseLevelsComeFirst() {
        const bytes = fs.readFileSync(layered), whole = codec.openBytes(bytes);
        const level = whole.info.coarse, [U, V, S, T] = whole.info.levels[level].size;
        assert(level > 0 && U * V * S * T < 40 * 24 * 12 * 10);
        const preview = whole.preview();
        assert.equal(preview.rgba.length, preview.width * preview.height * 4);
        const texel = whole.box([1, 2, 1, 2, 1, 2, 0, 1], undefined, level);
        const at = ((1 * T + 0) * preview.width + 1 * S + 1) * 4;
        assert.deepEqual([...preview.rgba.subarray(at, at + 3)], [...texel]);
        const source = slowSource(bytes), far = await codec.openSource(source);
        assert.equal(sha1((await far.fetchPreview()).rgba), sha1(preview.rgba));
        assert(source.sent < bytes.length);

        const cut = bytes.subarray(0, Math.floor(bytes.length * 0.6));
        assert.throws(() => codec.openBytes(cut), /cut off/);
        assert.equal(codec.openBytes(cut, {partial: true}).atlas([0, 40, 0, 24]).length, 40 * 24 * 12 * 10 * 4);
    },

    async layersAreTexturesOfTheirOwn() {
        const bytes = fs.readFileSync(lit), cut = cutLayers(bytes), file = codec.openBytes(bytes);
        const {specular, roughness, normal, visibility, reflection, environment} = LAYER_ROLE;
        const {scale, further, lights} = file.layers();
        assert(scale > 0);
        assert.deepEqual(further.map(({role}) => role), [specular, roughness, normal, visibility, reflection, environment]);
        assert.deepEqual(further.map(({role, scale}) => [role, scale]), cut.map(({role, scale}) => [role, scale]));
        assert.deepEqual(further.map(({file}) => file.info.channels), [3, 1, 2, 1, 3, 3]);
        assert.equal(lights.length, 8);
        for (const {direction, spread, irradiance} of lights)
            assert(Math.abs(Math.hypot(...direction) - 1) < 1e-6 && spread >= 0 && irradiance.some(x => x > 0));
        assert.equal(fnv(file.box(everything(file))), fnv(nativeTexels(lit)));

        const source = slowSource(bytes), far = await codec.openSource(source), opened = source.reads;
        const {further: farther} = await far.fetchLayers();
        assert(source.reads - opened <= 2, `${source.reads - opened} reads open the layers`);
        for (const [i, {file: layer}] of further.entries()) {
            const name = path.join(scratch, 'layer.tess');
            fs.writeFileSync(name, cut[i].bytes);
            const expected = fnv(nativeTexels(name));
            assert.equal(fnv(layer.box(everything(layer))), expected, `role ${further[i].role}`);
            assert.equal(fnv(await farther[i].file.fetchBox(everything(layer))), expected, `role ${further[i].role}`);
        }
        assert.deepEqual(codec.openBytes(fs.readFileSync(layered)).layers(), {scale: 1, further: [], lights: []});

        const damaged = Buffer.from(bytes);
        damaged[cut[2].first.byteOffset - bytes.byteOffset + 40] ^= 1; // in the header of the layer
        assert.throws(() => codec.openBytes(damaged).layers(), /layer normal: .*checksum/);
        further[0].file.close();
        assert(file.closed);
    },

    async infoDescribesTheFile() {
        const sphere = codec.openBytes(fs.readFileSync(layered)).info;
        assert.deepEqual([sphere.proxy, sphere.surfaceMap, sphere.angularMap],
                         [PROXY.sphere, SURFACE_MAP.sphereLongitudeLatitude, ANGULAR_MAP.hemisphereAlphaBeta]);
        assert.deepEqual([sphere.transfer, sphere.alpha], [TRANSFER.srgb, ALPHA.none]);
        assert(sphere.radius > 0 && !sphere.inside);
        assert.equal(codec.openBytes(fs.readFileSync(path.join(goldenFolder, 'rgb_half.tess'))).info.sampleType,
                     SAMPLE_TYPE.half16);
        const plain = codec.openBytes(fs.readFileSync(path.join(goldenFolder, 'rgb8.tess'))).info;
        assert.deepEqual(plain.metadata, {Software: 'golden', Title: 'rgb8.tess'});
        const longText = path.join(scratch, 'long_text.tess'); // its metadata is packed
        run('encode', layered, '-o', longText, '-q', '--effort', '0', '--meta', `Comment=${'long '.repeat(100)}`);
        assert.equal(codec.openBytes(fs.readFileSync(longText)).info.metadata, null);
        const surface = codec.openBytes(fs.readFileSync(mesh));
        assert.deepEqual([surface.info.proxy, surface.info.surfaceMap], [PROXY.mesh, SURFACE_MAP.meshUv]);
        assert.equal(Buffer.from(surface.meshBytes().subarray(0, 5)).toString(), 'DRACO');
        assert.throws(() => surface.mesh(), /no mesh decoder/);
    },

    // The constants have the names that the library gives to the codes.
    async constantsAreNamedLikeTheCodes() {
        const tables = {proxy: PROXY, surfaceMap: SURFACE_MAP, angularMap: ANGULAR_MAP, transfer: TRANSFER,
                        primaries: PRIMARIES, alpha: ALPHA};
        const seen = new Set();
        for (const [name] of files) {
            const {info} = codec.openBytes(fs.readFileSync(name));
            for (const [field, table] of Object.entries(tables)) {
                const constant = info.names[field].replace(/-(.)/g, (_, letter) => letter.toUpperCase());
                assert.equal(info[field], table[constant], `${name}: ${field}`);
                seen.add(`${field} ${info[field]}`);
            }
        }
        assert(seen.size > 12, [...seen].join(', '));
        assert(Object.values(tables).every(Object.isFrozen));
    },

    async badCallsAreErrors() {
        const file = codec.openBytes(fs.readFileSync(layered));
        for (const box of [[0, 41, 0, 24, 0, 12, 0, 10], [3, 3, 0, 1, 0, 1, 0, 1], [-1, 1, 0, 1, 0, 1, 0, 1],
                           [0, 1.5, 0, 1, 0, 1, 0, 1], [0, NaN, 0, 1, 0, 1, 0, 1], [0, 1, 0, 1]])
            assert.throws(() => file.box(box), Error, String(box));
        assert.throws(() => file.atlas([0, 1, 0, 1], new Uint8Array(3)), /bytes/);
        assert.throws(() => file.atlas([0, 1, 0, 1], undefined, 9), /level 9/);
        await assert.rejects(codec.openSource({size: 500, read: async () => new Uint8Array(3)}), /3 of 500/);
        await assert.rejects(codec.openSource({size: 500, read: async () => { throw new Error('cable cut'); }}),
                             /cable cut/);
        await assert.rejects(codec.openSource({size: NaN, read: async () => []}), /NaN/);
        await assert.rejects(loadTessera(new Uint8Array(8)), Error);
    },

    // A flipped bit anywhere gives an Error or texels, and the module stays usable.
    async damageIsReportedAsAnError() {
        let refused = 0;
        const random = (state => () => (state = Math.imul(state, 1664525) + 1013904223 >>> 0))(7);
        for (const name of [layered, path.join(goldenFolder, 'rgb8.tess'), mesh]) {
            const sound = fs.readFileSync(name);
            for (let round = 0; round < 60; ++round) {
                const bytes = Buffer.from(sound);
                const at = round < 30 ? random() % 600 : random() % bytes.length;
                bytes[at % bytes.length] ^= 1 << random() % 8;
                try {
                    const file = codec.openBytes(bytes);
                    file.box([0, 8, 0, 8, 0, 4, 0, 4]);
                } catch (error) {
                    assert(error instanceof Error && !(error instanceof WebAssembly.RuntimeError));
                    assert.doesNotMatch(error.message, /decoder stopped/);
                    ++refused;
                }
            }
            for (const length of [0, 1, 63, 200, sound.length - 1])
                assert.throws(() => codec.openBytes(sound.subarray(0, length)), Error);
        }
        assert(refused > 90, `${refused} refused`);
    },

    async worksInAWorker() {
        const script = `
            import {parentPort, workerData} from 'node:worker_threads';
            const {loadTessera} = await import(workerData.url);
            const file = (await loadTessera(workerData.module)).openBytes(workerData.bytes);
            const {size: [u, v, s, t]} = file.info;
            parentPort.postMessage(file.box([0, u, 0, v, 0, s, 0, t]));`;
        const bytes = fs.readFileSync(layered);
        const worker = new Worker(new URL(`data:text/javascript,${encodeURIComponent(script)}`),
                                  {workerData: {url: moduleUrl, module: codec.module, bytes}});
        const texels = await new Promise((resolve, reject) => worker.on('message', resolve).on('error', reject));
        const file = codec.openBytes(bytes);
        assert.equal(sha1(texels), sha1(file.box(everything(file))));
    },

    async readsRangesFromAServer() {
        const bytes = fs.readFileSync(layered);
        const {createServer} = await import('node:http');
        let failures = 1, requests = 0, version = '"1"';
        const server = createServer((request, response) => {
            const [, from, to] = /bytes=(\d+)-(\d+)/.exec(request.headers.range ?? '') ?? [];
            if (++requests > 1 && failures-- > 0)
                return response.destroy(); // a lost connection
            const end = Math.min(Number(to) + 1, bytes.length);
            response.writeHead(206, {ETag: version, 'Content-Range': `bytes ${from}-${end - 1}/${bytes.length}`});
            response.end(bytes.subarray(Number(from), end));
        });
        await new Promise(ready => server.listen(0, '127.0.0.1', ready));
        const url = `http://127.0.0.1:${server.address().port}/x.tess`;
        const file = await codec.openUrl(url);
        assert.equal(fnv(await file.fetchBox(everything(file))), files.at(-2)[1]);
        const other = await httpSource(url);
        version = '"2"';
        await assert.rejects(other.read(9000, 10), /has changed/);
        server.closeAllConnections();
        server.close();
    },
};

const wanted = process.argv[7];
for (const [name, test] of Object.entries(tests)) {
    if (wanted !== undefined && wanted !== name)
        continue;
    const begin = performance.now();
    await test();
    console.log(`ok ${name} (${Math.round(performance.now() - begin)} ms)`);
}
