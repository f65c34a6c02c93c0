// What the plugins for loaders of glTF share: the textures of a glTF file that have TESSERA_texture_light_field
// (format/gltf/README.md).
import {attributesOf, readSurface} from './surface_shader.js';
import {GLB_EXTENSION, loadTessera} from './tessera.js';

export {GLB_EXTENSION};

const attributeNames = {normal: 'NORMAL', tangent: 'TANGENT', uv: 'TEXCOORD_0'};

// Opens the Tessera textures of materials. wasm: as for loadTessera(), which is called once.
export class GltfTextures {
    constructor(wasm) {
        this.wasm = wasm;
        this.codec = null;
    }

    // The object of the extension that material number `index` uses; null: none.
    static find(gltf, index) {
        const base = gltf.materials?.[index]?.pbrMetallicRoughness?.baseColorTexture;
        return gltf.textures?.[base?.index]?.extensions?.[GLB_EXTENSION] ?? null;
    }

    // The surface of surface_shader.js. readView(number) resolves to the bytes of a buffer view. longestSide: of textures
    // of the device. Throws an Error if the material cannot be drawn as the extension says.
    async surface(gltf, index, readView, longestSide) {
        const base = gltf.materials[index].pbrMetallicRoughness.baseColorTexture;
        if (base.texCoord || base.extensions?.KHR_texture_transform)
            throw new Error('the texture does not lie on TEXCOORD_0 as it is');
        const {bufferView} = GltfTextures.find(gltf, index);
        if (!gltf.bufferViews?.[bufferView])
            throw new Error(`there is no buffer view ${bufferView}`);
        const bytes = await readView(bufferView);
        this.codec ??= loadTessera(this.wasm);
        const file = (await this.codec).openBytes(bytes);
        try {
            const surface = readSurface(file, longestSide);
            GltfTextures.checkMeshes(gltf, index, attributesOf(surface).map(name => attributeNames[name]));
            return surface;
        } finally {
            file.close();
        }
    }

    static checkMeshes(gltf, material, needed) {
        for (const {primitives} of gltf.meshes ?? [])
            for (const primitive of primitives)
                for (const name of needed)
                    if (primitive.material === material && !(name in primitive.attributes))
                        throw new Error(`a primitive has no ${name}`);
    }
}
