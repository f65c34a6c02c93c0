// The functions of surface.glsl, octahedral.glsl and layers.glsl in decoder_glsl/shaders/ as nodes of three.js (TSL), for
// tessera_three_webgpu.js. They are called while a node function is built, and `TSL` is the module three/tsl.

const noDirection = 1e-6, leastCosine = 0.02, leastRoughness = 0.03, littleLight = 1e-6;

// The texels around `place` in an atlas with mips, as placesIn() of surface_shader.js finds them. atlas: {size, mips, row}
// of a surface with mips; charts: their texture; footprint: what the pixel covers of the atlas along u and v.
export function placesIn(TSL, charts, {size: [U, V], mips, row}, place, footprint) {
    const {float, ivec2, select, textureLoad, vec2, vec4} = TSL, whole = vec2(U, V);
    const texels = footprint.mul(whole).toVar();
    const covered = texels.x.min(texels.y).mul(Math.SQRT1_2).max(texels.x.max(texels.y).div(4)).toVar();
    const mip = select(covered.greaterThan(1), covered.log2().min(mips), float(0)).toVar(), lower = mip.floor().toVar();
    const chartAt = at => textureLoad(charts, ivec2(at).add(ivec2(0, row))).xy;
    const inside = place.clamp(0, 1).mul(whole).toVar(), own = chartAt(inside.min(whole.sub(1)).floor()).toVar();
    const around = (sides, at) => { // the texels around `at`, in texels of a mip
        const low = at.sub(0.5).floor().clamp(vec2(-1), sides.sub(1)).toVar(), weight = at.sub(0.5).sub(low).toVar();
        const other = weight.oneMinus(), ofRow = share => [other.x.mul(share), weight.x.mul(share)];
        return {low: low.max(0).toVar(), high: low.add(1).min(sides.sub(1)).toVar(),
                share: vec4(...ofRow(other.y), ...ofRow(weight.y)).toVar()};
    };
    const cornersOf = ({low, high}) => [low, vec2(high.x, low.y), vec2(low.x, high.y), high];
    const taps = [0, 1].map(step => {
        const level = lower.add(step).min(mips).toVar(), scale = level.exp2().toVar();
        const sides = whole.add(scale).sub(1).div(scale).floor().toVar();
        // Mip 1 is in row 0 beside the atlas. The heights of the mips above this one are added.
        const top = float(0).toVar();
        for (let above = 1; above < mips; ++above)
            top.addAssign(select(level.greaterThan(above), float(Math.ceil(V / 2 ** above)), float(0)));
        const atlas = around(whole, inside), mipped = around(sides, inside.div(scale));
        const begin = select(level.greaterThan(0), vec2(U, top), vec2(0)).toVar();
        const same = cornersOf(mipped).map(at => {
            const chart = chartAt(begin.add(at)).sub(own).abs().toVar();
            return select(chart.x.add(chart.y).lessThan(1 / 512), float(1), float(0));
        });
        const share = mipped.share.mul(vec4(...same)).toVar(), sum = share.x.add(share.y).add(share.z).add(share.w).toVar();
        const isFound = level.greaterThan(0).and(own.x.add(own.y).greaterThan(0)).and(sum.greaterThan(0)).toVar();
        const weight = step ? mip.sub(lower) : lower.add(1).sub(mip);
        return {low: select(isFound, begin.add(mipped.low), atlas.low).toVar(),
                high: select(isFound, begin.add(mipped.high), atlas.high).toVar(),
                share: select(isFound, share.div(sum), atlas.share).mul(weight).toVar()};
    });
    return {isMipped: mip.greaterThan(0).toVar(), taps: taps.map(tap => ({...tap, corners: cornersOf(tap)}))};
}

// The colour of a view, whose number is an integer in a float. layer: of a surface, with its `texture`, and with `places`
// and the `cell` that its view and mips lie in, if it has mips.
export function viewColour(TSL, {texture: picture, size: [U, V], columns, places, cell}, place, view) {
    const {If, float, ivec2, texture, textureLoad, vec2, vec4} = TSL, side = vec2(U, V);
    const row = view.add(0.5).div(columns).floor().toVar(), column = view.sub(row.mul(columns));
    const begin = vec2(column, row).mul(cell ? vec2(cell.width, cell.height) : side).toVar();
    const inAtlas = () => texture(picture, place.mul(side).clamp(vec2(0.5), side.sub(0.5)).add(begin)
        .div(vec2(picture.image.width, picture.image.height)), float(0));
    if (!places)
        return inAtlas();
    const colour = vec4(0).toVar();
    If(places.isMipped, () => {
        for (const {corners, share} of places.taps)
            for (const [i, corner] of corners.entries())
                colour.addAssign(textureLoad(picture, ivec2(begin.add(corner))).mul(share['xyzw'[i]]));
    }).Else(() => {
        colour.assign(inAtlas());
    });
    return colour;
}

