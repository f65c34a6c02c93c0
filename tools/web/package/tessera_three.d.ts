// Types of tessera_three.js. `THREE` is the caller's three.js module.
import type {Surface} from './surface_shader.js';
import type {Info} from './tessera.js';

/** The parts of three.js that are used. */
export interface Three {
    [name: string]: any;
}

/**
 * A RawShaderMaterial for a texture on a sphere or a mesh. rgba: TessFile.atlas() of the whole texture. Throws if the
 * proxy is another one or if the size of `rgba` is wrong.
 */
export function tesseraMaterial(THREE: Three, info: Info, rgba: Uint8Array): any;
/**
 * The same for a mesh with one texture or with layers. The geometry needs the attributes position, normal and uv, and
 * those that attributesOf() of `surface` lists. `blends`: a layer of opacity shows what is behind the surface, in display
 * values like other materials of three.js. Then the indices of the geometry are sorted whenever the camera has moved.
 */
export function surfaceMaterial(THREE: Three, surface: Surface, options?: {blends?: boolean}): any;
/** A Mesh that shows a texture on a sphere, at its position in the world. Throws if the proxy is not a sphere. */
export function tesseraSphere(THREE: Three, info: Info, rgba: Uint8Array): any;
/**
 * A Mesh that shows a texture on `geometry`, a BufferGeometry with the attributes position, normal and uv, and also
 * tangent unless the angular map is ANGULAR_MAP.octahedralMirrored. Throws if the proxy is not a mesh or if an
 * attribute is missing.
 */
export function tesseraSurface(THREE: Three, info: Info, rgba: Uint8Array, geometry: any): any;
