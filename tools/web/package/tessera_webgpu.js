// Decodes textures on the GPU by WebGPU, from their compressed tiles. The shaders are those of `tessera shaders
// --dialect wgsl`.
//
//   const codec = await loadTessera(fetch('tessera_webgpu.wasm'));
//   const file = codec.openBytes(bytes);
//   const gpu = await openGpu(wgslFrom(new URL('wgsl/', import.meta.url)));   // null without WebGPU
//   const {texture, box} = await gpu.decode(file, [0, U, 0, V, 0, S, 0, T]);
//
// tessera_webgpu.wasm does what tessera.wasm does, and also prepares tiles for the shaders.

const gridLevel = 0xFFFFFFFF; // boxes are in the grid of level 0's tiles
const divided = (count, size) => Math.ceil(count / size);

// What web_batch() returns, in its order.
const batchFields = ['tiles', 'damaged', 'mostSegments', 'rawChunks', 'corrections', 'waves', 'mostTexels', 'predicted',
    'borders', 'workWords', 'coefficients', 'wordsAt', 'wordCount', 'tablesAt', 'tableCount', 'mostTables', 'generation',
    'filters'];
// Words of the work buffer: where the states of tiles begin, words of a state, and the one that says that the tile is
// damaged (decoder_glsl/shaders/layout.glsl).
const stateAt = 6, stateWords = 6, stateDamaged = 4;

// WGSL by its set of macros and its name, such as ('half', 'texels.comp'), from a folder of this package.
export const wgslFrom = folder => async (macros, name) => {
    const answer = await fetch(new URL(`${macros}/${name}.wgsl`, folder));
    if (!answer.ok)
        throw new Error(`${answer.url}: the server responded with status ${answer.status}`);
    return answer.text();
};

// A GpuDecoder on a device of its own, or null if there is no WebGPU, only a software device, or one that is too small. code: see wgslFrom().
export async function openGpu(code, {software = false} = {}) {
    const adapter = await globalThis.navigator?.gpu?.requestAdapter();
    const workgroupBytes = 32768; // that texels.comp shares
    if (!adapter || adapter.info.isFallbackAdapter && !software ||
        adapter.limits.maxComputeWorkgroupStorageSize < workgroupBytes)
        return null;
    const wanted = ['maxStorageBufferBindingSize', 'maxBufferSize', 'maxComputeWorkgroupStorageSize'];
    const requiredLimits = Object.fromEntries(wanted.map(name => [name, adapter.limits[name]]));
    return new GpuDecoder(await adapter.requestDevice({requiredLimits}), code);
}

// The layout of a binding that WGSL declares as `var<space> name : type`.
function layoutOf(space, type) {
    if (space)
        return {buffer: {type: {uniform: 'uniform', 'storage, read': 'read-only-storage',
            'storage, read_write': 'storage'}[space]}};
    const stored = type.match(/^texture_storage_2d_array<(\w+), write>$/);
    if (stored)
        return {storageTexture: {format: stored[1], viewDimension: '2d-array'}};
    return type === 'sampler' ? {sampler: {}} : {texture: {viewDimension: '2d-array'}};
}

// Compute programs, compiled when they are needed.
export class Shaders {
    #made = new Map();

    constructor(device, code) {
        Object.assign(this, {device, code});
    }

