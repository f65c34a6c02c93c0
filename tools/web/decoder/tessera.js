// Tessera's decoder for browsers, workers and node, as an ES module without dependencies.
//
//   const codec = await loadTessera(wasm);          // bytes, a Response, or a compiled module
//   const file = codec.openBytes(bytes);            // a .tess file in memory
//   const pixels = file.atlas([0, 64, 0, 32]);      // RGBA for WebGL
//   file.close();
//
// openSource() and openUrl() open files that are read as needed, with fetchAtlas() and fetchBox(). Calls that fail
// throw an Error whose message is a sentence. Each file has its own instance of the WebAssembly module: a file that
// breaks its instance does not affect others, and close() frees all of its memory. tessera.d.ts documents the types.

// The codes of the header's fields (FORMAT.md 1.1). A file may hold a code that no table lists.
export const SAMPLE_TYPE = Object.freeze({unorm8: 0, half16: 1});
export const ALPHA = Object.freeze({none: 0, straight: 1, premultiplied: 2});
export const PROXY = Object.freeze({none: 0, sphere: 1, mesh: 2, sphereInside: 3});
export const SURFACE_MAP = Object.freeze({none: 0, sphereLongitudeLatitude: 1, meshUv: 2});
export const ANGULAR_MAP = Object.freeze(
    {none: 0, hemisphereAlphaBeta: 1, planarViews: 2, octahedralHemisphere: 3, octahedralMirrored: 4});
export const TRANSFER = Object.freeze({unspecified: 0, srgb: 1, linear: 2});
export const PRIMARIES = Object.freeze({unspecified: 0, bt709: 1});
// What a layer holds (FORMAT.md 1.7).
export const LAYER_ROLE = Object.freeze(
    {diffuse: 0, emission: 1, specular: 2, roughness: 3, normal: 4, visibility: 5, reflection: 6,
     coverage: 7, environment: 8, difference: 9, sharedDifference: 10, opacity: 11});

// The glTF extension under which a .glb holds a .tess file (format/gltf/README.md).
export const GLB_EXTENSION = 'TESSERA_texture_light_field';

const ofGrid = 0xFFFFFFFF; // replaces the number of a level: the grid of level 0's tiles
const failed = 1, wantsBytes = 2; // values that the module's functions return, as in exports.cpp

// `wasm`: tessera.wasm as an ArrayBuffer or an array of bytes, a Response or a promise of one, or a
// WebAssembly.Module that another thread has compiled.
export async function loadTessera(wasm) {
    return new Codec(await compiled(await wasm));
}

async function compiled(wasm) {
    if (wasm instanceof WebAssembly.Module)
        return wasm;
    if (typeof Response !== 'undefined' && wasm instanceof Response) {
        if (!wasm.ok)
            throw new Error(`${wasm.url}: the server responded with status ${wasm.status}`);
        wasm = await wasm.arrayBuffer();
    }
    return WebAssembly.compile(wasm);
}

class Codec {
    constructor(module) {
        this.module = module; // can be posted to workers
    }

    // bytes: a .tess file, or a .glb that holds one. options: {partial: accept a truncated file, damaged: replace
    // damaged tiles, texture: which one of a .glb with several, counted from 0}
    openBytes(bytes, options = {}) {
        bytes = bytes instanceof Uint8Array ? bytes : new Uint8Array(bytes);
        if (isGlb(bytes)) {
            const {begin, size} = placeInGlb(bytes.subarray(20, 20 + glbJsonBytes(bytes)), bytes.length, options.texture);
            bytes = bytes.subarray(begin, begin + size);
        }
        const file = new TessFile(this.module, bytes.length, null);
        file._keep(0, bytes);
        file._open(options);
        return file;
    }

    // source: {size, read(offset, length)}; read() returns a promise of exactly `length` bytes.
    async openSource(source, options = {}) {
        const file = new TessFile(this.module, source.size, source);
        await file._withBytes(() => file._open(options));
        return file;
    }

    // Opens the .tess file, or the .glb that holds one, at a URL with range requests.
    async openUrl(url, options = {}) {
        return this.openSource(await glbPayload(await httpSource(url, options), options.texture), options);
    }
}

// The .tess file in a source that is a .glb; any other source itself. texture: which one of several, counted from 0.
export async function glbPayload(source, texture) {
    const head = new Uint8Array(await source.read(0, Math.min(20, source.size)));
    if (!isGlb(head))
        return source;
    const {begin, size} = placeInGlb(new Uint8Array(await source.read(20, glbJsonBytes(head))), source.size, texture);
    return {size, read: (offset, length) => source.read(begin + offset, length)};
}

