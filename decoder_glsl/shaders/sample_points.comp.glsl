// tessera_sample() at places and directions from a list: what tests compare with the CPU.
#include "sample.glsl"

// Two vectors a point, place and direction; the first is replaced by the colour.
layout(std430, binding = 7) buffer TesseraPoints { vec4 tsr_points[]; };

layout(local_size_x = 64) in;
void main() {
    uint point = gl_WorkGroupID.y * 65536u + gl_GlobalInvocationID.x;
    if (point * 2u + 1u < uint(tsr_points.length()))
        tsr_points[point * 2u] =
            tessera_sample(tsr_points[point * 2u].xyz, tsr_points[point * 2u + 1u].xyz);
}
