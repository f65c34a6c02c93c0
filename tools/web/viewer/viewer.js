// The viewer opens the file, loads tiles and draws when something has changed. page.html contains its elements.

const usualFov = 45;
const usualCache = 256; // MiB of tiles on the GPU
const smallFile = 1 << 18; // bytes; files up to this size are fetched whole

class Viewer {
    // kit: text(name), bytes(name); page: {canvas, note, figures, help, poster}.
    constructor(kit, page) {
        Object.assign(this, {kit, page, frames: [], waiting: [], ray: 0, restsUntil: 0, drawn: null});
        this.hash = new URLSearchParams(location.hash.slice(1));
    }

    // inputs: {bytes} or {url, texture}, and {viewData}: a promise of the result of parsedViewData(). texture: as for
    // glbPayload().
    async start(inputs) {
        this.gl = this.context();
        this.source = inputs.url ? await new RemoteSource(inputs.url, text => this.page.say(text)).open() : null;
        const file = this.source && await glbPayload(this.source, inputs.texture);
        this.fileBytes = inputs.bytes ? inputs.bytes.length : file.size;
        this.bytes = inputs.bytes || null;
        if (file && file.size <= smallFile && !this.hash.has('parts'))
            this.bytes = await file.read(0, file.size);
        this.workers = new Workers(this.kit, this.bytes ? null : file, this.bytes);
        this.opened = await this.workers.open();
        this.info = this.opened.info;
        await this.setUp(await inputs.viewData);
        this.listen();
        await this.showCoarse();
        this.change();
        // Pages without a server, and servers without these files, decode by WebAssembly alone.
        if (this.source && navigator.gpu)
            import(new URL('?viewer=gpu_worker.js', location)).then(gpu => gpu.join(this)).catch(() => {});
    }

    context() {
        const options = {alpha: false, antialias: false, depth: false, preserveDrawingBuffer: true};
        const gl = this.page.canvas.getContext('webgl2', options);
        if (!gl)
            throw Error('The viewer needs WebGL2, which this browser does not offer. Current versions of Chromium, ' +
                        'Firefox and Safari have it unless it is switched off.');
        this.page.canvas.addEventListener('webglcontextlost', event => {
            event.preventDefault();
            this.page.say('The graphics device was reset.');
        });
        this.page.canvas.addEventListener('webglcontextrestored', () => location.reload());
        return gl;
    }

    async setUp(data) {
        const {gl, info} = this, level = {...info.levels[0], size: info.gridSize}, about = data?.about || {};
        const background = [...(about.background || shownBackground(info)), 1];
        const isHalf = info.sampleType === SAMPLE_TYPE.half16, isMesh = info.proxy === PROXY.mesh;
        const isSphere = info.proxy === PROXY.sphere || info.proxy === PROXY.sphereInside;
        const isPlanar = info.proxy === PROXY.none && info.angularMap === ANGULAR_MAP.planarViews;
        const mesh = isMesh && about.mesh ? new MeshData(about.mesh, data.rest) : null;
        if (isMesh && !mesh)
            throw Error('The texture lies on a mesh, which this page cannot decode. ' +
                        'Use `tessera view` or `tessera serve`.');
        if (this.opened.further.length && !mesh)
            throw Error('The layers of the file do not lie on a mesh.');
        this.surface = mesh ? new MeshSurface(gl, info, mesh, background)
            : isPlanar ? new PlanarSurface(info, background, numbersOf(about.cameras, 4))
            : isSphere ? new SphereSurface(info, background) : null;
        if (!this.surface)
            throw Error('The file does not say what its texture lies on. Encode it with --proxy.');
        const charts = mesh && mesh.atlases[0], mips = mesh ? charts.mips : 0;
        const budget = (Number(this.hash.get('cache')) || usualCache) * 2 ** 20;
        const grid = (this.bytes && allDirections(level, mips, isHalf ? 8 : 4, budget)) ||
            new TileGrid(level.size, level.tile, level.tiles);
        grid.checkFloats();
        const layout = new SlotLayout(grid.tileSide, mips);
        this.cache = new TileCache(gl, grid, layout, isHalf, budget);
        this.layers = this.opened.further.length
            ? new LayerPictures(gl, this.workers, this.opened, mesh, budget, () => this.change(true)) : null;
        this.renderer = new Renderer(gl, this.kit, info, this.surface, this.cache, this.layers);
        this.renderer.empty = [...shownBackground(info), 1];
        const first = {tileSide: grid.tileSide, mips, chartIds: charts?.ids, chartSize: charts?.size};
        await this.workers.prepare({parts: [first, ...(this.layers ? this.layers.parts : [])]});
        this.loader = new TileLoader(this.workers, this.cache, () => this.sharpen());
        this.usual = {...this.surface.defaultPose(), ...this.poseOfHash()};
        this.lastPose = this.usual;
        this.lastFov = Number(this.hash.get('fov')) || usualFov;
    }

