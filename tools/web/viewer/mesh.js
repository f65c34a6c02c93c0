// The mesh of a texture as `tessera view` writes it into the page. tools/page/view_data.h specifies the columns:
// differences of consecutive integers, zigzag coded and split into planes of bytes.

class MeshData {
    // about: `mesh` of the JSON line; bytes: the columns behind this line.
    constructor(about, bytes) {
        let at = 0;
        const column = (count, planes) => {
            const out = new Int32Array(count);
            for (let plane = 0; plane < planes; ++plane, at += count)
                for (let i = 0; i < count; ++i)
                    out[i] |= bytes[at + i] << 8 * plane;
            for (let i = 0, last = 0; i < count; ++i)
                last = out[i] = last + (out[i] >>> 1 ^ -(out[i] & 1));
            return out;
        };
        const {vertices, triangles, tangents, low, high, step} = about;
        const places = [0, 1, 2].map(() => column(vertices, 3));
        this.low = low;
        this.high = high;
        this.positions = new Float32Array(vertices * 3);
        for (let axis = 0; axis < 3; ++axis)
            for (let i = 0; i < vertices; ++i)
                this.positions[3 * i + axis] = low[axis] + step * places[axis][i];
        this.normals = directions(column(vertices, 3), column(vertices, 3));
        this.indices = new Uint32Array(column(triangles * 3, 4));
        this.uv = about.charts ? uvOfCharts(this, about.charts, column)
                               : interleaved([column(vertices, 4), column(vertices, 4)], 2 ** -24);
        // The mirrored map does not use tangents, so any values will do.
        this.tangents = tangents ? tangentsOf(this) : this.normals;
        // The charts of each atlas. The first one is that of the texture or of its first layer.
        const uvOf = vertex => this.uv.subarray(2 * vertex, 2 * vertex + 2), {indices} = this;
        this.atlases = [about, ...(about.further || [])].map(({mips, atlas}) => new Charts(
            mips ? chartIds(atlas, mips, [{indices, vertices, uvOf}]) : new Uint16Array(), atlas, mips));
        this.layers = about.layers || []; // the number of the atlas of each further layer
    }
}

function interleaved([us, vs], unit) {
    const out = new Float32Array(us.length * 2);
    us.forEach((u, i) => out.set([u * unit, vs[i] * unit], 2 * i));
    return out;
}

// The uv that charts give (FORMAT.md 5.2), like lay_charts() of the library. column: reads the next column.
function uvOfCharts({positions, indices}, {count, size, density}, column) {
    const chartOf = column(indices.length / 3, 3), rotations = [0, 1, 2, 3].map(() => column(count, 2));
    const shares = column(count, 2), begins = [column(count, 4), column(count, 4)];
    const charts = Array.from(shares, (share, i) => {
        const [x, y, z, w] = rotations.map(numbers => numbers[i] - 128), n = x * x + y * y + z * z + w * w;
        return {low: [Infinity, Infinity], texels: density * (share + 1) / 256,
                axes: [[w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
                       [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)]]
                    .map(axis => scale(axis, 1 / n))};
    });
    const uv = new Float64Array(positions.length / 3 * 2), chartOfVertex = new Int32Array(positions.length / 3);
    indices.forEach((vertex, i) => {
        const number = chartOf[Math.floor(i / 3)], {axes, low} = charts[number];
        chartOfVertex[vertex] = number;
        for (let k = 0; k < 2; ++k) {
            const along = dot(axes[k], positions.subarray(3 * vertex, 3 * vertex + 3));
            uv[2 * vertex + k] = along;
            low[k] = Math.min(low[k], along);
        }
    });
    return Float32Array.from(uv, (along, i) => {
        const number = chartOfVertex[i >> 1], k = i & 1, {low, texels} = charts[number];
        return ((along - low[k]) * texels + begins[k][number]) / size[k];
    });
}

// The tangent of each vertex (FORMAT.md 5.2), like mesh_tangents() of the library.
function tangentsOf({positions, normals, uv, indices}) {
    const sums = new Float64Array(positions.length), out = new Float32Array(positions.length);
    const place = vertex => positions.subarray(3 * vertex, 3 * vertex + 3);
    for (let i = 0; i < indices.length; i += 3) {
        const corners = indices.subarray(i, i + 3), [first, second, third] = corners;
        const a = sub(Array.from(place(second)), place(first)), b = sub(Array.from(place(third)), place(first));
        const [px, py, qx, qy] = [second, third].flatMap(
            vertex => [0, 1].map(axis => uv[2 * vertex + axis] - uv[2 * first + axis]));
        const turn = px * qy - py * qx, along = sub(scale(a, qy), scale(b, py));
        const length = Math.hypot(...along);
        if (turn === 0 || !(length > 0))
            continue;
        const size = Math.hypot(...cross(a, b)) / length * Math.sign(turn);
        for (const vertex of corners)
            for (let axis = 0; axis < 3; ++axis)
                sums[3 * vertex + axis] += along[axis] * size;
    }
    for (let i = 0; i < positions.length; i += 3)
        out.set(perpendicularPart(Array.from(sums.subarray(i, i + 3)), unit(Array.from(normals.subarray(i, i + 3)))), i);
    return out;
}

// The part of `v` that is perpendicular to the unit vector `normal`, scaled to unit length. If there is none, that part
// of the coordinate axis that is closest to perpendicular to the normal.
function perpendicularPart(v, normal) {
    const part = x => sub(x, scale(normal, dot(x, normal)));
    const flat = part(v), length = Math.hypot(...flat);
    if (length > 1e-6 * Math.hypot(...v))
        return scale(flat, 1 / length);
    const [x, y, z] = normal.map(Math.abs);
    return unit(part(x <= y && x <= z ? [1, 0, 0] : y <= z ? [0, 1, 0] : [0, 0, 1]));
}

// Unit vectors from octahedral coordinates, 0..4095 along both sides of the square.
function directions(across, up) {
    const out = new Float32Array(across.length * 3);
    for (let i = 0; i < across.length; ++i) {
        let x = across[i] / 2047.5 - 1, y = up[i] / 2047.5 - 1;
        const z = 1 - Math.abs(x) - Math.abs(y);
        if (z < 0)
            [x, y] = [(1 - Math.abs(y)) * (x < 0 ? -1 : 1), (1 - Math.abs(x)) * (y < 0 ? -1 : 1)];
        out.set(unit([x, y, z]), 3 * i);
    }
    return out;
}
