// Several textures where no variable may index an array of textures: OpenGL ES, WGSL, and with it
// HLSL and MSL. Texture i is at unit i. All textures share a storage buffer, which holds the words of
// one after those of another, and a uniform block, which holds their headers in the same order. The
// host sets tsr_p_words_at in each header to the word where the texture's words begin.
#if TESSERA_TEXTURES > 12
#error "TESSERA_TEXTURES is 12 at most"
#endif
const int tsr_textures = TESSERA_TEXTURES;
int tsr_selected = 0;
void tsr_select(int texture_number) {
    tsr_selected = texture_number;
}
layout(std430, binding = TESSERA_BINDING_SAMPLER) restrict readonly buffer TesseraSampler {
    uint tsr_sampler[];
};
layout(std140, TSR_UNIFORMS(TESSERA_BINDING_PARAMETERS)) uniform TesseraParameters {
    uvec4 tsr_parameters[tsr_textures * tsr_sampler_words / 4];
};
layout(TSR_TEXTURE(0)) uniform highp TSR_TEXTURE_TYPE tsr_texels_0;
#if TESSERA_TEXTURES > 1
layout(TSR_TEXTURE(1)) uniform highp TSR_TEXTURE_TYPE tsr_texels_1;
#endif
#if TESSERA_TEXTURES > 2
layout(TSR_TEXTURE(2)) uniform highp TSR_TEXTURE_TYPE tsr_texels_2;
#endif
#if TESSERA_TEXTURES > 3
layout(TSR_TEXTURE(3)) uniform highp TSR_TEXTURE_TYPE tsr_texels_3;
#endif
#if TESSERA_TEXTURES > 4
layout(TSR_TEXTURE(4)) uniform highp TSR_TEXTURE_TYPE tsr_texels_4;
#endif
#if TESSERA_TEXTURES > 5
layout(TSR_TEXTURE(5)) uniform highp TSR_TEXTURE_TYPE tsr_texels_5;
#endif
#if TESSERA_TEXTURES > 6
layout(TSR_TEXTURE(6)) uniform highp TSR_TEXTURE_TYPE tsr_texels_6;
#endif
#if TESSERA_TEXTURES > 7
layout(TSR_TEXTURE(7)) uniform highp TSR_TEXTURE_TYPE tsr_texels_7;
#endif
#if TESSERA_TEXTURES > 8
layout(TSR_TEXTURE(8)) uniform highp TSR_TEXTURE_TYPE tsr_texels_8;
#endif
#if TESSERA_TEXTURES > 9
layout(TSR_TEXTURE(9)) uniform highp TSR_TEXTURE_TYPE tsr_texels_9;
#endif
#if TESSERA_TEXTURES > 10
layout(TSR_TEXTURE(10)) uniform highp TSR_TEXTURE_TYPE tsr_texels_10;
#endif
#if TESSERA_TEXTURES > 11
layout(TSR_TEXTURE(11)) uniform highp TSR_TEXTURE_TYPE tsr_texels_11;
#endif

uvec4 tsr_parameters_from(int field) {
    return tsr_parameters[tsr_selected * (tsr_sampler_words / 4) + (field >> 2)];
}
uint tsr_word(int i) {
    return tsr_sampler[int(tsr_parameters_from(tsr_p_words_at)[tsr_p_words_at & 3]) + i];
}
vec4 tsr_texel(ivec3 at) {
#if TESSERA_TEXTURES > 11
    if (tsr_selected == 11)
        return texelFetch(tsr_texels_11, at, 0);
#endif
#if TESSERA_TEXTURES > 10
    if (tsr_selected == 10)
        return texelFetch(tsr_texels_10, at, 0);
#endif
#if TESSERA_TEXTURES > 9
    if (tsr_selected == 9)
        return texelFetch(tsr_texels_9, at, 0);
#endif
#if TESSERA_TEXTURES > 8
    if (tsr_selected == 8)
        return texelFetch(tsr_texels_8, at, 0);
#endif
#if TESSERA_TEXTURES > 7
    if (tsr_selected == 7)
        return texelFetch(tsr_texels_7, at, 0);
#endif
#if TESSERA_TEXTURES > 6
    if (tsr_selected == 6)
        return texelFetch(tsr_texels_6, at, 0);
#endif
#if TESSERA_TEXTURES > 5
    if (tsr_selected == 5)
        return texelFetch(tsr_texels_5, at, 0);
#endif
#if TESSERA_TEXTURES > 4
    if (tsr_selected == 4)
        return texelFetch(tsr_texels_4, at, 0);
#endif
#if TESSERA_TEXTURES > 3
    if (tsr_selected == 3)
        return texelFetch(tsr_texels_3, at, 0);
#endif
#if TESSERA_TEXTURES > 2
    if (tsr_selected == 2)
        return texelFetch(tsr_texels_2, at, 0);
#endif
#if TESSERA_TEXTURES > 1
    if (tsr_selected == 1)
        return texelFetch(tsr_texels_1, at, 0);
#endif
    return texelFetch(tsr_texels_0, at, 0);
}
#ifdef TESSERA_HARDWARE_FILTER
vec4 tsr_filtered_texel(vec3 place) {
#if TESSERA_TEXTURES > 11
    if (tsr_selected == 11)
        return textureLod(TSR_WITH_SAMPLER(tsr_texels_11), place, 0.0);
#endif
#if TESSERA_TEXTURES > 10
    if (tsr_selected == 10)
        return textureLod(TSR_WITH_SAMPLER(tsr_texels_10), place, 0.0);
#endif
#if TESSERA_TEXTURES > 9
    if (tsr_selected == 9)
        return textureLod(TSR_WITH_SAMPLER(tsr_texels_9), place, 0.0);
#endif
#if TESSERA_TEXTURES > 8
    if (tsr_selected == 8)
        return textureLod(TSR_WITH_SAMPLER(tsr_texels_8), place, 0.0);
#endif
#if TESSERA_TEXTURES > 7
    if (tsr_selected == 7)
        return textureLod(TSR_WITH_SAMPLER(tsr_texels_7), place, 0.0);
#endif
#if TESSERA_TEXTURES > 6
    if (tsr_selected == 6)
        return textureLod(TSR_WITH_SAMPLER(tsr_texels_6), place, 0.0);
#endif
#if TESSERA_TEXTURES > 5
    if (tsr_selected == 5)
        return textureLod(TSR_WITH_SAMPLER(tsr_texels_5), place, 0.0);
#endif
#if TESSERA_TEXTURES > 4
    if (tsr_selected == 4)
        return textureLod(TSR_WITH_SAMPLER(tsr_texels_4), place, 0.0);
#endif
#if TESSERA_TEXTURES > 3
    if (tsr_selected == 3)
        return textureLod(TSR_WITH_SAMPLER(tsr_texels_3), place, 0.0);
#endif
#if TESSERA_TEXTURES > 2
    if (tsr_selected == 2)
        return textureLod(TSR_WITH_SAMPLER(tsr_texels_2), place, 0.0);
#endif
#if TESSERA_TEXTURES > 1
    if (tsr_selected == 1)
        return textureLod(TSR_WITH_SAMPLER(tsr_texels_1), place, 0.0);
#endif
    return textureLod(TSR_WITH_SAMPLER(tsr_texels_0), place, 0.0);
}
#endif
