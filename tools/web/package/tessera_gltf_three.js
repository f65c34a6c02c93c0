// A plugin for three.js' GLTFLoader that shows Tessera's textures.
//
//   const loader = new GLTFLoader();
//   loader.register(tesseraGltf(THREE, fetch('tessera.wasm')));
//   scene.add((await loader.loadAsync('bunny.glb')).scene);
//
// A texture that cannot be read is replaced by the picture that the file has for other viewers, with a warning.
import {GLB_EXTENSION, GltfTextures} from './tessera_gltf.js';
import {withMips} from './mips.js';
import {surfaceMaterial} from './tessera_three.js';

// The longest side of textures of the device, in pixels. The loader does not know the renderer.
function longestSide() {
    const gl = document.createElement('canvas').getContext('webgl2'), side = gl?.getParameter(gl.MAX_TEXTURE_SIZE);
    gl?.getExtension('WEBGL_lose_context')?.loseContext();
    return side;
}

// wasm: as for loadTessera(). warn(text) is called with a sentence for each texture that is replaced. materialOf(surface, {blends})
// makes another material than the one for WebGLRenderer; blends: whether the material of the file has alphaMode BLEND. It
// is called again with the surface of withMips(), and this material replaces the other one.
export function tesseraGltf(THREE, wasm, warn = text => console.warn(text),
                            materialOf = (surface, options) => surfaceMaterial(THREE, surface, options)) {
    const textures = new GltfTextures(wasm);
    return parser => new TesseraPlugin(THREE, textures, parser, warn, materialOf);
}

class TesseraPlugin {
    constructor(THREE, textures, parser, warn, materialOf) {
        Object.assign(this, {THREE, textures, parser, warn, materialOf, name: GLB_EXTENSION});
        this.made = new Map(); // from a material to {surface, blends}
    }

    // The loader calls this; null leaves the material to the loader.
    loadMaterial(index) {
        const {parser, textures, warn} = this, {json} = parser;
        if (!GltfTextures.find(json, index))
            return null;
        const readView = async view => new Uint8Array(await parser.getDependency('bufferView', view));
        return textures.surface(json, index, readView, longestSide())
            .then(surface => {
                const blends = GltfTextures.blends(json, index), material = this.materialOf(surface, {blends});
                this.made.set(material, {surface, blends});
                material.name = json.materials[index].name ?? '';
                return material;
            })
            .catch(error => {
                textures.tell(warn, error);
                return parser.loadMaterial(index);
            });
    }

    // The loader calls this when everything is there.
    async afterRoot({scenes}) {
        const meshes = [];
        for (const scene of scenes)
            scene.traverse(object => this.made.has(object.material) && meshes.push(object));
        this.addMips(meshes);
        // WebGPURenderer does not call Material.onBeforeRender(), in which materials that blend sort triangles.
        for (const mesh of meshes)
            if (mesh.material.isNodeMaterial)
                mesh.onBeforeRender = (renderer, scene, camera, geometry) =>
                    mesh.material.onBeforeRender(renderer, scene, camera, geometry, mesh);
    }

    // Replaces the materials of the meshes by those with mips, which need the charts of the geometries.
    addMips(meshes) {
        const {made} = this, bySurface = new Map();
        for (const mesh of meshes) {
            const {surface} = made.get(mesh.material);
            bySurface.set(surface, [...bySurface.get(surface) ?? [], mesh]);
        }
        for (const [surface, own] of bySurface) {
            const geometries = [...new Set(own.map(({geometry}) => geometry))].filter(({index}) => index);
            const mipped = withMips(surface, geometries.map(({index, attributes: {uv}}) => (
                {indices: index.array, vertices: uv.count, uvOf: i => [uv.getX(i), uv.getY(i)]})), longestSide());
            if (mipped === surface)
                continue;
            const next = new Map();
            for (const mesh of own) {
                const {material} = mesh, {blends} = made.get(material);
                if (!next.has(material))
                    next.set(material, Object.assign(this.materialOf(mipped, {blends}), {name: material.name}));
                mesh.material = next.get(material);
            }
            for (const material of next.keys())
                material.dispose();
        }
    }
}
