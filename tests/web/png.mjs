// Reads and writes 8-bit PNGs that are not interlaced.
import {deflateSync, inflateSync} from 'node:zlib';

function checksum(bytes) {
    let sum = 0xFFFFFFFF;
    for (const byte of bytes) {
        sum ^= byte;
        for (let bit = 0; bit < 8; ++bit)
            sum = sum >>> 1 ^ (sum & 1 ? 0xEDB88320 : 0);
    }
    return ~sum >>> 0;
}

// colour(x, y) returns [red, green, blue], or with alpha four numbers.
export function pngOf(width, height, colour) {
    const {length: channels} = colour(0, 0), bytes = 1 + channels * width, rows = Buffer.alloc(bytes * height);
    for (let y = 0; y < height; ++y)
        for (let x = 0; x < width; ++x)
            rows.set(colour(x, y), bytes * y + 1 + channels * x);
    const part = (kind, data) => {
        const out = Buffer.alloc(12 + data.length);
        out.writeUInt32BE(data.length);
        out.write(kind, 4, 'latin1');
        out.set(data, 8);
        out.writeUInt32BE(checksum(out.subarray(4, 8 + data.length)), 8 + data.length);
        return out;
    };
    const header = Buffer.alloc(13);
    header.writeUInt32BE(width);
    header.writeUInt32BE(height, 4);
    header.set([8, channels === 4 ? 6 : 2], 8);
    return Buffer.concat([Buffer.from('\x89PNG\r\n\x1a\n', 'latin1'), part('IHDR', header),
                          part('IDAT', deflateSync(rows)), part('IEND', Buffer.alloc(0))]);
}

// The pixels of an RGB or RGBA picture.
export function readPng(file) {
    const parts = [];
    let width, height, channels;
    for (let at = 8; at < file.length;) {
        const length = file.readUInt32BE(at), kind = file.toString('latin1', at + 4, at + 8);
        const data = file.subarray(at + 8, at + 8 + length);
        if (kind === 'IHDR')
            [width, height, channels] = [data.readUInt32BE(0), data.readUInt32BE(4), data[9] === 6 ? 4 : 3];
        if (kind === 'IDAT')
            parts.push(data);
        at += 12 + length;
    }
    const raw = inflateSync(Buffer.concat(parts)), row = width * channels, out = Buffer.alloc(row * height);
    for (let y = 0; y < height; ++y) {
        const filter = raw[y * (row + 1)];
        for (let x = 0; x < row; ++x) {
            const a = x >= channels ? out[y * row + x - channels] : 0, b = y ? out[(y - 1) * row + x] : 0;
            const c = x >= channels && y ? out[(y - 1) * row + x - channels] : 0;
            const p = a + b - c, near = Math.abs(p - a) <= Math.abs(p - b) && Math.abs(p - a) <= Math.abs(p - c) ? a
                : Math.abs(p - b) <= Math.abs(p - c) ? b : c;
            out[y * row + x] = raw[y * (row + 1) + 1 + x] + [0, a, b, a + b >> 1, near][filter];
        }
    }
    return {width, height, channels, pixels: out};
}

// Compares two pictures: the share of pixels whose samples differ by at most one step, the largest
// difference, and the PSNR.
export function compared(picture, png) {
    if (picture.width !== png.width || picture.height !== png.height)
        throw Error(`${picture.width}x${picture.height} is not ${png.width}x${png.height}`);
    let near = 0, most = 0, squares = 0;
    const pixels = png.width * png.height;
    for (let i = 0; i < pixels; ++i) {
        let worst = 0;
        for (let c = 0; c < 3; ++c) {
            const d = Math.abs(picture.rgba[4 * i + c] - png.pixels[png.channels * i + c]);
            worst = Math.max(worst, d);
            squares += d * d;
        }
        near += worst <= 1;
        most = Math.max(most, worst);
    }
    return {share: near / pixels, most, psnr: 10 * Math.log10(255 ** 2 * pixels * 3 / squares)};
}
