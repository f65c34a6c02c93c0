// What the layers after the first one add to its light (FORMAT.md 5.6), like tools/view/layered_renderer.cpp. Each
// layer is a picture with its mips, in the layout of class SlotLayout. Arrays are indexed by roles.
uniform sampler2D emissionLayer, specularLayer, roughnessLayer, normalLayer, visibilityLayer, reflectionLayer,
    coverageLayer, environmentLayer, differenceLayer, sharedDifferenceLayer, opacityLayer;
uniform ivec4 layers[12];     // x: number of the atlas, -1: not loaded; y: 1 for transfer sRGB; z, w: pixels per texel
uniform float layerScales[12];
uniform sampler2D lights;     // a row per light: direction and spread; irradiance and the sample if it is not blocked
uniform int lightCount;
uniform bool blends;          // whether the file has a layer of opacity, so that colours are linear light
uniform bool drawsBlended;    // the places that do not hide what is behind them, or those that do

// The texels of an atlas that the pixel samples, in two mips.
struct AtlasPlaces {
    int count;
    ivec2 low[2], high[2]; // in the picture of the atlas with its mips
    vec4 share[2];
};
AtlasPlaces places;
int placesOf = -1;

// Sets `places`.
void findPlaces(int atlas, vec2 uv, vec2 footprint) {
    for (; placesOf != atlas; placesOf = atlas) {
        float mip = mipOf(atlas, footprint);
        int first = int(mip);
        float second = mip - float(first);
        places.count = second > 0.0 ? 2 : 1;
        for (int i = 0; i < places.count; ++i) {
            AtlasPlace at = atlasPlace(atlas, uv, first + i);
            ivec2 begin = mipBegin(atlas, at.mip);
            places.low[i] = begin + at.low;
            places.high[i] = begin + at.high;
            places.share[i] = at.share * (i == 0 ? 1.0 - second : second);
        }
    }
}

// A layer at `places`. pixel: the one of `pixels` per texel that is read.
vec4 layerAt(sampler2D layer, ivec2 pixels, ivec2 pixel) {
    vec4 sum = vec4(0.0);
    for (int i = 0; i < places.count; ++i) {
        ivec2 low = places.low[i] * pixels + pixel, high = places.high[i] * pixels + pixel;
        sum += places.share[i].x * texelFetch(layer, low, 0) +
               places.share[i].y * texelFetch(layer, ivec2(high.x, low.y), 0) +
               places.share[i].z * texelFetch(layer, ivec2(low.x, high.y), 0) +
               places.share[i].w * texelFetch(layer, high, 0);
    }
    return sum;
}

vec3 lightOf(vec3 value, int role) {
    vec3 light = layers[role].y == 0 ? value : vec3(tsr_linear(value.r), tsr_linear(value.g), tsr_linear(value.b));
    return light * layerScales[role];
}

// 1 if a layer is not loaded, else 0: for loops that are skipped then, like those in slots.glsl.
int missing(int role) {
    return layers[role].x < 0 ? 1 : 0;
}

const int emission = 1, specular = 2, roughness = 3, normal = 4, visibility = 5, reflection = 6,
    coverage = 7, environment = 8, difference = 9, sharedDifference = 10, opacity = 11;

// A layer of several directions in the one that is mirrored about the normal, at `places`.
vec4 mirroredSample(sampler2D layer, int role, TsrMeshFrame frame, vec3 direction) {
    ivec2 directions = layers[role].zw;
    TsrOctahedralTaps around =
        tsr_octahedral_taps(tsr_octahedral_place(tsr_map_mirrored, frame, direction), directions);
    vec4 share = shares(around.weight), sum = vec4(0.0);
    for (int corner = 0; corner < 4; ++corner) {
        ivec2 st = tsr_folded(around.first + ivec2(corner & 1, corner >> 1), directions);
        sum += share[corner] * layerAt(layer, directions, st);
    }
    return sum;
}

vec3 reflectedLight(TsrMeshFrame frame, vec3 direction) {
    return lightOf(mirroredSample(reflectionLayer, reflection, frame, direction).rgb, reflection);
}

// What the display value changes by.
vec3 differenceAt(sampler2D layer, int role, vec2 uv, vec2 footprint, TsrMeshFrame frame, vec3 direction) {
    vec3 change = vec3(0.0);
    for (int once = missing(role); once < 1; ++once) {
        findPlaces(layers[role].x, uv, footprint);
        change = layerScales[role] * tsr_signed_value(mirroredSample(layer, role, frame, direction).rgb);
    }
    return change;
}

vec3 environmentLight(TsrMeshFrame frame, vec3 direction, TsrReflectance r) {
    float lobes = float(atlases[layers[environment].x].x);
    placesOf = -1; // those of an atlas of the same size are not lobes
    findPlaces(layers[environment].x, vec2((tsr_environment_lobe(r, lobes) + 0.5) / lobes, 0.5), vec2(0.0));
    vec3 root = lightOf(mirroredSample(environmentLayer, environment, frame, direction).rgb, environment);
    placesOf = -1;
    return root * root / layerScales[environment];
}

vec3 lightOf(TsrReflectance r, int number) {
    vec4 to = texelFetch(lights, ivec2(0, number), 0);
    return tsr_light_of(r, TsrLight(to.xyz, to.w, texelFetch(lights, ivec2(1, number), 0).rgb));
}

// Dark lights at the end of the list have none.
float peakOf(int number) {
    return max(texelFetch(lights, ivec2(1, number), 0).a, 1e-3);
}