    // The program of a shader, to which `entryPoint` is added if it has none.
    pipeline(macros, name, entryPoint = '') {
        const key = `${macros}/${name}`;
        if (!this.#made.has(key))
            this.#made.set(key, (async () => this.compile(await this.code(macros, name) + entryPoint))());
        return this.#made.get(key);
    }

    // A compute pipeline, and the bindings of its groups. All that a shader declares is bound, even what it only
    // measures.
    async compile(code) {
        const groups = [];
        const declared = /@group\((\d+)\) @binding\((\d+)\) var(?:<([^>]*)>)? \w+ : ([^;]+);/g;
        for (const [, group, binding, space, type] of code.matchAll(declared)) {
            while (groups.length <= +group)
                groups.push([]);
            groups[+group].push({binding: +binding, visibility: GPUShaderStage.COMPUTE, ...layoutOf(space, type)});
        }
        const layout = this.device.createPipelineLayout(
            {bindGroupLayouts: groups.map(entries => this.device.createBindGroupLayout({entries}))});
        const module = this.device.createShaderModule({code});
        const pipeline = await this.device.createComputePipelineAsync({layout, compute: {module, entryPoint: 'main'}});
        return {pipeline, groups: groups.map(entries => entries.map(entry => entry.binding))};
    }

    // Adds a dispatch. resources: by group and binding, as in {'0:2': {buffer}}; count: numbers of groups, or a buffer
    // that holds them.
    dispatch(encoder, {pipeline, groups}, resources, count) {
        const pass = encoder.beginComputePass();
        pass.setPipeline(pipeline);
        groups.forEach((numbers, group) => {
            const entries = numbers.map(binding => ({binding, resource: resources[`${group}:${binding}`]}));
            pass.setBindGroup(group, this.device.createBindGroup({layout: pipeline.getBindGroupLayout(group), entries}));
        });
        if (Array.isArray(count))
            pass.dispatchWorkgroups(...count);
        else
            pass.dispatchWorkgroupsIndirect(count, 0);
        pass.end();
    }
}

// content: an array of words, or a number of bytes.
export function buffer(device, usage, content) {
    const size = typeof content === 'number' ? content : content.byteLength;
    const made = device.createBuffer({size: Math.max(16, size), usage: usage | GPUBufferUsage.COPY_DST});
    if (typeof content !== 'number')
        device.queue.writeBuffer(made, 0, content);
    return made;
}

// Adds the passes of a batch (decoder_glsl/README.md), which decode it into `texture`, and returns the buffers that must
// live until they are submitted. file: {half, filters}; batch: the fields of DecodeBatch; tables: a buffer. The second
// one holds the states of tiles.
export async function addBatch(shaders, encoder, file, batch, tables, texture) {
    const {device} = shaders, usage = GPUBufferUsage;
    const work = buffer(device, usage.STORAGE | usage.COPY_SRC, batch.workWords * 4);
    const own = [buffer(device, usage.STORAGE, batch.words), work,
        buffer(device, usage.STORAGE, batch.coefficients * 16), buffer(device, usage.INDIRECT, 12)];
    const [words, , coefficients, groups] = own;
    const resources = {'0:0': {buffer: tables}, '0:1': {buffer: words}, '0:2': {buffer: work},
        '0:3': {buffer: coefficients}, '1:0': texture.createView({dimension: '2d-array'})};
    const format = file.half ? 'half' : 'plain';
    const keeps = batch.predicted || file.filters ? `${format}_predicted` : format;
    const run = async (macros, name, count) =>
        shaders.dispatch(encoder, await shaders.pipeline(macros, `${name}.comp`), resources, count);
    await run('plain', 'tree', [divided(batch.tiles, 16)]);
    await run('plain', 'levels', [divided(batch.tiles, 4), batch.mostSegments]);
    if (batch.corrections)
        await run('plain', 'corrections', [divided(batch.corrections, 16)]);
    if (batch.rawChunks)
        await run('plain', 'order', [Math.min(batch.rawChunks, 1024), divided(batch.rawChunks, 1024)]);
    for (let wave = 0; wave < batch.waves; ++wave) {
        await run('plain', 'items', [batch.tiles]);
        await run('plain', 'groups', [1]);
        // A dispatch cannot write the buffer that sizes it.
        encoder.copyBufferToBuffer(work, 0, groups, 0, 12);
        await run(keeps, 'texels', groups);
        if (wave === 0 && batch.borders)
            await run(format, 'border', [batch.tiles]);
    }
    if (file.filters)
        await run(format, 'filter', [divided(batch.mostTexels, 64), batch.tiles]);
    return own;
}

// Adds a copy of bytes to a buffer that can be mapped.
function readable(device, size) {
    return device.createBuffer({size, usage: GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ});
}

// Decodes boxes one after another. Errors are exceptions: a lost device, a limit of it, damaged tiles.
export class GpuDecoder {
    constructor(device, code) {
        Object.assign(this, {device, shaders: new Shaders(device, code), tables: new WeakMap(), last: Promise.resolve()});
        device.lost.then(({message}) => this.lost = message || 'the device was lost');
    }

