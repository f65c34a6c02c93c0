// A three.js material for Tessera's textures. It samples the picture of TessFile.atlas() as FORMAT.md 5.1 and 5.2
// specify. The GLSL in sampling.js is generated from the shaders of the GPU decoder, which the viewer also uses.
//
//   const file = codec.openBytes(bytes);
//   scene.add(tesseraSphere(THREE, file.info, file.atlas([0, U, 0, V])));
//
// Colours are written as they are stored, ready for the display, without lights or tone mapping.
import {sampling} from './sampling.js';
import {fragmentShader, isTranslucent, surfaceOf, vertexShader} from './surface_shader.js';
import {ANGULAR_MAP, PROXY} from './tessera.js';
import {TriangleOrder} from './triangle_order.js';

export const isSphere = info => info.proxy === PROXY.sphere || info.proxy === PROXY.sphereInside;

const sphereVertexShader = `precision highp float;
precision highp int;
uniform mat4 modelMatrix, modelViewMatrix, projectionMatrix;
uniform vec3 cameraPosition;
in vec3 position;
out vec3 place, eye; // in the object's coordinates
void main() {
    place = position;
    eye = (inverse(modelMatrix) * vec4(cameraPosition, 1.0)).xyz;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

const sphereShader = `precision highp float;
precision highp int;
precision highp sampler2D;
${sampling}
uniform sampler2D atlas;
uniform ivec4 size; // texels along u, v, s, t
in vec3 place, eye;
out vec4 colour;

