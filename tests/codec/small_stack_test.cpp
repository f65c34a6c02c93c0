// Encoding and decoding on a thread with a small stack, as hosts and other systems give to theirs.
#include "tests/support/memory_texture.h"
#include "tests/support/round_trips.h"

#include <functional>
#include <gtest/gtest.h>
#include <pthread.h>
#include <string>

namespace tessera::test {
namespace {

using namespace tessera::test::round_trips;

using Kind = RateTarget::Kind;

constexpr std::size_t small_stack = 128 * 1024; // as codec/tessera.h promises

// Runs `work` on a thread with a stack of `bytes` and waits for it. An overflow ends the program.
void run_on_stack(std::size_t bytes, const std::function<void()>& work) {
    pthread_attr_t attributes;
    ASSERT_EQ(pthread_attr_init(&attributes), 0);
    ASSERT_EQ(pthread_attr_setstacksize(&attributes, bytes), 0);
    const auto enter = [](void* argument) -> void* {
        (*static_cast<const std::function<void()>*>(argument))();
        return nullptr;
    };
    pthread_t thread;
    void* const argument = const_cast<std::function<void()>*>(&work);
    ASSERT_EQ(pthread_create(&thread, &attributes, enter, argument), 0);
    pthread_attr_destroy(&attributes);
    pthread_join(thread, nullptr);
}

void round_trip(const TextureDesc& desc, const EncodeOptions& options, double least_psnr) {
    MemoryTexture texture = named_texture(desc, "smooth");
    const Encoded encoded = encode(texture, options);
    const Bytes decoded = decode_all(encoded.file, desc);
    EXPECT_GE(difference(texture.texels, decoded, desc.type).psnr, least_psnr);
}

TEST(SmallStack, HoldsEncodingAndDecodingAtAllEfforts) {
#if !defined(__OPTIMIZE__) || defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "frames are larger without optimisation and under sanitizers";
#endif
    for (int effort = 0; effort <= 4; ++effort)
        run_on_stack(small_stack, [effort] {
            // Threads of the encoder have stacks of their own, so it uses this one only.
            const auto options = [effort](const RateTarget& rate) {
                EncodeOptions chosen = options_for(rate, effort);
                chosen.threads = 1;
                return chosen;
            };
            const TextureDesc views = describe({24, 20, 5, 3}, SampleType::unorm8, 3);
            round_trip(views, options({Kind::psnr, 38}), 38);
            round_trip(views, options({Kind::max_error, 0}), 999);
            EncodeOptions layered = options({Kind::quality, 60});
            layered.layers = true;
            layered.tile_extent = {8, 8, 4, 4};
            round_trip(views, layered, 30);
            round_trip(describe({40, 33, 1, 1}, SampleType::unorm8, 3), options({Kind::bytes, 900}),
                       20);
            round_trip(describe({9, 8, 3, 4}, SampleType::half16, 4), options({Kind::quality, 60}),
                       30);
        });
}

} // namespace
} // namespace tessera::test
