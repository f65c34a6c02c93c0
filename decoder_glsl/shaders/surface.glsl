// The texels that a sample of a sphere reads: FORMAT.md part 5, "Sampling", in single precision.
// Tests compare it with format/sampler.h, which is the same in double precision.
//
// This file compiles as GLSL 4.50, GLSL ES 3.10 and, with GLM, C++: so it has no swizzles and no
// array constructors. Built-in trigonometric functions may be off by 2^-11, which is more than a
// texel of a large texture. The functions here are minimax polynomials (Remez) for the ranges they
// state.

const float tsr_pi = 3.14159265f;
// A vector computed from unit vectors has no reliable direction if it is shorter than this.
const float tsr_no_direction = 1e-6f;

// The four surface texels around a position: u is low.x or high.x, v is low.y or high.y.
struct TsrSurfaceFootprint {
    ivec2 low;
    ivec2 high;
    vec2 weight; // of high
};

// The four texels of an angular image around a direction: s is low.x or high.x, t is low.y or
// high.y.
struct TsrAngularFootprint {
    vec2 weight; // of high. First, because Tint confuses structures that have the same members.
    ivec2 low;
    ivec2 high;
};

// The local frame at a surface texel: sine (x) and cosine (y) of its longitude and latitude.
struct TsrFrame {
    vec2 longitude;
    vec2 latitude;
};

// The standard atan2, for numbers whose sum does not overflow; 0 for (0, 0). The error is below
// 2e-7, mostly from the last rounding.
float tsr_atan2(float y, float x) {
    float lesser = min(abs(x), abs(y));
    float greater = max(abs(x), abs(y));
    if (greater <= 0.0f)
        return 0.0f;
    // Since atan(a / b) = pi/4 + atan((a - b) / (a + b)) for a <= b, the polynomial needs to span
    // |z| <= tan(pi/8) only. The reflections below count eighths of a turn and change the sign.
    bool beyond = lesser > 0.41421356f * greater;
    float z = beyond ? (lesser - greater) / (lesser + greater) : lesser / greater;
    float w = z * z;
    float angle =
        z + z * w * (-0.33332757f + w * (0.19971879f + w * (-0.13824454f + w * 0.079025984f)));
    float eighths = beyond ? 1.0f : 0.0f;
    if (abs(y) > abs(x)) {
        eighths = 2.0f - eighths;
        angle = -angle;
    }
    if (x < 0.0f) {
        eighths = 4.0f - eighths;
        angle = -angle;
    }
    // pi/4 in two parts, so that the first one times 0..4 is exact.
    angle = eighths * 0.78515625f + (eighths * 0.0002419134f + angle);
    return y < 0.0f ? -angle : angle;
}

// Sine (x) and cosine (y) of pi * numerator / denominator, for |numerator| <= denominator <= 2^21.
// The error is below 1.5e-7: the reduction to an eighth of a turn is exact, in integers.
vec2 tsr_sincos(int numerator, int denominator) {
    int eighths = 4 * (numerator + 2 * denominator); // plus a whole turn: never negative
    int quarter = (eighths + denominator) / (2 * denominator);
    int rest = eighths / 2 - quarter * denominator;
    float x = float(rest) / float(denominator); // in quarter turns, -1/2..1/2
    float w = x * x;
    float sine = x * (1.5707963f + w * (-0.64596294f + w * (0.079675903f + w * -0.0045922891f)));
    float cosine =
        1.0f + w * (-1.2337005f + w * (0.25366924f + w * (-0.020860289f + w * 0.00090402171f)));
    int turned = quarter & 3;
    if (turned == 1)
        return vec2(cosine, -sine);
    if (turned == 2)
        return vec2(-sine, -cosine);
    if (turned == 3)
        return vec2(-cosine, sine);
    return vec2(sine, cosine);
}