const wordAt = (bytes, offset) => new DataView(bytes.buffer, bytes.byteOffset).getUint32(offset, true);
const isGlb = bytes => bytes.length >= 20 && wordAt(bytes, 0) === 0x46546C67;
const glbJsonBytes = head => wordAt(head, 12);

// json: the bytes of the first chunk; length: of the whole file; number: of the texture, absent if there is only one.
function placeInGlb(json, length, number) {
    const gltf = JSON.parse(new TextDecoder().decode(json));
    const textures = (gltf.textures ?? []).filter(({extensions}) => extensions?.[GLB_EXTENSION]), {length: count} = textures;
    if (!count)
        throw new Error('the glTF file has no Tessera texture');
    if (number === undefined ? count > 1 : !textures[Number(number)])
        throw new Error(`the glTF file has ${count} Tessera textures: choose one by its number, 0 to ${count - 1}`);
    const texture = textures[Number(number ?? 0)];
    const view = gltf.bufferViews?.[texture.extensions[GLB_EXTENSION].bufferView];
    const begin = 28 + json.length + (view?.byteOffset ?? 0), size = view?.byteLength;
    if (view?.buffer !== 0 || !(size >= 0 && begin >= 28 + json.length && begin + size <= length))
        throw new Error('the Tessera texture is not within the glTF file');
    return {begin, size};
}

class TessFile {
    constructor(module, size, source) {
        if (!Number.isSafeInteger(size) || size < 0)
            throw new Error(`${size} is not the size of a file`);
        this._instance = {wasm: instantiate(module)}; // shared with the layers
        this._layer = 0;
        this._source = source;
        this._coming = new Map(); // "offset length" -> promise of a range that is being fetched
        this._call(() => this._wasm.web_begin(size));
        this._box = this._call(() => this._wasm.malloc(32));
    }

    // Texels of a level as RGBA with 8 bits per sample. Texel (u, v, s, t) is at x = (u - u0) * S + s,
    // y = (v - v0) * T + t. `out`: an array of exactly that size that receives them.
    atlas(places, out, level = 0) {
        return this._read('web_atlas', level, this._everyDirection(places, level), 4, out);
    }
    // The decoded samples of the box [u0, u1, v0, v1, s0, s1, t0, t1], in the order v, u, t, s, channels together.
    box(corners, out, level = 0) {
        return this._read('web_box', level, corners, this.info.texelBytes, out);
    }
    // The same for files of openSource(): missing bytes are fetched first.
    async fetchAtlas(places, out, level = 0) {
        await this.fetch(this._everyDirection(places, level), level);
        return this._withBytes(() => this.atlas(places, out, level));
    }
    async fetchBox(corners, out, level = 0) {
        await this.fetch(corners, level);
        return this._withBytes(() => this.box(corners, out, level));
    }
    // Fetches the bytes of these texels, so that atlas() and box() can read them.
    fetch(corners, level = 0) {
        return this._withBytes(() => this._ask('web_fetch', level, corners));
    }

    // Like fetchBox(), but the box is in the grid of level 0's tiles (FORMAT.md part 2), whose size is info.gridSize.
    fetchGridBox(corners, out) {
        return this.fetchBox(corners, out, ofGrid);
    }

    // The whole coarsest level as {level, width, height, rgba}; null if there are no coarse levels.
    preview() {
        const level = this.info.coarse;
        return level === 0 ? null : this._picture(level, this.atlas(this._everywhere(level), undefined, level));
    }
    async fetchPreview() {
        const level = this.info.coarse;
        return level === 0 ? null
                           : this._picture(level, await this.fetchAtlas(this._everywhere(level), undefined, level));
    }

    // The Draco stream of the mesh; null if the proxy is not a mesh. This module cannot decode it.
    meshBytes() {
        const length = this._call(() => this._wasm.web_mesh_bytes());
        return length === 0 ? null : this._bytes(this._wasm.web_mesh(), length).slice();
    }
    mesh() {
        if (this.meshBytes() === null)
            return null;
        throw new Error('this module has no mesh decoder: meshBytes() returns the Draco stream');
    }

    // The layers (FORMAT.md 1.7) as {scale, further, lights}. `further` has {role, scale, file} for each layer after the
    // first one, whose texels are those of this file. Closing the file of a layer closes all of them.
    layers() {
        this._check(this._call(() => this._wasm.web_open_layers()));
        return this._layers();
    }
    async fetchLayers() {
        return this._withBytes(() => this.layers());
    }

