// Types of tessera_three.js. `THREE` is the three.js module of whoever calls.
import type {Info} from './tessera.js';

/** The part of three.js that is used. */
export interface Three {
    [name: string]: any;
}

/** A RawShaderMaterial. rgba: TessFile.atlas() of all places. Errors: another proxy, another size. */
export function tesseraMaterial(THREE: Three, info: Info, rgba: Uint8Array): any;
/** A Mesh that shows the sphere where it stands in the world. */
export function tesseraSphere(THREE: Three, info: Info, rgba: Uint8Array): any;
/** A Mesh of `geometry`, a BufferGeometry with position, normal, uv and, for the octahedral hemisphere, tangent. */
export function tesseraSurface(THREE: Three, info: Info, rgba: Uint8Array, geometry: any): any;
