// Fixture for tests that need a GPU context. TESSERA_NO_GPU=1 skips them.
#pragma once

#include "decoder_glsl/gl_context.h"

#include <cstdlib>
#include <gtest/gtest.h>
#include <optional>
#include <string>

namespace tessera::test {

inline bool no_gpu_asked() {
    const char* value = std::getenv("TESSERA_NO_GPU");
    return value != nullptr && std::string(value) == "1";
}

class GpuTest : public ::testing::Test {
protected:
    void SetUp() override {
        if (no_gpu_asked())
            GTEST_SKIP() << "TESSERA_NO_GPU=1";
        auto context = HeadlessContext::create();
        ASSERT_TRUE(context) << context.status().message();
        context_.emplace(std::move(*context));
    }
    std::optional<HeadlessContext> context_;
};

} // namespace tessera::test