    close() {
        this._instance.wasm = null;
    }
    get closed() {
        return this._wasm === null;
    }
    get _wasm() {
        return this._instance.wasm;
    }

    _picture(level, rgba) {
        const [u, v, s, t] = this.info.levels[level].size;
        return {level, width: u * s, height: v * t, rgba};
    }
    _everywhere(level) {
        const [u, v] = this.info.levels[level].size;
        return [0, u, 0, v];
    }
    _everyDirection(places, level) {
        const of = this.info.levels[level];
        if (of === undefined)
            throw new Error(`there is no level ${level}`);
        return [places[0], places[1], places[2], places[3], 0, of.size[2], 0, of.size[3]];
    }

    _open(options) {
        this._check(this._call(() => this._wasm.web_open(options.partial ? 1 : 0, options.damaged ? 1 : 0)));
        this.info = this._facts();
    }

    // Calls a function of the module that reads texels, and returns its result.
    _read(name, level, corners, texelBytes, out) {
        this._ask(name, level, corners);
        const [u0, u1, v0, v1, s0, s1, t0, t1] = corners;
        const length = (u1 - u0) * (v1 - v0) * (s1 - s0) * (t1 - t0) * texelBytes;
        const bytes = this._bytes(this._wasm.web_result(), length);
        if (out === undefined)
            return bytes.slice();
        if (out.length !== length)
            throw new Error(`the array has ${out.length} bytes, but the texels have ${length} bytes`);
        out.set(bytes);
        return out;
    }

    _ask(name, level, corners) {
        if (!corners.every(x => Number.isInteger(x) && x >= 0 && x < 2 ** 32))
            throw new Error(`[${corners}] is not a box of texels`);
        const [u0, u1, v0, v1, s0, s1, t0, t1] = corners;
        this._check(this._call(() => {
            new Uint32Array(this._wasm.memory.buffer, this._box, 8).set([u0, v0, s0, t0, u1, v1, s1, t1]);
            return this._wasm[name](level, this._box);
        }));
    }

    // Repeats `work` and fetches the bytes that it lacks, until it succeeds.
    async _withBytes(work) {
        for (;;)
            try {
                return work();
            } catch (error) {
                if (!error.ranges || this._source === null)
                    throw error;
                await Promise.all(error.ranges.map(range => this._bring(range)));
            }
    }

    _bring([offset, length]) {
        const key = `${offset} ${length}`;
        if (!this._coming.has(key))
            this._coming.set(key, (async () => {
                try {
                    const bytes = new Uint8Array(await this._source.read(offset, length));
                    if (bytes.length !== length)
                        throw new Error(`the source returned ${bytes.length} of ${length} bytes at offset ${offset}`);
                    this._keep(offset, bytes);
                } finally {
                    this._coming.delete(key);
                }
            })());
        return this._coming.get(key);
    }

    // Passes bytes of the file to the module.
    _keep(offset, bytes) {
        this._call(() => {
            const at = this._wasm.malloc(bytes.length || 1);
            if (at === 0)
                throw new Error(`there is not enough memory for ${bytes.length} bytes`);
            this._bytes(at, bytes.length).set(bytes);
            this._wasm.web_keep(offset, at, bytes.length);
        });
    }

    _check(answer) {
        if (answer !== failed && answer !== wantsBytes)
            return;
        const error = new Error(this._string(this._wasm.web_error()));
        if (answer === wantsBytes) {
            const numbers = new Float64Array(this._wasm.memory.buffer, this._wasm.web_wanted(),
                                             2 * this._wasm.web_wanted_count());
            error.ranges = [];
            for (let i = 0; i < numbers.length; i += 2)
                error.ranges.push([numbers[i], numbers[i + 1]]);
        }
        throw error;
    }

    // A call that stops the instance, usually because memory runs out, closes the file and throws an Error.
    _call(work) {
        if (this._wasm === null)
            throw new Error('the file is closed');
        try {
            this._wasm.web_select(this._layer);
            return work();
        } catch (error) {
            if (!(error instanceof WebAssembly.RuntimeError))
                throw error;
            this.close();
            throw new Error('the decoder stopped, probably because memory ran out; the file is closed',
                            {cause: error});
        }
    }

    // A function that returns the next numbers of those that a function of the module returns.
    _numbers(name) {
        const at = this._call(() => this._wasm[name]());
        const all = new Float64Array(this._wasm.memory.buffer, at);
        let next = 0;
        return count => Array.from(all.subarray(next, next += count));
    }

