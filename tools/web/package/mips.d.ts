// Types of mips.js.
import type {Surface} from './surface_shader.js';

/** The triangles of a primitive. */
export interface Triangles {
    indices: ArrayLike<number>;
    /** The number of vertices. */
    vertices: number;
    /** (u, v) of a vertex, 0..1 over the atlas. */
    uvOf(vertex: number): [number, number];
}

/**
 * The surface with mips for a shader, so that it does not flicker from afar. `meshes` are all primitives that it lies
 * on. Layers stay as they are if they have half floats, if their tiles do not begin at even texels, or if their picture
 * would have a side above `longestSide`.
 */
export function withMips(surface: Surface, meshes: Triangles[], longestSide?: number): Surface;
