// The shader of a mesh with a Tessera texture or with layers (FORMAT.md 5.2 and 5.6), in GLSL ES 3.00 for any engine
// on WebGL2. Each texture becomes a picture whose S x T views, U x V pixels each, lie next to each other; mips.js adds
// mips. The GLSL in sampling.js is generated from the shaders of the GPU decoder.
import {cellOf, mipCount} from './mip_layout.js';
import {sampling} from './sampling.js';
import {ANGULAR_MAP, LAYER_ROLE, PROXY, SAMPLE_TYPE, SURFACE_MAP, TRANSFER} from './tessera.js';

export const usualSide = 16384; // the longest side of a texture on most devices, in pixels; some allow only 8192
const single = 'texture';
const drawnRoles = ['diffuse', 'emission', 'specular', 'roughness', 'normal', 'visibility', 'reflection', 'coverage',
                    'environment', 'difference', 'sharedDifference', 'opacity']; // keys of LAYER_ROLE

// The texture of an open file as {angularMap, layers, lights}. `layers` has {name, size, columns, srgb, scale, mips,
// picture} for each layer, in which `mips` is how many withMips() may add, and `picture` is {width, height, half, pixels}
// with RGBA pixels: numbers of 8 bits or, if `half`, half floats. `lights` is {count, pixels}: two RGBA pixels of 32-bit floats a row. Throws if the file is
// damaged, does not lie on a mesh, or needs a picture with a side above `longestSide`, the limit of the device.
export function readSurface(file, longestSide = usualSide) {
    const {info} = file;
    if (info.proxy !== PROXY.mesh || info.surfaceMap !== SURFACE_MAP.meshUv ||
        (info.angularMap !== ANGULAR_MAP.octahedralHemisphere && info.angularMap !== ANGULAR_MAP.octahedralMirrored))
        throw new Error('the texture does not lie on a mesh with an octahedral map');
    const {scale, further, lights} = file.layers();
    if (!further.length)
        return oneTexture(info, longestSide, () => file.atlas([0, info.size[0], 0, info.size[1]]));
    const layers = [{role: LAYER_ROLE.diffuse, scale, file}, ...further].map(({role, scale, file}) => {
        const name = drawnRoles.find(key => LAYER_ROLE[key] === role);
        if (!name)
            throw new Error(`the shader does not know layers of the role ${role}`);
        const {info} = file, wanted = role === LAYER_ROLE.visibility ? lights.length : 0;
        const size = wanted ? [...info.size.slice(0, 2), Math.ceil(wanted / 4), 1] : info.size;
        return layerOf(name, {...info, size}, scale, longestSide,
                       () => wanted ? lightsTogether(file, wanted) : texelsOf(file));
    });
    return {angularMap: ANGULAR_MAP.octahedralMirrored, layers, lights: lightTable(lights)};
}

// The same for one texture. rgba: file.atlas() of all texels.
export function surfaceOf(info, rgba) {
    return oneTexture(info, usualSide, () => rgba);
}

function oneTexture(info, longestSide, readRgba) {
    const [U, , S, T] = info.size, layer = layerOf(single, info, 1, longestSide, () => {
        const rgba = readRgba();
        return {half: false, value: (u, v, s, t, c) => rgba[4 * ((v * T + t) * U * S + u * S + s) + c]};
    });
    return {angularMap: info.angularMap, lights: {count: 0}, layers: [layer]};
}

// What a vertex needs besides its position.
export function attributesOf({angularMap, layers}) {
    const bumped = layers.some(({name}) => name === 'normal');
    return ['normal', 'uv'].concat(bumped || angularMap === ANGULAR_MAP.octahedralHemisphere ? ['tangent'] : []);
}

// read() returns {half, value}, and value(u, v, s, t, c) is channel c of a texel.
function layerOf(name, info, scale, longestSide, read) {
    const {size, transfer} = info, [U, V, S, T] = size, views = S * T;
    const columns = Math.max(1, Math.min(views, Math.round(Math.sqrt(views * V / U)) || 1));
    const width = columns * U, height = Math.ceil(views / columns) * V;
    if (width > longestSide || height > longestSide)
        throw new Error(`a texture of ${size.join('x')} needs a picture of ${width}x${height} pixels, but the device ` +
                        `allows only ${longestSide} a side`);
    const {half, value} = read(), pixels = new (half ? Uint16Array : Uint8Array)(width * height * 4);
    for (let t = 0, view = 0; t < T; ++t)
        for (let s = 0; s < S; ++s, ++view) {
            const first = Math.floor(view / columns) * V * width + (view % columns) * U;
            for (let v = 0; v < V; ++v)
                for (let u = 0, at = 4 * (first + v * width); u < U; ++u)
                    for (let c = 0; c < 4; ++c, ++at)
                        pixels[at] = value(u, v, s, t, c);
        }
    return {name, size, columns, srgb: transfer === TRANSFER.srgb, scale, mips: mipCount(info),
            picture: {width, height, half, pixels}};
}