// The colour in direction d from a place whose normal is z. tangent: null for the mirrored map.
export function directionColour(TSL, layer, place, z, tangent, d) {
    const {dot, select, vec2, vec4} = TSL, [, , S, T] = layer.size, views = vec2(S, T);
    const bent = d.sub(dot(z, d).min(0).mul(z)).toVar();
    const away = select(bent.length().greaterThan(noDirection), bent.normalize(), z).toVar();
    const square = tangent ? hemisphereSquare(TSL, z, tangent, away) : mirroredSquare(TSL, z, away);
    const at = square.add(1).mul(0.5).clamp(0, 1).mul(views).sub(0.5).toVar();
    const first = at.floor().clamp(vec2(-1), views.sub(1)).toVar(), weight = at.sub(first).toVar();
    const sum = vec4(0).toVar();
    for (const corner of [[0, 0], [1, 0], [0, 1], [1, 1]]) {
        const tap = first.add(vec2(...corner)).toVar();
        const view = tangent ? tap.clamp(vec2(0), views.sub(1)) : folded(TSL, tap, S, T);
        const share = corner.map((far, axis) => far ? weight.element(axis) : weight.element(axis).oneMinus());
        sum.addAssign(viewColour(TSL, layer, place, view.y.mul(S).add(view.x)).mul(share[0].mul(share[1])));
    }
    return sum;
}

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

function folded({select, vec2}, tap, S, T) {
    const across = select(tap.x.lessThan(0).or(tap.x.greaterThanEqual(S)),
                          vec2(tap.x.clamp(0, S - 1), tap.y.mul(-1).add(T - 1)), tap).toVar();
    return select(across.y.lessThan(0).or(across.y.greaterThanEqual(T)),
                  vec2(across.x.mul(-1).add(S - 1), across.y.clamp(0, T - 1)), across).toVar();
}

// The unit normal of an interpolated one, in place of which d is used if it has no direction.
export function unitNormal({select}, normal, d) {
    return select(normal.length().greaterThan(noDirection), normal.normalize(), d).toVar();
}

export function madeTangent({dot, select, vec3}, v, n) {
    const flat = v.sub(dot(v, n).mul(n)).toVar(), size = n.abs().toVar();
    const axis = select(size.x.lessThanEqual(size.y).and(size.x.lessThanEqual(size.z)), vec3(1, 0, 0),
                        select(size.y.lessThanEqual(size.z), vec3(0, 1, 0), vec3(0, 0, 1))).toVar();
    const made = axis.sub(dot(axis, n).mul(n));
    return select(flat.length().greaterThan(v.length().mul(noDirection)), flat.normalize(), made.normalize()).toVar();
}

export function bumpedNormal({cross, dot, select}, z, tangent, value) {
    const xy = value.mul(255).sub(128).div(127).toVar(), square = dot(xy, xy).toVar();
    const short = select(square.greaterThan(1), xy.div(square.sqrt()), xy).toVar();
    return tangent.mul(short.x).add(cross(z, tangent).mul(short.y)).add(z.mul(square.oneMinus().max(0).sqrt()))
        .normalize().toVar();
}

export function facingNormal({dot, float, select}, normal, view) {
    const cosine = dot(normal, view).toVar();
    return select(cosine.lessThan(leastCosine), normal.add(view.mul(float(leastCosine).sub(cosine))).normalize(), normal)
        .toVar();
}

export function linear({select}, x) {
    const channel = c => select(c.lessThanEqual(0.04045), c.div(12.92), c.add(0.055).div(1.055).max(0).pow(2.4));
    return perChannel(x, channel);
}
export function displayed({select}, light) {
    const channel = c => select(c.lessThanEqual(0.0031308), c.mul(12.92), c.pow(1 / 2.4).mul(1.055).sub(0.055));
    return perChannel(light.clamp(0, 1).toVar(), channel);
}
const perChannel = (x, channel) => {
    const whole = x.toVar(), out = whole.mul(0).toVar();
    for (const axis of ['x', 'y', 'z'])
        out[axis].assign(channel(whole[axis]));
    return out;
};

export const signedValue = texel => texel.mul(255).sub(128).div(127).clamp(-1, 1);

