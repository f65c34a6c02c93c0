// The page around the viewer: its elements, its messages and its start.

class Page {
    constructor() {
        for (const name of ['canvas', 'note', 'figures', 'help', 'poster'])
            this[name] = document.getElementById(name);
        this.buttons = document.getElementById('buttons');
    }

    say(text) {
        this.note.textContent = text;
        this.note.hidden = !text;
    }
    fail(error) {
        this.say(error.message || String(error));
        this.note.classList.add('error');
        document.title = 'Error';
        console.error(error);
    }
    toggle(name) {
        this[name].hidden = !this[name].hidden;
    }

    // Called after each frame.
    update(viewer) {
        const {loader, renderer, cache, layers} = viewer;
        if (!this.begun && (renderer.coarse || !loader.busy && viewer.searched !== 'not')) {
            this.begun = performance.now(); // since the page was opened
            this.bytesAtFirst = viewer.source ? viewer.source.received : 0;
            this.poster.hidden = true;
            this.say('');
        }
        if (!this.whole && !loader.busy && viewer.searched === 'all')
            this.whole = performance.now();
        if (loader.failed.size && !this.note.textContent)
            this.say(`${loader.failed.size} tiles could not be loaded: ${loader.failed.values().next().value}`);
        if (layers?.trouble && !this.note.textContent)
            this.say(layers.trouble);
        if (this.figures.hidden)
            return;
        const {info, source} = viewer, ms = viewer.drawTime;
        const lines = [
            `first picture after ${this.begun?.toFixed(0)} ms`,
            `${info.size.join(' x ')}, ${inBytes(viewer.fileBytes)}`,
            ms ? `${(1000 / ms).toFixed(0)} frames per second` : 'idle',
            `${cache.tiles.size} of ${cache.grid.tiles} tiles, ${loader.queue.length + loader.coming.size} loading`,
            `${inBytes(renderer.bytes)} of GPU memory`
        ];
        if (layers)
            lines.push(`${1 + Object.keys(layers.loaded).length} of ${1 + layers.layers.length} layers`);
        if (source)
            lines.push(`${inBytes(source.received)} received in ${source.asked} requests`);
        this.figures.textContent = lines.join('\n');
    }

    listen(viewer) {
        this.buttons.addEventListener('click', event => {
            const action = event.target.dataset.action;
            if (action)
                viewer[action]();
        });
    }
}

const inBytes = n => n < 1e3 ? `${n} bytes` : n < 1e6 ? `${(n / 1e3).toFixed(1)} kB` : `${(n / 1e6).toFixed(1)} MB`;

// Splits view data (tools/page/view_data.h) into its JSON line and the bytes behind it: {about, rest}. Returns null if
// the bytes are something else.
function parsedViewData(bytes) {
    const end = bytes.indexOf(10);
    if (end < 0 || bytes[0] !== 123) // {
        return null;
    return {about: JSON.parse(new TextDecoder().decode(bytes.subarray(0, end))), rest: bytes.subarray(end + 1)};
}

// Requests the view data that `tessera serve` offers. Other servers send the file itself or an error; then the result
// is null. texture: as for glbPayload().
async function fetchedViewData(url, texture = '') {
    try {
        const answer = await fetch(`${url}?view=${texture}`, {headers: {Range: 'bytes=0-'}});
        const type = answer.headers.get('Content-Type') || '';
        if (!answer.ok || !type.includes('x-tessera-view')) {
            answer.body?.cancel();
            return null;
        }
        return parsedViewData(await unpacked(new Uint8Array(await answer.arrayBuffer())));
    } catch {
        return null;
    }
}

// Shows the file in the page or the one that the URL names. kit: see page.html. element(id) returns the decoded bytes
// of an element of the page, or null.
async function showPage(kit, element) {
    const page = new Page(), viewer = new Viewer(kit, page);
    window.tessera = viewer; // for scripts
    try {
        const bytes = element('file'), data = element('data');
        if (bytes) {
            await viewer.start({bytes, viewData: unpacked(data).then(parsedViewData)});
        } else {
            const asked = new URLSearchParams(location.search), name = asked.get('f');
            const texture = asked.get('texture') ?? undefined;
            if (!name)
                throw Error('The URL names no file. Open this page as ?f=NAME.tess');
            // A full URL is used unchanged. In the name of a file, characters with a meaning in URLs are encoded.
            const path = /^https?:\/\//.test(name) ? name : name.split('/').map(encodeURIComponent).join('/');
            const url = new URL(path, location.origin + location.pathname).href;
            document.title = name;
            await viewer.start({url, texture, viewData: fetchedViewData(url, texture)});
        }
        page.listen(viewer);
    } catch (error) {
        page.fail(error);
    }
}
