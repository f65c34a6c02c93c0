// Sorts triangles, so that surfaces that blend are drawn after those behind them.
export class TriangleOrder {
    // indices: three per triangle; positionOf(vertex) returns [x, y, z].
    constructor(indices, positionOf) {
        this.indices = indices.slice();
        this.middles = new Float64Array(indices.length);
        for (let i = 0; i < indices.length; ++i)
            positionOf(indices[i]).forEach((x, axis) => { this.middles[i - i % 3 + axis] += x / 3; });
    }

    // The indices with the triangles farthest from `eye` first; null if `eye` is where it was at the last call.
    seenFrom(eye) {
        if (this.eye?.every((x, axis) => x === eye[axis]))
            return null;
        this.eye = [...eye];
        const {indices, middles} = this, [x, y, z] = eye, distances = new Float64Array(indices.length / 3);
        for (let i = 0; i < distances.length; ++i)
            distances[i] = Math.hypot(middles[3 * i] - x, middles[3 * i + 1] - y, middles[3 * i + 2] - z);
        const order = Uint32Array.from(distances, (_, i) => i).sort((a, b) => distances[b] - distances[a] || a - b);
        const sorted = indices.slice();
        order.forEach((from, to) => sorted.set(indices.subarray(3 * from, 3 * from + 3), 3 * to));
        return sorted;
    }
}
