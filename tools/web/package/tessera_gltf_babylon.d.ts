// Types of tessera_gltf_babylon.js. `BABYLON` is the caller's module @babylonjs/core.
import type {loadTessera} from './tessera.js';

export {GLB_EXTENSION} from './tessera.js';

/**
 * The factory of an extension for registerGLTFExtension() that shows Tessera's textures with WebGL2. `wasm` is loaded
 * when the first of them comes. `warn` is called with a sentence for each texture that cannot be shown, in place of
 * which the file's picture for other viewers appears; it prints a warning by default.
 */
export function tesseraBabylon(
    BABYLON: {[name: string]: any}, wasm: Parameters<typeof loadTessera>[0],
    warn?: (text: string) => void): (loader: any) => any;
