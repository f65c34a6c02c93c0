// Texels straight from the sorted coefficients of their block: the inverse transform at one (u, v)
// for up to four angles at once. Exact, so it is the same picture as from decoded texels.
#ifndef TESSERA_BINDING_DIRECTORY
#define TESSERA_BINDING_DIRECTORY 6
#endif
layout(std430, binding = 0) restrict readonly buffer TesseraTables { uint tsr_tables[]; };
layout(std430, binding = 3) restrict readonly buffer TesseraCoefficients { uvec4 tsr_coefficients[]; };
layout(std430, binding = TESSERA_BINDING_DIRECTORY) restrict readonly buffer TesseraDirectory {
    uint tsr_directory[];
};
#define TSR_READ_ONLY
#include "colour.glsl"
#include "walk.glsl"

// A block and what it says of where its coefficients are.
struct TsrBlock {
    ivec4 origin; // in the tile
    ivec4 sides;
    uint record; // word of the directory
};

// Down the split tree of a tile to the block that holds a texel.
TsrBlock tsr_find_block(uint tile, ivec4 sides, ivec4 at) {
    uint nodes = tsr_directory[tile * uint(tsr_d_words)];
    uint blocks = tsr_directory[tile * uint(tsr_d_words) + 1u];
    TsrBlock b;
    b.origin = ivec4(0);
    b.sides = sides;
    uint node = tsr_directory[nodes];
    for (int depth = 0; depth < tsr_max_depth && (node >> 31) == 0u; ++depth) {
        bool spatial = (node >> 28) == 1u;
        ivec2 side = spatial ? ivec2(b.sides.x, b.sides.y) : ivec2(b.sides.z, b.sides.w);
        ivec2 from = spatial ? ivec2(b.origin.x, b.origin.y) : ivec2(b.origin.z, b.origin.w);
        ivec2 to = spatial ? ivec2(at.x, at.y) : ivec2(at.z, at.w);
        ivec2 head = (side + ivec2(1)) / 2;
        int first = side.x > 1 && to.x >= from.x + head.x ? 1 : 0;
        int second = side.y > 1 && to.y >= from.y + head.y ? 1 : 0;
        ivec2 rest = ivec2(side.x > 1 ? (first == 1 ? side.x - head.x : head.x) : side.x,
                           side.y > 1 ? (second == 1 ? side.y - head.y : head.y) : side.y);
        from += ivec2(first * head.x, second * head.y);
        if (spatial) {
            b.origin = ivec4(from.x, from.y, b.origin.z, b.origin.w);
            b.sides = ivec4(rest.x, rest.y, b.sides.z, b.sides.w);
        } else {
            b.origin = ivec4(b.origin.x, b.origin.y, from.x, from.y);
            b.sides = ivec4(b.sides.x, b.sides.y, rest.x, rest.y);
        }
        uint child = uint(side.x > 1 ? first + 2 * second : second);
        node = tsr_directory[nodes + (node & 0x0FFFFFFFu) + child];
    }
    b.record = blocks + (node & 0xFFFu) * uint(tsr_block_words);
    return b;
}

// Sums along s and t for the angles (s0, t0), (s1, t0), (s0, t1), (s1, t1).
struct TsrAngularSums {
    TsrSum s0;
    TsrSum s1;
    ivec3 value_s; // along a side of 1, in place of both
    TsrSum t00;
    TsrSum t10;
    TsrSum t01;
    TsrSum t11;
    ivec3 value_t0;
    ivec3 value_t1;
};

void tsr_end_s(TsrBlock b, ivec4 angles, uint kt, TSR_INOUT(TsrAngularSums) a) {
    ivec3 low = b.sides.z > 1 ? tsr_rounded(a.s0) : a.value_s;
    ivec3 high = b.sides.z > 1 ? tsr_rounded(a.s1) : a.value_s;
    if (b.sides.w > 1) {
        int basis = tsr_basis_of(b.sides.w) + int(kt) * b.sides.w;
        uint first = tsr_table(basis + angles.z);
        uint second = tsr_table(basis + angles.w);
        tsr_add(a.t00, first, low);
        tsr_add(a.t10, first, high);
        tsr_add(a.t01, second, low);
        tsr_add(a.t11, second, high);
    } else {
        a.value_t0 = low;
        a.value_t1 = high;
    }
    a.s0 = tsr_no_sum();
    a.s1 = tsr_no_sum();
    a.value_s = ivec3(0);
}

void tsr_end_of_column(TsrBlock b, ivec4 angles, TSR_INOUT(TsrWalk) w,
                       TSR_INOUT(TsrAngularSums) a) {
    uint ks = (w.key >> 10) & 31u;
    ivec3 value = tsr_end_column(w);
    if (b.sides.z > 1) {
        int basis = tsr_basis_of(b.sides.z) + int(ks) * b.sides.z;
        tsr_add(a.s0, tsr_table(basis + angles.x), value);
        tsr_add(a.s1, tsr_table(basis + angles.y), value);
    } else
        a.value_s = value;
}

void tsr_one_more(TsrBlock b, ivec4 angles, uint at, uint end, TSR_INOUT(TsrWalk) w,
                  TSR_INOUT(TsrAngularSums) a) {
    if (at >= end)
        return;
    uvec4 coefficient = tsr_coefficient_at(at);
    if ((coefficient.x >> 10) != (w.key >> 10)) {
        tsr_end_of_column(b, angles, w, a);
        if ((coefficient.x >> 15) != (w.key >> 15))
            tsr_end_s(b, angles, w.key >> 15, a);
        w.key = coefficient.x;
    }
    tsr_walk_on(w, coefficient);
}