TsrLightSum withLight(TsrLightSum sum, int number, vec3 specular, float seen) {
    return tsr_with_light(sum, texelFetch(lights, ivec2(0, number), 0).w, specular, seen);
}

// A pixel of the layer of visibility holds four lights. `lights` is filled up to a multiple of four with dark ones.
TsrLightSum lightOfLights(TsrReflectance r) {
    ivec2 pixels = layers[visibility].zw;
    TsrLightSum sum = TsrLightSum(vec3(0.0), vec3(0.0), vec3(0.0));
    float least = missing(environment) == 1 ? 1e-5 : 1e-8;
    for (int four = 0; 4 * four < lightCount; ++four) {
        int first = 4 * four;
        vec3 a = lightOf(r, first), b = lightOf(r, first + 1), c = lightOf(r, first + 2), d = lightOf(r, first + 3);
        vec3 most = max(max(a, b), max(c, d));
        for (int once = max(most.r, max(most.g, most.b)) < least ? 1 : 0; once < 1; ++once) {
            vec4 seen = vec4(1.0);
            for (int there = missing(visibility); there < 1; ++there)
                seen = min(layerAt(visibilityLayer, pixels, ivec2(four % pixels.x, four / pixels.x)) /
                               vec4(peakOf(first), peakOf(first + 1), peakOf(first + 2), peakOf(first + 3)), 1.0);
            sum = withLight(sum, first, a, seen.x);
            sum = withLight(sum, first + 1, b, seen.y);
            sum = withLight(sum, first + 2, c, seen.z);
            sum = withLight(sum, first + 3, d, seen.w);
        }
    }
    return sum;
}

// The opacity of a place that this pass draws; 0 if it does not draw the place. A layer that is not loaded hides all.
float opacityAt(vec2 uv, vec2 footprint) {
    float value = 1.0;
    for (int once = missing(opacity); once < 1; ++once) {
        findPlaces(layers[opacity].x, uv, footprint);
        value = layerAt(opacityLayer, ivec2(1), ivec2(0)).r;
    }
    bool hides = value >= tsr_full_opacity;
    return hides == drawsBlended ? 0.0 : hides ? 1.0 : value;
}

// Whether there is no surface at the place.
bool isHole(vec2 uv) {
    float covered = 1.0;
    for (int once = missing(coverage); once < 1; ++once) {
        findPlaces(layers[coverage].x, uv, vec2(0.0));
        covered = layerAt(coverageLayer, ivec2(1), ivec2(0)).r;
        placesOf = -1; // other layers of this atlas have another footprint
    }
    return covered < tsr_least_coverage;
}

// The display values of the light, or, if the file has a layer of opacity, linear light. diffuse: a sample of the first layer; uv: the place in all atlases; footprint: what
// the pixel covers of them; direction: towards the observer.
vec3 withLayers(vec3 diffuse, vec2 uv, vec2 footprint, TsrMeshFrame frame, vec3 direction) {
    vec3 light = lightOf(diffuse, 0), share = vec3(1.0);
    for (int once = missing(normal); once < 1; ++once) {
        findPlaces(layers[normal].x, uv, footprint);
        frame.z = tsr_bumped_normal(frame, layerAt(normalLayer, ivec2(1), ivec2(0)).rg);
    }
    frame.z = tsr_facing_normal(frame.z, direction);
    for (int once = missing(specular); once < 1; ++once) {
        TsrReflectance r = TsrReflectance(frame.z, direction, vec3(0.0), 1.0);
        findPlaces(layers[specular].x, uv, footprint);
        r.specular = lightOf(layerAt(specularLayer, ivec2(1), ivec2(0)).rgb, specular);
        for (int once = missing(roughness); once < 1; ++once) {
            findPlaces(layers[roughness].x, uv, footprint);
            r.roughness = lightOf(layerAt(roughnessLayer, ivec2(1), ivec2(0)).rgb, roughness).r;
        }
        for (int once = missing(visibility); once < 1; ++once)
            findPlaces(layers[visibility].x, uv, footprint);
        share = tsr_reflection_share(r);
        TsrLightSum sum = lightOfLights(r);
        vec3 specularLight = sum.points + sum.patches;
        for (int once = lightCount > 0 ? missing(environment) : 1; once < 1; ++once)
            specularLight = tsr_with_environment(sum, share * environmentLight(frame, direction, r),
                                                 r.roughness);
        light += specularLight;
    }
    for (int once = missing(reflection); once < 1; ++once) {
        findPlaces(layers[reflection].x, uv, footprint);
        light += share * reflectedLight(frame, direction);
    }
    for (int once = missing(emission); once < 1; ++once) {
        findPlaces(layers[emission].x, uv, footprint);
        light += lightOf(layerAt(emissionLayer, ivec2(1), ivec2(0)).rgb, emission);
    }
    bool differs = missing(difference) + missing(sharedDifference) < 2;
    if (blends && !differs)
        return light;
    vec3 shown = vec3(tsr_displayed(light.r), tsr_displayed(light.g), tsr_displayed(light.b)) +
                 differenceAt(differenceLayer, difference, uv, footprint, frame, direction) +
                 differenceAt(sharedDifferenceLayer, sharedDifference, uv, footprint, frame, direction);
    shown = clamp(shown, 0.0, 1.0);
    return blends ? vec3(tsr_linear(shown.r), tsr_linear(shown.g), tsr_linear(shown.b)) : shown;
}
