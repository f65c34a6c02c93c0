// Decodes whole files by the npm package's decoder on WebGPU (Dawn), and compares the texels with WebAssembly's (run.sh).
//   node package_decoder.mjs NODE_MODULES SHADERS PACKAGE FILE.tess...
// PACKAGE: build/web/package
import fs from "node:fs";
import path from "node:path";
import {pathToFileURL} from "node:url";
import {openDawn} from "./cases.mjs";

const [modules, folder, packageFolder, ...files] = process.argv.slice(2);
const device = await openDawn(modules);
const imported = name => import(pathToFileURL(path.resolve(packageFolder, name)).href);
const [{loadTessera}, {GpuDecoder}] = [await imported("tessera.js"), await imported("tessera_webgpu.js")];
const codec = await loadTessera(fs.readFileSync(path.join(packageFolder, "tessera_webgpu.wasm")));
const gpu = new GpuDecoder(device, async (macros, name) =>
    fs.readFileSync(path.join(folder, macros, `${name}.wgsl`), "utf8"));
let failures = 0;
for (const name of files) {
    const bytes = fs.readFileSync(name), file = codec.openBytes(bytes), size = file.info.gridSize;
    // A part of the tiles, and of a tile, as well.
    for (const box of [size.flatMap(n => [0, n]), size.flatMap(n => [n >> 1, (n >> 1) + 1])]) {
        const expected = await file.fetchGridBox(box);
        const got = await gpu.texels(file, box).catch(error => error);
        const good = got instanceof Uint8Array && Buffer.compare(got, expected) === 0;
        failures += good ? 0 : 1;
        console.log(`${good ? "" : "FAILED: "}${path.basename(name)} [${box}]: ` +
                    (got instanceof Error ? got.message : `${expected.length} bytes ${good ? "are equal" : "differ"}`));
    }
    file.close();
}
process.exit(failures ? 1 : 0);
