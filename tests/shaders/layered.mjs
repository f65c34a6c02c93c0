// Draws a mesh with all layers by the shaders in WGSL and compares the picture with the CPU's (run.sh).
//   node layered.mjs NODE_MODULES SHADERS CASE      CASE: by layered_case
import fs from "node:fs";
import path from "node:path";
import {openDawn, readCase} from "./cases.mjs";
import {buffer} from "./wgsl_decoder.mjs";

const [modules, folder, file] = process.argv.slice(2);
const device = await openDawn(modules);
let failed = false;
device.addEventListener("uncapturederror", event => {
    console.log(`FAILED: ${event.error.message}`);
    failed = true;
});
const arrays = readCase(file);
const named = what => arrays.find(array => array.name === what).words;
const [width, height, lights] = named("facts");
const textures = arrays.filter(array => array.name === "texture").map(array => array.words);
const parameters = named("parameters");

const module = (macros, name) => device.createShaderModule(
    {code: fs.readFileSync(path.join(folder, macros, `${name}.wgsl`), "utf8")});
// Constants 1 to 11 are the numbers of the layers' textures, which are their roles here.
const constants = Object.fromEntries(textures.slice(1).map((_, i) => [i + 1, i + 1]));
constants[12] = lights;

const fragment = GPUShaderStage.FRAGMENT;
const textureEntries = textures.map((_, binding) => (
    {binding, visibility: fragment, texture: {viewDimension: "2d-array"}}));
const uniform = (binding, visibility) => ({binding, visibility, buffer: {type: "uniform"}});
const groups = [
    [{binding: 4, visibility: fragment, buffer: {type: "read-only-storage"}}],
    [],
    textureEntries,
    [uniform(0, GPUShaderStage.VERTEX), uniform(1, fragment), uniform(2, fragment)]]
    .map(entries => device.createBindGroupLayout({entries}));
const depthFormat = "depth32float", colourFormat = "rgba16float"; // both are exact enough for 8 bits
// The passes of decoder_glsl/README.md: depths, fragments that hide what is behind them, the others.
const passes = [
    {macros: "coverage", blended: 0, depth: {depthWriteEnabled: true, depthCompare: "less"}, writeMask: 0},
    {macros: "plain", blended: 0, depth: {depthWriteEnabled: false, depthCompare: "less-equal"}},
    {macros: "plain", blended: 1, depth: {depthWriteEnabled: false, depthCompare: "less"},
     blend: {srcFactor: "one", dstFactor: "one-minus-src-alpha"}},
];
const layout = device.createPipelineLayout({bindGroupLayouts: groups});
const pipelineOf = ({macros, blended, depth, blend, writeMask = GPUColorWrite.ALL}) => device.createRenderPipelineAsync({
    layout,
    vertex: {module: module("plain", "mesh.vert"), buffers: [{arrayStride: 44, attributes: [
        {shaderLocation: 0, offset: 0, format: "float32x3"}, {shaderLocation: 1, offset: 12, format: "float32x3"},
        {shaderLocation: 2, offset: 24, format: "float32x3"}, {shaderLocation: 3, offset: 36, format: "float32x2"}]}]},
    fragment: {module: module(macros, "layered_mesh.frag"), constants: {...constants, 13: blended}, targets: [
        {format: colourFormat, writeMask, blend: blend && {color: blend, alpha: blend}}]},
    depthStencil: {format: depthFormat, ...depth},
});
const pipelines = await Promise.all(passes.map(pipelineOf));

const texture = (words, i) => {
    const [w, h] = parameters.subarray(i * 32 + 22, i * 32 + 24);
    const made = device.createTexture({size: [w, h, 1], format: "rgba8unorm",
        usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST});
    device.queue.writeTexture({texture: made}, words, {bytesPerRow: w * 4, rowsPerImage: h}, [w, h, 1]);
    return made.createView({dimension: "2d-array"});
};
const uniforms = (content, bytes = content.byteLength) => {
    const made = buffer(device, GPUBufferUsage.UNIFORM, bytes);
    device.queue.writeBuffer(made, 0, content);
    return {buffer: made};
};
const target = device.createTexture({size: [width, height], format: colourFormat,
    usage: GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.COPY_SRC});
