// Runs the shaders in WGSL by Dawn and compares what they give with the CPU (run.sh).
//   node dawn.mjs NODE_MODULES SHADERS CASE...
// SHADERS: a folder of folders that `tessera shaders --dialect wgsl` wrote; CASE: by shader_cases
import fs from "node:fs";
import path from "node:path";
import {batchesOf, openDawn, readCase} from "./cases.mjs";
import {Shaders, buffer, decodeBatch, readTexture} from "./wgsl_decoder.mjs";

const [modules, folder, ...cases] = process.argv.slice(2);
const device = await openDawn(modules);
let failures = 0;
function report(good, text) {
    failures += good ? 0 : 1;
    console.log(good ? text : `FAILED: ${text}`);
}
device.addEventListener("uncapturederror", event => report(false, event.error.message));

// Validates every shader; those that the passes below need are also run.
async function validateAll() {
    let count = 0;
    for (const macros of fs.readdirSync(folder))
        for (const name of fs.readdirSync(path.join(folder, macros))) {
            device.pushErrorScope("validation");
            const module = device.createShaderModule(
                {code: fs.readFileSync(path.join(folder, macros, name), "utf8")});
            const {messages} = await module.getCompilationInfo();
            const wrong = messages.find(message => message.type === "error");
            await device.popErrorScope();
            ++count;
            if (wrong)
                report(false, `${macros}/${name}:${wrong.lineNum}: ${wrong.message}`);
        }
    console.log(`${count} shaders are valid WGSL unless FAILED stands above`);
}

function countDifferences(got, expected, painted, perPixel) {
    let differences = 0, texels = 0;
    for (let i = 0; i < painted.length; ++i) {
        if (!painted[i])
            continue;
        ++texels;
        for (let k = 0; k < perPixel; ++k)
            if (got[i * perPixel + k] !== expected[i * perPixel + k]) {
                ++differences;
                break;
            }
    }
    return {texels, differences};
}

// Returns the texture of the last batch, which holds one tile per layer.
async function checkDecoding(shaders, name, file, arrays) {
    const tables = buffer(device, GPUBufferUsage.STORAGE, arrays.find(a => a.name === "tables").words);
    let texture, texels = 0, differences = 0, waves = 0;
    for (const {batch, pixels, painted} of batchesOf(arrays)) {
        texture?.destroy();
        const {STORAGE_BINDING, TEXTURE_BINDING, COPY_SRC} = GPUTextureUsage;
        texture = device.createTexture({size: [file.width, file.height, batch.tiles],
            format: file.half ? "rgba16float" : "rgba8unorm",
            usage: STORAGE_BINDING | TEXTURE_BINDING | COPY_SRC});
        await decodeBatch(shaders, file, batch, tables, texture);
        const found = countDifferences(await readTexture(device, texture), pixels, painted,
                                       file.half ? 2 : 1);
        texels += found.texels;
        differences += found.differences;
        waves = Math.max(waves, batch.waves);
    }
    tables.destroy();
    report(differences === 0 && texels > 0,
           `${name}: ${texels} texels in ${waves} waves, ${differences} differ from the CPU's`);
    return texture;
}

// A program that calls the sampler, as an application would.
const probeProgram = `
struct Probe { a : vec4<f32>, b : vec4<f32>, c : vec4<f32>, d : vec4<f32> }
@group(0) @binding(7) var<storage, read_write> probes : array<Probe>;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id : vec3<u32>) {
  if (id.x >= arrayLength(&probes)) { return; }
  let p = probes[id.x];
  let sphere = tessera_sample(p.a.xyz, p.b.xyz);
  let surface = tessera_sample_surface(p.d.xy, p.a.xyz, p.c.xyz, p.b.xyz, p.d.zw);
  probes[id.x] = Probe(sphere, surface, vec4<f32>(0.0), vec4<f32>(0.0));
}
`;

// The largest difference of samples to the CPU's, in 1/255 of the largest value of halves, else of 1:
// on the sphere and on the mesh.
async function sampleDifferences(shaders, macros, words, texture, probes, values, surfaceAt, channels) {
    const made = await shaders.pipeline(macros, "sample", probeProgram);
    const usage = GPUBufferUsage;
    const points = buffer(device, usage.STORAGE | usage.COPY_SRC, probes);
    const resources = {"0:4": {buffer: buffer(device, usage.STORAGE, words)},
        "0:5": {buffer: buffer(device, usage.STORAGE, 4096)}, "0:7": {buffer: points},
        "2:0": texture.createView({dimension: "2d-array"}),
        "2:12": device.createSampler({magFilter: "linear", minFilter: "linear"}),
        "3:2": {buffer: buffer(device, usage.UNIFORM, words.subarray(0, 32))}};
    const encoder = device.createCommandEncoder();
    const count = probes.length / 16;
    shaders.dispatch(encoder, made, resources, [Math.ceil(count / 64)]);
    const copy = device.createBuffer({size: probes.byteLength, usage: usage.COPY_DST | usage.MAP_READ});
    encoder.copyBufferToBuffer(points, 0, copy, 0, probes.byteLength);
    device.queue.submit([encoder.finish()]);
    await copy.mapAsync(GPUMapMode.READ);
    const got = new Float32Array(copy.getMappedRange());
    const most = [0, 0];
    for (let i = 0; i < count; ++i)
        for (let k = 0; k < (channels < 3 ? 1 : channels); ++k)
            for (const [which, at] of [[0, 0], [1, surfaceAt]]) {
                const difference = Math.abs(got[i * 16 + which * 4 + k] - values[i * 12 + at * 4 + k]);
                if (!(difference <= most[which])) // also where it is not a number
                    most[which] = difference;
            }
    const range = words[17] ? values.reduce((a, b) => Math.max(a, Math.abs(b)), 0) : 1;
    return most.map(difference => difference / range * 255);
}

