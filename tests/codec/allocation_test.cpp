// Each allocation fails in turn. The library must return an error code and leak nothing.
#include "codec/tessera.h"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <gtest/gtest.h>
#include <new>
#include <vector>

namespace {

std::atomic<long> allocations_left{-1}; // before the one that fails; negative: none fails
std::atomic<long> alive{0};

void* allocate(std::size_t size) {
    if (allocations_left >= 0 && allocations_left-- == 0)
        throw std::bad_alloc();
    void* memory = std::malloc(size > 0 ? size : 1);
    if (memory == nullptr)
        throw std::bad_alloc();
    ++alive;
    return memory;
}

void release(void* memory) noexcept {
    if (memory != nullptr)
        --alive;
    std::free(memory);
}

} // namespace

// These replace the operators of the whole test program. In other tests no allocation fails.
void* operator new(std::size_t size) {
    return allocate(size);
}
void* operator new[](std::size_t size) {
    return allocate(size);
}
// The address sanitizer replaces the nothrow operators, which must match our delete.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
    try {
        return allocate(size);
    } catch (const std::bad_alloc&) {
        return nullptr;
    }
}
void* operator new[](std::size_t size, const std::nothrow_t& without_throwing) noexcept {
    return operator new(size, without_throwing);
}
void operator delete(void* memory) noexcept {
    release(memory);
}
void operator delete[](void* memory) noexcept {
    release(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    release(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
    release(memory);
}

namespace {

constexpr std::uint32_t whole[4] = {6, 5, 3, 2}, origin[4] = {0, 0, 0, 0};
constexpr std::size_t texel_bytes = std::size_t{6} * 5 * 3 * 2 * 3;

const std::vector<unsigned char>& texels() {
    static const std::vector<unsigned char> all = [] {
        std::vector<unsigned char> made(texel_bytes);
        for (std::size_t i = 0; i < made.size(); ++i)
            made[i] = static_cast<unsigned char>(i * 37 % 200);
        return made;
    }();
    return all;
}

int encode(void** file, size_t* bytes) {
    tessera_texel_source source;
    tessera_texel_source_init(&source);
    std::copy_n(whole, 4, source.texture.size);
    source.texture.type = TESSERA_UNORM8;
    source.texture.channels = 3;
    source.texels = texels().data();
    source.texel_bytes = texel_bytes;
    tessera_encode_options options;
    tessera_encode_options_init(&options);
    options.effort = 0;
    options.threads = 1;
    return tessera_encode_to_memory(&source, file, bytes, &options, nullptr);
}

int decode(const void* file, std::size_t bytes) {
    tessera_open_options open;
    tessera_open_options_init(&open);
    tessera_decoder* decoder = nullptr;
    int error = tessera_open_memory(file, bytes, &open, &decoder);
    if (error != TESSERA_OK)
        return error;
    tessera_decode_options options;
    tessera_decode_options_init(&options);
    options.threads = 1;
    unsigned char out[texel_bytes];
    error = tessera_decode_box(decoder, origin, whole, out, sizeof out, &options);
    tessera_close(decoder);
    return error;
}

// Calls work() with the n-th allocation failing, for n = 0, 1, ... until no allocation fails.
// Returns how often an allocation failed.
template <class Work> int fail_everywhere(const Work& work) {
    int failures = 0;
    for (long n = 0;; ++n) {
        allocations_left = n;
        const int error = work();
        const bool reached = allocations_left < 0;
        allocations_left = -1;
        if (error == TESSERA_OK && !reached)
            return failures;
        failures += error != TESSERA_OK;
        // Some failures are recoverable, because the library can do with less memory.
        EXPECT_TRUE(error == TESSERA_OK || error == TESSERA_RUNTIME)
            << "allocation " << n << ": " << error << " " << tessera_last_error();
        if (testing::Test::HasFailure())
            return failures;
    }
}

TEST(Allocation, OpeningAndDecodingSurviveEachFailure) {
    void* file = nullptr;
    size_t bytes = 0;
    ASSERT_EQ(encode(&file, &bytes), TESSERA_OK) << tessera_last_error();
    ASSERT_EQ(decode(file, bytes), TESSERA_OK);
    const long before = alive;
    const int failures = fail_everywhere([&] { return decode(file, bytes); });
    EXPECT_GT(failures, 20);
    RecordProperty("failures", failures); // shown by --gtest_output=xml
    EXPECT_LE(alive, before + 2);         // the thread's last error message
    tessera_free(file);
}

TEST(Allocation, EncodingSurvivesEachFailure) {
    void* file = nullptr;
    size_t bytes = 0;
    ASSERT_EQ(encode(&file, &bytes), TESSERA_OK);
    tessera_free(file);
    const long before = alive;
    const int failures = fail_everywhere([&] {
        const int error = encode(&file, &bytes);
        tessera_free(file);
        return error;
    });
    EXPECT_GT(failures, 200);
    RecordProperty("failures", failures);
    EXPECT_LE(alive, before + 2);
}

} // namespace
