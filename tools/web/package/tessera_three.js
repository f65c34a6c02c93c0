// A three.js material for Tessera's textures. It samples the picture of TessFile.atlas() as FORMAT.md 5.1 and 5.2
// specify. The GLSL in sampling.js is generated from the shaders of the GPU decoder, which the viewer also uses.
//
//   const file = codec.openBytes(bytes);
//   scene.add(tesseraSphere(THREE, file.info, file.atlas([0, U, 0, V])));
//
// Colours are written as they are stored, ready for the display, without lights or tone mapping.
import {sampling} from './sampling.js';
import {ANGULAR_MAP, PROXY} from './tessera.js';

const isSphere = info => info.proxy === PROXY.sphere || info.proxy === PROXY.sphereInside;

const vertexShader = `precision highp float;
precision highp int;
uniform mat4 modelMatrix, modelViewMatrix, projectionMatrix;
uniform vec3 cameraPosition;
in vec3 position;
out vec3 place, eye; // in the object's coordinates
#ifdef TESSERA_MESH
in vec3 normal;
in vec4 tangent;
in vec2 uv;
centroid out vec3 surfaceNormal, surfaceTangent;
centroid out vec2 surfacePlace;
#endif
void main() {
    place = position;
    eye = (inverse(modelMatrix) * vec4(cameraPosition, 1.0)).xyz;
#ifdef TESSERA_MESH
    surfaceNormal = normal;
    surfaceTangent = tangent.xyz;
    surfacePlace = uv;
#endif
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

const fragmentShader = `precision highp float;
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
`;

const sphereShader = `
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

const meshShader = `
uniform int angularMap;
centroid in vec3 surfaceNormal, surfaceTangent;
centroid in vec2 surfacePlace;
vec4 placeColour(ivec2 texel, TsrOctahedralTaps taps) {
    if (angularMap != tsr_map_mirrored || !tsr_crosses_fold(taps, size.zw))
        return imageColour(texel, tsr_ended(taps, size.zw));
    vec4 sum = vec4(0.0); // at the edge of the mirrored map the four texels are not adjacent
    for (int i = 0; i < 4; ++i) {
        ivec2 corner = ivec2(i & 1, i >> 1);
        vec2 share = mix(1.0 - taps.weight, taps.weight, vec2(corner));
        sum += share.x * share.y * texelFetch(atlas, texel * size.zw + tsr_folded(taps.first + corner, size.zw), 0);
    }
    return sum;
}
void main() {
    vec3 direction = normalize(eye - place);
    TsrMeshFrame frame = tsr_mesh_frame(surfaceNormal, surfaceTangent, direction);
    TsrOctahedralTaps taps = tsr_octahedral_taps(tsr_octahedral_place(angularMap, frame, direction), size.zw);
    TsrSurfaceFootprint f = tsr_atlas_footprint(surfacePlace, size.xy);
    colour = mix(mix(placeColour(f.low, taps), placeColour(ivec2(f.high.x, f.low.y), taps), f.weight.x),
                 mix(placeColour(ivec2(f.low.x, f.high.y), taps), placeColour(f.high, taps), f.weight.x),
                 f.weight.y);
}`;

// rgba: file.atlas() of the whole texture. The picture must fit into a texture of the GPU; practically all devices
// allow sides of 8192 texels. The viewer of `tessera view` shows larger textures with a tile cache.
export function tesseraMaterial(THREE, info, rgba) {
    const isMesh = info.proxy === PROXY.mesh;
    if (!isMesh && !isSphere(info))
        throw new Error(`there is no material for textures with the proxy "${info.names.proxy}"`);
    const [U, V, S, T] = info.size;
    if (rgba.length !== U * V * S * T * 4)
        throw new Error(`the atlas has ${rgba.length} bytes, a texture of ${info.size.join('x')} ${U * V * S * T * 4}`);
    const atlas = new THREE.DataTexture(rgba, U * S, V * T, THREE.RGBAFormat, THREE.UnsignedByteType);
    atlas.minFilter = atlas.magFilter = THREE.LinearFilter;
    atlas.generateMipmaps = false;
    atlas.needsUpdate = true;
    const uniforms = {atlas: {value: atlas}, size: {value: new Int32Array(info.size)}};
    if (isMesh)
        uniforms.angularMap = {value: info.angularMap};
    else
        Object.assign(uniforms, {radius: {value: info.radius}, inside: {value: info.inside}});
    const material = new THREE.RawShaderMaterial({
        glslVersion: THREE.GLSL3, uniforms, vertexShader,
        fragmentShader: fragmentShader + (isMesh ? meshShader : sphereShader),
        defines: isMesh ? {TESSERA_MESH: 1} : {}, side: info.inside ? THREE.BackSide : THREE.FrontSide,
    });
    material.toneMapped = false;
    return material;
}

// A mesh that shows a texture on a sphere, at its position in the world.
export function tesseraSphere(THREE, info, rgba) {
    if (!isSphere(info))
        throw new Error(`the proxy of the texture is "${info.names.proxy}", not a sphere`);
    const material = tesseraMaterial(THREE, info, rgba);
    const segments = 32;
    const around = info.radius / Math.cos(Math.PI / segments) ** 2; // so that the triangles enclose the sphere
    const mesh = new THREE.Mesh(new THREE.SphereGeometry(around, 2 * segments, segments), material);
    mesh.position.set(...info.centre);
    return mesh;
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
