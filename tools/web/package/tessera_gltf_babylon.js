// An extension of Babylon.js' loader of glTF that shows Tessera's textures with WebGL2.
//
//   import * as BABYLON from '@babylonjs/core';
//   import {registerGLTFExtension} from '@babylonjs/loaders/glTF/2.0';
//   registerGLTFExtension(GLB_EXTENSION, true, tesseraBabylon(BABYLON, fetch('tessera.wasm')));
//   await BABYLON.AppendSceneAsync('bunny.glb', scene);
//
// A texture that cannot be read is replaced by the picture that the file has for other viewers, with a warning.
import {attributesOf, fragmentShader, isTranslucent, vertexShader} from './surface_shader.js';
import {withMips} from './mips.js';
import {GLB_EXTENSION, GltfTextures} from './tessera_gltf.js';
import {TriangleOrder} from './triangle_order.js';

export {GLB_EXTENSION};

// wasm: as for loadTessera(). warn(text) is called with a sentence for each texture that is replaced.
export function tesseraBabylon(BABYLON, wasm, warn = text => console.warn(text)) {
    const textures = new GltfTextures(wasm);
    return loader => new TesseraExtension(BABYLON, textures, loader, warn);
}

class TesseraExtension {
    constructor(BABYLON, textures, loader, warn) {
        Object.assign(this, {BABYLON, textures, loader, warn, name: GLB_EXTENSION, order: 0, made: new Map()});
        this.materials = new Map(); // from a material to {surface, blends}
        this.enabled = loader.isExtensionUsed(GLB_EXTENSION);
    }
    dispose() {
        this.made.clear();
        this.materials.clear();
    }

    // The loader calls this for each primitive; null leaves the material to the loader.
    _loadMaterialAsync(context, material, mesh, drawMode, assign) {
        const {loader} = this, index = loader.gltf.materials.indexOf(material);
        if (!GltfTextures.find(loader.gltf, index) || this.made.get(index) === null)
            return null;
        if (!this.made.has(index))
            this.made.set(index, this.make(index));
        return this.made.get(index).then(
            made => {
                assign(made);
                return made;
            },
            error => {
                if (this.made.get(index) !== null)
                    this.textures.tell(this.warn, error);
                this.made.set(index, null);
                return loader._loadMaterialAsync(context, material, mesh, drawMode, assign);
            });
    }

    async make(index) {
        const {BABYLON, loader} = this, {gltf, babylonScene: scene} = loader;
        const readView = async number => {
            const {buffer, byteOffset, byteLength} =
                await loader.loadBufferViewAsync(`/bufferViews/${number}`, gltf.bufferViews[number]);
            return new Uint8Array(buffer, byteOffset, byteLength);
        };
        const surface = await this.textures.surface(gltf, index, readView, scene.getEngine().getCaps().maxTextureSize);
        const name = gltf.materials[index].name ?? GLB_EXTENSION;
        const material = this.materialOf(name, surface, GltfTextures.blends(gltf, index));
        loader.parent?.onMaterialLoadedObservable?.notifyObservers(material);
        return material;
    }

    materialOf(name, surface, blends) {
        const {BABYLON, loader: {babylonScene: scene}} = this;
        const material = babylonMaterial(BABYLON, scene, name, surface, blends);
        material.sideOrientation = scene.useRightHandedSystem ? BABYLON.Material.CounterClockWiseSideOrientation
                                                              : BABYLON.Material.ClockWiseSideOrientation;
        this.materials.set(material, {surface, blends});
        return material;
    }

    // The loader calls this when everything is there. Mips need the charts of the geometries.
    onReady() {
        const {BABYLON, loader: {babylonScene: scene}} = this, made = [...this.materials];
        this.materials.clear();
        for (const surface of new Set(made.map(([, of]) => of.surface))) {
            const own = made.filter(([, of]) => of.surface === surface);
            const meshes = own.flatMap(([material]) => material.getBindedMeshes()).filter(mesh => mesh.getIndices());
            const mipped = withMips(surface, meshes.map(mesh => {
                const uv = mesh.getVerticesData(BABYLON.VertexBuffer.UVKind);
                return {indices: mesh.getIndices(), vertices: uv.length / 2, uvOf: i => [uv[2 * i], uv[2 * i + 1]]};
            }), scene.getEngine().getCaps().maxTextureSize);
            if (mipped === surface)
                continue;
            for (const [material, {blends}] of own) {
                const bound = material.getBindedMeshes(), next = this.materialOf(material.name, mipped, blends);
                for (const mesh of bound)
                    mesh.material = next;
                material.dispose();
            }
            for (const texture of Object.values(layerTextures(BABYLON, scene, surface)))
                texture.dispose();
        }
    }
}

