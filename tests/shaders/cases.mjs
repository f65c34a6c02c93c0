// Reads what shader_cases wrote, and opens Dawn.
import fs from "node:fs";
import path from "node:path";
import {pathToFileURL} from "node:url";

let gpu; // Dawn ends with this object

// A device of Dawn, which the npm package webgpu in the folder `modules` contains.
export async function openDawn(modules) {
    const {create, globals} = await import(pathToFileURL(path.join(modules, "webgpu/index.js")));
    Object.assign(globalThis, globals);
    gpu = create([]);
    const adapter = await gpu.requestAdapter();
    if (!adapter)
        throw new Error("Dawn finds no adapter: VK_ICD_FILENAMES names no Vulkan driver");
    const {vendor, architecture, description} = adapter.info;
    console.log(`Dawn on ${vendor} ${architecture} ${description}`);
    const wanted = ["maxStorageBufferBindingSize", "maxBufferSize", "maxComputeWorkgroupStorageSize"];
    return adapter.requestDevice(
        {requiredLimits: Object.fromEntries(wanted.map(name => [name, adapter.limits[name]]))});
}

// The arrays of a case: {name, words}, in their order.
export function readCase(file) {
    const bytes = fs.readFileSync(file);
    const arrays = [];
    for (let at = 0; at < bytes.length;) {
        const end = bytes.indexOf(10, at);
        const [name, words] = bytes.toString("latin1", at, end).split(" ");
        const from = bytes.byteOffset + end + 1;
        arrays.push({name, words: new Uint32Array(bytes.buffer.slice(from, from + 4 * words))});
        at = end + 1 + 4 * words;
    }
    return arrays;
}

const batchFields = ["tiles", "mostSegments", "rawChunks", "corrections", "waves", "mostTexels",
    "predicted", "borders", "workWords", "coefficients"];

// The batches of a case, with the pixels that they must give.
export function* batchesOf(arrays) {
    for (let i = 0; i < arrays.length; ++i) {
        if (arrays[i].name !== "batch")
            continue;
        const batch = Object.fromEntries(batchFields.map((field, k) => [field, arrays[i].words[k]]));
        batch.words = arrays[i + 1].words;
        yield {batch, pixels: arrays[i + 2].words, painted: arrays[i + 3].words};
    }
}