    close() {
        this.device.destroy();
    }

    // Decodes the tiles that the box [u0, u1, v0, v1, s0, s1, t0, t1] touches, in texels of the tile grid, to a texture
    // of one layer. Texel (u, v, s, t) is at x = (u - u0) * (s1 - s0) + s - s0 and y = (v - v0) * (t1 - t0) + t - t0, where
    // u0 and so on are those of the returned `box`: all texels of these tiles. Grey is copied to R, G and B. The caller
    // destroys the texture.
    async decode(file, corners) {
        await file.fetch(corners, gridLevel);
        const decoded = this.last.then(() => this.#decoded(file, corners));
        this.last = decoded.catch(() => {});
        return decoded;
    }

    async #decoded(file, corners) {
        const {device} = this;
        if (this.lost)
            throw new Error(this.lost);
        for (const kind of ['validation', 'out-of-memory', 'internal'])
            device.pushErrorScope(kind);
        let result, failure;
        try {
            result = await this.#allBatches(file, corners);
        } catch (error) {
            failure = error;
        }
        const wrong = (await Promise.all([0, 1, 2].map(() => device.popErrorScope()))).find(Boolean);
        if (failure || wrong) {
            result?.texture.destroy();
            throw failure || new Error(wrong.message);
        }
        return result;
    }

    async #allBatches(file, corners) {
        file._ask('web_batches', gridLevel, corners);
        let texture, box;
        const checks = [];
        try {
            for (;;) {
                await file._withBytes(() => file._check(file._call(() => file._wasm.web_next_batch())));
                const {batch, tables} = this.#batch(file);
                box ??= batch.box;
                texture ??= this.#texture(file, box);
                if (batch.tiles === 0)
                    break;
                if (batch.damaged)
                    throw new Error('a tile is damaged');
                checks.push(await this.#submitted(file, batch, tables, texture));
            }
            for (const check of checks)
                await check();
        } catch (error) {
            texture?.destroy();
            throw error;
        }
        return {texture, box};
    }

    // The next batch of the module, and the buffer of tables that it needs.
    #batch(file) {
        const take = file._numbers('web_batch'), memory = file._wasm.memory.buffer;
        const batch = Object.fromEntries(take(batchFields.length).map((number, i) => [batchFields[i], number]));
        const begin = take(4), end = take(4);
        batch.box = begin.flatMap((first, axis) => [first, end[axis]]);
        batch.words = new Uint32Array(memory, batch.wordsAt, batch.wordCount);
        const limit = this.device.limits.maxStorageBufferBindingSize;
        const most = Math.max(batch.wordCount * 4, batch.workWords * 4, batch.coefficients * 16, batch.mostTables * 4);
        if (most > limit)
            throw new Error(`a batch needs a buffer of ${most} bytes, but this device allows only ${limit}`);
        let tables = this.tables.get(file);
        if (!tables) {
            tables = {buffer: buffer(this.device, GPUBufferUsage.STORAGE, batch.mostTables * 4)};
            this.tables.set(file, tables);
        }
        if (tables.count !== batch.tableCount || tables.generation !== batch.generation)
            this.device.queue.writeBuffer(tables.buffer, 0, new Uint32Array(memory, batch.tablesAt, batch.tableCount));
        Object.assign(tables, {count: batch.tableCount, generation: batch.generation});
        return {batch, tables: tables.buffer};
    }

