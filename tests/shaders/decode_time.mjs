// Measures the time to decode on WebGPU (Dawn) beside WebAssembly: the table of decoder_glsl/DIALECTS.md.
//   node decode_time.mjs NODE_MODULES SHADERS PACKAGE FILE.tess...
// SHADERS: a folder of folders that `tessera shaders --dialect wgsl` wrote; PACKAGE: build/web/package. WebGPU decodes to
// a texture, WebAssembly to memory, both from the whole file and with its preparation. Times are CPU time of the process,
// the best of several runs, because other work on the machine changes them least. SwiftShader runs the shaders on all
// cores of the CPU.
import fs from "node:fs";
import path from "node:path";
import {pathToFileURL} from "node:url";
import {openDawn} from "./cases.mjs";

const [modules, folder, packageFolder, ...files] = process.argv.slice(2);
const runs = 3;
const imported = name => import(pathToFileURL(path.resolve(packageFolder, name)).href);
const [{loadTessera}, {GpuDecoder}] = [await imported("tessera.js"), await imported("tessera_webgpu.js")];
const codec = await loadTessera(fs.readFileSync(path.join(packageFolder, "tessera_webgpu.wasm")));
const gpu = new GpuDecoder(await openDawn(modules), async (macros, name) =>
    fs.readFileSync(path.join(folder, macros, `${name}.wgsl`), "utf8"));

async function seconds(work, times) {
    let best = Infinity;
    for (let run = 0; run < times; ++run) {
        const start = process.cpuUsage();
        await work();
        const {user, system} = process.cpuUsage(start);
        best = Math.min(best, (user + system) / 1e6);
    }
    return best;
}

for (const name of files) {
    const bytes = fs.readFileSync(name), file = codec.openBytes(bytes), size = file.info.gridSize;
    const box = size.flatMap(n => [0, n]), atlas = new Uint8Array(size.reduce((a, b) => a * b) * 4);
    const onGpu = async () => {
        const {texture} = await gpu.decode(file, box);
        await gpu.device.queue.onSubmittedWorkDone();
        texture.destroy();
    };
    const first = await seconds(onGpu, 1), again = await seconds(onGpu, runs);
    const wasm = await seconds(async () => file.atlas(box.slice(0, 4), atlas), runs);
    console.log(`${path.basename(name)}: ${size.join("x")}, ${bytes.length} bytes, WebGPU ${(again * 1000).toFixed(0)} ms ` +
                `(${first.toFixed(1)} s the first time, with compiling), WebAssembly ${(wasm * 1000).toFixed(1)} ms`);
    file.close();
}
process.exit(0);
