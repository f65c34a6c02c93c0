// Node materials for three.js' WebGPURenderer, which draws by WebGPU or WebGL2: what tessera_three.js is for the
// WebGLRenderer.
//
//   import * as THREE from 'three/webgpu';
//   import * as TSL from 'three/tsl';
//   const material = surfaceNodeMaterial(THREE, TSL, readSurface(file));
//
// Colours are shown as they are stored if the renderer's output is sRGB without tone mapping.
import {cellOf} from './mip_layout.js';
import * as nodes from './surface_nodes.js';
import {isTranslucent} from './surface_shader.js';
import {ANGULAR_MAP} from './tessera.js';
import {blended, enclosingSphere, isSphere, layerTextures, pictureTexture} from './tessera_three.js';

const leastCoverage = 0.5, fullOpacity = 254 / 255, pictureOfFile = 'texture';

// surface: readSurface() or surfaceOf() in surface_shader.js: one texture, or layers. The geometry needs the attributes
// that attributesOf() lists, and position. blends: as for surfaceMaterial() in tessera_three.js. WebGPURenderer does not
// call Material.onBeforeRender(), which sorts the triangles, so Object3D.onBeforeRender() has to, as in
// tessera_gltf_three.js.
export function surfaceNodeMaterial(THREE, TSL, surface, {blends = false} = {}) {
    const textures = layerTextures(THREE, surface);
    const isBlended = blends && isTranslucent(surface);
    const material = nodeMaterial(THREE, TSL.Fn(() => {
        const {attribute, cameraPosition, modelWorldMatrixInverse, positionGeometry, uv, varying, vec4} = TSL;
        const eye = modelWorldMatrixInverse.mul(vec4(cameraPosition, 1)).xyz;
        const d = varying(eye.sub(positionGeometry)).normalize().toVar(), place = varying(uv()).toVar();
        const by = layersIn(TSL, surface, textures, place);
        const z = nodes.unitNormal(TSL, varying(attribute('normal', 'vec3')), d);
        const isHemisphere = surface.angularMap === ANGULAR_MAP.octahedralHemisphere;
        const tangent = isHemisphere || by.normal
            ? nodes.madeTangent(TSL, varying(attribute('tangent', 'vec4')).xyz, z) : null;
        const view = (name, number = TSL.float(0)) => nodes.viewColour(TSL, by[name], place, number);
        const one = by[pictureOfFile];
        if (one)
            return vec4(nodes.linear(TSL, nodes.directionColour(TSL, one, place, z, isHemisphere ? tangent : null, d).xyz), 1);
        if (by.coverage)
            TSL.Discard(view('coverage').x.lessThan(leastCoverage));
        const light = nodes.linear(TSL, layeredColour(TSL, by, {...surface.lights, texture: textures.lights},
                                                      {d, place, z, tangent, view}));
        const hidden = isBlended ? view('opacity').x.toVar() : null;
        return vec4(light, hidden ? TSL.select(hidden.lessThan(fullOpacity), hidden, 1) : 1);
    })());
    return isBlended ? blended(THREE, material) : material;
}

// The layers by their names, with their textures and, if they have mips, the texels around `place`.
function layersIn(TSL, {layers, atlases = []}, textures, place) {
    const across = TSL.dFdx(place).toVar(), down = TSL.dFdy(place).toVar();
    const footprint = across.mul(across).add(down.mul(down)).sqrt().toVar();
    const places = atlases.map(atlas => nodes.placesIn(TSL, textures.charts, atlas, place, footprint));
    return Object.fromEntries(layers.map(layer => {
        const mipped = layer.atlas === undefined ? {} : {cell: cellOf(layer.size, layer.mips), places: places[layer.atlas]};
        if (layer.name === 'coverage')
            delete mipped.places;
        return [layer.name, {...layer, texture: textures[`${layer.name}Layer`], ...mipped}];
    }));
}

// The display values of FORMAT.md 5.6, as layeredLines() of surface_shader.js writes them in GLSL.
function layeredColour(TSL, by, lights, {d, place, z, tangent, view}) {
    const {vec2, vec3} = TSL;
    const light = ({srgb, scale}, value) => (srgb ? nodes.linear(TSL, value.xyz) : value.xyz).mul(scale);
    if (by.normal)
        z = nodes.bumpedNormal(TSL, z, tangent, view('normal').xy);
    z = nodes.facingNormal(TSL, z, d);
    const turned = (name, at = place) => nodes.directionColour(TSL, by[name], at, z, null, d);
    const sum = light(by.diffuse, view('diffuse')).toVar();
    let share = vec3(1);
    if (by.specular) {
        const specular = light(by.specular, view('specular')).toVar();
        const roughness = (by.roughness ? light(by.roughness, view('roughness')).x : TSL.float(1)).toVar();
        const r = {normal: z, view: d, specular, roughness};
        share = nodes.reflectionShare(TSL, r);
        const direct = lightOfLights(TSL, r, lights, by.visibility ? four => view('visibility', four) : null);
        if (by.environment) {
            const {size: [lobes], scale} = by.environment;
            const lobe = vec2(nodes.environmentLobe(TSL, r, lobes).add(0.5).div(lobes), 0.5);
            const root = light(by.environment, turned('environment', lobe)).toVar();
            sum.addAssign(nodes.withEnvironment(TSL, direct, share.mul(root).mul(root).div(scale), roughness));
        } else {
            sum.addAssign(direct.points.add(direct.patches));
        }
    }
    if (by.reflection)
        sum.addAssign(share.mul(light(by.reflection, turned('reflection'))));
    if (by.emission)
        sum.addAssign(light(by.emission, view('emission')));
    const shown = nodes.displayed(TSL, sum).toVar();
    for (const name of ['difference', 'sharedDifference'])
        if (by[name])
            shown.addAssign(nodes.signedValue(turned(name).xyz).mul(by[name].scale));
    return shown.clamp(0, 1);
}