// The colour of one surface texel in a direction. The hardware interpolates between four texels.
vec4 imageColour(ivec2 texel, TsrAngularFootprint f) {
    vec2 at = clamp(vec2(f.low) + vec2(notEqual(f.low, f.high)) * f.weight, vec2(0.0), vec2(size.zw - 1)) + 0.5;
    return texture(atlas, (vec2(texel * size.zw) + at) / vec2(size.xy * size.zw));
}
uniform float radius;
uniform bool inside;
vec4 placeColour(ivec2 texel, vec3 direction) {
    return imageColour(texel, tsr_angular_footprint(texel, size.xy, size.zw, inside, direction));
}
void main() {
    vec3 ray = normalize(place - eye);
    float along = -dot(eye, ray);
    vec3 nearest = eye + along * ray;
    float rest = radius * radius - dot(nearest, nearest);
    if (rest < 0.0)
        discard; // the triangles enclose the sphere, and this ray misses it
    vec3 fromCentre = nearest + (inside ? sqrt(rest) : -sqrt(rest)) * ray;
    TsrSurfaceFootprint f = tsr_surface_footprint(fromCentre, size.xy);
    colour = mix(mix(placeColour(f.low, -ray), placeColour(ivec2(f.high.x, f.low.y), -ray), f.weight.x),
                 mix(placeColour(ivec2(f.low.x, f.high.y), -ray), placeColour(f.high, -ray), f.weight.x),
                 f.weight.y);
}`;

// rgba: file.atlas() of the whole texture. Its picture must fit into a texture of the GPU; practically all devices
// allow sides of 8192 texels. The viewer of `tessera view` shows larger textures with a tile cache.
export function tesseraMaterial(THREE, info, rgba) {
    if (info.proxy !== PROXY.mesh && !isSphere(info))
        throw new Error(`there is no material for textures with the proxy "${info.names.proxy}"`);
    const [U, V, S, T] = info.size;
    if (rgba.length !== U * V * S * T * 4)
        throw new Error(`the atlas has ${rgba.length} bytes, a texture of ${info.size.join('x')} ${U * V * S * T * 4}`);
    if (info.proxy === PROXY.mesh)
        return surfaceMaterial(THREE, surfaceOf(info, rgba));
    const atlas = pictureTexture(THREE, rgba, U * S, V * T, THREE.UnsignedByteType, THREE.LinearFilter);
    const uniforms = {atlas: {value: atlas}, size: {value: new Int32Array(info.size)}, radius: {value: info.radius},
                      inside: {value: info.inside}};
    return rawMaterial(THREE, uniforms, sphereVertexShader, sphereShader, info.inside ? THREE.BackSide : THREE.FrontSide);
}

const texturesOf = new WeakMap(); // from a surface to its textures, which all of its materials share

export function layerTextures(THREE, surface) {
    if (texturesOf.has(surface))
        return texturesOf.get(surface);
    const textures = {}, {layers, lights, charts} = surface;
    if (charts)
        textures.charts = pictureTexture(THREE, charts.pixels, charts.width, charts.height, THREE.UnsignedByteType,
                                         THREE.NearestFilter);
    for (const {name, picture: {width, height, half, pixels}} of layers)
        textures[`${name}Layer`] = pictureTexture(THREE, pixels, width, height,
                                                  half ? THREE.HalfFloatType : THREE.UnsignedByteType, THREE.LinearFilter);
    if (lights.count)
        textures.lights = pictureTexture(THREE, lights.pixels, 2, lights.count, THREE.FloatType, THREE.NearestFilter);
    texturesOf.set(surface, textures);
    return textures;
}

// A material for a surface of readSurface() or surfaceOf() in surface_shader.js: a mesh with one texture or with
// layers. The geometry needs the attributes position, normal and uv, and tangent if attributesOf() lists it. blends:
// a layer of opacity shows what is behind the surface. Then the indices of the geometry are sorted before it is drawn.
export function surfaceMaterial(THREE, surface, {blends = false} = {}) {
    const vertex = vertexShader({
        uniforms: 'uniform mat4 modelMatrix, modelViewMatrix, projectionMatrix;\nuniform vec3 cameraPosition;',
        eye: '(inverse(modelMatrix) * vec4(cameraPosition, 1.0)).xyz', project: '(projectionMatrix * modelViewMatrix)'});
    const uniforms = Object.fromEntries(
        Object.entries(layerTextures(THREE, surface)).map(([name, value]) => [name, {value}]));
    const material = rawMaterial(THREE, uniforms, vertex, fragmentShader(surface, blends), THREE.FrontSide);
    return blends && isTranslucent(surface) ? blended(THREE, material) : material;
}

// Lets a material blend. Triangles are sorted whenever the camera has moved, because depth does not order them.
export function blended(THREE, material) {
    const orders = new WeakMap(); // by geometry
    const onBeforeRender = (renderer, scene, camera, geometry, object) => {
        const {index, attributes: {position}} = geometry;
        if (!index)
            return;
        if (!orders.has(geometry))
            orders.set(geometry, new TriangleOrder(
                index.array, i => [position.getX(i), position.getY(i), position.getZ(i)]));
        const eye = object.worldToLocal(new THREE.Vector3().setFromMatrixPosition(camera.matrixWorld));
        const sorted = orders.get(geometry).seenFrom(eye.toArray());
        if (sorted) {
            index.array.set(sorted);
            index.needsUpdate = true;
        }
    };
    return Object.assign(material, {transparent: true, depthWrite: false, onBeforeRender});
}

export function pictureTexture(THREE, pixels, width, height, type, filter) {
    const texture = new THREE.DataTexture(pixels, width, height, THREE.RGBAFormat, type);
    texture.minFilter = texture.magFilter = filter;
    texture.generateMipmaps = false;
    texture.needsUpdate = true;
    return texture;
}

function rawMaterial(THREE, uniforms, vertexShader, fragmentShader, side) {
    const material =
        new THREE.RawShaderMaterial({glslVersion: THREE.GLSL3, uniforms, vertexShader, fragmentShader, side});
    material.toneMapped = false;
    return material;
}

// A mesh that shows a texture on a sphere, at its position in the world.
export function tesseraSphere(THREE, info, rgba) {
    if (!isSphere(info))
        throw new Error(`the proxy of the texture is "${info.names.proxy}", not a sphere`);
    const material = tesseraMaterial(THREE, info, rgba);
    const mesh = new THREE.Mesh(enclosingSphere(THREE, info), material);
    mesh.position.set(...info.centre);
    return mesh;
}

// Triangles that enclose the sphere of the texture.
export function enclosingSphere(THREE, {radius}) {
    const segments = 32;
    return new THREE.SphereGeometry(radius / Math.cos(Math.PI / segments) ** 2, 2 * segments, segments);
}

// A mesh that shows a texture on `geometry`, which has the positions, normals and uv of the file's mesh. three.js'
// DRACOLoader reads them from file.meshBytes(). The octahedral hemisphere also needs tangents.
export function tesseraSurface(THREE, info, rgba, geometry) {
    if (info.proxy !== PROXY.mesh)
        throw new Error(`the proxy of the texture is "${info.names.proxy}", not a mesh`);
    const isMirrored = info.angularMap === ANGULAR_MAP.octahedralMirrored;
    const needed = ['position', 'normal', 'uv'].concat(isMirrored ? [] : ['tangent']);
    for (const name of needed)
        if (!geometry.attributes[name])
            throw new Error(`the geometry has no ${name}`);
    return new THREE.Mesh(geometry, tesseraMaterial(THREE, info, rgba));
}
