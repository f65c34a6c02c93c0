// What this machine and this compiler make of the same textures and files, one line each, to compare with what
// others do (run.sh): the golden files' texels as in their manifest, what is shown of damaged copies of them, then
// encoded files and their texels.
//   same_bytes GOLDEN_FOLDER [decode]   decode: encodes nothing; short enough for valgrind
#include "codec/decoder.h"
#include "codec/encoder.h"
#include "tests/support/memory_texture.h"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace tessera {
namespace {

using test::Bytes;
using test::MemoryTexture;
using Kind = RateTarget::Kind;

std::uint64_t fnv1a_64(std::span<const std::byte> bytes) {
    std::uint64_t hash = 0xCBF29CE484222325;
    for (const std::byte b : bytes)
        hash = (hash ^ std::to_integer<std::uint64_t>(b)) * 0x100000001B3;
    return hash;
}

template <class T> T checked(Result<T> result, const std::string& of) {
    if (result)
        return std::move(*result);
    std::fprintf(stderr, "%s: %s\n", of.c_str(), result.status().message().c_str());
    std::exit(1);
}

std::uint64_t hash_of_texels(const Decoder& decoder, const std::string& of) {
    const Box4 all = Box4::whole(decoder.desc().size);
    Bytes texels(decoder.desc().box_bytes(all));
    if (const Status status = decoder.decode_box(all, texels); !status) {
        std::fprintf(stderr, "%s: %s\n", of.c_str(), status.message().c_str());
        std::exit(1);
    }
    return fnv1a_64(texels);
}

std::vector<std::string> golden_names(const std::string& folder) {
    std::ifstream manifest(folder + "/manifest.txt");
    std::vector<std::string> names;
    for (std::string name, expected; manifest >> name >> expected;)
        names.push_back(name);
    return names;
}

void decode_golden(const std::string& folder) {
    for (const std::string& name : golden_names(folder)) {
        const Decoder decoder = checked(Decoder::open_file(folder + "/" + name), name);
        std::printf("%s %llx\n", name.c_str(),
                    static_cast<unsigned long long>(hash_of_texels(decoder, name)));
    }
}

// A bit of it flipped at a time: what the tiles' own bytes let through is decoded, the rest is filled.
void decode_damaged(const std::string& folder, const std::string& name, int copies) {
    std::ifstream in(folder + "/" + name, std::ios::binary);
    const std::string text((std::istreambuf_iterator<char>(in)), {});
    const auto bytes = std::as_bytes(std::span(text));
    test::Random random(static_cast<std::uint32_t>(bytes.size()));
    std::uint64_t hash = 0, filled = 0;
    int refused = 0;
    for (int i = 0; i < 2 * copies; ++i) {
        Bytes file(bytes.begin(), bytes.end());
        file[random() % file.size()] ^= static_cast<std::byte>(1u << random() % 8);
        const Result<Decoder> decoder = Decoder::open(wrap_memory(file), DecodeOptions{true, true});
        if (!decoder || texel_count(decoder->desc().size) > 1 << 20) {
            ++refused;
            continue;
        }
        const Box4 all = Box4::whole(decoder->desc().size);
        Bytes texels(decoder->desc().box_bytes(all));
        ReadOptions options;
        options.integrity = i % 2 == 0 ? Integrity::tile : Integrity::page;
        if (decoder->decode_box(all, texels, options))
            hash = hash * 31 + fnv1a_64(texels);
        else
            ++refused;
        filled += decoder->fill_report().texels;
    }
    std::printf("%s damaged: %llx, %d refused, %llu texels filled\n", name.c_str(),
                static_cast<unsigned long long>(hash), refused,
                static_cast<unsigned long long>(filled));
}

// Without functions of the C library, whose last bits differ: edges, slopes and some noise.
double sample(int u, int v, int s, int t, int c, test::Random& random) {
    const int edge = (u * 3 + v * 2 + s - t) / 8 % 3;
    const double slope = (u * (c + 2) + v * 3 + s * 5 + t * 4) % 64 / 64.0;
    return 0.25 * edge + 0.4 * slope * slope + 0.05 * random.unit();
}

void encode_again(const std::string& name, const TextureDesc& desc, RateTarget rate, int effort) {
    test::Random random(11);
    const double gain = desc.type == SampleType::half16 ? 37 : 1;
    MemoryTexture texture(desc, [&](int u, int v, int s, int t, int c) {
        return gain * sample(u, v, s, t, c, random);
    });
    EncodeOptions options;
    options.rate = rate;
    options.effort = effort;
    options.layers = effort == usual_effort;
    Bytes file;
    const EncodeReport report = checked(encode_memory(texture, file, options), name);
    const Decoder decoder = checked(Decoder::open(wrap_memory(file)), name);
    std::printf("%s %zu %llx %llx psnr %.9g\n", name.c_str(), file.size(),
                static_cast<unsigned long long>(fnv1a_64(file)),
                static_cast<unsigned long long>(hash_of_texels(decoder, name)), report.psnr);
}

} // namespace
} // namespace tessera

int main(int argc, char** argv) {
    using namespace tessera;
    const bool only_decode = argc == 3 && std::string(argv[2]) == "decode";
    if (argc != 2 && !only_decode)
        return 2;
    std::setvbuf(stdout, nullptr, _IOLBF, 0); // a crash keeps what was before
    decode_golden(argv[1]);
    for (const std::string& name : golden_names(argv[1]))
        decode_damaged(argv[1], name, 8);
    if (only_decode)
        return 0;
    const SampleType unorm8 = SampleType::unorm8, half16 = SampleType::half16;
    for (const int effort : {0, 1, 3})
        encode_again("rgb8_effort" + std::to_string(effort), {{20, 12, 6, 5}, unorm8, 3},
                     {Kind::quality, 60}, effort);
    encode_again("rgb_half", {{12, 9, 5, 4}, half16, 3}, {Kind::quality, 70}, 2);
    encode_again("rgb_half_lossless", {{8, 9, 3, 4}, half16, 3}, {Kind::max_error, 0}, 1);
    encode_again("grey8_bounded", {{16, 9, 4, 4}, unorm8, 1}, {Kind::max_error, 2}, 1);
    encode_again("rgba8_rate", {{16, 12, 4, 4}, unorm8, 4}, {Kind::bpt, 2}, 1);
}
