// Types of tessera_gltf_three.js. `THREE` is the caller's three.js module.
import type {Surface} from './surface_shader.js';
import type {loadTessera} from './tessera.js';
import type {Three} from './tessera_three.js';

/**
 * A plugin for GLTFLoader.register() that shows Tessera's textures with a WebGLRenderer. `wasm` is loaded when the
 * first of them comes. `warn` is called with a sentence for each texture that cannot be shown, in place of which the
 * file's picture for other viewers appears; it prints a warning by default. For a WebGPURenderer, `materialOf` is
 * (surface, options) => surfaceNodeMaterial(THREE, TSL, surface, options). It is called again with the surface of
 * withMips() where the triangles allow mips, and that material replaces the other one.
 */
export function tesseraGltf(
    THREE: Three, wasm: Parameters<typeof loadTessera>[0], warn?: (text: string) => void,
    materialOf?: (surface: Surface, options: {blends: boolean}) => any): (parser: any) => any;
