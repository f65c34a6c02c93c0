// Codecs that take the texture as one array: zfp in four dimensions, OpenEXR's DWAA, raw texels.
#include "format/samples.h"
#include "tools/lab/rd/bt709.h"
#include "tools/lab/rd/exr_rival.h"
#include "tools/lab/rd/rivals.h"
#include "tools/support/output_folders.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace tessera {
namespace {

// --- zfp: planes of floats, each a 4D array with s fastest ---------------------------------------

bool has_yuv(const TextureDesc& desc) {
    return sample_bytes(desc.type) == 1 && desc.channels == 3;
}

// Converts 8-bit RGB to Y Cb Cr of BT.709. Half floats become the 16-bit codes by which errors are
// measured, because these grow with the logarithm of the value. Other samples stay as they are.
std::vector<std::vector<float>> planes_of(const RdTexture& texture) {
    const unsigned channels = texture.desc.channels;
    std::vector<std::vector<float>> planes(channels, std::vector<float>(texture.texel_count()));
    const SampleType type = texture.desc.type;
    const std::byte* from = texture.texels.data();
    for (std::size_t i = 0; i < texture.texel_count(); ++i)
        for (unsigned c = 0; c < channels; ++c, from += sample_bytes(type))
            planes[c][i] = static_cast<float>(sample_code(load_sample(from, type), type));
    for (std::size_t i = 0; has_yuv(texture.desc) && i < texture.texel_count(); ++i) {
        const auto c = to_bt709(planes[0][i], planes[1][i], planes[2][i]);
        planes[0][i] = c.y;
        planes[1][i] = c.cb;
        planes[2][i] = c.cr;
    }
    return planes;
}

std::vector<std::byte> texels_of(const TextureDesc& desc, std::vector<std::vector<float>> planes) {
    const std::size_t count = planes[0].size();
    for (std::size_t i = 0; has_yuv(desc) && i < count; ++i) {
        const auto c = from_bt709(planes[0][i], planes[1][i], planes[2][i]);
        planes[0][i] = c.r;
        planes[1][i] = c.g;
        planes[2][i] = c.b;
    }
    std::vector<std::byte> texels(count * desc.texel_bytes());
    std::byte* to = texels.data();
    for (std::size_t i = 0; i < count; ++i)
        for (unsigned c = 0; c < desc.channels; ++c, to += sample_bytes(desc.type)) {
            const long value = std::clamp(std::lround(planes[c][i]), -65536l, 65536l);
            store_sample(to, code_sample(static_cast<std::int32_t>(value), desc.type), desc.type);
        }
    return texels;
}

// Cb and Cr get half the rate, or twice the tolerance.
std::vector<std::string> zfp_mode(const std::string& setting, const TextureDesc& desc,
                                  std::size_t plane) {
    const bool colour = has_yuv(desc) && plane > 0;
    double value = std::stod(value_of(setting));
    if (setting.rfind("rate", 0) == 0)
        return {"-r", std::to_string(colour ? value / 2 : value)};
    if (traits_of(desc.type).is_float)
        value *= 128; // the largest code of halves is about 128 times 255
    return {"-a", std::to_string(colour ? value * 2 : value)};
}

std::vector<std::string> zfp_shape(const Extent4& n) {
    return {"-f",
            "-4",
            std::to_string(n[axis_s]),
            std::to_string(n[axis_t]),
            std::to_string(n[axis_u]),
            std::to_string(n[axis_v])};
}

Result<Coded> code_zfp(const CodingJob& job, const std::string& setting) {
    const TextureDesc& desc = job.texture.desc;
    auto planes = planes_of(job.texture);
    Coded coded;
    for (std::size_t p = 0; p < planes.size(); ++p) {
        const std::string number = std::to_string(p), in = job.folder.at("in" + number + ".f32"),
                          packed = job.folder.at("plane" + number + ".zfp"),
                          out = job.folder.at("out" + number + ".f32");
        TESSERA_TRY(write_bytes(in, std::as_bytes(std::span(planes[p]))));
        std::vector<std::string> shape_and_mode = zfp_shape(desc.size);
        for (const std::string& word : zfp_mode(setting, desc, p))
            shape_and_mode.push_back(word);
        std::vector<std::string> encode = {"zfp", "-q", "-i", in, "-z", packed};
        encode.insert(encode.end(), shape_and_mode.begin(), shape_and_mode.end());
        TESSERA_TRY_ASSIGN(const auto encoded,
                           seconds_of_tool(encode, job.timeout, ticker(job, "encoding")));
        TESSERA_TRY_ASSIGN(const auto bytes, bytes_of_file(packed));
        coded.bytes += bytes;
        coded.encode_seconds += encoded;
        std::vector<std::string> decode = {"zfp", "-q", "-z", packed, "-o", out};
        decode.insert(decode.end(), shape_and_mode.begin(), shape_and_mode.end());
        TESSERA_TRY_ASSIGN(const auto decoded, best_time([&] {
                               return seconds_of_tool(decode, job.timeout, ticker(job, "decoding"));
                           }));
        coded.decode_seconds += decoded;
        TESSERA_TRY_ASSIGN(const auto back, bytes_in_file(out));
        if (back.size() != planes[p].size() * sizeof(float))
            return Status(ErrorCode::runtime, "zfp: decoded an array of a different size");
        std::memcpy(planes[p].data(), back.data(), back.size());
    }
    coded.texels = texels_of(desc, std::move(planes));
    if (setting.rfind("rate", 0) == 0) { // blocks of 4x4x4x4 texels at known positions
        const Extent4& n = desc.size;
        const auto blocks = [&](Axis axis) { return std::ceil(n[axis] / 4.0); };
        coded.texel_bytes = static_cast<double>(coded.bytes) /
                            (blocks(axis_u) * blocks(axis_v) * blocks(axis_s) * blocks(axis_t));
        coded.view_bytes = *coded.texel_bytes * blocks(axis_u) * blocks(axis_v);
    } else { // blocks of variable length without an index
        coded.texel_bytes = coded.view_bytes = static_cast<double>(coded.bytes);
    }
    return coded;
}

// --- raw -----------------------------------------------------------------------------------------

Result<Coded> keep_raw(const CodingJob& job, const std::string&) {
    Coded coded;
    coded.texels = job.texture.texels;
    coded.bytes = coded.texels.size();
    const Extent4& n = job.texture.desc.size;
    const auto texel = static_cast<double>(job.texture.desc.texel_bytes());
    coded.texel_bytes = texel;
    coded.view_bytes = texel * n[axis_u] * n[axis_v];
    return coded;
}

Rival array_rival(const char* id, const char* layout, std::vector<std::string> tools,
                  const char* package, std::vector<std::string> settings) {
    Rival rival;
    rival.id = id;
    rival.layout = layout;
    rival.tools = std::move(tools);
    rival.package = package;
    rival.settings = std::move(settings);
    rival.run = code_zfp;
    return rival;
}

} // namespace