const depth = device.createTexture({size: [width, height], format: depthFormat,
    usage: GPUTextureUsage.RENDER_ATTACHMENT});
const encoder = device.createCommandEncoder();
const pass = encoder.beginRenderPass({
    colorAttachments: [{view: target.createView(), loadOp: "clear", storeOp: "store", clearValue: [0, 0, 0, 0]}],
    depthStencilAttachment: {view: depth.createView(), depthLoadOp: "clear", depthStoreOp: "store",
        depthClearValue: 1}});
const bind = (group, entries) =>
    pass.setBindGroup(group, device.createBindGroup({layout: groups[group], entries}));
bind(0, [{binding: 4, resource: {buffer: buffer(device, GPUBufferUsage.STORAGE, named("words"))}}]);
bind(1, []);
bind(2, textures.map((words, binding) => ({binding, resource: texture(words, binding)})));
bind(3, [{binding: 0, resource: uniforms(named("view"))},
    // Room for 1,024 lights.
    {binding: 1, resource: uniforms(named("layers"), (textures.length + 2 * 1024) * 16)},
    {binding: 2, resource: uniforms(parameters)}]);
pass.setVertexBuffer(0, buffer(device, GPUBufferUsage.VERTEX, named("vertices")));
for (const pipeline of pipelines) {
    pass.setPipeline(pipeline);
    pass.draw(named("vertices").length / 11);
}
pass.end();
const row = Math.ceil(width * 8 / 256) * 256;
const copy = device.createBuffer({size: row * height, usage: GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ});
encoder.copyTextureToBuffer({texture: target}, {buffer: copy, bytesPerRow: row}, [width, height]);
device.queue.submit([encoder.finish()]);
await copy.mapAsync(GPUMapMode.READ);
const got = new Uint16Array(copy.getMappedRange());
const halfOf = bits => {
    const exponent = bits >> 10 & 31, fraction = bits & 1023;
    return exponent ? 2 ** (exponent - 15) * (1 + fraction / 1024) : fraction * 2 ** -24;
};
// The target holds linear light.
const displayed = light => light <= 0.0031308 ? 12.92 * light : 1.055 * light ** (1 / 2.4) - 0.055;
const expected = new Float32Array(named("picture").buffer);

// Where a highlight or a fold of the angular map is steep, single and double precision may differ by more
// than a step of 8 bits, and pixels at the rim of a hole belong to it or not by the last bit of their place.
const mostOff = 0.005; // share of the pixels
let worst = 0, off = 0, drawn = 0, holes = 0;
for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) {
        const pixel = y * row / 2 + x * 4;
        const hole = got[pixel + 3] === 0;
        holes += hole ? 1 : 0;
        let most = 0;
        for (let k = 0; k < 3; ++k)
            most = Math.max(most, 255 * Math.abs(displayed(Math.min(halfOf(got[pixel + k]), 1)) -
                                                 expected[(y * width + x) * 3 + k]));
        if (hole !== [0, 1, 2].every(k => expected[(y * width + x) * 3 + k] === 0) || !(most <= 1))
            ++off;
        else
            worst = Math.max(worst, most);
        drawn += hole ? 0 : 1;
    }
failed ||= off > mostOff * drawn || drawn === 0 || holes === 0;
console.log(`${failed ? "FAILED: " : ""}layers: ${drawn} pixels with ${textures.length} layers and ${lights} lights, ` +
            `${holes} in holes; ${off} are more than 1 of 255 off, the others at most ${worst.toFixed(3)}`);
process.exit(failed ? 1 : 0);
