// Types of tessera.js. Everything that fails throws an Error (or rejects with one) whose message is a sentence.

/** Texels along u, v, s, t: (u, v) is the place on the surface, (s, t) the direction that light leaves it in. */
export type Extent4 = [number, number, number, number];
/** Places [u0, u1, v0, v1], ends excluded. */
export type Places = [number, number, number, number];
/** Texels [u0, u1, v0, v1, s0, s1, t0, t1], ends excluded. */
export type Box = [number, number, number, number, number, number, number, number];

export interface Level {
    size: Extent4;
    /** The largest tile, and the tiles along each axis. */
    tile: Extent4;
    tiles: Extent4;
    /** A texel stands for 2^spatialLod texels of level 0 along u and v, 2^angularLod along s and t. */
    spatialLod: number;
    angularLod: number;
}

export interface Info {
    size: Extent4;
    type: 'unorm8' | 'half';
    /** 1 grey, 2 grey and alpha, 3 RGB, 4 RGB and alpha. */
    channels: number;
    texelBytes: number;
    /** Bytes of the whole file. */
    bytes: number;
    tile: Extent4;
    tiles: Extent4;
    /**
     * How many texels further along u (of each next s) and v (of each next t) views lie in the grid of tiles, -128
     * to 127; [0, 0]: texels lie where the texture has them. Then coarse is 0 and the proxy none or planar.
     */
    alignment: [number, number];
    /** Texels of the grid that `tiles` cut; without an alignment those of the texture, `size`. */
    gridSize: Extent4;
    /** The texture first, then coarser and coarser copies. */
    levels: Level[];
    /** Number of the coarsest level; 0 where there is only the texture. */
    coarse: number;
    /** What the texture lies on; planar: the views of a grid of cameras. */
    proxy: 'none' | 'sphere' | 'mesh' | 'planar' | 'unknown';
    /** The sphere is seen from inside. */
    inside: boolean;
    /** Of the sphere, in world units. */
    centre: [number, number, number];
    radius: number;
    /** Nearest and farthest observer from the centre; [0, 0]: anywhere. */
    viewingRadius: [number, number];
    /** Names as `tessera info` prints them. */
    proxyName: string;
    angularMap: string;
    colour: string;
    transfer: 'unspecified' | 'srgb' | 'linear' | 'unknown';
    primaries: 'unspecified' | 'bt709' | 'unknown';
    alpha: 'none' | 'straight' | 'premultiplied' | 'unknown';
    /** Of texels that are not stored: 0..1, of half-floats their values. */
    background: number[];
    /** null where it is packed with Zstandard, which is not read here. */
    metadata: Record<string, string> | null;
}

export interface Picture {
    level: number;
    width: number;
    height: number;
    rgba: Uint8Array;
}

export class TessFile {
    readonly info: Info;
    /**
     * RGBA of 8 bits, (u1 - u0) * S wide and (v1 - v0) * T high: texel (u, v, s, t) stands at
     * x = (u - u0) * S + s, y = (v - v0) * T + t. Half-floats are tone-mapped as `tessera render` does it.
     * `out`, of exactly that size, saves an allocation.
     */
    atlas(places: Places, out?: Uint8Array, level?: number): Uint8Array;
    /** Samples as they are stored, order v, u, t, s, channels adjacent; half-floats little-endian. */
    box(box: Box, out?: Uint8Array, level?: number): Uint8Array;
    /** The same for openSource() and openUrl(): missing bytes are fetched first. */
    fetchAtlas(places: Places, out?: Uint8Array, level?: number): Promise<Uint8Array>;
    fetchBox(box: Box, out?: Uint8Array, level?: number): Promise<Uint8Array>;
    /**
     * Like fetchBox() of level 0, but a box of the grid of tiles, info.gridSize texels large: the box of a tile needs
     * no other. Texel (u, v, s, t) of the texture lies there at u + shift(alignment[0], s, S),
     * v + shift(alignment[1], t, T), s, t with shift(a, x, n) = a >= 0 ? a * x : -a * (n - 1 - x). What lies in no
     * view may be anything.
     */
    fetchGridBox(box: Box, out?: Uint8Array): Promise<Uint8Array>;
    /** Brings the bytes of these texels, so that atlas() and box() need not wait. */
    fetch(box: Box, level?: number): Promise<void>;
    /** The coarsest level whole; null where there is none. */
    preview(): Picture | null;
    fetchPreview(): Promise<Picture | null>;
    /** A Draco stream, for three.js' DRACOLoader or others; null where the proxy is no mesh. */
    meshBytes(): Uint8Array | null;
    /** null where the proxy is no mesh; else an Error: there is no Draco in this module. */
    mesh(): null;
    /** Gives all memory back; the file cannot be used any more. */
    close(): void;
    /** By close(), or for want of memory. */
    readonly closed: boolean;
}

export interface OpenOptions {
    /** Accept the beginning of a file; coarser levels stand in for what is missing. */
    partial?: boolean;
    /** Let coarser levels, or the background, stand in for damaged tiles. */
    damaged?: boolean;
}

export interface HttpOptions {
    /** How often a range is asked for in a row (5). */
    tries?: number;
    signal?: AbortSignal;
}

export interface ByteSource {
    /** Bytes of the whole file. */
    size: number;
    /** Exactly `length` bytes from `offset` on. */
    read(offset: number, length: number): Promise<Uint8Array | ArrayBuffer>;
}

export class Codec {
    /** May be sent to workers, which call loadTessera() with it. */
    readonly module: WebAssembly.Module;
    openBytes(bytes: Uint8Array | ArrayBuffer, options?: OpenOptions): TessFile;
    openSource(source: ByteSource, options?: OpenOptions): Promise<TessFile>;
    openUrl(url: string, options?: OpenOptions & HttpOptions): Promise<TessFile>;
}

/** `wasm`: tessera.wasm as bytes or as a Response (or a promise of one), or a compiled module. */
export function loadTessera(
    wasm: BufferSource | Response | WebAssembly.Module | Promise<BufferSource | Response | WebAssembly.Module>
): Promise<Codec>;

/** A file on a web server, by range requests; lost connections are taken up again. */
export function httpSource(url: string, options?: HttpOptions): Promise<ByteSource>;
