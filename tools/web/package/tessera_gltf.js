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
        this.surfaces = new WeakMap(); // from a glTF file to a map from the number of a texture to its surface
        this.told = new WeakSet(); // errors
    }

    // The object of the extension that material number `index` uses; null: none.
    static find(gltf, index) {
        const base = gltf.materials?.[index]?.pbrMetallicRoughness?.baseColorTexture;
        return gltf.textures?.[base?.index]?.extensions?.[GLB_EXTENSION] ?? null;
    }

    // Calls warn() with why a material cannot be shown, once for all materials with one texture.
    tell(warn, error) {
        if (!this.told.has(error))
            warn(`${GLB_EXTENSION}: ${error.message}; the picture is shown instead`);
        this.told.add(error);
    }

    // Whether material number `index` blends with what is behind it.
    static blends(gltf, index) {
        return gltf.materials[index].alphaMode === 'BLEND';
    }

    // The surface of surface_shader.js, the same object for all materials with one texture. readView(number) resolves
    // to the bytes of a buffer view. longestSide: of textures of the device. Throws an Error if the material cannot be
    // drawn as the extension says.
    async surface(gltf, index, readView, longestSide) {
        const base = gltf.materials[index].pbrMetallicRoughness.baseColorTexture;
        if (base.texCoord || base.extensions?.KHR_texture_transform)
            throw new Error('the texture does not lie on TEXCOORD_0 as it is');
        if (!this.surfaces.has(gltf))
            this.surfaces.set(gltf, new Map());
        const ofFile = this.surfaces.get(gltf);
        if (!ofFile.has(base.index))
            ofFile.set(base.index, this.read(gltf, GltfTextures.find(gltf, index), readView, longestSide));
        const surface = await ofFile.get(base.index);
        GltfTextures.checkMeshes(gltf, index, attributesOf(surface).map(name => attributeNames[name]));
        return surface;
    }

    async read(gltf, {bufferView}, readView, longestSide) {
        if (!gltf.bufferViews?.[bufferView])
            throw new Error(`there is no buffer view ${bufferView}`);
        const bytes = await readView(bufferView);
        this.codec ??= loadTessera(this.wasm);
        const file = (await this.codec).openBytes(bytes);
        try {
            return readSurface(file, longestSide);
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