    #texture(file, [u0, u1, v0, v1, s0, s1, t0, t1]) {
        const size = [(u1 - u0) * (s1 - s0), (v1 - v0) * (t1 - t0)], limit = this.device.limits.maxTextureDimension2D;
        if (Math.max(...size) > limit)
            throw new Error(`the box needs a texture of ${size.join('x')} pixels, but this device allows only ${limit}`);
        const {STORAGE_BINDING, TEXTURE_BINDING, COPY_SRC} = GPUTextureUsage;
        return this.device.createTexture({size, format: file.info.sampleType ? 'rgba16float' : 'rgba8unorm',
                                          usage: STORAGE_BINDING | TEXTURE_BINDING | COPY_SRC});
    }

    // Submits a batch. Returns a function that waits for it and throws if a tile is damaged.
    async #submitted(file, batch, tables, texture) {
        const {device} = this, encoder = device.createCommandEncoder();
        const format = {half: file.info.sampleType !== 0, filters: batch.filters !== 0};
        const own = await addBatch(this.shaders, encoder, format, batch, tables, texture);
        const bytes = batch.tiles * stateWords * 4, states = readable(device, bytes);
        encoder.copyBufferToBuffer(own[1], stateAt * 4, states, 0, bytes);
        device.queue.submit([encoder.finish()]);
        own.forEach(one => one.destroy());
        return async () => {
            await states.mapAsync(GPUMapMode.READ);
            const words = new Uint32Array(states.getMappedRange());
            const isDamaged = words.some((word, i) => i % stateWords === stateDamaged && word !== 0);
            states.destroy();
            if (isDamaged)
                throw new Error('a tile is damaged');
        };
    }

    // The decoded samples of the box, like file.fetchGridBox().
    async texels(file, corners, out) {
        const {texture, box} = await this.decode(file, corners);
        const {device} = this, {width, height} = texture, half = file.info.sampleType !== 0;
        const row = divided(width * (half ? 8 : 4), 256) * 256, copy = readable(device, row * height);
        const encoder = device.createCommandEncoder();
        encoder.copyTextureToBuffer({texture}, {buffer: copy, bytesPerRow: row}, [width, height]);
        device.queue.submit([encoder.finish()]);
        texture.destroy();
        await copy.mapAsync(GPUMapMode.READ);
        const pixels = new (half ? Uint16Array : Uint8Array)(copy.getMappedRange());
        const samples = samplesOf(pixels, row / (half ? 2 : 1), box, corners, file.info.channels);
        copy.destroy();
        const bytes = new Uint8Array(samples.buffer);
        if (!out)
            return bytes;
        out.set(bytes);
        return out;
    }
}

// The samples of `corners` in the order v, u, t, s, from pixels of `box`. row: samples of a row of pixels.
function samplesOf(pixels, row, box, corners, channels) {
    const [u0, u1, v0, v1, s0, s1, t0, t1] = corners, wide = box[5] - box[4], high = box[7] - box[6];
    const samples = new pixels.constructor((u1 - u0) * (v1 - v0) * (s1 - s0) * (t1 - t0) * channels);
    const of = channels === 2 ? [0, 3] : [0, 1, 2, 3].slice(0, channels); // the pixel's channels
    let to = 0;
    for (let v = v0; v < v1; ++v)
        for (let u = u0; u < u1; ++u)
            for (let t = t0; t < t1; ++t) {
                let from = ((v - box[2]) * high + t - box[6]) * row + ((u - box[0]) * wide + s0 - box[4]) * 4;
                for (let s = s0; s < s1; ++s, from += 4)
                    for (let c = 0; c < channels; ++c)
                        samples[to++] = pixels[from + of[c]];
            }
    return samples;
}
