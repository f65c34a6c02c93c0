// The passes along u and v of the inverse transform, for one (u, v) of a block, in one walk over
// its sorted coefficients. A line is all coefficients that differ in the u frequency only; a column
// is all lines that differ in the v frequency only. Each sum is rounded when the next line or
// column begins, so the walk rounds where the format does and holds two sums only.
#ifndef TSR_WALK
#define TSR_WALK
#include "transform.glsl"

struct TsrWalk {
    ivec4 sides;  // of the block
    bool pass_u;  // whether there is a pass along u
    bool pass_v;
    ivec2 place;  // u, v in the block
    int basis_u;  // words of the basis at frequency 0
    int basis_v;
    uint key;     // frequency of the previous coefficient
    TsrSum line_sum;
    TsrSum column_sum;
    ivec3 line_value;   // used instead of the sum along an axis that has no pass
    ivec3 column_value;
};

// `axes`: see tsr_k_rest.
TsrWalk tsr_start_walk(ivec4 sides, uint axes, ivec2 place) {
    TsrWalk w;
    w.sides = sides;
    w.pass_u = sides.x > 1 && (axes & tsr_plain_u) == 0u;
    w.pass_v = sides.y > 1 && (axes & tsr_plain_v) == 0u;
    w.place = place;
    w.basis_u =
        ((axes & tsr_sines_u) != 0u ? tsr_sine_basis_of(sides.x) : tsr_basis_of(sides.x)) + place.x;
    w.basis_v =
        ((axes & tsr_sines_v) != 0u ? tsr_sine_basis_of(sides.y) : tsr_basis_of(sides.y)) + place.y;
    w.key = 0u;
    w.line_sum = tsr_no_sum();
    w.column_sum = tsr_no_sum();
    w.line_value = ivec3(0);
    w.column_value = ivec3(0);
    return w;
}

void tsr_end_line(TSR_INOUT(TsrWalk) w) {
    ivec3 value = w.pass_u ? tsr_rounded(w.line_sum) : w.line_value;
    int k = int((w.key >> 5) & 31u);
    if (w.pass_v)
        tsr_add(w.column_sum, tsr_table(w.basis_v + k * w.sides.y), value);
    else if (k == w.place.y)
        w.column_value = value;
    w.line_sum = tsr_no_sum();
    w.line_value = ivec3(0);
}

// Ends the column of w.key and returns its value at (u, v).
ivec3 tsr_end_column(TSR_INOUT(TsrWalk) w) {
    tsr_end_line(w);
    ivec3 value = w.pass_v ? tsr_rounded(w.column_sum) : w.column_value;
    w.column_sum = tsr_no_sum();
    w.column_value = ivec3(0);
    return value;
}

// Adds a coefficient of the current column.
void tsr_walk_on(TSR_INOUT(TsrWalk) w, uvec4 coefficient) {
    if ((coefficient.x >> 5) != (w.key >> 5))
        tsr_end_line(w);
    w.key = coefficient.x;
    ivec3 value = ivec3(int(coefficient.y), int(coefficient.z), int(coefficient.w));
    if (w.pass_u)
        tsr_add(w.line_sum, tsr_table(w.basis_u + int(coefficient.x & 31u) * w.sides.x), value);
    else if (int(coefficient.x & 31u) == w.place.x)
        w.line_value = ivec3(uvec3(w.line_value) + uvec3(value)); // unsigned, so that it wraps
}

uvec4 tsr_coefficient_at(uint at) {
    return at < uint(tsr_coefficients.length()) ? tsr_coefficients[at] : uvec4(0u);
}

#endif
