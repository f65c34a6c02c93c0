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
            const number = chartOf.get(group), [a, b, c] = [0, 1, 2].map(k => {
                const [u, v] = uvOf(indices[i + k]);
                return [u * U, v * V];
            });
            visitCovered(a, b, c, size, (u, v) => { ids[v * cell.width + u] ||= number; });
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

// Calls visit(u, v) for each texel whose square intersects the triangle (a, b, c), like visit_covered_texels() of the
// library.
function visitCovered([ax, ay], [bx, by], [cx, cy], [U, V], visit) {
    const area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax), inside = area < 0 ? -1 : 1;
    if (area === 0)
        return;
    const within = (x, most) => Math.min(Math.max(Math.floor(x), 0), most);
    const u0 = within(Math.min(ax, bx, cx), U), u1 = within(Math.max(ax, bx, cx) + 1, U);
    const v0 = within(Math.min(ay, by, cy), V), v1 = within(Math.max(ay, by, cy) + 1, V);
    const xs = [ax, bx, cx], ys = [ay, by, cy], dx = [bx - ax, cx - bx, ax - cx], dy = [by - ay, cy - by, ay - cy];
    // The corner of a square that is furthest inside an edge: if it is outside, the whole square is.
    const along = dy.map(d => inside * d < 0 ? 1 : 0), across = dx.map(d => inside * d > 0 ? 1 : 0);
    for (let v = v0; v < v1; ++v) {
        const row0 = dx[0] * (v + across[0] - ys[0]), row1 = dx[1] * (v + across[1] - ys[1]);
        const row2 = dx[2] * (v + across[2] - ys[2]);
        for (let u = u0; u < u1; ++u)
            if ((row0 - dy[0] * (u + along[0] - xs[0])) * inside >= 0 &&
                (row1 - dy[1] * (u + along[1] - xs[1])) * inside >= 0 &&
                (row2 - dy[2] * (u + along[2] - xs[2])) * inside >= 0)
                visit(u, v);
    }
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
