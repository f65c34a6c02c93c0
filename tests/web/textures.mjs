// Textures for tests, in the layout of .rgb files.

// colour(u, v, s, t) returns [red, green, blue].
export function texelsOf([U, V, S, T], colour) {
    const out = Buffer.alloc(U * V * S * T * 3);
    let at = 0;
    for (let v = 0; v < V; ++v)
        for (let u = 0; u < U; ++u)
            for (let t = 0; t < T; ++t)
                for (let s = 0; s < S; ++s, at += 3)
                    out.set(colour(u, v, s, t), at);
    return out;
}

// A colour of moving views: per view, the picture moves by two texels along u and by minus two
// along v.
export function movingColour(u, v, s, t) {
    const x = u - 2 * s, y = v + 2 * t;
    return [0, 1, 2].map(c => 128 + 50 * Math.sin(0.3 * x + c) + 50 * Math.cos(0.3 * y - 0.01 * x * y));
}
