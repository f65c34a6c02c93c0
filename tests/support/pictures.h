// Helpers of the tests that read pictures.
#pragma once

#include "corpus/picture_file.h"

#include <gtest/gtest.h>

namespace tessera::corpus::support {

// The beginnings of a file, at 64 lengths, are refused or hold the same picture.
template <class Read> void expect_no_beginning(const std::string& file, const Read& read) {
    const auto whole = read(file);
    ASSERT_TRUE(whole.ok()) << whole.status().message();
    for (std::size_t i = 0; i < 64; ++i) {
        const std::size_t length = i * file.size() / 64;
        const auto part = read(file.substr(0, length));
        if (part.ok())
            EXPECT_TRUE(part->texels == whole->texels) << length << " of " << file.size();
        else
            EXPECT_EQ(part.status().code(), ErrorCode::invalid_file) << part.status().message();
    }
    const auto all_but_one = read(file.substr(0, file.size() - 1));
    EXPECT_TRUE(!all_but_one.ok() || all_but_one->texels == whole->texels);
}

inline Result<LightImage> light_of(const std::string& file) {
    const auto source = wrap_memory(std::as_bytes(std::span(file)));
    return read_light_image(*source);
}

} // namespace tessera::corpus::support