// The samples as they are stored; channels that the texture does not have are 0.
function texelsOf(file) {
    const {size: [U, V, S, T], channels, sampleType} = file.info, half = sampleType === SAMPLE_TYPE.half16;
    const bytes = file.box([0, U, 0, V, 0, S, 0, T]);
    const samples = half ? new Uint16Array(bytes.buffer, bytes.byteOffset, bytes.length / 2) : bytes;
    return {half, value: (u, v, s, t, c) => c < channels ? samples[(((v * U + u) * T + t) * S + s) * channels + c] : 0};
}

// The layer of visibility with four lights in a pixel.
function lightsTogether(file, count) {
    const {half, value} = texelsOf(file), S = file.info.size[2];
    const ofLight = (u, v, light) => light < count ? value(u, v, light % S, Math.floor(light / S), 0) : 0;
    return {half, value: (u, v, s, t, c) => ofLight(u, v, 4 * s + c)};
}

// Filled up to a multiple of four lights by dark ones, whose direction must be a unit vector, too. The last number of
// a light is its sample if nothing blocks it.
function lightTable(lights) {
    const brightest = Math.max(0, ...lights.flatMap(({irradiance}) => irradiance));
    const count = 4 * Math.ceil(lights.length / 4), pixels = new Float32Array(8 * Math.max(count, 1));
    for (let i = lights.length; i < count; ++i)
        pixels[8 * i + 1] = 1;
    lights.forEach(({direction, spread, irradiance}, i) => {
        const peak = Math.max(1 / 51, brightest > 0 ? Math.sqrt(Math.max(...irradiance) / brightest) : 1);
        pixels.set([...direction, spread, ...irradiance, peak], 8 * i);
    });
    return {count, pixels};
}

// `eye` and `project` are expressions for the observer's position in the coordinates of the mesh and for the matrix
// from there to the screen. `uniforms` declares what they use.
export function vertexShader({uniforms, eye, project}) {
    return `precision highp float;
${uniforms}
in vec3 position, normal;
in vec4 tangent;
in vec2 uv;
out vec3 toEye;
out vec3 surfaceNormal, surfaceTangent;
out vec2 surfacePlace;
void main() {
    toEye = ${eye} - position;
    surfaceNormal = normal;
    surfaceTangent = tangent.xyz;
    surfacePlace = uv;
    gl_Position = ${project} * vec4(position, 1.0);
}`;
}

// Places in an atlas and its mips, as in viewer/atlas.glsl.
const mipSource = `uniform sampler2D charts; // red and green: the chart of each texel; the atlases are below each other
ivec2 mipSize(ivec2 whole, int mip) {
    return (whole + (1 << mip) - 1) >> mip;
}
ivec2 mipBegin(ivec2 whole, int mip) {
    ivec2 begin = ivec2(whole.x, 0);
    for (int above = 1; above < mip; ++above)
        begin.y += mipSize(whole, above).y;
    return begin;
}
vec2 chartAt(int row, ivec2 texel) {
    return texelFetch(charts, texel + ivec2(0, row), 0).rg;
}
vec4 sharesOf(vec2 weight) {
    vec2 other = 1.0 - weight;
    return vec4(other.x * other.y, weight.x * other.y, other.x * weight.y, weight.x * weight.y);
}
Places placesIn(ivec2 whole, int mips, int row, vec2 footprint) {
    vec2 texels = footprint * vec2(whole);
    float covered = max(min(texels.x, texels.y) * 0.70710678, max(texels.x, texels.y) / 4.0);
    float mip = covered > 1.0 ? min(log2(covered), float(mips)) : 0.0;
    int first = int(mip);
    float second = mip - float(first);
    Places places;
    places.count = mip > 0.0 ? second > 0.0 ? 2 : 1 : 0;
    vec2 place = clamp(surfacePlace, 0.0, 1.0) * vec2(whole);
    vec2 own = chartAt(row, min(ivec2(place), whole - 1));
    for (int i = 0; i < places.count; ++i) {
        TsrSurfaceFootprint f = tsr_atlas_footprint(surfacePlace, whole);
        ivec2 begin = ivec2(0);
        vec4 share = sharesOf(f.weight);
        if (first + i > 0) {
            ivec2 sides = mipSize(whole, first + i), start = mipBegin(whole, first + i);
            TsrSurfaceFootprint g = tsr_atlas_footprint(place / float(1 << (first + i)) / vec2(sides), sides);
            vec4 same = sharesOf(g.weight) *
                vec4(chartAt(row, start + g.low) == own, chartAt(row, start + ivec2(g.high.x, g.low.y)) == own,
                     chartAt(row, start + ivec2(g.low.x, g.high.y)) == own, chartAt(row, start + g.high) == own);
            float sum = same.x + same.y + same.z + same.w;
            if (own != vec2(0.0) && sum > 0.0) {
                f = g;
                begin = start;
                share = same / sum;
            }
        }
        places.low[i] = begin + f.low;
        places.high[i] = begin + f.high;
        places.share[i] = share * (i == 0 ? 1.0 - second : second);
    }
    return places;
}`;