const texturesOf = new WeakMap(); // from a scene to a map from its surfaces to their textures

// The textures of a surface by the names of their samplers, the same for all materials of the scene.
function layerTextures(BABYLON, scene, surface) {
    if (!texturesOf.has(scene))
        texturesOf.set(scene, new WeakMap());
    const ofScene = texturesOf.get(scene);
    if (ofScene.has(surface))
        return ofScene.get(surface);
    const {Constants, RawTexture} = BABYLON, {layers, lights, charts} = surface, textures = {};
    const picture = (pixels, width, height, type, sampling) => {
        const texture = new RawTexture(pixels, width, height, Constants.TEXTUREFORMAT_RGBA, scene, false, false,
                                       sampling, type);
        texture.wrapU = texture.wrapV = Constants.TEXTURE_CLAMP_ADDRESSMODE;
        return texture;
    };
    for (const {name, picture: {width, height, half, pixels}} of layers)
        textures[`${name}Layer`] =
            picture(pixels, width, height, half ? Constants.TEXTURETYPE_HALF_FLOAT : Constants.TEXTURETYPE_UNSIGNED_BYTE,
                    Constants.TEXTURE_BILINEAR_SAMPLINGMODE);
    if (lights.count)
        textures.lights = picture(lights.pixels, 2, lights.count, Constants.TEXTURETYPE_FLOAT,
                                  Constants.TEXTURE_NEAREST_SAMPLINGMODE);
    if (charts)
        textures.charts = picture(charts.pixels, charts.width, charts.height, Constants.TEXTURETYPE_UNSIGNED_BYTE,
                                  Constants.TEXTURE_NEAREST_SAMPLINGMODE);
    ofScene.set(surface, textures);
    return textures;
}

// A ShaderMaterial for a surface of readSurface(). blends: a layer of opacity shows what is behind the surface. Then the
// indices of the meshes are sorted before each frame.
export function babylonMaterial(BABYLON, scene, name, surface, blends = false) {
    const textures = layerTextures(BABYLON, scene, surface), isBlended = blends && isTranslucent(surface);
    const vertexSource = '#version 300 es\n' + vertexShader({
        uniforms: 'uniform mat4 world, worldViewProjection;\nuniform vec3 cameraPosition;',
        eye: '(inverse(world) * vec4(cameraPosition, 1.0)).xyz', project: 'worldViewProjection'});
    const material = new BABYLON.ShaderMaterial(
        name, scene, {vertexSource, fragmentSource: '#version 300 es\n' + fragmentShader(surface, blends)},
        {attributes: ['position', ...attributesOf(surface)], samplers: Object.keys(textures), needAlphaBlending: isBlended,
         uniforms: ['world', 'worldViewProjection', 'cameraPosition']});
    for (const [name, texture] of Object.entries(textures))
        material.setTexture(name, texture);
    // Set on the effect, because the material would apply it to the next frame.
    material.onBindObservable.add(
        () => material.getEffect().setVector3('cameraPosition', scene.activeCamera.globalPosition));
    material.backFaceCulling = true;
    if (isBlended)
        sortBeforeFrames(BABYLON, scene, material);
    return material;
}

// Sorts the triangles of meshes with the material from back to front.
function sortBeforeFrames(BABYLON, scene, material) {
    const orders = new WeakMap(); // by mesh
    const watcher = scene.onBeforeRenderObservable.add(() => {
        for (const mesh of material.getBindedMeshes()) {
            const indices = mesh.getIndices(), positions = mesh.getVerticesData(BABYLON.VertexBuffer.PositionKind);
            if (!indices || !positions)
                continue;
            if (!orders.has(mesh))
                orders.set(mesh, new TriangleOrder(Uint32Array.from(indices),
                                                   i => [0, 1, 2].map(axis => positions[3 * i + axis])));
            const toLocal = mesh.computeWorldMatrix(true).clone().invert();
            const eye = BABYLON.Vector3.TransformCoordinates(scene.activeCamera.globalPosition, toLocal);
            const sorted = orders.get(mesh).seenFrom(eye.asArray());
            if (sorted)
                mesh.updateIndices(sorted);
        }
    });
    material.onDisposeObservable.add(() => scene.onBeforeRenderObservable.remove(watcher));
}
