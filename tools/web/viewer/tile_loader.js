// Brings the tiles that views need into the cache, those that fill most of the picture first.

class TileLoader {
    // onTile(): the picture may have changed.
    constructor(workers, cache, onTile) {
        Object.assign(this, {workers, cache, onTile, queue: [], coming: new Set(), failed: new Map(), full: false, decoded: 0});
    }

    // counts: pixels by tile. What was wanted before and is not any more is left out.
    want(counts) {
        const tiles = [...counts.keys()].sort((a, b) => counts.get(b) - counts.get(a));
        this.cache.view(tiles);
        this.full = false;
        this.queue = tiles.filter(tile => this.lacks(tile));
        this.pump();
    }
    // All others, too, where there is room for them.
    wantAll() {
        for (let tile = 0; tile < this.cache.grid.tiles; ++tile)
            if (this.lacks(tile))
                this.queue.push(tile);
        this.pump();
    }

    lacks(tile) {
        return !this.cache.has(tile) && !this.failed.has(tile);
    }
    get busy() {
        return this.coming.size > 0 || this.queue.length > 0;
    }

    pump() {
        while (this.workers.idle > 0 && this.queue.length) {
            const tile = this.queue.shift();
            if (this.lacks(tile) && !this.coming.has(tile))
                this.bring(tile);
        }
    }

    // A tile that cannot be had stays coarse.
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
            this.failed.set(tile, error.message);
        }
        this.coming.delete(tile);
        this.pump();
        this.onTile();
    }
}
