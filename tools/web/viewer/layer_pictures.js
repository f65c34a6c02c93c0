// The layers of a file besides the first one (FORMAT.md 5.6), each decoded whole to a picture on the GPU. They are loaded
// in their order in the file, in which they help the eye, and each is drawn once it is complete.

class LayerPictures {
    static names = Object.keys(LAYER_ROLE); // by role

    // about: the answer to the job "open"; mesh: MeshData; budget: bytes of all pictures together. onChange() is called
    // when the picture has changed or loading has ended.
    constructor(gl, workers, about, mesh, budget, onChange) {
        Object.assign(this, {gl, workers, onChange, about, budget, bytes: 0, loaded: {}, trouble: '', started: false});
        this.busy = true; // until all layers are loaded or have failed
        this.layers = about.further.map(({role, scale, info}, i) => {
            const charts = mesh.atlases[mesh.layers[i]], [, , s, t] = info.size;
            const lights = role === LAYER_ROLE.visibility ? about.lights.length : 0;
            const pixels = lights ? packedSides(lights) : [s, t]; // per texel
            return {number: i + 1, role, scale, info, charts, lights, pixels, atlas: mesh.layers[i],
                    tileSide: [...info.tile.slice(0, 2), ...pixels], half: info.sampleType === SAMPLE_TYPE.half16};
        });
        // Samplers must not be left without a texture of their kind.
        this.nothing = this.picture(gl.RGBA8, 1, 1);
        this.lights = this.lightsPicture(about.lights);
    }

    picture(format, width, height) {
        const {gl} = this, texture = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D, texture);
        gl.texStorage2D(gl.TEXTURE_2D, 1, format, width, height);
        nearest(gl, gl.TEXTURE_2D);
        return texture;
    }

    // Filled up to a multiple of four lights.
    lightsPicture(lights) {
        const {gl} = this, texture = this.picture(gl.RGBA32F, 2, 4 * Math.ceil(Math.max(1, lights.length) / 4));
        const brightest = Math.max(...lights.flatMap(({irradiance}) => irradiance));
        const peak = irradiance => Math.max(1 / 51, brightest > 0 ? Math.sqrt(Math.max(...irradiance) / brightest) : 1);
        const numbers = lights.flatMap(
            ({direction, spread, irradiance}) => [...direction, spread, ...irradiance, peak(irradiance)]);
        if (lights.length)
            gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 2, lights.length, gl.RGBA, gl.FLOAT, new Float32Array(numbers));
        return texture;
    }

    has(role) {
        return this.layers.some(layer => layer.role === role);
    }

    // What the job "prepare" needs to know.
    get parts() {
        return this.layers.map(({tileSide, charts, lights}) => (
            {tileSide, lights, mips: charts.mips, chartIds: charts.ids, chartSize: charts.size}));
    }

    // Called repeatedly; the first call loads the layers.
    async start() {
        if (this.started)
            return;
        this.started = true;
        for (const layer of this.layers) {
            try {
                await this.load(layer);
                this.loaded[layer.role] = layer;
                this.onChange();
            } catch (error) {
                this.trouble ||= `The ${LayerPictures.names[layer.role]} layer cannot be shown: ${error.message}`;
                this.gl.deleteTexture(layer.texture);
            }
        }
        this.busy = false;
        this.onChange();
    }

    async load(layer) {
        const {gl, workers} = this, {info, charts, pixels, half} = layer;
        const whole = new SlotLayout([...charts.size, ...pixels], charts.mips), {width, height} = whole;
        const most = gl.getParameter(gl.MAX_TEXTURE_SIZE), bytes = width * height * (half ? 8 : 4);
        if (width > most || height > most)
            throw Error(`it needs a texture of ${width}x${height} pixels, but this device allows only ${most}.`);
        if (this.bytes + bytes > this.budget)
            throw Error(`all layers together need more than ${inBytes(this.budget)} of GPU memory. ` +
                        'Add #cache=MEBIBYTES to the address for a higher limit.');
        this.bytes += bytes;
        layer.texture = this.picture(half ? gl.RGBA16F : gl.RGBA8, width, height);
        const grid = new TileGrid(info.size, info.tile, [...info.tiles.slice(0, 2), 1, 1]), tiles = [];
        for (let tile = 0; tile < grid.tiles; ++tile)
            tiles.push(grid.box(tile));
        // One job per worker, so that tiles of the first layer, which come into view, do not wait long.
        const part = new SlotLayout(layer.tileSide, charts.mips);
        const lanes = workers.workers.map(async () => {
            for (let box; (box = tiles.shift());)
                this.put(layer, whole, part, box, await this.decoded(layer, box));
        });
        await Promise.all(lanes).catch(error => {
            tiles.length = 0;
            throw error;
        });
    }

    async decoded(layer, box) {
        for (;;)
            try {
                return (await this.workers.run({job: 'tile', layer: layer.number, box})).pixels;
            } catch (error) {
                if (!error.elsewhere)
                    throw error;
            }
    }

    // Copies a tile, with its part of each mip.
    put({texture, pixels: [across, up], charts, half}, whole, part, [u0, u1, v0, v1], decoded) {
        const {gl} = this, side = (begin, end, mip) => Math.ceil(end / 2 ** mip) - (begin >> mip);
        gl.bindTexture(gl.TEXTURE_2D, texture);
        gl.pixelStorei(gl.UNPACK_ROW_LENGTH, part.width);
        for (let mip = 0; mip <= charts.mips; ++mip) {
            gl.pixelStorei(gl.UNPACK_SKIP_PIXELS, (mip ? part.side[0] : 0) * across);
            gl.pixelStorei(gl.UNPACK_SKIP_ROWS, part.rows[mip] * up);
            gl.texSubImage2D(gl.TEXTURE_2D, 0, ((mip ? whole.side[0] : 0) + (u0 >> mip)) * across,
                             (whole.rows[mip] + (v0 >> mip)) * up, side(u0, u1, mip) * across, side(v0, v1, mip) * up,
                             gl.RGBA, half ? gl.HALF_FLOAT : gl.UNSIGNED_BYTE, decoded);
        }
        for (const name of ['UNPACK_ROW_LENGTH', 'UNPACK_SKIP_PIXELS', 'UNPACK_SKIP_ROWS'])
            gl.pixelStorei(gl[name], 0);
    }

    // A layer is drawn with those that it depends on: reflections and lights would be too bright without reflectance
    // and visibility.
    shown(role) {
        const {specular, reflection} = LAYER_ROLE;
        return role === reflection && this.has(specular) && !this.loaded[specular] ? undefined : this.loaded[role];
    }

    get uniforms() {
        const {about, gl} = this, {diffuse, visibility} = LAYER_ROLE, values = {};
        const numbers = [], scales = [];
        LayerPictures.names.forEach((name, role) => {
            const layer = this.shown(role), first = role === diffuse;
            values[`${name}Layer`] = {texture: layer ? layer.texture : this.nothing, target: gl.TEXTURE_2D};
            const {info, atlas, scale, pixels} =
                first ? {info: about.info, atlas: 0, scale: about.scale, pixels: [1, 1]} : layer || {};
            numbers.push(...(info ? [atlas, info.transfer === TRANSFER.srgb ? 1 : 0, ...pixels] : [-1, 0, 1, 1]));
            scales.push(scale || 1);
        });
        const waits = this.has(visibility) && !this.loaded[visibility];
        return {...values, layers: numbers, layerScales: scales, lights: {texture: this.lights, target: gl.TEXTURE_2D},
                lightCount: waits ? 0 : about.lights.length};
    }
}
