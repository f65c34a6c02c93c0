// Which layers a file has. In HLSL, MSL and WGSL one program draws all files: constants, which the
// host sets when it compiles the program, give the numbers of the textures, 0 for layers that do not
// exist, the number of lights, and whether the pass blends. Otherwise macros do, and no program has
// code of other layers.
#ifdef TSR_TRANSLATED
#define TESSERA_TEXTURES 12
layout(constant_id = 1) const int TESSERA_EMISSION = 0;
layout(constant_id = 2) const int TESSERA_SPECULAR = 0;
layout(constant_id = 3) const int TESSERA_ROUGHNESS = 0;
layout(constant_id = 4) const int TESSERA_NORMAL = 0;
layout(constant_id = 5) const int TESSERA_VISIBILITY = 0;
layout(constant_id = 6) const int TESSERA_REFLECTION = 0;
layout(constant_id = 7) const int TESSERA_COVERAGE = 0;
layout(constant_id = 8) const int TESSERA_ENVIRONMENT = 0;
layout(constant_id = 9) const int TESSERA_DIFFERENCE = 0;
layout(constant_id = 10) const int TESSERA_SHARED_DIFFERENCE = 0;
layout(constant_id = 11) const int TESSERA_OPACITY = 0;
layout(constant_id = 12) const int TESSERA_LIGHT_COUNT = 0;
layout(constant_id = 13) const int TESSERA_BLENDED_PASS = 0;
#define TESSERA_LAYER_EMISSION TESSERA_EMISSION
#define TESSERA_LAYER_SPECULAR TESSERA_SPECULAR
#define TESSERA_LAYER_ROUGHNESS TESSERA_ROUGHNESS
#define TESSERA_LAYER_NORMAL TESSERA_NORMAL
#define TESSERA_LAYER_VISIBILITY TESSERA_VISIBILITY
#define TESSERA_LAYER_REFLECTION TESSERA_REFLECTION
#define TESSERA_LAYER_COVERAGE TESSERA_COVERAGE
#define TESSERA_LAYER_ENVIRONMENT TESSERA_ENVIRONMENT
#define TESSERA_LAYER_DIFFERENCE TESSERA_DIFFERENCE
#define TESSERA_LAYER_SHARED_DIFFERENCE TESSERA_SHARED_DIFFERENCE
#define TESSERA_LAYER_OPACITY TESSERA_OPACITY
#define TESSERA_LIGHTS TESSERA_LIGHT_COUNT
#define TSR_ROOM_FOR_LIGHTS 1024
// A function, because Tint cannot translate expressions of constants.
bool tsr_is_set(int constant) {
    return constant > 0;
}
#define TSR_IF(texture_number) tsr_is_set(texture_number)
#define TSR_BLENDS tsr_is_set(TESSERA_BLENDED_PASS)
#else
#define TSR_ROOM_FOR_LIGHTS TESSERA_LIGHTS
#define TSR_IF(texture_number) true
#ifdef TESSERA_BLENDED
#define TSR_BLENDS true
#else
#define TSR_BLENDS false
#endif
#endif