// (u, v) of the surface in direction n from the centre; u = 1/2 on the axis. The square of n's
// length must be a normal number. v takes the arc tangent, because the arc sine loses half the
// digits near the poles.
vec2 tsr_sphere_place(vec3 n) {
    float u = tsr_atan2(n.x, n.z) / (2.0f * tsr_pi) + 0.5f;
    float v = tsr_atan2(n.y, sqrt(n.x * n.x + n.z * n.z)) / tsr_pi + 0.5f;
    return vec2(u >= 1.0f ? 0.0f : u, v);
}

// size: texels along u and v. u wraps around, v is clamped.
TsrSurfaceFootprint tsr_surface_footprint(vec3 n, ivec2 size) {
    vec2 place = tsr_sphere_place(n);
    float across = place.x * float(size.x) - 0.5f;
    float up = place.y * float(size.y) - 0.5f;
    int i = int(floor(across));
    int j = int(floor(up));
    TsrSurfaceFootprint f;
    f.weight = vec2(across - float(i), up - float(j));
    // The clamps keep texels inside the texture even if n is not a number.
    f.low = ivec2(i < 0 ? size.x - 1 : min(i, size.x - 1), clamp(j, 0, size.y - 1));
    f.high = ivec2(i >= size.x - 1 ? 0 : max(i + 1, 0), clamp(j + 1, 0, size.y - 1));
    return f;
}

// The frame at the centre of a surface texel. For a sphere seen from inside, the normal points to
// the centre, so it is the frame at the antipode.
TsrFrame tsr_frame(ivec2 texel, ivec2 size, bool inside) {
    TsrFrame f;
    f.longitude = tsr_sincos(2 * texel.x + 1 - size.x, size.x);
    f.latitude = tsr_sincos(2 * texel.y + 1 - size.y, 2 * size.y);
    if (inside) {
        f.longitude = -f.longitude;
        f.latitude = vec2(-f.latitude.x, f.latitude.y);
    }
    return f;
}

// (s, t) in 0..1 of direction d, of any length, which points away from the surface.
//     ez = (sin l cos p, sin p, cos l cos p)    ex = (cos l, 0, -sin l)    ey = ez x ex
// for longitude l and latitude p.
vec2 tsr_angles(TsrFrame frame, vec3 d) {
    float x = frame.longitude.y * d.x - frame.longitude.x * d.z;
    float outward = frame.longitude.x * d.x + frame.longitude.y * d.z;
    float z = frame.latitude.y * outward + frame.latitude.x * d.y;
    float y = frame.latitude.y * d.y - frame.latitude.x * outward;
    float planar = sqrt(x * x + z * z);
    float s = 0.5f;
    if (planar > tsr_no_direction) {
        if (z < 0.0f)
            s = x < 0.0f ? 0.0f : 1.0f;
        else
            s = tsr_atan2(x, z) / tsr_pi + 0.5f;
    }
    return vec2(s, tsr_atan2(y, planar) / tsr_pi + 0.5f);
}

// The texels around (s, t) in 0..1. angular_size: texels along s and t.
TsrAngularFootprint tsr_footprint_of_angles(vec2 angles, ivec2 angular_size) {
    float across = angles.x * float(angular_size.x) - 0.5f;
    float up = angles.y * float(angular_size.y) - 0.5f;
    int i = int(floor(across));
    int j = int(floor(up));
    TsrAngularFootprint f;
    f.weight = vec2(across - float(i), up - float(j));
    f.low = ivec2(clamp(i, 0, angular_size.x - 1), clamp(j, 0, angular_size.y - 1));
    f.high = ivec2(clamp(i + 1, 0, angular_size.x - 1), clamp(j + 1, 0, angular_size.y - 1));
    return f;
}

// The same for one surface texel and the unit direction d from the surface to the observer. The
// sizes are texels along u and v, and along s and t.
TsrAngularFootprint tsr_angular_footprint(ivec2 texel, ivec2 surface_size, ivec2 angular_size,
                                          bool inside, vec3 d) {
    return tsr_footprint_of_angles(tsr_angles(tsr_frame(texel, surface_size, inside), d),
                                   angular_size);
}