// Outputs of the transform at the four angles, a row each.
struct TsrFour {
    ivec3 x00;
    ivec3 x10;
    ivec3 x01;
    ivec3 x11;
};

TsrFour tsr_evaluate(TsrBlock b, ivec2 place, ivec4 angles, uint begin, uint count) {
    TsrAngularSums a;
    a.s0 = tsr_no_sum();
    a.s1 = tsr_no_sum();
    a.t00 = tsr_no_sum();
    a.t10 = tsr_no_sum();
    a.t01 = tsr_no_sum();
    a.t11 = tsr_no_sum();
    a.value_s = ivec3(0);
    a.value_t0 = ivec3(0);
    a.value_t1 = ivec3(0);
    if (count > 0u) {
        TsrWalk w = tsr_start_walk(b.sides, place);
        w.key = tsr_coefficient_at(begin).x;
        // Two a round: hosts refuse files whose blocks would take too many rounds.
        for (uint i = 0u; i < count; i += 2u) {
            tsr_one_more(b, angles, begin + i, begin + count, w, a);
            tsr_one_more(b, angles, begin + i + 1u, begin + count, w, a);
        }
        tsr_end_of_column(b, angles, w, a);
        tsr_end_s(b, angles, w.key >> 15, a);
    }
    bool pass = b.sides.w > 1;
    TsrFour f;
    f.x00 = pass ? tsr_rounded(a.t00) : a.value_t0;
    f.x10 = pass ? tsr_rounded(a.t10) : a.value_t1;
    f.x01 = pass ? tsr_rounded(a.t01) : a.value_t0;
    f.x11 = pass ? tsr_rounded(a.t11) : a.value_t1;
    return f;
}

vec4 tsr_shown(TsrFormat format, ivec3 colour, int alpha) {
    ivec4 values = tsr_values(format, ivec4(colour.x, colour.y, colour.z, alpha));
    uvec4 samples = tsr_samples(format, tsr_codes(format, values));
    if (format.half_floats)
        return tsr_unpack(samples.x | (samples.y << 16), samples.z | (samples.w << 16));
    return vec4(samples) / 255.0;
}

vec4 tsr_angular_image(ivec2 texel, TsrAngularFootprint f) {
    TsrFormat format = tsr_format();
    vec4 corner[4];
    int done = 0;
    // A round evaluates all texels that lie in the block of the first one still to do: one round
    // inside a block, four where it is cut both ways.
    for (int round = 0; round < 4 && done != 15; ++round) {
        int next = (done & 1) == 0 ? 0 : ((done & 2) == 0 ? 1 : ((done & 4) == 0 ? 2 : 3));
        ivec4 at = ivec4(texel.x, texel.y, (next & 1) == 0 ? f.low.x : f.high.x,
                         next < 2 ? f.low.y : f.high.y);
        uvec4 axes = uvec4(tsr_axis(0, at.x), tsr_axis(1, at.y), tsr_axis(2, at.z),
                           tsr_axis(3, at.w));
        ivec4 tiles = tsr_four(tsr_p_tiles);
        int number = ((tsr_axis_tile(axes.w) * tiles.z + tsr_axis_tile(axes.z)) * tiles.y +
                      tsr_axis_tile(axes.y)) *
                         tiles.x +
                     tsr_axis_tile(axes.x);
        ivec4 in_tile = ivec4(tsr_axis_place(axes.x), tsr_axis_place(axes.y),
                              tsr_axis_place(axes.z), tsr_axis_place(axes.w));
        ivec4 extent = ivec4(tsr_axis_extent(axes.x), tsr_axis_extent(axes.y),
                             tsr_axis_extent(axes.z), tsr_axis_extent(axes.w));
        TsrBlock b = tsr_find_block(uint(number), extent, in_tile);
        ivec4 origin = at - in_tile + b.origin;
        ivec4 angles = ivec4(f.low.x - origin.z, f.high.x - origin.z, f.low.y - origin.w,
                             f.high.y - origin.w);
        bool s0 = angles.x >= 0 && angles.x < b.sides.z;
        bool s1 = angles.y >= 0 && angles.y < b.sides.z;
        bool t0 = angles.z >= 0 && angles.z < b.sides.w;
        bool t1 = angles.w >= 0 && angles.w < b.sides.w;
        ivec4 within = clamp(angles, ivec4(0), ivec4(b.sides.z, b.sides.z, b.sides.w, b.sides.w) - 1);
        uint counts = tsr_directory[b.record + uint(tsr_k_counts)];
        uint first = tsr_directory[b.record + uint(tsr_k_first)];
        ivec2 place = ivec2(at.x - origin.x, at.y - origin.y);
        TsrFour colour = tsr_evaluate(b, place, within, first, counts & 0xFFFFu);
        TsrFour alpha = tsr_evaluate(b, place, within, first + (counts & 0xFFFFu), counts >> 16);
        if (s0 && t0)
            corner[0] = tsr_shown(format, colour.x00, alpha.x00.x);
        if (s1 && t0)
            corner[1] = tsr_shown(format, colour.x10, alpha.x10.x);
        if (s0 && t1)
            corner[2] = tsr_shown(format, colour.x01, alpha.x01.x);
        if (s1 && t1)
            corner[3] = tsr_shown(format, colour.x11, alpha.x11.x);
        done |= (s0 && t0 ? 1 : 0) | (s1 && t0 ? 2 : 0) | (s0 && t1 ? 4 : 0) | (s1 && t1 ? 8 : 0);
    }
    return tsr_mix4(corner[0], corner[1], corner[2], corner[3], f.weight);
}
