// Textures that tests make, as .rgb files have them.

// colour(u, v, s, t): red, green, blue
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

// Of cameras that see one picture move by two texels a view, along v the other way.
export function movingColour(u, v, s, t) {
    const x = u - 2 * s, y = v + 2 * t;
    return [0, 1, 2].map(c => 128 + 50 * Math.sin(0.3 * x + c) + 50 * Math.cos(0.3 * y - 0.01 * x * y));
}