// seenBy(number): the shares of four lights that arrive; null: all do.
function lightOfLights(TSL, r, {count, texture}, seenBy) {
    const {Loop, float, int, ivec2, textureLoad, vec3} = TSL;
    const sum = {points: vec3(0).toVar(), patches: vec3(0).toVar(), unblocked: vec3(0).toVar()};
    if (count)
        Loop(count / 4, ({i: four}) => {
            const seen = seenBy ? seenBy(float(four)).toVar() : null;
            for (const [i, channel] of [...'xyzw'].entries()) {
                const row = int(four).mul(4).add(i).toVar();
                const to = textureLoad(texture, ivec2(0, row)).toVar(), of = textureLoad(texture, ivec2(1, row)).toVar();
                const share = seen ? seen[channel].div(of.w.max(1e-3)).min(1) : float(1);
                nodes.addLight(TSL, sum, to.w, nodes.lightOf(TSL, r, to, of.xyz), share);
            }
        });
    return sum;
}

// A mesh that shows a texture on a sphere, at its position in the world, like tesseraSphere() of tessera_three.js.
// rgba: file.atlas() of the whole texture.
export function tesseraNodeSphere(THREE, TSL, info, rgba) {
    if (!isSphere(info))
        throw new Error(`the proxy of the texture is "${info.names.proxy}", not a sphere`);
    const [U, V, S, T] = info.size, {inside, radius} = info;
    const atlas = pictureTexture(THREE, rgba, U * S, V * T, THREE.UnsignedByteType, THREE.LinearFilter);
    const material = nodeMaterial(THREE, TSL.Fn(() => {
        const {cameraPosition, dot, float, modelWorldMatrixInverse, positionGeometry, select, varying, vec2, vec4} = TSL;
        const eye = modelWorldMatrixInverse.mul(vec4(cameraPosition, 1)).xyz.toVar();
        const ray = varying(positionGeometry).sub(eye).normalize().toVar(), along = dot(eye, ray).negate();
        const nearest = eye.add(ray.mul(along)).toVar(), rest = float(radius * radius).sub(dot(nearest, nearest)).toVar();
        TSL.Discard(rest.lessThan(0)); // the triangles enclose the sphere, and this ray misses it
        const n = nearest.add(ray.mul(rest.max(0).sqrt().mul(inside ? 1 : -1))).toVar(), d = ray.negate().toVar();
        const x = nodes.arcTangent(TSL, n.x, n.z).div(2 * Math.PI).add(0.5).mul(U).sub(0.5).toVar();
        const y = nodes.arcTangent(TSL, n.y, vec2(n.x, n.z).length()).div(Math.PI).add(0.5).mul(V).sub(0.5).toVar();
        const low = vec2(x, y).floor().toVar(), weight = vec2(x, y).sub(low).toVar();
        const wrapped = u => select(u.lessThan(0), float(U - 1), select(u.greaterThanEqual(U), float(0), u));
        const at = (i, j) => sphereTexel(TSL, atlas, info, wrapped(low.x.add(i)), low.y.add(j).clamp(0, V - 1), d);
        const row = j => TSL.mix(at(0, j), at(1, j), weight.x);
        return vec4(nodes.linear(TSL, TSL.mix(row(0), row(1), weight.y)), 1);
    })());
    material.side = inside ? THREE.BackSide : THREE.FrontSide;
    const mesh = new THREE.Mesh(enclosingSphere(THREE, info), material);
    mesh.position.set(...info.centre);
    return mesh;
}

// The colour of a surface texel in direction d. The hardware interpolates between directions.
function sphereTexel(TSL, atlas, {size: [U, V, S, T], inside}, u, v, d) {
    const {float, select, texture, vec2} = TSL;
    const longitude = u.mul(2).add(1 - U).div(U).mul(Math.PI).toVar();
    const latitude = v.mul(2).add(1 - V).div(2 * V).mul(Math.PI).toVar();
    const turn = inside ? -1 : 1; // from inside, the frame is that of the antipode
    const [sinL, cosL] = [longitude.sin().mul(turn).toVar(), longitude.cos().mul(turn).toVar()];
    const [sinP, cosP] = [latitude.sin().mul(turn).toVar(), latitude.cos().toVar()];
    const outward = sinL.mul(d.x).add(cosL.mul(d.z)).toVar();
    const x = cosL.mul(d.x).sub(sinL.mul(d.z)).toVar(), y = cosP.mul(d.y).sub(sinP.mul(outward)).toVar();
    const z = cosP.mul(outward).add(sinP.mul(d.y)).toVar(), planar = vec2(x, z).length().toVar();
    const behind = select(x.lessThan(0), float(0), float(1));
    const ahead = select(z.lessThan(0), behind, nodes.arcTangent(TSL, x, z).div(Math.PI).add(0.5));
    const s = select(planar.greaterThan(1e-6), ahead, float(0.5));
    const t = nodes.arcTangent(TSL, y, planar).div(Math.PI).add(0.5);
    const inTexel = vec2(s.mul(S), t.mul(T)).clamp(vec2(0.5), vec2(S - 0.5, T - 0.5));
    return texture(atlas, vec2(u.mul(S), v.mul(T)).add(inTexel).div(vec2(U * S, V * T)), float(0)).xyz;
}

// colour: linear light, which the renderer encodes for the display, and alpha.
function nodeMaterial(THREE, colour) {
    const material = new THREE.MeshBasicNodeMaterial();
    material.toneMapped = false;
    material.colorNode = colour;
    return material;
}
