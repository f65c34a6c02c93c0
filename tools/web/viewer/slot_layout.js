// The layout of a tile's texels in its slot of the GPU's tile cache. A slot is a picture with the angular images of the
// tile's surface texels side by side. For a mesh, the angular images of the mips are to their right, each mip below the
// previous one. The page and its workers use this file.

class SlotLayout {
    constructor(tileSide, mips) {
        const [u, v, s, t] = tileSide;
        this.side = tileSide;
        this.mips = mips;
        this.rows = [0]; // first row of each mip, in surface texels; mip 0 is the atlas
        for (let mip = 1, row = 0; mip <= mips; ++mip) {
            this.rows.push(row);
            row += Math.ceil(v / 2 ** mip);
        }
        const below = mips ? this.rows[mips] + Math.ceil(v / 2 ** mips) : 0;
        this.width = (u + (mips ? Math.ceil(u / 2) : 0)) * s;
        this.height = Math.max(v, below) * t;
    }
    // Index of the first pixel of the angular image of (u, v), counted in texels of the mip from the tile's first one.
    pixel(mip, u, v) {
        const [side_u, , s, t] = this.side;
        return ((this.rows[mip] + v) * t) * this.width + (u + (mip ? side_u : 0)) * s;
    }
}

// Converts decoded texels (order v, u, t, s; 8-bit samples, or half floats as 16-bit integers) to the RGBA pixels of a
// slot. Grey is copied to R, G and B, and alpha is ignored, as in `tessera render`. `raw` keeps all channels and repeats
// the last one.
// charts: null if there are no mips.
function slotPixels(texels, box, channels, half, layout, charts, raw = false) {
    const [u0, u1, v0, v1, s0, s1, t0, t1] = box;
    const across = u1 - u0, up = v1 - v0, wide = s1 - s0, high = t1 - t0;
    const out = new (half ? Uint16Array : Uint8Array)(layout.width * layout.height * 4);
    const opaque = half ? 0x3C00 : 255, last = raw ? channels - 1 : channels >= 3 ? 2 : 0;
    const green = Math.min(1, last), blue = Math.min(2, last);
    let from = 0;
    for (let v = 0; v < up; ++v)
        for (let u = 0; u < across; ++u)
            for (let t = 0; t < high; ++t) {
                let to = (layout.pixel(0, u, v) + t * layout.width) * 4;
                for (let s = 0; s < wide; ++s, from += channels, to += 4) {
                    out[to] = texels[from];
                    out[to + 1] = texels[from + green];
                    out[to + 2] = texels[from + blue];
                    out[to + 3] = raw ? texels[from + last] : opaque;
                }
            }
    for (let mip = 1; charts && mip <= layout.mips; ++mip)
        addMip(out, mip, box, half, layout, charts);
    return out;
}

// Four directions of one channel share a pixel: the sides of a texel's picture of `count` directions, in pixels.
function packedSides(count) {
    const pixels = Math.ceil(count / 4), side = Math.ceil(Math.sqrt(pixels));
    return [side, Math.ceil(pixels / side)];
}
// The first `count` of `all` directions of each texel, as four channels of packedSides(count).
function packed(texels, all, count) {
    const [across, up] = packedSides(count), pixels = across * up * 4;
    const result = new texels.constructor(texels.length / all * pixels);
    for (let from = 0, to = 0; from < texels.length; from += all, to += pixels)
        result.set(texels.subarray(from, from + count), to);
    return result;
}

// A texel of a mip is the mean of the texels of its chart in its square (FORMAT.md 5.2).
function addMip(out, mip, box, half, layout, charts) {
    const [u0, u1, v0, v1, s0, s1, t0, t1] = box, row = (s1 - s0) * 4, high = t1 - t0;
    const sums = half ? new Float64Array(row * high) : new Uint32Array(row * high);
    const pixels = half ? Float64Array.from(out, halfToFloat) : out;
    for (let y = v0 >> mip; y << mip < v1; ++y)
        for (let x = u0 >> mip; x << mip < u1; ++x) {
            const own = charts.at(mip, x, y);
            if (!own)
                continue;
            let count = 0;
            sums.fill(0);
            for (let v = y << mip; v < Math.min(y + 1 << mip, v1); ++v)
                for (let u = x << mip; u < Math.min(x + 1 << mip, u1); ++u) {
                    if (charts.at(0, u, v) !== own)
                        continue;
                    addImage(sums, pixels, layout.pixel(0, u - u0, v - v0) * 4, row, high, layout.width * 4);
                    ++count;
                }
            putMean(out, layout.pixel(mip, x - (u0 >> mip), y - (v0 >> mip)) * 4, sums, count, half, row, high,
                    layout.width * 4);
        }
}

function addImage(sums, pixels, at, row, high, stride) {
    for (let t = 0, i = 0; t < high; ++t, at += stride)
        for (let s = 0; s < row; ++s, ++i)
            sums[i] += pixels[at + s];
}

function putMean(out, at, sums, count, half, row, high, stride) {
    for (let t = 0, i = 0; t < high; ++t, at += stride)
        for (let s = 0; s < row; ++s, ++i)
            out[at + s] = half ? floatToHalf(sums[i] / count) : (2 * sums[i] + count) / (2 * count);
}

function halfToFloat(h) {
    const sign = h & 0x8000 ? -1 : 1, exponent = h >> 10 & 31, rest = h & 1023;
    if (exponent === 0)
        return sign * rest * 2 ** -24;
    return exponent === 31 ? (rest ? NaN : sign * Infinity) : sign * (1 + rest / 1024) * 2 ** (exponent - 15);
}

// Rounds to nearest, ties to even.
function floatToHalf(x) {
    const sign = x < 0 || Object.is(x, -0) ? 0x8000 : 0, size = Math.abs(x);
    if (Number.isNaN(x))
        return 0x7E00;
    if (size >= 65520)
        return sign | 0x7C00;
    const exponent = Math.max(Math.floor(Math.log2(size || 1e-30)), -14), units = size / 2 ** (exponent - 10);
    let rounded = Math.floor(units);
    if (units - rounded > 0.5 || (units - rounded === 0.5 && rounded % 2))
        ++rounded;
    return sign | (exponent + 14 << 10) + rounded; // 1024 units carry into the exponent; subnormals have no leading 1
}

// The charts of an atlas and its mips: one number per texel, 0 for none. They form one picture of `width` x `height`
// texels with the mips to the right of the atlas, each below the previous one.
class Charts {
    constructor(ids, size, mips) {
        Object.assign(this, {ids, size, mips});
        this.width = size[0] + (mips ? Math.ceil(size[0] / 2) : 0);
        this.rows = [0];
        for (let mip = 1, row = 0; mip <= mips; ++mip) {
            this.rows.push(row);
            row += this.side(mip)[1];
        }
        this.height = Math.max(size[1], mips ? this.rows[mips] + this.side(mips)[1] : 0);
    }
    side(mip) {
        return this.size.map(n => Math.ceil(n / 2 ** mip));
    }
    at(mip, u, v) {
        return this.ids[(this.rows[mip] + v) * this.width + u + (mip ? this.size[0] : 0)];
    }
}