std::vector<Rival> array_rivals() {
    std::vector<Rival> all;
    const auto add = [&all](Rival rival) -> Rival& {
        all.push_back(std::move(rival));
        return all.back();
    };
    Rival& rate = add(array_rival("zfp:rate", "fixed rate, 4D blocks, Cb and Cr at half the rate",
                                  {"zfp"}, "zfp", {"rate 1", "rate 2", "rate 3", "rate 4"}));
    rate.coarser = {"rate 0.5"};
    rate.finer = {"rate 6", "rate 8"};
    Rival& accuracy = add(array_rival(
        "zfp:accuracy", "fixed accuracy, 4D blocks, Cb and Cr at twice the tolerance", {"zfp"},
        "zfp", {"tolerance 256", "tolerance 128", "tolerance 64", "tolerance 32"}));
    accuracy.coarser = {"tolerance 512", "tolerance 1024"};
    accuracy.finer = {"tolerance 16", "tolerance 8"};
    Rival& exr = add(array_rival("exr:dwaa", "OpenEXR's DWAA, mosaic of views, half floats", {}, "",
                                 {"level 4000", "level 2000", "level 1000", "level 500"}));
    exr.coarser = {"level 8000", "level 16000"};
    exr.finer = {"level 200", "level 100"};
    exr.run = code_exr_mosaic;
    Rival& raw = add(array_rival("raw", "uncompressed texels", {}, "", {"as it is"}));
    raw.run = keep_raw;
    raw.in_plot = false;
    raw.quick = true;
    return all;
}

} // namespace tessera
