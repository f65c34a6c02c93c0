// A C++ program that uses Tessera: encodes a gradient into a file, opens it, reads a box and
// compares.
//   consumer_cpp FILE.tess   writes FILE.tess, then tries to open a file that does not exist
#include <tessera/codec/decoder.h>
#include <tessera/codec/encoder.h>
#include <tessera/format/texture.h>

#include <cstdio>
#include <cstdlib>
#include <vector>

using namespace tessera;

namespace {

const TextureDesc desc{{32, 16, 4, 4}, SampleType::unorm8, 1};

int gradient(std::uint32_t u, std::uint32_t v, std::uint32_t s, std::uint32_t t) {
    return static_cast<int>(4 * u + 4 * v + 2 * s + 2 * t);
}

// Calls visit(value) with the expected value of each texel of a box, in box order.
template <class Visit> void for_each_texel(const Box4& box, Visit visit) {
    for (std::uint32_t v = box.begin[axis_v]; v < box.end[axis_v]; ++v)
        for (std::uint32_t u = box.begin[axis_u]; u < box.end[axis_u]; ++u)
            for (std::uint32_t t = box.begin[axis_t]; t < box.end[axis_t]; ++t)
                for (std::uint32_t s = box.begin[axis_s]; s < box.end[axis_s]; ++s)
                    visit(gradient(u, v, s, t));
}

Status encode(const std::string& path) {
    std::vector<std::byte> texels;
    for_each_texel(Box4::whole(desc.size),
                   [&](int value) { texels.push_back(static_cast<std::byte>(value)); });
    MemorySource source(desc, texels);
    EncodeOptions options;
    options.rate = {RateTarget::Kind::max_error, 1};
    TESSERA_TRY_ASSIGN(const EncodeReport report, encode_file(source, path, options));
    std::printf("%zu texels in %llu bytes, largest error %g\n", texels.size(),
                static_cast<unsigned long long>(report.file_bytes), report.max_error);
    return {};
}

Status compare(const std::string& path) {
    TESSERA_TRY_ASSIGN(const Decoder decoder, Decoder::open_file(path));
    const Box4 box{{7, 3, 1, 0}, {29, 11, 3, 4}};
    std::vector<std::byte> texels(decoder.desc().box_bytes(box));
    TESSERA_TRY(decoder.decode_box(box, texels));
    std::size_t i = 0, wrong = 0;
    for_each_texel(
        box, [&](int value) { wrong += std::abs(std::to_integer<int>(texels[i++]) - value) > 1; });
    if (wrong > 0)
        return {ErrorCode::difference, std::to_string(wrong) + " texels of the box are wrong"};
    return {};
}

} // namespace

int main(int argc, char** argv) {
    const std::string path = argc > 1 ? argv[1] : "consumer_cpp.tess";
    Status status = encode(path);
    if (status)
        status = compare(path);
    if (!status) {
        std::fprintf(stderr, "error: %s\n", status.message().c_str());
        return static_cast<int>(status.code());
    }
    // A missing file is reported as a Status.
    const Result<Decoder> none = Decoder::open_file(path + ".none");
    return none.ok() || none.status().code() != ErrorCode::io ? 1 : 0;
}
