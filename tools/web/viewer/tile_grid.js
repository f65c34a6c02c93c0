// The division of a texture into tiles (format/levels.h). Along an axis of D texels with n tiles, tile i covers the
// texels from floor(i D / n) up to, but not including, floor((i + 1) D / n).

class TileGrid {
    constructor(size, tileSide, count) {
        Object.assign(this, {size, tileSide, count});
        this.tiles = count.reduce((product, n) => product * n, 1);
    }
    coordinates(number) {
        return this.count.map(n => {
            const i = number % n;
            number = Math.floor(number / n);
            return i;
        });
    }
    // The texels of a tile: [u0, u1, v0, v1, s0, s1, t0, t1], ends excluded.
    box(number) {
        return this.coordinates(number).flatMap((i, axis) => [0, 1].map(
            end => Math.floor((i + end) * this.size[axis] / this.count[axis])));
    }

    // The uniforms of tileOf() and tileBegin() in slots.glsl, in single precision.
    get uniforms() {
        const {size, count} = this;
        return {size, tiles: count, tileSide: this.tileSide, sides: size, tileCount: count,
                perTexel: size.map((n, axis) => Math.fround(count[axis] / n)),
                perTile: size.map((n, axis) => Math.fround(n / count[axis]))};
    }
    // Throws if these functions are not exact in single precision, which happens for axes of many thousand texels.
    checkFloats() {
        const f = Math.fround, {perTexel, perTile} = this.uniforms;
        this.size.forEach((n, axis) => {
            const tiles = this.count[axis];
            for (let tile = 0; tile < tiles; ++tile) {
                const begin = Math.floor(tile * n / tiles), last = Math.floor((tile + 1) * n / tiles) - 1;
                const tileOf = texel => Math.ceil(f(f((texel + 1) * perTexel[axis]) - f(0.25 / n))) - 1;
                if (Math.floor(f(f(tile * perTile[axis]) + f(0.25 / tiles))) !== begin || tileOf(begin) !== tile ||
                    tileOf(last) !== tile)
                    throw Error(`an axis of ${n} texels in ${tiles} tiles is too long for this viewer`);
            }
        });
    }
}
