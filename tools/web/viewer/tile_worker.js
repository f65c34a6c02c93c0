// Runs in workers together with tessera.js and slot_layout.js. It opens the file with its layers and decodes tiles to
// pixels of slots.

function startTileWorker(load = loadTessera) {
    let file, layers = []; // of each layer: its file, then what "prepare" says about it
    const reads = new Map();
    let lastRead = 0;

    const readFromPage = (offset, length) => new Promise((resolve, reject) => {
        reads.set(++lastRead, {resolve, reject});
        postMessage({read: lastRead, offset, length});
    });
    const isHalf = ({info}) => info.sampleType === SAMPLE_TYPE.half16;
    const asSamples = (texels, half) => half
        ? new Uint16Array(texels.buffer.slice(texels.byteOffset, texels.byteOffset + texels.byteLength)) : texels;

    const jobs = {
        async open({wasm, bytes, size}) {
            const codec = await load(wasm);
            file = bytes ? codec.openBytes(bytes) : await codec.openSource({size, read: readFromPage});
            const {scale, lights, further} = await file.fetchLayers();
            layers = [{file}, ...further];
            return {info: file.info, scale, lights,
                    further: further.map(({role, scale, file}) => ({role, scale, info: file.info}))};
        },
        // parts: for each layer {tileSide, mips, chartIds, chartSize, lights}. lights: number of directions that
        // packed() keeps; 0: all of them, not packed.
        prepare({parts}) {
            layers = layers.map((layer, i) => {
                const {tileSide, mips, chartIds, chartSize, lights} = parts[i];
                return {...layer, lights, layout: new SlotLayout(tileSide, mips),
                        charts: mips ? new Charts(chartIds, chartSize, mips) : null};
            });
            return {};
        },
        async tile({box, layer = 0}) {
            const {file, layout, charts, lights} = layers[layer], half = isHalf(file), {channels, size} = file.info;
            const texels = asSamples(await file.fetchGridBox(box), half);
            if (!lights)
                return {pixels: slotPixels(texels, box, channels, half, layout, charts, layer > 0)};
            const places = [...box.slice(0, 4), ...packedSides(lights).flatMap(n => [0, n])];
            return {pixels: slotPixels(packed(texels, size[2] * size[3], lights), places, 4, half, layout, charts, true)};
        },
        // A whole coarse level, in the layout of one large tile without mips.
        async coarse({level}) {
            const {size} = file.info.levels[level], box = size.flatMap(n => [0, n]);
            const whole = new SlotLayout(size, 0);
            const half = isHalf(file), texels = asSamples(await file.fetchBox(box, undefined, level), half);
            return {pixels: slotPixels(texels, box, file.info.channels, half, whole, null)};
        },
    };

    onmessage = async ({data}) => {
        if (data.bytesOf) {
            const read = reads.get(data.bytesOf);
            reads.delete(data.bytesOf);
            return data.error ? read.reject(Error(data.error)) : read.resolve(data.bytes);
        }
        try {
            const answer = await jobs[data.job](data);
            postMessage({id: data.id, ...answer}, answer.pixels ? [answer.pixels.buffer] : []);
        } catch (error) {
            postMessage({id: data.id, error: String(error.message || error), gone: !!file?.closed});
        }
    };
}
