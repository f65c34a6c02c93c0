// Tests how line numbers in a driver's log are mapped from expanded sources to files.
#include "decoder_glsl/shader_source.h"
#include "decoder_glsl/shaders/shader_files.h"
#include "decoder_glsl/shaders/shader_log.h"

#include <gtest/gtest.h>

namespace tessera::test {
namespace {

TEST(ShaderLog, LineNumbersAreMappedThroughIncludes) {
    const ShaderFile files[] = {{"a.glsl", "one\n#include \"b.glsl\"\nthree\n"},
                                {"b.glsl", "first\nsecond\n"}};
    const auto source = shader_source(files, "a.glsl", ShaderDialect::gl450);
    ASSERT_TRUE(source);
    EXPECT_EQ(explain_shader_log("2:2(7): error: bad", *source),
              "2:2(7): error: bad\n    b.glsl:2 | second\n");
    EXPECT_EQ(explain_shader_log("1(3) : error C0000: bad\n\n", *source),
              "1(3) : error C0000: bad\n    a.glsl:3 | three\n");
    EXPECT_EQ(explain_shader_log("ERROR: 2:1: 'first' : bad\nERROR: 1 error\n", *source),
              "ERROR: 2:1: 'first' : bad\n    b.glsl:1 | first\nERROR: 1 error\n");
    EXPECT_EQ(explain_shader_log("0:2: head\n9:9: nowhere\nno place at all\n", *source),
              "0:2: head\n    2 | #define TSR_GL450 1\n9:9: nowhere\nno place at all\n");
    EXPECT_EQ(explain_shader_log("0:2(1): error", "x\ny\n"), "0:2(1): error\n    2 | y\n");
    EXPECT_EQ(explain_shader_log("", ""), "");
}

} // namespace
} // namespace tessera::test