// r: {normal, view, specular, roughness}; to: direction and spread of a light; irradiance: on a surface that faces it.
export function lightOf({cross, dot, select, vec3}, r, to, irradiance) {
    const nv = dot(r.normal, r.view).toVar(), z = dot(r.normal, to.xyz).toVar();
    const stretched = r.roughness.mul(10).sub(1.5).clamp(0, 1).toVar(), radius = to.w.mul(stretched).toVar();
    const above = z.div(radius.mul(3).max(1e-6)).add(0.6).clamp(0, 1).toVar();
    const raised = z.add(z.mul(z).add(radius.mul(radius).mul(4)).sqrt()).mul(0.5).toVar();
    const middle = to.xyz.add(r.normal.mul(raised.sub(z))).toVar(), l = middle.normalize().toVar();
    const nl = raised.div(middle.length()).toVar(), h = l.add(r.view).normalize().toVar();
    const alpha = r.roughness.max(leastRoughness).pow(2).toVar(), s2 = alpha.mul(alpha).toVar();
    const halfCosine = dot(r.view, h).clamp(0, 1).toVar(), along = to.w.mul(0.75).toVar();
    const across = along.div(stretched.mul(halfCosine.oneMinus()).oneMinus().max(0.01)).toVar(), nh = dot(r.normal, h).min(1).toVar();
    const along2 = s2.add(along.mul(along)).min(1).toVar(), across2 = s2.add(across.mul(across)).min(1).toVar();
    const axis = cross(l, r.view).toVar(), sine = cross(r.normal, h).toVar(), outOfPlane = dot(r.normal, axis).toVar();
    const x2 = outOfPlane.mul(outOfPlane).div(dot(axis, axis).max(1e-12)).toVar();
    const root = nh.mul(nh).add(dot(sine, sine).sub(x2).max(0).div(along2)).add(x2.div(across2)).toVar();
    const density = root.mul(root).mul(along2.mul(across2).sqrt()).mul(Math.PI).reciprocal();
    const masked = (a, b) => a.mul(s2.add(s2.oneMinus().mul(b).mul(b)).sqrt());
    const visibility = masked(nl, nv).add(masked(nv, nl)).reciprocal().mul(0.5);
    const grazing = halfCosine.oneMinus().pow(5);
    const light = r.specular.add(r.specular.oneMinus().mul(grazing)).mul(density.mul(visibility).mul(nl).mul(above)).mul(irradiance);
    return select(above.lessThanEqual(0).or(nv.lessThanEqual(0)), vec3(0), light).toVar();
}

// The rows of coefficients of tsr_reflection_share(), in ascending order.
const shareScale = [[0.005, 4.342, -6.276, 2.906], [1.07, -7.577, 16.225, -9.22], [1.467, -4.067, -5.616, 6.752],
                    [-1.745, 6.274, -3.532, -0.735]];
const shareBias = [[1.048, -4.432, 6.109, -2.742], [-2.27, 12.147, -19.452, 9.669], [1.162, -10.616, 20.845, -11.548],
                   [0.126, 2.675, -7.248, 4.528]];

export function reflectionShare({dot, float, vec3}, r) {
    const q = r.roughness.max(leastRoughness).toVar(), c = dot(r.normal, r.view).clamp(0, 1).toVar();
    const cubic = ([a, b, c, d], x) => x.mul(x.mul(x.mul(d).add(c)).add(b)).add(a);
    const both = rows => cubic(rows.map(row => cubic(row.map(number => float(number)), c).toVar()), q).clamp(0, 1);
    return r.specular.mul(both(shareScale)).add(vec3(both(shareBias))).toVar();
}

export function environmentLobe({dot}, r, lobes) {
    const roughness = r.roughness.mul(dot(r.normal, r.view).clamp(0, 1).sqrt());
    return roughness.max(0.05).div(0.05).log2().clamp(0, lobes - 1);
}

// sum: {points, patches, unblocked}, variables of specular light.
export function addLight({select}, sum, spread, specular, seen) {
    const patched = select(spread.greaterThan(0), 1, 0).toVar();
    sum.points.addAssign(specular.mul(seen).mul(patched.oneMinus()));
    sum.patches.addAssign(specular.mul(seen).mul(patched));
    sum.unblocked.addAssign(specular.mul(patched));
}

export function withEnvironment(TSL, sum, environment, roughness) {
    const share = roughness.sub(0.1).div(0.3).clamp(0, 1).toVar();
    const seen = sum.patches.add(littleLight).div(sum.unblocked.add(littleLight));
    return sum.points.add(sum.patches.mul(share)).add(seen.mul(environment).mul(share.oneMinus()));
}

// The standard atan2 as surface.glsl has it: that of a device may be off by a texel.
export function arcTangent({select}, y, x) {
    const lesser = y.abs().min(x.abs()).toVar(), greater = y.abs().max(x.abs()).toVar();
    const beyond = lesser.greaterThan(greater.mul(0.41421356)).toVar();
    const z = select(beyond, lesser.sub(greater).div(lesser.add(greater)), lesser.div(greater.max(1e-30))).toVar();
    const w = z.mul(z).toVar();
    const even = w.mul(0.079025984).sub(0.13824454).mul(w).add(0.19971879).mul(w).sub(0.33332757);
    const angle = z.add(z.mul(w).mul(even)).add(select(beyond, Math.PI / 4, 0)).toVar();
    angle.assign(select(y.abs().greaterThan(x.abs()), angle.negate().add(Math.PI / 2), angle));
    angle.assign(select(x.lessThan(0), angle.negate().add(Math.PI), angle));
    return select(y.lessThan(0), angle.negate(), angle).toVar();
}
