// Everything that owns an OpenGL object.
#pragma once

#include "decoder_glsl/gl/gl_buffer.h"
#include "decoder_glsl/gl/gl_program.h"
#include "decoder_glsl/gl/gl_sync.h"
#include "decoder_glsl/gl/gl_texture.h"
