// Types of surface_shader.js.
import type {Info, TessFile} from './tessera.js';

/** A texture or the layers of a mesh, decoded as a whole for a shader. */
export interface Surface {
    /** One of ANGULAR_MAP. */
    angularMap: number;
    layers: {
        /** The layer's key in LAYER_ROLE, or "texture" if the file has one texture. Its sampler is NAMELayer. */
        name: string;
        size: [number, number, number, number];
        /** Views in a row of the picture. */
        columns: number;
        srgb: boolean;
        scale: number;
        /** How many mips withMips() may add. */
        mips: number;
        /** RGBA, 8 bits a sample or, if `half`, half floats. */
        picture: {width: number; height: number; half: boolean; pixels: Uint8Array | Uint16Array};
    }[];
    /** Two RGBA pixels of 32-bit floats for each light; `count` is a multiple of four. */
    lights: {count: number; pixels?: Float32Array};
    /** With mips: the charts of the atlases, for the sampler `charts`. */
    charts?: {width: number; height: number; pixels: Uint8Array};
}

/**
 * Decodes an open file. Throws if it is damaged, does not lie on a mesh, or needs a picture with a side above
 * `longestSide`, the limit of the device, which is 16384 pixels by default.
 */
export function readSurface(file: TessFile, longestSide?: number): Surface;
/** The same for one texture. rgba: TessFile.atlas() of all texels. */
export function surfaceOf(info: Info, rgba: Uint8Array): Surface;
/** The attributes that the shader needs besides the position. */
export function attributesOf(surface: Surface): ('normal' | 'uv' | 'tangent')[];
/**
 * GLSL ES 3.00. `eye` and `project` are expressions for the observer's position in the coordinates of the mesh and for
 * the matrix from there to the screen. `uniforms` declares what they use.
 */
export function vertexShader(names: {uniforms: string; eye: string; project: string}): string;
/** Whether the surface has a layer of opacity. */
export function isTranslucent(surface: Surface): boolean;
/**
 * GLSL ES 3.00 with one sampler per layer, the sampler `lights` if there are lights, and `charts` with mips. `blends`: alpha is the layer
 * of opacity, by which the colours are not multiplied; else alpha is 1.
 */
export function fragmentShader(surface: Surface, blends?: boolean): string;
