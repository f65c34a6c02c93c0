// An extension of Babylon.js' loader of glTF that shows Tessera's textures with WebGL2.
//
//   import * as BABYLON from '@babylonjs/core';
//   import {registerGLTFExtension} from '@babylonjs/loaders/glTF/2.0';
//   registerGLTFExtension(GLB_EXTENSION, true, tesseraBabylon(BABYLON, fetch('tessera.wasm')));
//   await BABYLON.AppendSceneAsync('bunny.glb', scene);
//
// A texture that cannot be read is replaced by the picture that the file has for other viewers, with a warning.
import {attributesOf, fragmentShader, vertexShader} from './surface_shader.js';
import {GLB_EXTENSION, GltfTextures} from './tessera_gltf.js';

export {GLB_EXTENSION};

// wasm: as for loadTessera(). warn(text) is called with a sentence for each texture that is replaced.
export function tesseraBabylon(BABYLON, wasm, warn = text => console.warn(text)) {
    const textures = new GltfTextures(wasm);
    return loader => new TesseraExtension(BABYLON, textures, loader, warn);
}

class TesseraExtension {
    constructor(BABYLON, textures, loader, warn) {
        Object.assign(this, {BABYLON, textures, loader, warn, name: GLB_EXTENSION, order: 0, made: new Map()});
        this.enabled = loader.isExtensionUsed(GLB_EXTENSION);
    }
    dispose() {
        this.made.clear();
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
                    this.warn(`${GLB_EXTENSION}: ${error.message}; the picture is shown instead`);
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
        const material = babylonMaterial(BABYLON, scene, name, surface);
        material.sideOrientation = scene.useRightHandedSystem ? BABYLON.Material.CounterClockWiseSideOrientation
                                                              : BABYLON.Material.ClockWiseSideOrientation;
        loader.parent?.onMaterialLoadedObservable?.notifyObservers(material);
        return material;
    }
}

// A ShaderMaterial for a surface of readSurface().
export function babylonMaterial(BABYLON, scene, name, surface) {
    const {Constants, RawTexture, ShaderMaterial} = BABYLON, {layers, lights} = surface;
    const picture = (pixels, width, height, type, sampling) => {
        const texture = new RawTexture(pixels, width, height, Constants.TEXTUREFORMAT_RGBA, scene, false, false,
                                       sampling, type);
        texture.wrapU = texture.wrapV = Constants.TEXTURE_CLAMP_ADDRESSMODE;
        return texture;
    };
    const samplers = layers.map(layer => `${layer.name}Layer`).concat(lights.count ? ['lights'] : []);
    const vertexSource = '#version 300 es\n' + vertexShader({
        uniforms: 'uniform mat4 world, worldViewProjection;\nuniform vec3 cameraPosition;',
        eye: '(inverse(world) * vec4(cameraPosition, 1.0)).xyz', project: 'worldViewProjection'});
    const material = new ShaderMaterial(
        name, scene, {vertexSource, fragmentSource: '#version 300 es\n' + fragmentShader(surface)},
        {attributes: ['position', ...attributesOf(surface)], samplers,
         uniforms: ['world', 'worldViewProjection', 'cameraPosition']});
    for (const {name, picture: {width, height, half, pixels}} of layers)
        material.setTexture(`${name}Layer`,
                            picture(pixels, width, height, half ? Constants.TEXTURETYPE_HALF_FLOAT : Constants.TEXTURETYPE_UNSIGNED_BYTE,
                                    Constants.TEXTURE_BILINEAR_SAMPLINGMODE));
    if (lights.count)
        material.setTexture('lights', picture(lights.pixels, 2, lights.count, Constants.TEXTURETYPE_FLOAT,
                                              Constants.TEXTURE_NEAREST_SAMPLINGMODE));
    // Set on the effect, because the material would apply it to the next frame.
    material.onBindObservable.add(
        () => material.getEffect().setVector3('cameraPosition', scene.activeCamera.globalPosition));
    material.backFaceCulling = true;
    return material;
}
