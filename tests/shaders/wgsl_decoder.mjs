// The passes of the decoder in WGSL, as the npm package runs them, for batches that shader_cases wrote.
import fs from "node:fs";
import path from "node:path";
import {Shaders as PackageShaders, addBatch, buffer} from "../../tools/web/package/tessera_webgpu.js";

export {buffer};

// The shaders that `tessera shaders --dialect wgsl` wrote. folder: has a folder for each set of macros, such as "plain"
export class Shaders extends PackageShaders {
    constructor(device, folder) {
        super(device, async (macros, name) => fs.readFileSync(path.join(folder, macros, `${name}.wgsl`), "utf8"));
    }
}

// Decodes a batch into a texture. file: {half, filters}; batch: the fields of DecodeBatch
export async function decodeBatch(shaders, file, batch, tables, texture) {
    const {device} = shaders, encoder = device.createCommandEncoder();
    const own = await addBatch(shaders, encoder, file, batch, tables, texture);
    device.queue.submit([encoder.finish()]);
    await device.queue.onSubmittedWorkDone();
    own.forEach(one => one.destroy());
}

// The pixels of a texture, as words, without padding.
export async function readTexture(device, texture) {
    const {width, height, depthOrArrayLayers: layers} = texture;
    const pixel = texture.format === "rgba16float" ? 8 : 4;
    const row = Math.ceil(width * pixel / 256) * 256;
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
