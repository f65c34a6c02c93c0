// The mips of a surface (FORMAT.md 5.2): means over texels of one chart. The charts come from the triangles of the mesh.
import {cellOf, halved} from './mip_layout.js';
import {usualSide} from './surface_shader.js';

const mostCharts = 0xFFFF;
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

// The numbers of the charts from 1, in the layout of a cell; 0: none. Without `ids` if there are too many.
function atlasOf(size, mips, meshes) {
    const [U, V] = size, cell = cellOf(size, mips), ids = new Uint16Array(cell.width * cell.height);
    let charts = 0, covered = 0, triangles = 0;
    for (const {indices, vertices, uvOf} of meshes) {
        const joined = joinedVertices(indices, vertices), chartOf = new Map();
        triangles += indices.length / 3;
        for (let i = 0; i < indices.length; i += 3) {
            const corners = [0, 1, 2].map(k => uvOf(indices[i + k])).map(([u, v]) => [u * U, v * V]);
            const group = joined(indices[i]);
            if (!chartOf.has(group))
                chartOf.set(group, ++charts);
            const [width, height] = [0, 1].map(axis => corners.map(c => c[axis]))
                .map(places => Math.max(...places) - Math.min(...places) + 2);
            covered += width * height;
            if (charts > mostCharts || covered > mostCovered * (U * V + 65536 + 9 * triangles))
                return {size, mips};
            visitCovered(corners, size, (u, v) => { ids[v * cell.width + u] ||= chartOf.get(group); });
        }
    }
    for (let mip = 1; mip <= mips; ++mip)
        for (let y = 0; y < halved(V, mip); ++y)
            for (let x = 0; x < halved(U, mip); ++x)
                ids[(cell.rows[mip] + y) * cell.width + U + x] = mostFrequent(ids, cell.width, size, mip, x, y);
    return {size, mips, ids, cell};
}

// A function from a vertex to the number of its group, which triangles connect.
function joinedVertices(indices, vertices) {
    const first = Uint32Array.from({length: vertices}, (_, i) => i);
    const find = vertex => {
        while (first[vertex] !== vertex)
            vertex = first[vertex] = first[first[vertex]];
        return vertex;
    };
    for (let i = 0; i < indices.length; i += 3)
        for (const next of [1, 2]) {
            const [a, b] = [find(indices[i]), find(indices[i + next])];
            first[Math.max(a, b)] = Math.min(a, b);
        }
    return find;
}

// Calls visit(u, v) for each texel whose square intersects the triangle, like visit_covered_texels() of the library.
function visitCovered(corners, size, visit) {
    const edges = corners.map(([x, y], k) => {
        const [toX, toY] = corners[(k + 1) % 3];
        return {x, y, dx: toX - x, dy: toY - y};
    });
    const [{dx, dy}, , last] = edges, area = last.dx * dy - last.dy * dx; // the third edge points back to the first corner
    if (area === 0)
        return;
    // Whether a square is entirely outside an edge: then its corner that is furthest inside is.
    const isBeyond = (u, v) => {
        for (const {x, y, dx, dy} of edges) {
            const inside = area < 0 ? -1 : 1, across = inside * dx > 0 ? 1 : 0, along = inside * dy < 0 ? 1 : 0;
            if ((dx * (v + across - y) - dy * (u + along - x)) * inside < 0)
                return true;
        }
        return false;
    };
    const range = axis => {
        const values = corners.map(corner => corner[axis]), within = x => Math.min(Math.max(x, 0), size[axis]);
        return [within(Math.floor(Math.min(...values))), within(Math.floor(Math.max(...values)) + 1)];
    };
    const [[u0, u1], [v0, v1]] = [range(0), range(1)];
    for (let v = v0; v < v1; ++v)
        for (let u = u0; u < u1; ++u)
            if (!isBeyond(u, v))
                visit(u, v);
}

// The chart of most texels of the atlas in a texel of a mip, and the lowest of several; 0 if there is none.
function mostFrequent(ids, width, [U, V], mip, x, y) {
    const u0 = x << mip, u1 = Math.min(x + 1 << mip, U), v1 = Math.min(y + 1 << mip, V), counts = new Map();
    const first = ids[(y << mip) * width + u0];
    let differs = false;
    for (let v = y << mip; v < v1 && !differs; ++v)
        for (let u = u0; u < u1; ++u)
            differs ||= ids[v * width + u] !== first;
    if (!differs)
        return first;
    for (let v = y << mip; v < v1; ++v)
        for (let u = u0; u < u1; ++u) {
            const id = ids[v * width + u];
            if (id)
                counts.set(id, (counts.get(id) ?? 0) + 1);
        }
    let best = 0;
    for (const [id, count] of counts)
        if (!best || count > counts.get(best) || count === counts.get(best) && id < best)
            best = id;
    return best;
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