// The largest difference between halves in steps between neighbouring halves. Means may be rounded
// otherwise in the last bit.
function mostHalfSteps(a, b) {
    const ordered = half => half & 0x8000 ? -(half & 0x7FFF) : half;
    const halves = words => new Uint16Array(words.buffer, words.byteOffset, 2 * words.length);
    const [left, right] = [halves(a), halves(b)];
    return left.reduce((most, half, i) => Math.max(most, Math.abs(ordered(half) - ordered(right[i]))), 0);
}

// Computes the mips beside the atlas, in a second texture, and compares them with the CPU's.
async function checkMips(shaders, name, file, expected, words, jobs, channels) {
    const {COPY_DST, COPY_SRC, TEXTURE_BINDING, STORAGE_BINDING} = GPUTextureUsage;
    const size = [words[22], words[23], 1];
    const format = file.half ? "rgba16float" : "rgba8unorm";
    const perPixel = file.half ? 2 : 1;
    const upload = (texture, pixels) => device.queue.writeTexture(
        {texture}, pixels, {bytesPerRow: size[0] * perPixel * 4, rowsPerImage: size[1]}, size);
    const atlas = device.createTexture({size, format, usage: COPY_DST | TEXTURE_BINDING});
    upload(atlas, expected);
    const usage = COPY_SRC | COPY_DST | TEXTURE_BINDING | STORAGE_BINDING;
    const texture = device.createTexture({size, format, usage});
    // The atlas alone, to which the pass adds its mips. Other texels are 0, of alpha 1 if there is no
    // alpha.
    const alone = expected.slice();
    const [width, height] = [words[0] * words[2], words[1] * words[3]];
    const opaque = channels % 2 ? (file.half ? 0x3C000000 : 0xFF000000) : 0;
    for (let i = 0; i < alone.length; ++i) {
        const pixel = Math.floor(i / perPixel);
        if (pixel % size[0] >= width || pixel >= height * size[0])
            alone[i] = i % perPixel === perPixel - 1 ? opaque : 0;
    }
    upload(texture, alone);
    if (words[26]) {
        const encoder = device.createCommandEncoder();
        const storage = content => ({buffer: buffer(device, GPUBufferUsage.STORAGE, content)});
        const resources = {"0:1": storage(jobs), "0:4": storage(words),
            "1:0": texture.createView({dimension: "2d-array"}),
            "2:1": atlas.createView({dimension: "2d-array"})};
        shaders.dispatch(encoder, await shaders.pipeline(file.half ? "half" : "plain", "mips.comp"),
                         resources, [words[0] * words[1], jobs.length / 8]);
        device.queue.submit([encoder.finish()]);
    }
    const got = await readTexture(device, texture);
    if (file.half) {
        const most = mostHalfSteps(got, expected);
        report(most <= 1, `${name}: ${words[26]} mips of halves, at most ${most} steps off the CPU's`);
    } else {
        const wrong = got.filter((word, i) => word !== expected[i]).length;
        report(wrong === 0, `${name}: ${words[26]} mips, ${wrong} words differ from the CPU's`);
    }
    atlas.destroy();
    return texture;
}

await validateAll();
const shaders = new Shaders(device, folder);
for (const one of cases) {
    const name = path.basename(one, ".case");
    const arrays = readCase(one);
    const named = what => arrays.find(array => array.name === what)?.words;
    const [half, filters, , width, height, batches, channels] = named("facts");
    const file = {half: half !== 0, filters: filters !== 0, width, height};
    const tiles = await checkDecoding(shaders, name, file, arrays);
    if (named("probes") && batches === 1) {
        const texture = await checkMips(shaders, name, file, named("texture"), named("plain_words"),
                                        named("jobs"), channels);
        const probes = named("probes"), values = new Float32Array(named("values").buffer);
        for (const [macros, words, from, surfaceAt] of [
            ["plain", "plain_words", texture, 1], ["filter", "plain_words", texture, 1],
            ["cache", "cache_words", tiles, 2], ["cache_filter", "cache_words", tiles, 2]]) {
            const most = await sampleDifferences(shaders, macros, named(words), from, probes, values,
                                                 surfaceAt, channels);
            // A filter of the hardware may round its weights to 8 bits, along two axes: up to half a
            // step each, and as much where it rounds the result.
            const allowed = macros.includes("filter") ? 1.5 : 1;
            report(most.every(difference => difference <= allowed),
                   `${name}, ${macros}: ${probes.length / 16} samples, at most ` +
                   `${most.map(x => x.toFixed(3)).join(" (sphere) and ")} (mesh) of 255 off`);
        }
        texture.destroy();
    }
    tiles.destroy();
}
console.log(failures ? `${failures} checks failed` : "all checks passed");
process.exit(failures ? 1 : 0);
