// Adds a worker to the viewer that decodes tiles by WebGPU. The viewer fetches this file and those that it uses only
// where the browser has WebGPU; until the shaders are compiled, the other workers do everything.

const address = name => new URL(`?viewer=${name}`, location);
async function fetched(name) {
    const answer = await fetch(address(name));
    if (!answer.ok)
        throw Error(`${name}: the server responded with status ${answer.status}`);
    return answer;
}

// Runs in the worker. Its file decodes boxes on the GPU, or by WebAssembly once the GPU has failed.
async function loadOnGpu(wasm, {folder, software}) {
    const codec = await loadTessera(wasm);
    let gpu = await openGpu(async (macros, name) => (await fetch(`${folder}wgsl/${macros}/${name}.wgsl`)).text(),
                            {software}), tiles = 0;
    if (!gpu)
        throw Error('there is no WebGPU in workers');
    const hooked = file => {
        const {fetchGridBox} = file;
        return Object.assign(file, {async fetchGridBox(box, out) {
            if (gpu)
                try {
                    const texels = await gpu.texels(this, box, out);
                    postMessage({gpu: {tiles: ++tiles}});
                    return texels;
                } catch (error) {
                    gpu?.close();
                    gpu = null;
                    postMessage({gpu: {failed: error.message}});
                }
            return fetchGridBox.call(this, box, out);
        }});
    };
    return {openBytes: bytes => hooked(codec.openBytes(bytes)), openSource: async source => hooked(await codec.openSource(source))};
}

// Ends without a change of the viewer if the device differs from the CPU in the first tile. viewer.gpu says what the
// worker does: {tiles: number of decoded boxes, failed: why it stopped using the GPU}.
export async function join(viewer) {
    const {kit, workers, cache} = viewer, software = viewer.hash.has('webgpu');
    const adapter = await navigator.gpu.requestAdapter();
    if (!adapter || adapter.info.isFallbackAdapter && !software)
        return;
    const [module, wasm] = await Promise.all(
        [fetched('tessera_webgpu.js').then(answer => answer.text()),
         fetched('tessera_webgpu.wasm').then(answer => answer.arrayBuffer())]);
    const options = JSON.stringify({folder: String(address('')), software});
    const code = [...['tessera.js', 'slot_layout.js', 'tile_worker.js'].map(kit.text), module, loadOnGpu].join('\n');
    const worker = workers.start(URL.createObjectURL(new Blob(
        [code.replace(/^export /gm, ''), `\nstartTileWorker(wasm => loadOnGpu(wasm, ${options}));`], {type: 'text/javascript'})));
    const {onmessage} = worker.thread;
    viewer.gpu = {};
    worker.thread.onmessage = event => event.data.gpu ? Object.assign(viewer.gpu, event.data.gpu) : onmessage(event);
    try {
        await workers.job(worker, {job: 'open', wasm, bytes: workers.bytes, size: workers.source?.size});
        await workers.job(worker, workers.prepared);
        const job = {job: 'tile', box: cache.grid.box(0)};
        const [own, other] = await Promise.all([workers.job(worker, job), workers.run(job)]);
        if (!own.pixels.every((sample, i) => sample === other.pixels[i]))
            viewer.gpu.failed = 'the device decodes other texels than the CPU';
    } catch (error) {
        viewer.gpu.failed = error.message;
    }
    if (viewer.gpu.failed)
        return worker.thread.terminate();
    workers.workers.push(worker);
    viewer.gpu.joined = true;
}
