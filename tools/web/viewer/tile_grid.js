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
}
