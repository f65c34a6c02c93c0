// The tiles on the GPU: a fixed number of slots, and a page table with the slot of each tile. Among the tiles that are
// not in view, the one that was last in view longest ago is evicted first.

class TileCache {
    static layerSide = 2048; // pixels, or the side of a slot if it is larger

    constructor(gl, grid, layout, half, budget) {
        Object.assign(this, {gl, grid, layout, half});
        const {width, height} = layout, texel = half ? 8 : 4;
        const most = gl.getParameter(gl.MAX_TEXTURE_SIZE);
        if (width > most || height > most)
            throw Error(`a tile needs a texture of ${width}x${height} pixels, but this device allows only ${most}`);
        if (grid.tiles > 1024 * Math.min(most, 8192))
            throw Error(`the file has ${grid.tiles} tiles, which are more than this viewer can show`);
        const slots = Math.max(1, Math.min(grid.tiles, Math.floor(budget / (width * height * texel))));
        this.columns = Math.min(slots, Math.max(1, Math.floor(TileCache.layerSide / width)));
        // Rows and layers are whole. A cache that cannot hold all tiles must stay within the budget.
        const round = slots < grid.tiles ? Math.floor : Math.ceil;
        this.rows = clamp(round(slots / this.columns), 1, Math.max(1, Math.floor(TileCache.layerSide / height)));
        const ofLayer = this.columns * this.rows;
        const layers = clamp(round(slots / ofLayer), 1, Math.min(gl.getParameter(gl.MAX_ARRAY_TEXTURE_LAYERS), 2048));
        this.slots = Math.min(grid.tiles, ofLayer * layers);
        this.bytes = ofLayer * width * height * layers * texel;
        this.layerSize = [this.columns * width, this.rows * height];
        this.texture = arrayTexture(gl, half ? gl.RGBA16F : gl.RGBA8, ...this.layerSize, layers, gl.LINEAR);
        this.pages = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D, this.pages);
        this.pageRows = Math.ceil(grid.tiles / 1024);
        gl.texStorage2D(gl.TEXTURE_2D, 1, gl.R32UI, 1024, this.pageRows);
        nearest(gl, gl.TEXTURE_2D);
        this.tiles = new Map(); // tile -> slot, least recently in view first
        this.inView = new Set();
    }

    get holdsAll() {
        return this.slots >= this.grid.tiles;
    }
    has(tile) {
        return this.tiles.has(tile);
    }

    // Sets the tiles that are in view.
    view(tiles) {
        this.inView = new Set(tiles);
        for (const tile of tiles) {
            const slot = this.tiles.get(tile);
            if (slot !== undefined) {
                this.tiles.delete(tile);
                this.tiles.set(tile, slot);
            }
        }
    }

    // Returns false if all slots hold tiles in view.
    put(tile, pixels) {
        const slot = this.tiles.size < this.slots ? this.tiles.size : this.freed();
        if (slot === undefined)
            return false;
        this.tiles.set(tile, slot);
        const {gl, layout, half} = this, row = Math.floor(slot / this.columns) % this.rows;
        const column = slot % this.columns, layer = Math.floor(slot / (this.columns * this.rows));
        gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.texture);
        gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, 0, column * layout.width, row * layout.height, layer, layout.width,
                         layout.height, 1, gl.RGBA, half ? gl.HALF_FLOAT : gl.UNSIGNED_BYTE, pixels);
        this.setPage(tile, (1 << 31 | layer << 20 | row << 10 | column) >>> 0);
        return true;
    }

    freed() {
        for (const [tile, slot] of this.tiles)
            if (!this.inView.has(tile)) {
                this.tiles.delete(tile);
                this.setPage(tile, 0);
                return slot;
            }
        return undefined;
    }

    setPage(tile, word) {
        const {gl} = this;
        gl.bindTexture(gl.TEXTURE_2D, this.pages);
        gl.texSubImage2D(gl.TEXTURE_2D, 0, tile % 1024, Math.floor(tile / 1024), 1, 1, gl.RED_INTEGER, gl.UNSIGNED_INT,
                         new Uint32Array([word]));
    }
}

// A whole coarse level: angular images side by side, divided among layers.
class CoarseLevel {
    constructor(gl, size, lod, half, pixels) {
        const [u, v, s, t] = size;
        this.size = size;
        this.lod = lod;
        this.fold = [Math.min(u, Math.max(1, Math.floor(2048 / s))), Math.min(v, Math.max(1, Math.floor(2048 / t)))];
        const across = Math.ceil(u / this.fold[0]), layers = across * Math.ceil(v / this.fold[1]);
        const width = this.fold[0] * s, height = this.fold[1] * t;
        this.bytes = width * height * layers * (half ? 8 : 4);
        this.texture = arrayTexture(gl, half ? gl.RGBA16F : gl.RGBA8, width, height, layers, gl.LINEAR);
        gl.pixelStorei(gl.UNPACK_ROW_LENGTH, u * s);
        for (let layer = 0; layer < layers; ++layer) {
            const x = layer % across * this.fold[0], y = Math.floor(layer / across) * this.fold[1];
            gl.pixelStorei(gl.UNPACK_SKIP_PIXELS, x * s);
            gl.pixelStorei(gl.UNPACK_SKIP_ROWS, y * t);
            gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, 0, 0, 0, layer, Math.min(width, (u - x) * s),
                             Math.min(height, (v - y) * t), 1, gl.RGBA, half ? gl.HALF_FLOAT : gl.UNSIGNED_BYTE,
                             pixels);
        }
        for (const name of ['UNPACK_ROW_LENGTH', 'UNPACK_SKIP_PIXELS', 'UNPACK_SKIP_ROWS'])
            gl.pixelStorei(gl[name], 0);
    }
}

function arrayTexture(gl, format, width, height, layers, filter) {
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, texture);
    gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, format, width, height, layers);
    nearest(gl, gl.TEXTURE_2D_ARRAY);
    gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_MIN_FILTER, filter);
    gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_MAG_FILTER, filter);
    return texture;
}

function nearest(gl, target) {
    for (const name of ['TEXTURE_MIN_FILTER', 'TEXTURE_MAG_FILTER'])
        gl.texParameteri(target, gl[name], gl.NEAREST);
    for (const name of ['TEXTURE_WRAP_S', 'TEXTURE_WRAP_T'])
        gl.texParameteri(target, gl[name], gl.CLAMP_TO_EDGE);
}
