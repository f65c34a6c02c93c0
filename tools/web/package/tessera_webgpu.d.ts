// Types of tessera_webgpu.js, which decodes textures on the GPU by WebGPU. The types of WebGPU are those of the package
// @webgpu/types.
import type {Box, TessFile} from './tessera.js';

/** The WGSL of a shader by its set of macros and its name, such as ("half", "texels.comp"). */
export type WgslSource = (macros: string, name: string) => Promise<string>;

/** Fetches WGSL from a folder, such as new URL('wgsl/', import.meta.url). */
export function wgslFrom(folder: string | URL): WgslSource;

/**
 * A decoder on a device of its own. null if there is no WebGPU, if its device has less than 32 KiB of workgroup storage,
 * or if it is a CPU and `software` is false: there WebAssembly is faster. Rejects if the browser refuses a device.
 */
export function openGpu(code: WgslSource, options?: {software?: boolean}): Promise<GpuDecoder | null>;

/** Decodes one box after another. Shaders are compiled when the first box needs them. */
export class GpuDecoder {
    /** The device needs 32 KiB of workgroup storage and, for large tiles, large storage buffers. */
    constructor(device: GPUDevice, code: WgslSource);
    readonly device: GPUDevice;
    /**
     * Decodes the tiles that `box` touches, in texels of the tile grid (info.gridSize), to a 2D texture of rgba8unorm
     * or rgba16float. `file` must be opened with tessera_webgpu.wasm. Texel (u, v, s, t) is at
     * x = (u - u0) * (s1 - s0) + s - s0 and y = (v - v0) * (t1 - t0) + t - t0, where u0 and so on are those of the
     * returned box, which holds these tiles whole. Grey is copied to R, G and B. The caller destroys the texture. A
     * batch takes at most 32 MiB for each of its buffers, or what a single tile needs.
     * Rejects if a tile is damaged, if the device is lost, or if a limit of it is too small.
     */
    decode(file: TessFile, box: Box): Promise<{texture: GPUTexture; box: Box}>;
    /** The decoded samples of the box, like file.fetchGridBox(). */
    texels(file: TessFile, box: Box, out?: Uint8Array): Promise<Uint8Array>;
    /** Destroys the device. */
    close(): void;
}
