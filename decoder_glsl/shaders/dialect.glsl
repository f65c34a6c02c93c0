// The words in which GLSL and C++ differ. Every file here that is not a *.comp.glsl main compiles in
// both: the tests build the integer core as C++ through GLM and fuzz it (tests/support/shader_machine.h
// gives the C++ meaning of these words).
#ifndef TSR_DIALECT
#define TSR_DIALECT
#ifndef __cplusplus
#define TSR_INOUT(type) inout type
// Stands first in the body of every loop; C++ counts there.
#define TSR_LOOP
// Vulkan numbers all kinds of bindings together; each kind has a descriptor set there.
#ifdef TSR_VULKAN
#define TSR_IMAGE(number) set = 1, binding = number
#define TSR_TEXTURE(number) set = 2, binding = number
#define TSR_UNIFORMS(number) set = 3, binding = number
#else
#define TSR_IMAGE(number) binding = number
#define TSR_TEXTURE(number) binding = number
#define TSR_UNIFORMS(number) binding = number
#endif
#endif
#endif
