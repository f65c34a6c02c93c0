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
        const {vertices, triangles, tangents, low, high} = about;
        const places = [0, 1, 2].map(() => column(vertices, 3));
        this.low = low;
        this.high = high;
        this.positions = new Float32Array(vertices * 3);
        for (let axis = 0; axis < 3; ++axis)
            for (let i = 0; i < vertices; ++i)
                this.positions[3 * i + axis] = low[axis] + (high[axis] - low[axis]) * places[axis][i] / 65535;
        this.normals = directions(column(vertices, 3), column(vertices, 3));
        // The mirrored map does not use tangents, so any values will do.
        this.tangents = tangents ? directions(column(vertices, 3), column(vertices, 3)) : this.normals;
        const u = column(vertices, 4), v = column(vertices, 4);
        this.uv = new Float32Array(vertices * 2);
        for (let i = 0; i < vertices; ++i) {
            this.uv[2 * i] = u[i] / 2 ** 24;
            this.uv[2 * i + 1] = v[i] / 2 ** 24;
        }
        this.indices = new Uint32Array(column(triangles * 3, 4));
        // The charts of each atlas. The first one is that of the texture or of its first layer.
        this.atlases = [about, ...(about.further || [])].map(({mips, atlas}) => {
            const charts = new Charts(null, atlas, mips);
            charts.ids = Uint16Array.from(mips ? column(charts.width * charts.height, 3) : []);
            return charts;
        });
        this.layers = about.layers || []; // the number of the atlas of each further layer
    }
}

// Unit vectors from octahedral coordinates, 0..65535 along both sides of the square.
function directions(across, up) {
    const out = new Float32Array(across.length * 3);
    for (let i = 0; i < across.length; ++i) {
        let x = across[i] / 32767.5 - 1, y = up[i] / 32767.5 - 1;
        const z = 1 - Math.abs(x) - Math.abs(y);
        if (z < 0)
            [x, y] = [(1 - Math.abs(y)) * (x < 0 ? -1 : 1), (1 - Math.abs(x)) * (y < 0 ? -1 : 1)];
        out.set(unit([x, y, z]), 3 * i);
    }
    return out;
}
