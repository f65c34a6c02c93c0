// A node material for three.js' WebGPURenderer, which draws by WebGPU or WebGL2: the texture of a mesh, sampled as
// FORMAT.md 5.2 specifies. Layers need the WebGLRenderer and tessera_three.js.
//
//   import * as THREE from 'three/webgpu';
//   import * as TSL from 'three/tsl';
//   const material = surfaceNodeMaterial(THREE, TSL, readSurface(file));
//
// Colours are shown as they are stored if the renderer's output is sRGB without tone mapping.
import {ANGULAR_MAP} from './tessera.js';

const noDirection = 1e-6; // as tsr_no_direction in decoder_glsl/shaders/surface.glsl

// surface: readSurface() or surfaceOf() in surface_shader.js. The geometry needs the attributes that attributesOf()
// lists, and position. Throws if the surface has layers.
export function surfaceNodeMaterial(THREE, TSL, surface) {
    const {angularMap, layers} = surface, [layer] = layers;
    if (layers.length !== 1)
        throw new Error('surfaceNodeMaterial() draws a single texture, but the surface has layers: use WebGLRenderer');
    const {width, height, half, pixels} = layer.picture;
    const picture = new THREE.DataTexture(pixels, width, height, THREE.RGBAFormat,
                                          half ? THREE.HalfFloatType : THREE.UnsignedByteType);
    picture.minFilter = picture.magFilter = THREE.LinearFilter;
    picture.generateMipmaps = false;
    picture.needsUpdate = true;
    const material = new THREE.MeshBasicNodeMaterial();
    material.toneMapped = false;
    material.colorNode = TSL.sRGBTransferEOTF(colourOf(TSL, picture, layer, angularMap)); // the renderer encodes it again
    return material;
}

function colourOf(TSL, picture, layer, angularMap) {
    const {Fn, attribute, cameraPosition, dot, modelWorldMatrixInverse, positionGeometry, select, uv, varying, vec2, vec4} = TSL;
    const isMirrored = angularMap === ANGULAR_MAP.octahedralMirrored;
    const toEye = varying(modelWorldMatrixInverse.mul(vec4(cameraPosition, 1)).xyz.sub(positionGeometry));
    const normal = varying(attribute('normal', 'vec3')), tangent = isMirrored ? null : varying(attribute('tangent', 'vec4')).xyz;
    const [, , S, T] = layer.size, views = vec2(S, T);
    return Fn(() => {
        const d = toEye.normalize().toVar();
        const z = select(normal.length().greaterThan(noDirection), normal.normalize(), d).toVar();
        const bent = d.sub(dot(z, d).min(0).mul(z)).toVar();
        const away = select(bent.length().greaterThan(noDirection), bent.normalize(), z).toVar();
        const square = isMirrored ? mirroredSquare(TSL, z, away) : hemisphereSquare(TSL, z, madeTangent(TSL, tangent, z), away);
        const at = square.add(1).mul(0.5).clamp(0, 1).mul(views).sub(0.5).toVar();
        const first = at.floor().clamp(vec2(-1), views.sub(1)).toVar(), weight = at.sub(first).toVar();
        const sum = vec4(0).toVar();
        for (const corner of [[0, 0], [1, 0], [0, 1], [1, 1]]) {
            const tap = first.add(vec2(...corner)).toVar();
            const view = isMirrored ? folded(TSL, tap, S, T) : tap.clamp(vec2(0), views.sub(1));
            const share = corner.map((far, axis) => far ? weight.element(axis) : weight.element(axis).oneMinus());
            sum.addAssign(viewColour(TSL, picture, layer, uv(), view.y.mul(S).add(view.x)).mul(share[0].mul(share[1])));
        }
        return sum.rgb;
    })();
}

// The colour of a view, whose number is an integer in a float.
function viewColour({float, texture, vec2}, picture, {size: [U, V], columns}, place, view) {
    const side = vec2(U, V), row = view.add(0.5).div(columns).floor(), column = view.sub(row.mul(columns));
    const at = place.mul(side).clamp(vec2(0.5), side.sub(0.5)).add(vec2(column, row).mul(side));
    return texture(picture, at.div(vec2(picture.image.width, picture.image.height)), float(0));
}

// The functions of octahedral.glsl with these names.
function mirroredSquare({dot, select, vec2}, n, d) {
    const side = x => select(x.lessThan(0), -1, 1), r = n.mul(dot(n, d).mul(2)).sub(d).toVar();
    const sum = r.x.abs().add(r.y.abs()).add(r.z.abs()), p = r.x.div(sum).toVar(), q = r.z.div(sum).toVar();
    return select(r.y.lessThan(0), vec2(q.abs().oneMinus().mul(side(p)), p.abs().oneMinus().mul(side(q))), vec2(p, q));
}

function hemisphereSquare({cross, dot, vec2}, z, tangent, d) {
    const x = dot(tangent, d).toVar(), y = dot(cross(z, tangent), d).toVar();
    const sum = x.abs().add(y.abs()).add(dot(z, d).max(0));
    return vec2(x.add(y), x.sub(y)).div(sum);
}

function madeTangent({dot, select, vec3}, v, n) {
    const flat = v.sub(dot(v, n).mul(n)).toVar(), size = n.abs().toVar();
    const axis = select(size.x.lessThanEqual(size.y).and(size.x.lessThanEqual(size.z)), vec3(1, 0, 0),
                        select(size.y.lessThanEqual(size.z), vec3(0, 1, 0), vec3(0, 0, 1))).toVar();
    const made = axis.sub(dot(axis, n).mul(n));
    return select(flat.length().greaterThan(v.length().mul(noDirection)), flat.normalize(), made.normalize()).toVar();
}

function folded({select, vec2}, tap, S, T) {
    const across = select(tap.x.lessThan(0).or(tap.x.greaterThanEqual(S)),
                          vec2(tap.x.clamp(0, S - 1), tap.y.mul(-1).add(T - 1)), tap).toVar();
    return select(across.y.lessThan(0).or(across.y.greaterThanEqual(T)),
                  vec2(across.x.mul(-1).add(S - 1), across.y.clamp(0, T - 1)), across).toVar();
}