const number = x => Number.isInteger(x) ? `${x}.0` : `${x}`;

// Whether the layer of opacity lets something behind the surface be seen.
export function isTranslucent({layers}) {
    return layers.some(({name}) => name === 'opacity');
}

// The uniforms are one sampler per layer, `NAMELayer`, the sampler `lights` if there are lights, and `charts` if there
// are mips. blends: alpha is the opacity, else 1. Colours are not multiplied by it.
export function fragmentShader({angularMap, layers, lights, atlases = []}, blends = false) {
    const by = Object.fromEntries(layers.map(layer => [layer.name, layer]));
    // A layer of one view, of one of several, and of the direction mirrored about frame.z.
    const place = ({name, size, columns, atlas, mips}) => {
        const {width, height} = cellOf(size, atlas === undefined ? 0 : mips);
        return `${name}Layer, View(ivec2(${size[0]}, ${size[1]}), ivec2(${width}, ${height}), ${columns}), ` +
            (atlas === undefined || name === 'coverage' ? 'inAtlas' : `places${atlas}`);
    };
    const at = (name, view = '0') => `viewAt(${place(by[name])}, surfacePlace, ${view})`;
    const turned = (name, uv = 'surfacePlace', map = ANGULAR_MAP.octahedralMirrored) =>
        `directionAt(${place(by[name])}, ivec2(${by[name].size[2]}, ${by[name].size[3]}), ${map}, ${uv}, frame, d)`;
    const light = (name, value) =>
        `${number(by[name].scale)} * ${by[name].srgb ? 'linear' : ''}(${value}.rgb)`;
    const lines = ['Places inAtlas;', 'inAtlas.count = 0;'];
    if (atlases.length)
        lines.push('vec2 across = dFdx(surfacePlace), down = dFdy(surfacePlace);',
                   'vec2 footprint = sqrt(across * across + down * down);');
    atlases.forEach(({size: [U, V], mips, row}, i) =>
        lines.push(`Places places${i} = placesIn(ivec2(${U}, ${V}), ${mips}, ${row}, footprint);`));
    if (by.coverage)
        lines.push(`if (${at('coverage')}.r < tsr_least_coverage) discard;`);
    lines.push('vec3 d = normalize(toEye);',
               'TsrMeshFrame frame = tsr_mesh_frame(surfaceNormal, surfaceTangent, d);');
    if (by[single])
        lines.push(`colour = ${turned(single, 'surfacePlace', angularMap)};`);
    else
        lines.push(...layeredLines(by, lights, {at, turned, light}));
    if (blends && by.opacity)
        lines.push(`float hidden = ${at('opacity')}.r;`, 'colour.a = hidden < tsr_full_opacity ? hidden : 1.0;');
    return `precision highp float;
precision highp int;
precision highp sampler2D;
${sampling}
${layers.map(({name}) => `uniform sampler2D ${name}Layer;`).join('\n')}
uniform sampler2D lights; // a row per light: direction and spread; irradiance and the sample if it is not blocked
in vec3 toEye;
in vec3 surfaceNormal, surfaceTangent;
in vec2 surfacePlace;
out vec4 colour;
// The four texels around a place in up to two mips of an atlas; count is 0 where the texture unit interpolates.
struct Places {
    int count;
    ivec2 low[2], high[2];
    vec4 share[2]; // (low, low), (high, low), (low, high), (high, high)
};
struct View {
    ivec2 side, cell; // without and with its mips
    int columns;      // of the picture
};
${atlases.length ? mipSource : ''}
vec4 viewAt(sampler2D picture, View of, Places places, vec2 uv, int view) {
    ivec2 first = ivec2(view % of.columns, view / of.columns) * of.cell;
    if (places.count == 0) {
        vec2 at = clamp(uv * vec2(of.side), vec2(0.5), vec2(of.side) - 0.5);
        return textureLod(picture, (at + vec2(first)) / vec2(textureSize(picture, 0)), 0.0);
    }
    vec4 sum = vec4(0.0);
    for (int i = 0; i < places.count; ++i) {
        ivec2 low = first + places.low[i], high = first + places.high[i];
        sum += places.share[i].x * texelFetch(picture, low, 0) +
               places.share[i].y * texelFetch(picture, ivec2(high.x, low.y), 0) +
               places.share[i].z * texelFetch(picture, ivec2(low.x, high.y), 0) +
               places.share[i].w * texelFetch(picture, high, 0);
    }
    return sum;
}
vec4 directionAt(sampler2D picture, View of, Places places, ivec2 views, int map, vec2 uv, TsrMeshFrame frame, vec3 d) {
    TsrOctahedralTaps taps = tsr_octahedral_taps(tsr_octahedral_place(map, frame, d), views);
    vec4 sum = vec4(0.0);
    for (int i = 0; i < 4; ++i) {
        ivec2 corner = ivec2(i & 1, i >> 1), st = taps.first + corner;
        st = map == tsr_map_mirrored ? tsr_folded(st, views) : clamp(st, ivec2(0), views - 1);
        vec2 share = mix(1.0 - taps.weight, taps.weight, vec2(corner));
        sum += share.x * share.y * viewAt(picture, of, places, uv, st.y * views.x + st.x);
    }
    return sum;
}
vec3 linear(vec3 x) { return vec3(tsr_linear(x.r), tsr_linear(x.g), tsr_linear(x.b)); }
void main() {
    ${lines.join('\n    ')}
}`;
}

