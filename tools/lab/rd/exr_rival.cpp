#include "tools/lab/rd/exr_rival.h"

#include "corpus/exr_samples.h"
#include "corpus/exr_stream.h"
#include "format/work.h"
#include "tools/lab/rd/rivals.h"
#include "tools/support/parse.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfThreading.h>

#include <chrono>
#include <cmath>
#include <cstring>

namespace tessera {
namespace {

constexpr int chunk_lines = 32; // lines of pixels in a DWAA chunk

struct Mosaic {
    int width = 0, height = 0, channels = 0;
    std::vector<std::uint16_t> halves; // rows from the top, interleaved channels
};

Mosaic empty_mosaic(const TextureDesc& desc) {
    Mosaic m;
    m.width = static_cast<int>(desc.size[axis_u] * desc.size[axis_s]);
    m.height = static_cast<int>(desc.size[axis_v] * desc.size[axis_t]);
    m.channels = desc.channels;
    m.halves.resize(texel_count(desc.size) * desc.channels);
    return m;
}

// Calls body(index of the texel, index of its first half in the mosaic) for all texels.
template <class Body> void for_all_texels(const TextureDesc& desc, const Body& body) {
    const Extent4& n = desc.size;
    std::size_t index = 0;
    for (std::size_t v = 0; v < n[axis_v]; ++v)
        for (std::size_t u = 0; u < n[axis_u]; ++u)
            for (std::size_t t = 0; t < n[axis_t]; ++t)
                for (std::size_t s = 0; s < n[axis_s]; ++s) {
                    const std::size_t y = t * n[axis_v] + v, x = s * n[axis_u] + u;
                    body(index++, (y * n[axis_u] * n[axis_s] + x) * desc.channels);
                }
}

Imf::FrameBuffer frame_of(Mosaic& m) {
    Imf::FrameBuffer frame;
    const std::size_t pixel = static_cast<std::size_t>(m.channels) * 2;
    for (int c = 0; c < m.channels; ++c)
        frame.insert(channel_name(m.channels, c),
                     Imf::Slice::Make(Imf::HALF, m.halves.data() + c, Imath::V2i(0, 0), m.width,
                                      m.height, pixel, pixel * static_cast<std::size_t>(m.width)));
    return frame;
}

Status write_mosaic(const std::string& path, Mosaic& m, float level) {
    TESSERA_TRY_ASSIGN(auto file, OutputFile::create(path));
    ExrOutput stream(file);
    TESSERA_TRY(guard_exr(path, [&] {
        Imf::Header header(m.width, m.height);
        header.compression() = Imf::DWAA_COMPRESSION;
        header.dwaCompressionLevel() = level;
        for (int c = 0; c < m.channels; ++c)
            header.channels().insert(channel_name(m.channels, c), Imf::Channel(Imf::HALF));
        Imf::OutputFile picture(stream, header, Imf::globalThreadCount());
        picture.setFrameBuffer(frame_of(m));
        picture.writePixels(m.height);
        return Status();
    }));
    TESSERA_TRY(stream.status());
    return file.commit();
}

Status read_mosaic(const std::string& path, Mosaic& m) {
    TESSERA_TRY_ASSIGN(const auto bytes, open_file(path));
    return guard_exr(path, [&] {
        ExrInput stream(*bytes);
        Imf::InputFile picture(stream, Imf::globalThreadCount());
        picture.setFrameBuffer(frame_of(m));
        picture.readPixels(0, m.height - 1);
        return Status();
    });
}

template <class Work> Result<double> timed(const Work& work) {
    const auto begun = std::chrono::steady_clock::now();
    TESSERA_TRY(work());
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
}

} // namespace

Result<Coded> code_exr_mosaic(const CodingJob& job, const std::string& setting) {
    const RdTexture& texture = job.texture;
    const TextureDesc& desc = texture.desc;
    const std::string path = job.folder.at("mosaic.exr");
    Mosaic mosaic = empty_mosaic(desc);
    const std::size_t channels = desc.channels, texel = desc.texel_bytes();
    for_all_texels(desc, [&](std::size_t index, std::size_t place) {
        samples_to_halves(desc.type, texture.texels.data() + index * texel,
                          {mosaic.halves.data() + place, channels});
    });
    Imf::setGlobalThreadCount(static_cast<int>(thread_count(job.threads)));
    Coded coded;
    TESSERA_TRY_ASSIGN(const auto encoded, timed([&] {
                           return write_mosaic(path, mosaic,
                                               std::stof(setting.substr(setting.find(' '))));
                       }));
    TESSERA_TRY_ASSIGN(const auto decoded,
                       best_time([&] { return timed([&] { return read_mosaic(path, mosaic); }); }));
    TESSERA_TRY_ASSIGN(coded.bytes, bytes_of_file(path));
    coded.encode_seconds = encoded;
    coded.decode_seconds = decoded;
    coded.texels.resize(texture.texels.size());
    for_all_texels(desc, [&](std::size_t index, std::size_t place) {
        halves_to_samples(desc.type, {mosaic.halves.data() + place, channels},
                          coded.texels.data() + index * texel);
    });
    const double chunk =
        static_cast<double>(coded.bytes) / std::ceil(mosaic.height / double{chunk_lines});
    coded.texel_bytes = chunk;
    coded.view_bytes = chunk * (static_cast<double>(desc.size[axis_v] - 1) / chunk_lines + 1);
    return coded;
}

} // namespace tessera
