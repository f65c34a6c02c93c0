// The mips of a surface (FORMAT.md 5.2): means over texels of one chart. The charts come from the triangles of the mesh.
import {chartIds} from './charts.js';
import {cellOf, halved} from './mip_layout.js';
import {usualSide} from './surface_shader.js';

const mostCovered = 16; // area of the triangles' boxes, in atlases

// A surface of readSurface() whose layers of 8 bits have mips beside each view, or the surface itself if there can be
// none. meshes: [{indices, vertices, uvOf(vertex)}] for all primitives with the texture. longestSide: as for
// readSurface(); layers whose picture would be larger stay as they are.
export function withMips(surface, meshes, longestSide = usualSide) {
    const atlases = [], layers = surface.layers.map(layer => {
        const [U, V] = layer.size, {mips} = layer;
        if (layer.picture.half || layer.name === 'environment' || !mips || !fits(layer, longestSide))
            return layer;
        let atlas = atlases.find(({size, mips: count}) => size[0] === U && size[1] === V && count === mips);
        if (!atlas)
            atlases.push(atlas = atlasOf([U, V], mips, meshes));
        return atlas.ids ? {...layer, atlas: atlases.indexOf(atlas), picture: pictureWithMips(layer, atlas)} : layer;
    });
    return layers.some(({atlas}) => atlas !== undefined) ? {...surface, layers, ...chartPicture(atlases)} : surface;
}

function fits({size: [U, V, S, T], columns, mips}, longestSide) {
    const {width, height} = cellOf([U, V], mips);
    return columns * width <= longestSide && Math.ceil(S * T / columns) * height <= longestSide;
}

// The charts of an atlas, without `ids` if the triangles cover it too often.
function atlasOf(size, mips, meshes) {
    let covered = 0, triangles = 0;
    for (const {indices, uvOf} of meshes) {
        triangles += indices.length / 3;
        for (let i = 0; i < indices.length; i += 3) {
            const corners = [0, 1, 2].map(k => uvOf(indices[i + k]));
            const [width, height] = [0, 1].map(axis => corners.map(uv => uv[axis] * size[axis]))
                .map(places => Math.max(...places) - Math.min(...places) + 2);
            covered += width * height;
        }
    }
    if (covered > mostCovered * (size[0] * size[1] + 65536 + 9 * triangles))
        return {size, mips};
    return {size, mips, ids: chartIds(size, mips, meshes), cell: cellOf(size, mips)};
}

// The views of a layer with their mips.
function pictureWithMips({size: [U, V, S, T], columns, mips, picture}, {ids, cell}) {
    const views = S * T, width = columns * cell.width, height = Math.ceil(views / columns) * cell.height;
    const pixels = new Uint8Array(width * height * 4);
    for (let view = 0; view < views; ++view) {
        const [column, row] = [view % columns, Math.floor(view / columns)];
        const to = (row * cell.height * width + column * cell.width) * 4;
        for (let v = 0; v < V; ++v) {
            const from = ((row * V + v) * picture.width + column * U) * 4;
            pixels.set(picture.pixels.subarray(from, from + 4 * U), to + v * width * 4);
        }
        for (let mip = 1; mip <= mips; ++mip)
            addMip(pixels, to, width, [U, V], mip, ids, cell);
    }
    return {width, height, half: false, pixels};
}

function addMip(pixels, begin, width, [U, V], mip, ids, cell) {
    for (let y = 0; y < halved(V, mip); ++y)
        for (let x = 0; x < halved(U, mip); ++x) {
            const own = ids[(cell.rows[mip] + y) * cell.width + U + x];
            if (!own)
                continue;
            const u0 = x << mip, u1 = Math.min(x + 1 << mip, U), v1 = Math.min(y + 1 << mip, V);
            let count = 0, red = 0, green = 0, blue = 0, alpha = 0;
            for (let v = y << mip; v < v1; ++v)
                for (let u = u0; u < u1; ++u)
                    if (ids[v * cell.width + u] === own) {
                        const from = begin + (v * width + u) * 4;
                        ++count;
                        red += pixels[from];
                        green += pixels[from + 1];
                        blue += pixels[from + 2];
                        alpha += pixels[from + 3];
                    }
            const to = begin + ((cell.rows[mip] + y) * width + U + x) * 4;
            const mean = sum => Math.floor((2 * sum + count) / (2 * count));
            pixels[to] = mean(red);
            pixels[to + 1] = mean(green);
            pixels[to + 2] = mean(blue);
            pixels[to + 3] = mean(alpha);
        }
}

// The charts of all atlases below each other, with the number of a chart in red and green.
function chartPicture(atlases) {
    const width = Math.max(...atlases.map(({cell}) => cell?.width ?? 0)), places = [];
    let height = 0;
    for (const {size, mips, cell} of atlases) {
        places.push({size, mips, row: height});
        height += cell?.height ?? 0;
    }
    const pixels = new Uint8Array(width * height * 4);
    atlases.forEach(({ids, cell}, i) => ids?.forEach((id, at) => {
        const to = ((places[i].row + Math.floor(at / cell.width)) * width + at % cell.width) * 4;
        pixels[to] = id & 255;
        pixels[to + 1] = id >> 8;
    }));
    return {atlases: places, charts: {width, height, half: false, pixels}};
}
