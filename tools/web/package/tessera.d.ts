// Types of tessera.js. A call that fails throws an Error, or rejects with one; its message is a sentence.

/** Texels along u, v, s and t. (u, v) is a position on the surface, (s, t) a direction in which light leaves it. */
export type Extent4 = [number, number, number, number];
/** Positions on the surface: [u0, u1, v0, v1], ends excluded. All directions are included. */
export type Places = [number, number, number, number];
/** A box of texels: [u0, u1, v0, v1, s0, s1, t0, t1], ends excluded. */
export type Box = [number, number, number, number, number, number, number, number];

/*
 * Codes of the header's fields, as FORMAT.md 1.1 numbers them. Compare the fields of Info with these constants. A
 * file may hold other codes in proxy, surfaceMap, angularMap, transfer and primaries; its texels decode all the same.
 */
/** Type of a sample: an 8-bit integer that stands for 0..1, or an IEEE 754 half float. */
export const SAMPLE_TYPE: {readonly unorm8: 0; readonly half16: 1};
/** Meaning of the last of 2 or 4 channels. */
export const ALPHA: {readonly none: 0; readonly straight: 1; readonly premultiplied: 2};
/** The geometry that the texture lies on. */
export const PROXY: {readonly none: 0; readonly sphere: 1; readonly mesh: 2; readonly sphereInside: 3};
/** How (u, v) maps to positions on the proxy. */
export const SURFACE_MAP: {readonly none: 0; readonly sphereLongitudeLatitude: 1; readonly meshUv: 2};
/** How (s, t) maps to directions. With planarViews, (s, t) counts cameras of a grid and (u, v) pixels of a view. */
export const ANGULAR_MAP: {
    readonly none: 0;
    readonly hemisphereAlphaBeta: 1;
    readonly planarViews: 2;
    readonly octahedralHemisphere: 3;
    readonly octahedralMirrored: 4;
};
/** Transfer function of the colours. */
export const TRANSFER: {readonly unspecified: 0; readonly srgb: 1; readonly linear: 2};
/** Colour primaries. */
export const PRIMARIES: {readonly unspecified: 0; readonly bt709: 1};
/** What a layer holds. */
export const LAYER_ROLE: {
    readonly diffuse: 0;
    readonly emission: 1;
    readonly specular: 2;
    readonly roughness: 3;
    readonly normal: 4;
    readonly visibility: 5;
    readonly reflection: 6;
    readonly coverage: 7;
    readonly environment: 8;
    readonly difference: 9;
    readonly sharedDifference: 10;
    readonly opacity: 11;
};

/** Level 0 is the texture; levels above 0 are coarser copies. */
export interface Level {
    size: Extent4;
    /** Size of the largest tile. */
    tile: Extent4;
    /** Number of tiles along each axis. */
    tiles: Extent4;
    /** A texel covers 2^spatialLod texels of level 0 along u and v. */
    spatialLod: number;
    /** A texel covers 2^angularLod texels of level 0 along s and t. */
    angularLod: number;
}

export interface Info {
    size: Extent4;
    /** One of SAMPLE_TYPE. */
    sampleType: number;
    /** 1 grey, 2 grey and alpha, 3 RGB, 4 RGB and alpha. */
    channels: number;
    /** Bytes per decoded texel. */
    texelBytes: number;
    /** Bytes of the whole file. */
    bytes: number;
    /** Those of level 0. */
    tile: Extent4;
    tiles: Extent4;
    /**
     * Aligned views are shifted in the tile grid: from one s to the next by alignment[0] texels along u, from one t to
     * the next by alignment[1] texels along v, each -128..127. [0, 0]: not aligned. Aligned files have no coarse
     * levels, and their proxy is PROXY.none.
     */
    alignment: [number, number];
    /** Size of the grid that the tiles of level 0 divide. It equals `size` if the views are not aligned. */
    gridSize: Extent4;
    /** The texture, followed by the coarse levels from fine to coarse. */
    levels: Level[];
    /** Number of the coarsest level; 0 if there is only the texture. */
    coarse: number;
    /** One of PROXY. */
    proxy: number;
    /** One of SURFACE_MAP. */
    surfaceMap: number;
    /** One of ANGULAR_MAP. */
    angularMap: number;
    /** One of TRANSFER. */
    transfer: number;
    /** One of PRIMARIES. */
    primaries: number;
    /** One of ALPHA. */
    alpha: number;
    /** Names of these fields and of the colour transform, for display, as `tessera info` prints them. */
    names: Record<'proxy' | 'surfaceMap' | 'angularMap' | 'transfer' | 'primaries' | 'alpha' | 'colour', string>;
    /** True if the proxy is PROXY.sphereInside. */
    inside: boolean;
    /** Centre of the sphere, in world units. */
    centre: [number, number, number];
    /** Radius of the sphere, in world units; 0 without one. */
    radius: number;
    /** Distances of the nearest and the farthest observer from the centre; [0, 0]: any distance. */
    viewingRadius: [number, number];
    /** Samples of a texel that is not stored: 0..1 for unorm8, values for half16. */
    background: number[];
    /** null if the metadata is packed with Zstandard, which this module cannot unpack. */
    metadata: Record<string, string> | null;
}

/** A whole level as a picture, in the layout of TessFile.atlas(). */
export interface Picture {
    level: number;
    width: number;
    height: number;
    rgba: Uint8Array;
}

/** Distant light from a patch of directions. */
export interface DistantLight {
    /** Unit vector towards the middle of the patch. */
    direction: [number, number, number];
    /** Root mean square of the angle between the middle and the patch's directions, along one axis, in radians. */
    spread: number;
    /** RGB, on a surface that faces the light. */
    irradiance: [number, number, number];
}

