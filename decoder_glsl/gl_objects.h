// Everything that owns an OpenGL object.
#pragma once

#include "decoder_glsl/gl_buffer.h"
#include "decoder_glsl/gl_program.h"
#include "decoder_glsl/gl_sync.h"
#include "decoder_glsl/gl_texture.h"