    _layers() {
        const take = this._numbers('web_layers'), [scale, count] = take(2);
        const further = Array.from({length: count}, () => take(2)).map(([role, scale], i) => {
            const file = Object.assign(Object.create(TessFile.prototype), this, {_layer: i + 1});
            return {role, scale, file};
        });
        const lights = Array.from({length: take(1)[0]},
                                  () => ({direction: take(3), spread: take(1)[0], irradiance: take(3)}));
        for (const {file} of further)
            file.info = file._facts();
        return {scale, further, lights};
    }

    // Reads the numbers and texts in the order of facts.h.
    _facts() {
        const take = this._numbers('web_facts');
        const size = take(4);
        const [sampleType, channels, proxy, surfaceMap, angularMap, transfer, primaries, alpha] = take(8);
        const info = {size, sampleType, channels, texelBytes: channels * (sampleType === SAMPLE_TYPE.half16 ? 2 : 1),
                      proxy, surfaceMap, angularMap, transfer, primaries, alpha,
                      inside: proxy === PROXY.sphereInside, centre: take(3), radius: take(1)[0],
                      viewingRadius: take(2), background: take(4).slice(0, channels), bytes: take(1)[0]};
        const packed = take(1)[0] !== 0;
        info.alignment = take(2);
        info.gridSize = take(4);
        info.levels = [];
        for (let left = take(1)[0]; left > 0; --left) {
            const level = {size: take(4), tile: take(4), tiles: take(4)};
            [level.spatialLod, level.angularLod] = take(2);
            info.levels.push(level);
        }
        info.coarse = info.levels.length - 1;
        info.tile = info.levels[0].tile;
        info.tiles = info.levels[0].tiles;

        const texts = this._call(() => this._wasm.web_texts());
        const [...pairs] = new TextDecoder().decode(this._bytes(texts, this._wasm.web_texts_bytes())).split('\0');
        info.names = {};
        for (const field of ['proxy', 'surfaceMap', 'angularMap', 'transfer', 'primaries', 'alpha', 'colour'])
            info.names[field] = pairs.shift();
        const entries = [];
        for (let i = 0; i + 1 < pairs.length; i += 2)
            entries.push([pairs[i], pairs[i + 1]]);
        info.metadata = packed ? null : Object.fromEntries(entries);
        return info;
    }

    _bytes(at, length) {
        return new Uint8Array(this._wasm.memory.buffer, at, length);
    }
    _string(at) {
        const memory = new Uint8Array(this._wasm.memory.buffer);
        return new TextDecoder().decode(memory.slice(at, memory.indexOf(0, at)));
    }
}

// The module has no imports.
function instantiate(module) {
    const wasm = new WebAssembly.Instance(module, {}).exports;
    wasm._initialize();
    return wasm;
}

// A file on a web server as a source for openSource(). Each request is attempted at most `tries` times, and the wait
// doubles after each attempt.
export async function httpSource(url, {tries = 5, signal} = {}) {
    const ask = async (headers, method = 'GET') => {
        for (let attempt = 1;; ++attempt)
            try {
                const response = await fetch(url, {method, headers, signal});
                if (response.status >= 500 && attempt < tries)
                    throw new Error(`${url}: the server responded with status ${response.status}`);
                return {response, bytes: new Uint8Array(await response.arrayBuffer())};
            } catch (error) {
                if (attempt >= tries || error.name === 'AbortError')
                    throw error;
                await new Promise(wake => setTimeout(wake, 250 * 2 ** attempt));
            }
    };
    const firstBytes = 8192; // the first read of the module
    const {response, bytes} = await ask({Range: `bytes=0-${firstBytes - 1}`});
    if (!response.ok)
        throw new Error(`${url}: the server responded with status ${response.status}`);
    if (response.status !== 206) // the server sent the whole file
        return {size: bytes.length, read: async (offset, length) => bytes.subarray(offset, offset + length)};
    const size = Number(/\/(\d+)$/.exec(response.headers.get('Content-Range') ?? '')?.[1]);
    if (!Number.isSafeInteger(size))
        throw new Error(`${url}: the server does not send the size of the file`);
    const version = response.headers.get('ETag') ?? response.headers.get('Last-Modified');
    return {
        size,
        async read(offset, length) {
            if (offset + length <= bytes.length)
                return bytes.subarray(offset, offset + length);
            const part = await ask({Range: `bytes=${offset}-${offset + length - 1}`});
            if (part.response.status !== 206)
                throw new Error(`${url}: the server responded to a range request with status ${part.response.status}`);
            const now = part.response.headers.get('ETag') ?? part.response.headers.get('Last-Modified');
            if (now !== version)
                throw new Error(`${url}: the file has changed since it was opened`);
            return part.bytes;
        }
    };
}
