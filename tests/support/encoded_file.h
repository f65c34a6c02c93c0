// Encodes a texture into memory, and reads the coding parameters (section CODE) of a file.
#pragma once

#include "codec/encoder.h"
#include "format/container/file_coding.h"
#include "tests/support/memory_texture.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

namespace tessera::test {

struct EncodedFile {
    EncodeReport report;
    Bytes file;
    CodingParameters parameters;
};

// Options: EncodeOptions or SwitchedOptions (tool_words.h).
template <class Options> EncodedFile encode_file_of(MemoryTexture& source, const Options& options) {
    EncodedFile encoded;
    const auto report = encode_memory(source, encoded.file, options);
    EXPECT_TRUE(report.ok()) << report.status().message();
    if (!report.ok())
        return encoded;
    encoded.report = *report;
    const auto bytes = wrap_memory(encoded.file);
    const auto reader = ContainerReader::open(*bytes);
    EXPECT_TRUE(reader.ok());
    const auto coding = coding_of(*reader);
    EXPECT_TRUE(coding.ok());
    encoded.parameters = *coding;
    return encoded;
}

} // namespace tessera::test
