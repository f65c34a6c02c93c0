// Words that GLSL and C++ define differently. The decoder's files compile as both, because tests
// build and fuzz them as C++ with GLM: tests/support/shader_machine.cpp gives these words their C++
// meaning.
#ifndef TSR_DIALECT
#define TSR_DIALECT
#ifndef __cplusplus
#ifdef TSR_TRANSLATED
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_KHR_memory_scope_semantics : require
// HLSL, MSL and WGSL have textures and samplers apart.
#define TSR_TEXTURE_TYPE texture2DArray
#define TSR_WITH_SAMPLER(name) sampler2DArray(name, tsr_linear_sampler)
#else
#define TSR_TEXTURE_TYPE sampler2DArray
#define TSR_WITH_SAMPLER(name) name
#endif
#define TSR_INOUT(type) inout type
// The first statement of every loop body, where C++ counts rounds.
#define TSR_LOOP
// Vulkan numbers all kinds of bindings together, so each kind gets a descriptor set of its own.
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
