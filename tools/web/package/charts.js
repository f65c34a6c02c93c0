// The charts of an atlas and its mips (FORMAT.md 5.2), from the triangles of a mesh, like class AtlasMips of the library.
// The npm package and the viewer use this file.
import {cellOf, halved} from './mip_layout.js';

const mostCharts = 0xFFFF; // numbers repeat after this; neighbours must differ

// The number of each texel's chart, from 1, in the layout of cellOf(size, mips); 0: none.
// meshes: [{indices, vertices, uvOf(vertex)}] for all primitives with the texture.
export function chartIds(size, mips, meshes) {
    const [U, V] = size, cell = cellOf(size, mips), ids = new Uint16Array(cell.width * cell.height);
    let charts = 0;
    for (const {indices, vertices, uvOf} of meshes) {
        const joined = joinedVertices(indices, vertices), chartOf = new Map();
        for (let i = 0; i < indices.length; i += 3) {
            const group = joined(indices[i]);
            if (!chartOf.has(group))
                chartOf.set(group, charts++ % mostCharts + 1);
            const corners = [0, 1, 2].map(k => uvOf(indices[i + k])).map(([u, v]) => [u * U, v * V]);
            visitCovered(corners, size, (u, v) => { ids[v * cell.width + u] ||= chartOf.get(group); });
        }
    }
    for (let mip = 1; mip <= mips; ++mip)
        for (let y = 0; y < halved(V, mip); ++y)
            for (let x = 0; x < halved(U, mip); ++x)
                ids[(cell.rows[mip] + y) * cell.width + U + x] = mostFrequent(ids, cell.width, size, mip, x, y);
    return ids;
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
