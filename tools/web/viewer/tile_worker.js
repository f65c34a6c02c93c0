// Runs in workers together with tessera.js and slot_layout.js. It opens the file and decodes tiles to pixels of slots.

function startTileWorker() {
    let file, layout, charts = null;
    const reads = new Map();
    let lastRead = 0;

    const readFromPage = (offset, length) => new Promise((resolve, reject) => {
        reads.set(++lastRead, {resolve, reject});
        postMessage({read: lastRead, offset, length});
    });
    const isHalf = () => file.info.sampleType === SAMPLE_TYPE.half16;
    const asSamples = texels => isHalf()
        ? new Uint16Array(texels.buffer.slice(texels.byteOffset, texels.byteOffset + texels.byteLength)) : texels;

    const jobs = {
        async open({wasm, bytes, size}) {
            const codec = await loadTessera(wasm);
            file = bytes ? codec.openBytes(bytes) : await codec.openSource({size, read: readFromPage});
            return {info: file.info};
        },
        prepare({tileSide, chartIds, chartSize, mips}) {
            layout = new SlotLayout(tileSide, mips);
            charts = mips ? new Charts(chartIds, chartSize, mips) : null;
            return {};
        },
        async tile({box}) {
            const texels = asSamples(await file.fetchGridBox(box));
            return {pixels: slotPixels(texels, box, file.info.channels, isHalf(), layout, charts)};
        },
        // A whole coarse level, in the layout of one large tile without mips.
        async coarse({level}) {
            const {size} = file.info.levels[level], box = size.flatMap(n => [0, n]);
            const whole = new SlotLayout(size, 0);
            const texels = asSamples(await file.fetchBox(box, undefined, level));
            return {pixels: slotPixels(texels, box, file.info.channels, isHalf(), whole, null)};
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
