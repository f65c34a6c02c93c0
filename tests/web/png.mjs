// Reads the pixels of an 8-bit RGB or RGBA PNG that is not interlaced.
import {inflateSync} from 'node:zlib';

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
