// The passes of the decoder in WGSL (decoder_glsl/README.md), as a host runs them.
import fs from "node:fs";
import path from "node:path";

const divided = (count, size) => Math.ceil(count / size);

// The layout of a binding that WGSL declares as `var<space> name : type`.
function layoutOf(space, type) {
    if (space)
        return {buffer: {type: {uniform: "uniform", "storage, read": "read-only-storage",
            "storage, read_write": "storage"}[space]}};
    const stored = type.match(/^texture_storage_2d_array<(\w+), write>$/);
    if (stored)
        return {storageTexture: {format: stored[1], viewDimension: "2d-array"}};
    return type === "sampler" ? {sampler: {}} : {texture: {viewDimension: "2d-array"}};
}

// The shaders that `tessera shaders --dialect wgsl` wrote, compiled when they are needed.
export class Shaders {
    #made = new Map();

    // folder: has a folder for each set of macros, such as "plain" or "half"
    constructor(device, folder) {
        this.device = device;
        this.folder = folder;
    }

    code(macros, name) {
        return fs.readFileSync(path.join(this.folder, macros, `${name}.wgsl`), "utf8");
    }

    // The program of a file, to which `entryPoint` is added if it has none.
    async pipeline(macros, name, entryPoint = "") {
        const key = `${macros}/${name}`;
        if (!this.#made.has(key))
            this.#made.set(key, await this.compile(this.code(macros, name) + entryPoint));
        return this.#made.get(key);
    }

    // A compute pipeline, and the bindings of its groups. All that a shader declares is bound, even
    // what it only measures.
    async compile(code) {
        const groups = [];
        const declared = /@group\((\d+)\) @binding\((\d+)\) var(?:<([^>]*)>)? \w+ : ([^;]+);/g;
        for (const [, group, binding, space, type] of code.matchAll(declared)) {
            while (groups.length <= +group)
                groups.push([]);
            groups[+group].push({binding: +binding, visibility: GPUShaderStage.COMPUTE,
                ...layoutOf(space, type)});
        }
        const layout = this.device.createPipelineLayout({bindGroupLayouts:
            groups.map(entries => this.device.createBindGroupLayout({entries}))});
        const module = this.device.createShaderModule({code});
        const pipeline = await this.device.createComputePipelineAsync(
            {layout, compute: {module, entryPoint: "main"}});
        return {pipeline, groups: groups.map(entries => entries.map(entry => entry.binding))};
    }

    // Adds a dispatch. resources: by group and binding, as in {"0:2": {buffer}}; groups: numbers of
    // groups, or a buffer that holds them
    dispatch(encoder, {pipeline, groups: bindings}, resources, groups) {
        const pass = encoder.beginComputePass();
        pass.setPipeline(pipeline);
        bindings.forEach((numbers, group) => {
            const entries = numbers.map(
                binding => ({binding, resource: resources[`${group}:${binding}`]}));
            pass.setBindGroup(group, this.device.createBindGroup(
                {layout: pipeline.getBindGroupLayout(group), entries}));
        });
        if (Array.isArray(groups))
            pass.dispatchWorkgroups(...groups);
        else
            pass.dispatchWorkgroupsIndirect(groups, 0);
        pass.end();
    }
}

export function buffer(device, usage, content) {
    const size = typeof content === "number" ? content : content.byteLength;
    const made = device.createBuffer({size: Math.max(16, size), usage: usage | GPUBufferUsage.COPY_DST});
    if (typeof content !== "number")
        device.queue.writeBuffer(made, 0, content);
    return made;
}

// Decodes a batch into a texture. file: {half, filters}; batch: the fields of DecodeBatch
export async function decodeBatch(shaders, file, batch, tables, texture) {
    const {device} = shaders;
    const usage = GPUBufferUsage;
    const work = buffer(device, usage.STORAGE | usage.COPY_SRC, batch.workWords * 4);
    const own = [buffer(device, usage.STORAGE, batch.words), work,
        buffer(device, usage.STORAGE, batch.coefficients * 16),
        buffer(device, usage.INDIRECT, 12)];
    const [words, , coefficients, groups] = own;
    const resources = {"0:0": {buffer: tables}, "0:1": {buffer: words}, "0:2": {buffer: work},
        "0:3": {buffer: coefficients}, "1:0": texture.createView({dimension: "2d-array"})};
    const format = file.half ? "half" : "plain";
    const keeps = batch.predicted || file.filters ? `${format}_predicted` : format;
    const encoder = device.createCommandEncoder();
    const run = async (macros, name, count) =>
        shaders.dispatch(encoder, await shaders.pipeline(macros, `${name}.comp`), resources, count);
    await run("plain", "tree", [divided(batch.tiles, 16)]);
    await run("plain", "levels", [divided(batch.tiles, 4), batch.mostSegments]);
    if (batch.corrections)
        await run("plain", "corrections", [divided(batch.corrections, 16)]);
    if (batch.rawChunks)
        await run("plain", "order", [Math.min(batch.rawChunks, 1024), divided(batch.rawChunks, 1024)]);
    for (let wave = 0; wave < batch.waves; ++wave) {
        await run("plain", "items", [batch.tiles]);
        await run("plain", "groups", [1]);
        // In WebGPU a dispatch cannot write the buffer that sizes it.
        encoder.copyBufferToBuffer(work, 0, groups, 0, 12);
        await run(keeps, "texels", groups);
        if (wave === 0 && batch.borders)
            await run(format, "border", [batch.tiles]);
    }
    if (file.filters)
        await run(format, "filter", [divided(batch.mostTexels, 64), batch.tiles]);
    device.queue.submit([encoder.finish()]);
    await device.queue.onSubmittedWorkDone();
    own.forEach(one => one.destroy());
}

// The pixels of a texture, as words, without padding.
export async function readTexture(device, texture) {
    const {width, height, depthOrArrayLayers: layers} = texture;
    const pixel = texture.format === "rgba16float" ? 8 : 4;
    const row = divided(width * pixel, 256) * 256;
    const copy = device.createBuffer(
        {size: row * height * layers, usage: GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ});
    const encoder = device.createCommandEncoder();
    encoder.copyTextureToBuffer({texture}, {buffer: copy, bytesPerRow: row, rowsPerImage: height},
                                [width, height, layers]);
    device.queue.submit([encoder.finish()]);
    await copy.mapAsync(GPUMapMode.READ);
    const padded = new Uint32Array(copy.getMappedRange());
    const words = width * pixel / 4;
    const pixels = new Uint32Array(words * height * layers);
    for (let y = 0; y < height * layers; ++y)
        pixels.set(padded.subarray(y * row / 4, y * row / 4 + words), y * words);
    copy.destroy();
    return pixels;
}