    // Loads coarse levels, the smallest first, so that the whole texture is visible at once.
    async showCoarse() {
        const {levels} = this.info, {half} = this.renderer, texel = half ? 8 : 4;
        for (let level = levels.length - 1; level > 0; --level) {
            const {size, spatialLod, angularLod} = levels[level];
            if (size.reduce((a, b) => a * b) * texel > 32e6)
                break;
            const first = this.workers.run({job: 'coarse', level}).then(({pixels}) => {
                this.renderer.coarse = new CoarseLevel(this.gl, size, [spatialLod, angularLod], half, pixels);
                this.change(true);
            }).catch(error => this.page.say(error.message));
            if (level === levels.length - 1)
                await first;
        }
    }

    // The hash may contain eye=x,y,z look=x,y,z fov=45 rays=1 size=640x480, and for planar views also focus=2.7 reach=1
    // middle=x,y zoom=1.
    poseOfHash() {
        const pose = {};
        for (const [name, length] of [['eye', 3], ['look', 3], ['middle', 2]]) {
            const numbers = numbersOf(this.hash.get(name), length);
            if (numbers)
                pose[name] = numbers;
        }
        for (const name of ['reach', 'zoom'])
            if (Number(this.hash.get(name)) > 0)
                pose[name] = Number(this.hash.get(name));
        if (this.surface.planar && Number(this.hash.get('focus')) > 0)
            pose.disparity = this.surface.disparityAt(Number(this.hash.get('focus')));
        return pose;
    }

    listen() {
        this.controls = new Controls(this.page.canvas, this);
        new ResizeObserver(() => this.change()).observe(this.page.canvas);
        addEventListener('hashchange', () => {
            this.hash = new URLSearchParams(location.hash.slice(1));
            this.lastFov = Number(this.hash.get('fov')) || usualFov;
            this.pose = {...this.surface.defaultPose(), ...this.poseOfHash()};
        });
    }

    get pose() {
        return this.lastPose;
    }
    set pose(pose) {
        if (!this.surface.allowed(pose))
            return;
        this.lastPose = pose;
        this.moved = performance.now();
        this.change();
    }
    get fov() {
        return this.lastFov;
    }
    set fov(fov) {
        this.lastFov = fov;
        this.moved = performance.now();
        this.change();
    }
    reset() {
        this.lastFov = Number(this.hash.get('fov')) || usualFov;
        this.pose = this.usual;
    }
    // Moves the eye to where the whole surface fills the picture.
    frameAll() {
        const {centre, radius} = this.surface.mesh ? this.surface : this.info;
        const arm = sub(this.pose.eye || [], this.pose.look || []);
        if (!this.surface.planar && !this.surface.inside)
            this.pose = {look: centre, eye: add(centre, scale(unit(arm), radius / Math.sin(this.fov * Math.PI / 360)))};
    }

    get moving() {
        return performance.now() - (this.moved || -1e9) < 150;
    }

    // The view to draw: the size in pixels of the display, the pose, the rays per pixel and the camera.
    view() {
        const {canvas} = this.page, fixed = /^(\d+)x(\d+)$/.exec(this.hash.get('size') || '');
        const ratio = devicePixelRatio || 1;
        if (fixed)
            Object.assign(canvas.style, {width: `${fixed[1] / ratio}px`, height: `${fixed[2] / ratio}px`});
        const most = Math.min(8192, this.gl.getParameter(this.gl.MAX_TEXTURE_SIZE));
        const pixels = (fixed ? [+fixed[1], +fixed[2]] : [canvas.clientWidth * ratio, canvas.clientHeight * ratio])
            .map(n => clamp(Math.round(n), 1, most));
        const aspect = pixels[0] / pixels[1], {surface, pose} = this;
        // In a window that is higher than wide, fov is the horizontal field of view.
        const fov = fixed || aspect >= 1 ? this.fov
                                         : Math.atan(Math.tan(this.fov * Math.PI / 360) / aspect) * 360 / Math.PI;
        const rays = clamp(Number(this.hash.get('rays')) || (this.moving ? 1 : surface.rays), 1, Renderer.mostRays);
        const camera = surface.planar ? surface.camera(pose, fov, aspect) : makeCamera(pose, fov, aspect);
        return {pixels, pose, rays, camera};
    }

    // Requests a new picture. tilesOnly: tiles have arrived, but the view needs the same tiles as before.
    change(tilesOnly = false) {
        this.ray = 0;
        if (!tilesOnly)
            this.searched = 'not';
        this.schedule();
    }

    // Called when a tile has arrived. The last one is drawn at once, earlier ones only now and then. Without a GPU a
    // frame takes longer than a tile, and drawing competes with decoding for the CPU, so drawing gets a third of the
    // time.
    sharpen() {
        if (this.loader.busy && (this.isDrawing() || performance.now() < this.restsUntil))
            return;
        this.change(true);
    }

