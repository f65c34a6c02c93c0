// Loads the tiles that a view needs into the cache, starting with those that cover most pixels.

class TileLoader {
    // onTile() is called when a tile in view has arrived or has failed.
    constructor(workers, cache, onTile) {
        Object.assign(this, {workers, cache, onTile, queue: [], rest: [], coming: new Set(), failed: new Map()});
        Object.assign(this, {full: false, decoded: 0});
    }

    // Replaces the queue. counts: tile -> number of pixels that use it.
    want(counts) {
        const tiles = [...counts.keys()].sort((a, b) => counts.get(b) - counts.get(a));
        this.cache.view(tiles);
        this.full = false;
        this.queue = tiles.filter(tile => this.lacks(tile));
        this.pump();
    }
    // Also loads all other tiles once those in view are there. The cache must have room for them.
    wantAll() {
        if (!this.rest.length)
            this.rest = Array.from({length: this.cache.grid.tiles}, (_, i) => this.cache.grid.tiles - 1 - i);
        this.pump();
    }

    lacks(tile) {
        return !this.cache.has(tile) && !this.failed.has(tile);
    }
    // True while tiles in view are missing.
    get busy() {
        return this.queue.length > 0 || [...this.coming].some(tile => this.cache.inView.has(tile));
    }

    pump() {
        while (this.workers.idle > 0 && this.queue.length + this.rest.length) {
            const tile = this.queue.length ? this.queue.shift() : this.rest.pop();
            if (this.lacks(tile) && !this.coming.has(tile))
                this.bring(tile);
        }
    }

    // Loads one tile. If it fails, its coarse texels stay visible.
    async bring(tile) {
        this.coming.add(tile);
        try {
            const {pixels} = await this.workers.run({job: 'tile', box: this.cache.grid.box(tile)});
            ++this.decoded;
            if (!this.cache.has(tile) && !this.cache.put(tile, pixels)) {
                this.full = true;
                this.queue = [];
            }
        } catch (error) {
            if (error.elsewhere)
                this.queue.push(tile);
            else
                this.failed.set(tile, error.message);
        }
        this.coming.delete(tile);
        this.pump();
        if (this.cache.inView.has(tile))
            this.onTile();
    }
}