// The statements that give `colour` by FORMAT.md 5.6.
function layeredLines(by, lights, {at, turned, light}) {
    const lines = [];
    if (by.normal)
        lines.push(`frame.z = tsr_bumped_normal(frame, ${at('normal')}.rg);`);
    lines.push('frame.z = tsr_facing_normal(frame.z, d);', `vec3 sum = ${light('diffuse', at('diffuse'))}, share = vec3(1.0);`);
    if (by.specular) {
        lines.push(`TsrReflectance r = TsrReflectance(frame.z, d, ${light('specular', at('specular'))}, 1.0);`);
        if (by.roughness)
            lines.push(`r.roughness = (${light('roughness', at('roughness'))}).r;`);
        lines.push('share = tsr_reflection_share(r);',
                   'TsrLightSum direct = TsrLightSum(vec3(0.0), vec3(0.0), vec3(0.0));');
        if (lights.count)
            lines.push(`for (int four = 0; four < ${lights.count / 4}; ++four) {`,
                       `    vec4 seen = ${by.visibility ? at('visibility', 'four') : 'vec4(1.0)'};`,
                       '    for (int i = 0; i < 4; ++i) {',
                       '        vec4 to = texelFetch(lights, ivec2(0, 4 * four + i), 0), of = texelFetch(lights, ivec2(1, 4 * four + i), 0);',
                       '        vec3 specular = tsr_light_of(r, TsrLight(to.xyz, to.w, of.rgb));',
                       `        direct = tsr_with_light(direct, to.w, specular, ${by.visibility ? 'min(seen[i] / max(of.a, 1e-3), 1.0)' : '1.0'});`,
                       '    }', '}');
        if (by.environment) {
            const lobes = number(by.environment.size[0]), scale = number(by.environment.scale);
            lines.push(`vec2 lobe = vec2((tsr_environment_lobe(r, ${lobes}) + 0.5) / ${lobes}, 0.5);`,
                       `vec3 root = ${light('environment', turned('environment', 'lobe'))};`,
                       `sum += tsr_with_environment(direct, share * root * root / ${scale}, r.roughness);`);
        } else {
            lines.push('sum += direct.points + direct.patches;');
        }
    }
    if (by.reflection)
        lines.push(`sum += share * ${light('reflection', turned('reflection'))};`);
    if (by.emission)
        lines.push(`sum += ${light('emission', at('emission'))};`);
    lines.push('vec3 shown = vec3(tsr_displayed(sum.r), tsr_displayed(sum.g), tsr_displayed(sum.b));');
    for (const name of ['difference', 'sharedDifference'])
        if (by[name])
            lines.push(`shown += ${number(by[name].scale)} * tsr_signed_value(${turned(name)}.rgb);`);
    lines.push('colour = vec4(clamp(shown, 0.0, 1.0), 1.0);');
    return lines;
}