    // True while the device draws the last frame. When it has finished, sets the pause before the next one.
    isDrawing() {
        const {gl} = this;
        if (this.drawn && gl.getSyncParameter(this.drawn, gl.SYNC_STATUS) === gl.SIGNALED) {
            gl.deleteSync(this.drawn);
            this.drawn = null;
            const now = performance.now();
            this.restsUntil = now + 100 + 2 * (now - this.drawnSince);
        }
        return !!this.drawn;
    }

    schedule() {
        if (!this.scheduled)
            this.scheduled = requestAnimationFrame(() => {
                this.scheduled = 0;
                this.frame();
            });
    }

    frame() {
        const view = this.view(), {canvas} = this.page;
        if (canvas.width !== view.pixels[0] || canvas.height !== view.pixels[1])
            [canvas.width, canvas.height] = view.pixels;
        if (this.lastRays !== view.rays)
            this.ray = 0;
        this.lastRays = view.rays;
        if (this.mayDraw(view)) {
            this.renderer.addRay(view, this.ray++);
            this.frames.push(performance.now());
            if (!this.drawn) {
                this.drawn = this.gl.fenceSync(this.gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
                this.drawnSince = performance.now();
            }
        }
        this.findTiles(view);
        this.page.update(this);
        if (this.mayDraw(view) || this.moving || this.searched !== 'all')
            this.schedule();
        else if (!this.busy)
            this.waiting.splice(0).forEach(resolve => resolve());
    }

    // True while tiles in view or layers are missing.
    get busy() {
        return this.loader.busy || !!this.layers?.busy;
    }

    // While something is missing, one ray per pixel is enough.
    mayDraw(view) {
        return this.ray < (this.busy ? Math.min(1, view.rays) : view.rays);
    }

    // Searches coarsely at once. When the tiles of this search are there, an exact search finds the few others.
    findTiles(view) {
        const {cache, loader, renderer} = this;
        if (cache.tiles.size === cache.grid.tiles)
            this.searched = 'all';
        if (this.searched === 'not' && performance.now() - (this.searchedAt || 0) > 60) {
            this.searchedAt = performance.now();
            this.counts = this.withHidden(renderer.tilesOf(view, 6, -1, [0, 0]));
            loader.want(this.counts);
            if (this.bytes && cache.holdsAll)
                loader.wantAll();
            this.searched = 'roughly';
        } else if (this.searched === 'roughly' && !this.moving && !loader.busy) {
            this.counts = new Map(this.counts);
            for (let corner = 0; corner < 8; ++corner)
                renderer.tilesOf(view, 1, corner, rayShift(corner % view.rays, view.rays)).forEach(
                    (count, tile) => this.counts.set(tile, (this.counts.get(tile) || 0) + count));
            if (!loader.full)
                loader.want(this.counts);
            this.searched = 'all';
        }
        if (!loader.busy && this.searched !== 'not')
            this.layers?.start();
    }

    // The search finds the nearest surfaces only, but others are seen through holes and surfaces that blend. So all
    // tiles of such files are wanted, like those of their other layers.
    withHidden(counts) {
        const {coverage, opacity} = LAYER_ROLE, {cache} = this;
        if (cache.holdsAll && [coverage, opacity].some(role => this.layers?.has(role)))
            for (let tile = 0; tile < cache.grid.tiles; ++tile)
                counts.has(tile) || counts.set(tile, 0);
        return counts;
    }

    // Resolves when the picture is final.
    settled() {
        return new Promise(resolve => {
            this.waiting.push(resolve);
            this.schedule();
        });
    }

    fullScreen() {
        document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen?.();
    }
    toggleFigures() {
        this.page.toggle('figures');
        this.schedule();
    }
    toggleHelp() {
        this.page.toggle('help');
    }

    // Mean time between consecutive recent frames in milliseconds; 0 if there are none.
    get drawTime() {
        this.frames.splice(0, this.frames.length - 20);
        const steps = this.frames.slice(1).map((at, i) => at - this.frames[i]).filter(step => step < 5000);
        return steps.length ? steps.reduce((a, b) => a + b) / steps.length : 0;
    }
}

// A grid in which a tile contains all directions of its positions, so that the texture unit can interpolate between any
// directions. Used if the whole file is in memory; null if the texture does not fit into the budget.
function allDirections({size, tile, tiles}, mips, texelBytes, budget) {
    const [, , s, t] = size, grid = new TileGrid(size, [tile[0], tile[1], s, t], [tiles[0], tiles[1], 1, 1]);
    const {width, height} = new SlotLayout(grid.tileSide, mips);
    return Math.max(width, height) <= 4096 && grid.tiles * width * height * texelBytes <= budget ? grid : null;
}

// Parses "1,2,3" to [1, 2, 3]; null if `text` is not a list of `count` numbers.
function numbersOf(text, count) {
    const numbers = (text || '').split(',').map(Number);
    return text && numbers.length === count && numbers.every(Number.isFinite) ? numbers : null;
}

// The background colour of the file as RGB.
function shownBackground({background}) {
    return background.length >= 3 ? background.slice(0, 3) : [0, 1, 2].map(() => background[0]);
}
