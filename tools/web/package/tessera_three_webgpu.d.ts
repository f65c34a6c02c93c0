// Types of tessera_three_webgpu.js. `THREE` is the caller's module three/webgpu, and `TSL` its module three/tsl.
import type {Surface} from './surface_shader.js';

/**
 * A MeshBasicNodeMaterial for a mesh with a single texture, for WebGPURenderer with either of its backends. The geometry
 * needs position and the attributes that attributesOf() of `surface` lists. Throws if the surface has layers.
 */
export function surfaceNodeMaterial(THREE: any, TSL: any, surface: Surface): any;
