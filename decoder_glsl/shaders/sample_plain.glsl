// A texture that is decoded as a whole: angular images side by side, folded over layers.
ivec3 tsr_plain_pixel(ivec2 texel, ivec2 angles) {
    int fold_u = int(tsr_parameter(tsr_p_fold_u));
    int fold_v = int(tsr_parameter(tsr_p_fold_v));
    int column = texel.x / fold_u;
    int row = texel.y / fold_v;
    return ivec3((texel.x - column * fold_u) * int(tsr_parameter(tsr_p_stride_s)) + angles.x,
                 (texel.y - row * fold_v) * int(tsr_parameter(tsr_p_stride_t)) + angles.y,
                 row * int(tsr_parameter(tsr_p_folds_u)) + column);
}

vec4 tsr_angular_image(ivec2 texel, TsrAngularFootprint f) {
    ivec3 pixel = tsr_plain_pixel(texel, f.low);
#ifdef TESSERA_HARDWARE_FILTER
    return tsr_filtered(pixel, f);
#else
    ivec2 step = f.high - f.low;
    return tsr_mix4(texelFetch(tsr_texels, pixel, 0),
                    texelFetch(tsr_texels, pixel + ivec3(step.x, 0, 0), 0),
                    texelFetch(tsr_texels, pixel + ivec3(0, step.y, 0), 0),
                    texelFetch(tsr_texels, pixel + ivec3(step.x, step.y, 0), 0), f.weight);
#endif
}
