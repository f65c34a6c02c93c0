// Measures the time to decode on WebGPU (Dawn) beside WebAssembly: the table of decoder_glsl/DIALECTS.md.
//   node decode_time.mjs NODE_MODULES SHADERS PACKAGE FILE.tess CASE [FILE.tess CASE...]
// PACKAGE: build/web/package. Times are CPU time of the process, the best of several runs, because other work
// on the machine changes them least. SwiftShader runs the shaders on all cores of the CPU.
import fs from "node:fs";
import path from "node:path";
import {pathToFileURL} from "node:url";
import {batchesOf, openDawn, readCase} from "./cases.mjs";
import {Shaders, buffer, decodeBatch} from "./wgsl_decoder.mjs";

const [modules, folder, packageFolder, ...files] = process.argv.slice(2);
const runs = 5;
const device = await openDawn(modules);
const {loadTessera} = await import(pathToFileURL(path.resolve(packageFolder, "tessera.js")).href);
const codec = await loadTessera(fs.readFileSync(path.join(packageFolder, "tessera.wasm")));
const shaders = new Shaders(device, folder);

async function milliseconds(work) {
    let best = Infinity;
    for (let run = 0; run < runs; ++run) {
        const start = process.cpuUsage();
        await work();
        const {user, system} = process.cpuUsage(start);
        best = Math.min(best, (user + system) / 1000);
    }
    return best.toFixed(0);
}

async function decodeOnGpu(file, tables, batches) {
    for (const {batch} of batches) {
        const texture = device.createTexture({size: [file.width, file.height, batch.tiles],
            format: file.half ? "rgba16float" : "rgba8unorm", usage: GPUTextureUsage.STORAGE_BINDING});
        await decodeBatch(shaders, file, batch, tables, texture);
        texture.destroy();
    }
}

for (let i = 0; i + 1 < files.length; i += 2) {
    const opened = codec.openBytes(fs.readFileSync(files[i]));
    const [U, V, S, T] = opened.info.size;
    const atlas = new Uint8Array(U * V * S * T * 4);
    const arrays = readCase(files[i + 1]);
    const named = what => arrays.find(array => array.name === what).words;
    const [half, filters, , width, height] = named("facts");
    const file = {half: half !== 0, filters: filters !== 0, width, height};
    const tables = buffer(device, GPUBufferUsage.STORAGE, named("tables"));
    const batches = [...batchesOf(arrays)];
    const start = performance.now();
    await decodeOnGpu(file, tables, batches);
    const first = ((performance.now() - start) / 1000).toFixed(1);
    const gpu = await milliseconds(() => decodeOnGpu(file, tables, batches));
    const wasm = await milliseconds(async () => opened.atlas([0, U, 0, V], atlas));
    console.log(`${path.basename(files[i])}: ${U}x${V}x${S}x${T}, WebGPU ${gpu} ms ` +
                `(${first} s the first time, with compiling), WebAssembly ${wasm} ms`);
    opened.close();
}
process.exit(0);
