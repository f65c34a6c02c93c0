// A plugin for three.js' GLTFLoader that shows Tessera's textures.
//
//   const loader = new GLTFLoader();
//   loader.register(tesseraGltf(THREE, fetch('tessera.wasm')));
//   scene.add((await loader.loadAsync('bunny.glb')).scene);
//
// A texture that cannot be read is replaced by the picture that the file has for other viewers, with a warning.
import {GLB_EXTENSION, GltfTextures} from './tessera_gltf.js';
import {surfaceMaterial} from './tessera_three.js';

// The longest side of textures of the device, in pixels. The loader does not know the renderer.
function longestSide() {
    const gl = document.createElement('canvas').getContext('webgl2'), side = gl?.getParameter(gl.MAX_TEXTURE_SIZE);
    gl?.getExtension('WEBGL_lose_context')?.loseContext();
    return side;
}

// wasm: as for loadTessera(). warn(text) is called with a sentence for each texture that is replaced. materialOf(surface, {blends})
// makes another material than the one for WebGLRenderer; blends: whether the material of the file has alphaMode BLEND.
export function tesseraGltf(THREE, wasm, warn = text => console.warn(text),
                            materialOf = (surface, options) => surfaceMaterial(THREE, surface, options)) {
    const textures = new GltfTextures(wasm), made = new WeakSet();
    return parser => ({
        name: GLB_EXTENSION,
        loadMaterial(index) {
            if (!GltfTextures.find(parser.json, index))
                return null;
            const readView = async view => new Uint8Array(await parser.getDependency('bufferView', view));
            return textures.surface(parser.json, index, readView, longestSide())
                .then(surface => {
                    const material = materialOf(surface, {blends: GltfTextures.blends(parser.json, index)});
                    made.add(material);
                    material.name = parser.json.materials[index].name ?? '';
                    return material;
                })
                .catch(error => {
                    textures.tell(warn, error);
                    return parser.loadMaterial(index);
                });
        },
        // WebGPURenderer does not call Material.onBeforeRender(), in which materials that blend sort triangles.
        async afterRoot({scenes}) {
            for (const scene of scenes)
                scene.traverse(object => {
                    const {material} = object;
                    if (made.has(material) && material.isNodeMaterial)
                        object.onBeforeRender = (renderer, of, camera, geometry) =>
                            material.onBeforeRender(renderer, of, camera, geometry, object);
                });
        },
    });
}
