// How a texture is cut into tiles (format/levels.h): along an axis of D texels tile i of n covers
// floor(i D / n) up to floor((i + 1) D / n).

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
    // [u0, u1, v0, v1, s0, s1, t0, t1]
    box(number) {
        return this.coordinates(number).flatMap((i, axis) => [0, 1].map(
            end => Math.floor((i + end) * this.size[axis] / this.count[axis])));
    }

    // What the shaders calculate with, in single precision; see tileOf() and tileBegin() in slots.glsl.
    get uniforms() {
        const {size, count} = this;
        return {size, tiles: count, tileSide: this.tileSide, sides: size, tileCount: count,
                perTexel: size.map((n, axis) => Math.fround(count[axis] / n)), perTile: size.map((n, axis) => Math.fround(n / count[axis]))};
    }
    // Throws where single precision is not enough for that, which takes axes of many thousand texels.
    checkFloats() {
        const f = Math.fround, {perTexel, perTile} = this.uniforms;
        this.size.forEach((n, axis) => {
            const tiles = this.count[axis];
            for (let tile = 0; tile < tiles; ++tile) {
                const begin = Math.floor(tile * n / tiles), last = Math.floor((tile + 1) * n / tiles) - 1;
                const tileOf = texel => Math.ceil(f(f((texel + 1) * perTexel[axis]) - f(0.25 / n))) - 1;
                if (Math.floor(f(f(tile * perTile[axis]) + f(0.25 / tiles))) !== begin || tileOf(begin) !== tile || tileOf(last) !== tile)
                    throw Error(`an axis of ${n} texels in ${tiles} tiles is more than this viewer can show`);
            }
        });
    }
}