/** The layers of a file, which FORMAT.md 5.6 puts together. The first one has the texels of the file itself. */
export interface Layers {
    /** The light of a sample of 1 in the first layer. */
    scale: number;
    /** The layers after the first one; empty: the file has one texture. */
    further: {
        /** One of LAYER_ROLE. */
        role: number;
        /** The light, or other value, of a sample of 1. */
        scale: number;
        /** The texels of the layer. Closing it closes the whole file. */
        file: TessFile;
    }[];
    lights: DistantLight[];
}

/**
 * An open file. box() and atlas() need all bytes that they read; the methods whose names begin with "fetch" request
 * missing bytes from the source first.
 */
export class TessFile {
    readonly info: Info;
    /**
     * An RGBA picture with 8 bits per sample, (u1 - u0) * S wide and (v1 - v0) * T high. Texel (u, v, s, t) is at
     * x = (u - u0) * S + s, y = (v - v0) * T + t. Half floats are tone-mapped like in `tessera render`. `out` receives
     * the picture if it is given; it must have exactly that size.
     */
    atlas(places: Places, out?: Uint8Array, level?: number): Uint8Array;
    /** Decoded samples in the order v, u, t, s, channels together. Half floats are little-endian. */
    box(box: Box, out?: Uint8Array, level?: number): Uint8Array;
    /** Like atlas(), after fetching what is missing. */
    fetchAtlas(places: Places, out?: Uint8Array, level?: number): Promise<Uint8Array>;
    /** Like box(), after fetching what is missing. */
    fetchBox(box: Box, out?: Uint8Array, level?: number): Promise<Uint8Array>;
    /**
     * Like fetchBox() for level 0, but `box` is in the tile grid, whose size is info.gridSize. The box of a tile reads
     * this tile only. Texel (u, v, s, t) of the texture is at u + shift(alignment[0], s, S),
     * v + shift(alignment[1], t, T), s, t in the grid, with shift(a, x, n) = a >= 0 ? a * x : -a * (n - 1 - x). Grid
     * positions outside all views have unspecified values.
     */
    fetchGridBox(box: Box, out?: Uint8Array): Promise<Uint8Array>;
    /** Fetches the bytes of these texels, so that atlas() and box() can read them. */
    fetch(box: Box, level?: number): Promise<void>;
    /** The whole coarsest level; null if the file has no coarse levels. */
    preview(): Picture | null;
    fetchPreview(): Promise<Picture | null>;
    /** The mesh as a Draco stream, for example for three.js' DRACOLoader; null if the proxy is not a mesh. */
    meshBytes(): Uint8Array | null;
    /** null if the proxy is not a mesh. Throws if it is one, because this module has no Draco decoder. */
    mesh(): null;
    /** Opens the layers; throws if the bytes of one of them are damaged. */
    layers(): Layers;
    /** Like layers(), after fetching what is missing. */
    fetchLayers(): Promise<Layers>;
    /** Frees all memory. Every later call throws. */
    close(): void;
    /** True after close(), and after the decoder ran out of memory. */
    readonly closed: boolean;
}

export interface OpenOptions {
    /** Accept a truncated file. Coarser levels, or the background, replace missing tiles. */
    partial?: boolean;
    /** Replace damaged tiles by coarser levels, or by the background. */
    damaged?: boolean;
    /** Which texture of a .glb with several, counted from 0. For openBytes() and openUrl(). */
    texture?: number;
}

export interface HttpOptions {
    /** Attempts per request if connections fail or the server reports an error of its own (5xx). Default: 5. */
    tries?: number;
    /** Cancels all requests. */
    signal?: AbortSignal;
}

/** A file that is read in parts. */
export interface ByteSource {
    /** Bytes of the whole file. */
    size: number;
    /** Resolves to exactly `length` bytes, starting at `offset`. */
    read(offset: number, length: number): Promise<Uint8Array | ArrayBuffer>;
}

/** A loaded decoder module. Each open file has its own instance of it, and its own memory. */
export class Codec {
    /** Can be posted to workers, which pass it to loadTessera(). */
    readonly module: WebAssembly.Module;
    /** Opens a file that is in memory: a .tess, or a .glb that holds one. */
    openBytes(bytes: Uint8Array | ArrayBuffer, options?: OpenOptions): TessFile;
    /** Opens a file whose bytes are read from `source` as they are needed. */
    openSource(source: ByteSource, options?: OpenOptions): Promise<TessFile>;
    /** Opens a .tess, or a .glb that holds one, on a web server; its bytes are requested as they are needed. */
    openUrl(url: string, options?: OpenOptions & HttpOptions): Promise<TessFile>;
}

/** `wasm`: the bytes of tessera.wasm, a Response or a promise of one, or the compiled module. */
export function loadTessera(
    wasm: BufferSource | Response | WebAssembly.Module | Promise<BufferSource | Response | WebAssembly.Module>
): Promise<Codec>;

/** The glTF extension under which a .glb holds a .tess file. */
export const GLB_EXTENSION: 'TESSERA_texture_light_field';

/**
 * The .tess file in a source that is a .glb; any other source itself. `texture`: which one of several, counted from 0.
 * Throws if the .glb holds none, or several and none is chosen.
 */
export function glbPayload(source: ByteSource, texture?: number): Promise<ByteSource>;

/** A file on a web server, read with range requests. Failed requests are repeated. */
export function httpSource(url: string, options?: HttpOptions): Promise<ByteSource>;
