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
    for (let i = 0; i < us.length; ++i) {
        out[2 * i] = us[i] * unit;
        out[2 * i + 1] = vs[i] * unit;
    }
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
        const x = positions[3 * vertex], y = positions[3 * vertex + 1], z = positions[3 * vertex + 2];
        chartOfVertex[vertex] = number;
        for (let k = 0; k < 2; ++k) {
            const along = axes[k][0] * x + axes[k][1] * y + axes[k][2] * z;
            uv[2 * vertex + k] = along;
            low[k] = Math.min(low[k], along);
        }
    });
    return Float32Array.from(uv, (along, i) => {
        const number = chartOfVertex[i >> 1], k = i & 1, {low, texels} = charts[number];
        return ((along - low[k]) * texels + begins[k][number]) / size[k];
    });
}

const lengthOf = (x, y, z) => Math.sqrt(x * x + y * y + z * z); // Math.hypot is much slower

// The tangent of each vertex (FORMAT.md 5.2), like mesh_tangents() of the library.
function tangentsOf({positions: p, normals, uv, indices}) {
    const sums = new Float64Array(p.length), out = new Float32Array(p.length);
    for (let i = 0; i < indices.length; i += 3) {
        const first = indices[i], second = indices[i + 1], third = indices[i + 2];
        const ax = p[3 * second] - p[3 * first], bx = p[3 * third] - p[3 * first];
        const ay = p[3 * second + 1] - p[3 * first + 1], by = p[3 * third + 1] - p[3 * first + 1];
        const az = p[3 * second + 2] - p[3 * first + 2], bz = p[3 * third + 2] - p[3 * first + 2];
        const pu = uv[2 * second] - uv[2 * first], pv = uv[2 * second + 1] - uv[2 * first + 1];
        const qu = uv[2 * third] - uv[2 * first], qv = uv[2 * third + 1] - uv[2 * first + 1];
        const turn = pu * qv - pv * qu, x = ax * qv - bx * pv, y = ay * qv - by * pv, z = az * qv - bz * pv;
        const length = lengthOf(x, y, z), area = lengthOf(ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx);
        if (turn === 0 || !(length > 0))
            continue;
        const size = area / length * Math.sign(turn);
        for (let k = 0; k < 3; ++k) {
            const at = 3 * indices[i + k];
            sums[at] += x * size;
            sums[at + 1] += y * size;
            sums[at + 2] += z * size;
        }
    }
    for (let i = 0; i < p.length; i += 3)
        putPerpendicular(out, i, sums[i], sums[i + 1], sums[i + 2], normals[i], normals[i + 1], normals[i + 2]);
    return out;
}

// Puts the part of (x, y, z) that is perpendicular to the normal (a, b, c), scaled to unit length. If there is none, it
// is that part of the coordinate axis that is closest to perpendicular to the normal.
function putPerpendicular(out, at, x, y, z, a, b, c) {
    const square = a * a + b * b + c * c, along = (x * a + y * b + z * c) / square;
    const u = x - along * a, v = y - along * b, w = z - along * c, length = lengthOf(u, v, w);
    if (length > 1e-6 * lengthOf(x, y, z)) {
        out[at] = u / length;
        out[at + 1] = v / length;
        out[at + 2] = w / length;
        return;
    }
    const [sideways, up, ahead] = [a, b, c].map(Math.abs);
    const axis = sideways <= up && sideways <= ahead ? [1, 0, 0] : up <= ahead ? [0, 1, 0] : [0, 0, 1];
    putPerpendicular(out, at, ...axis, a, b, c);
}

// Unit vectors from octahedral coordinates, 0..4095 along both sides of the square.
function directions(across, up) {
    const out = new Float32Array(across.length * 3);
    for (let i = 0; i < across.length; ++i) {
        let x = across[i] / 2047.5 - 1, y = up[i] / 2047.5 - 1;
        const z = 1 - Math.abs(x) - Math.abs(y);
        if (z < 0)
            [x, y] = [(1 - Math.abs(y)) * (x < 0 ? -1 : 1), (1 - Math.abs(x)) * (y < 0 ? -1 : 1)];
        const length = lengthOf(x, y, z);
        out[3 * i] = x / length;
        out[3 * i + 1] = y / length;
        out[3 * i + 2] = z / length;
    }
    return out;
}
