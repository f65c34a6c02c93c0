// Types of tessera_three_webgpu.js. `THREE` is the caller's module three/webgpu, and `TSL` its module three/tsl.
import type {Surface} from './surface_shader.js';
import type {Info} from './tessera.js';

/**
 * A MeshBasicNodeMaterial for a mesh with one texture or with layers, for WebGPURenderer with either of its backends.
 * The geometry needs position and the attributes that attributesOf() of `surface` lists. `blends`: a layer of opacity
 * shows what is behind the surface. Then Object3D.onBeforeRender() of the mesh has to call onBeforeRender() of the
 * material, which sorts triangles: the renderer does not. The plugin for glTF sees to it.
 */
export function surfaceNodeMaterial(THREE: any, TSL: any, surface: Surface, options?: {blends?: boolean}): any;
/**
 * A Mesh that shows a texture on a sphere, at its position in the world. rgba: TessFile.atlas() of the whole texture.
 * Throws if the proxy is not a sphere.
 */
export function tesseraNodeSphere(THREE: any, TSL: any, info: Info, rgba: Uint8Array): any;
