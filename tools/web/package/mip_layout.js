// How a view of a layer and its mips lie in a picture.
const mostMips = 4;

export const halved = (n, times) => Math.ceil(n / 2 ** times);

// The number of mips of an atlas: how often its tiles can be halved so that each begins at a whole texel (FORMAT.md 5.2).
export function mipCount({gridSize, tiles}) {
    let count = mostMips;
    for (const axis of [0, 1])
        for (let i = 1; i < tiles[axis]; ++i)
            while (Math.floor(i * gridSize[axis] / tiles[axis]) % 2 ** count)
                --count;
    return count;
}

// A view with its mips to the right of it, each below the previous one. rows: the first row of each mip.
export function cellOf([U, V], mips) {
    const rows = [0];
    for (let mip = 1, row = 0; mip <= mips; ++mip) {
        rows.push(row);
        row += halved(V, mip);
    }
    const below = mips ? rows[mips] + halved(V, mips) : 0;
    return {width: U + (mips ? halved(U, 1) : 0), height: Math.max(V, below), rows};
}
