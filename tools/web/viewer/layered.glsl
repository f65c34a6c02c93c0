// What the layers after the first one add to its light (FORMAT.md 5.6), like tools/view/layered_renderer.cpp. Each
// layer is a picture with its mips, in the layout of class SlotLayout. Arrays are indexed by roles.
uniform sampler2D emissionLayer, specularLayer, roughnessLayer, normalLayer, visibilityLayer, reflectionLayer;
uniform ivec4 layers[7];      // x: number of the atlas, -1: not loaded; y: 1 for transfer sRGB; z, w: pixels per texel
uniform float layerScales[7];
uniform sampler2D lights;     // a row per light: direction and spread, irradiance
uniform int lightCount;

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
    if (atlas == placesOf)
        return;
    placesOf = atlas;
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

const int emission = 1, specular = 2, roughness = 3, normal = 4, visibility = 5, reflection = 6;

vec3 reflectedLight(TsrMeshFrame frame, vec3 direction) {
    ivec2 directions = layers[reflection].zw;
    TsrOctahedralTaps around =
        tsr_octahedral_taps(tsr_octahedral_place(tsr_map_mirrored, frame, direction), directions);
    vec4 share = shares(around.weight), sum = vec4(0.0);
    for (int corner = 0; corner < 4; ++corner) {
        ivec2 st = tsr_folded(around.first + ivec2(corner & 1, corner >> 1), directions);
        sum += share[corner] * layerAt(reflectionLayer, directions, st);
    }
    return lightOf(sum.rgb, reflection);
}

// A pixel of the layer of visibility holds four lights.
vec3 lightOfLights(TsrReflectance r) {
    ivec2 pixels = layers[visibility].zw;
    vec3 sum = vec3(0.0);
    vec4 seen = vec4(1.0);
    int four = layers[visibility].x < 0 ? 1 << 20 : -1; // number of the lights in `seen`, divided by four
    for (int j = 0; j < lightCount; ++j) {
        vec4 to = texelFetch(lights, ivec2(0, j), 0);
        vec3 light = tsr_light_of(r, TsrLight(to.xyz, to.w, texelFetch(lights, ivec2(1, j), 0).rgb));
        if (max(light.r, max(light.g, light.b)) < 1e-5)
            continue;
        if (j >> 2 > four) {
            four = j >> 2;
            seen = layerAt(visibilityLayer, pixels, ivec2(four % pixels.x, four / pixels.x));
        }
        sum += seen[j & 3] * light;
    }
    return sum;
}

// The display values of the light. diffuse: a sample of the first layer; uv: the place in all atlases; footprint: what
// the pixel covers of them; direction: towards the observer.
vec3 withLayers(vec3 diffuse, vec2 uv, vec2 footprint, TsrMeshFrame frame, vec3 direction) {
    vec3 light = lightOf(diffuse, 0), share = vec3(1.0);
    if (layers[normal].x >= 0) {
        findPlaces(layers[normal].x, uv, footprint);
        frame.z = tsr_bumped_normal(frame, layerAt(normalLayer, ivec2(1), ivec2(0)).rg);
    }
    frame.z = tsr_facing_normal(frame.z, direction);
    if (layers[specular].x >= 0) {
        TsrReflectance r = TsrReflectance(frame.z, direction, vec3(0.0), 1.0);
        findPlaces(layers[specular].x, uv, footprint);
        r.specular = lightOf(layerAt(specularLayer, ivec2(1), ivec2(0)).rgb, specular);
        if (layers[roughness].x >= 0) {
            findPlaces(layers[roughness].x, uv, footprint);
            r.roughness = lightOf(layerAt(roughnessLayer, ivec2(1), ivec2(0)).rgb, roughness).r;
        }
        light *= tsr_diffuse_share(r);
        if (layers[visibility].x >= 0)
            findPlaces(layers[visibility].x, uv, footprint);
        light += lightOfLights(r);
        share = tsr_reflection_share(r);
    }
    if (layers[reflection].x >= 0) {
        findPlaces(layers[reflection].x, uv, footprint);
        light += share * reflectedLight(frame, direction);
    }
    if (layers[emission].x >= 0) {
        findPlaces(layers[emission].x, uv, footprint);
        light += lightOf(layerAt(emissionLayer, ivec2(1), ivec2(0)).rgb, emission);
    }
    return vec3(tsr_displayed(light.r), tsr_displayed(light.g), tsr_displayed(light.b));
}
