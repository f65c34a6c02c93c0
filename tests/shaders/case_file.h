// What shader_cases.cpp and layered_case.cpp write for the scripts in this folder.
#pragma once

#include "decoder_glsl/batch/plain_pixels.h"
#include "decoder_glsl/shaders/shader_layout.h"
#include "format/samples.h"
#include "format/surface_mesh.h"
#include "tools/view/mip_source.h"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

namespace tessera {

using Words = std::vector<std::uint32_t>;

[[noreturn]] inline void stop(const Status& status) {
    std::fprintf(stderr, "%s\n", status.message().c_str());
    std::exit(1);
}
inline void must(const Status& status) {
    if (!status)
        stop(status);
}
template <class T> T must(Result<T> result) {
    if (!result)
        stop(result.status());
    return std::move(*result);
}

// Writes arrays, each a line "name words" and its 32-bit words.
class Arrays {
public:
    explicit Arrays(const char* path) : path_(path), file_(path, std::ios::binary) {}
    void add(const char* name, std::span<const std::byte> bytes) {
        file_ << name << ' ' << bytes.size() / 4 << '\n';
        file_.write(reinterpret_cast<const char*>(bytes.data()),
                    static_cast<std::streamsize>(bytes.size()));
    }
    void add(const char* name, const Words& words) { add(name, std::as_bytes(std::span(words))); }
    // Error: io.
    Status finish() {
        return file_.flush() ? Status() : Status(ErrorCode::io, path_ + ": could not be written");
    }

private:
    std::string path_;
    std::ofstream file_;
};

// The header of the sampler's words (shaders/sampler_layout.glsl) with the strides of a texture whose
// angular images lie `angular` pixels apart.
inline Words sampler_header(const TileGrid& grid, AngularMap map, const Extent4& angular) {
    using namespace layout;
    Words words(tsr_sampler_words, 0);
    for (std::size_t axis = 0; axis < 4; ++axis) {
        words[tsr_p_size + axis] = grid.size()[axis];
        words[tsr_p_tiles + axis] = grid.count()[axis];
    }
    words[tsr_p_stride_s] = angular[axis_s];
    words[tsr_p_stride_t] = angular[axis_t];
    words[tsr_p_folds_u] = 1;
    words[tsr_p_angular_map] = static_cast<std::uint32_t>(map);
    return words;
}

// The words for a plain texture of one layer, with its mips beside it.
inline Words plain_words(const TileGrid& grid, const AtlasMips& mips, AngularMap map) {
    using namespace layout;
    const Extent4& size = grid.size();
    Words words = sampler_header(grid, map, size);
    for (const std::size_t axis : {axis_u, axis_v}) {
        words[tsr_p_axis_at + axis] = static_cast<std::uint32_t>(words.size());
        const std::uint32_t stride = size[axis == axis_u ? axis_s : axis_t];
        for (unsigned mip = 0; mip <= mips.count(); ++mip)
            for (std::uint32_t i = 0; i < (mip == 0 ? size[axis] : mips.size(mip)[axis]); ++i)
                words.push_back(((mip == 0 ? 0 : mips.begin(mip)[axis]) + i) * stride);
    }
    words[tsr_p_width] = mips.kept_size()[axis_u] * size[axis_s];
    words[tsr_p_height] = mips.kept_size()[axis_v] * size[axis_t];
    words[tsr_p_mips] = mips.count();
    words[tsr_p_mip_at] = static_cast<std::uint32_t>(words.size());
    const std::size_t table = words.size();
    words.resize(table + (mips.count() + 1) * tsr_mip_words);
    std::array<std::uint32_t, 2> begin{0, 0}; // on the axes
    for (unsigned mip = 0; mip <= mips.count() && mips.count() > 0; ++mip) {
        std::uint32_t* line = words.data() + table + mip * tsr_mip_words;
        line[tsr_mip_u] = begin[0];
        line[tsr_mip_v] = begin[1];
        line[tsr_mip_size] = mips.size(mip)[0] | (mips.size(mip)[1] << 16);
        line[tsr_mip_charts] = static_cast<std::uint32_t>(words.size());
        words.insert(words.end(), mips.charts(mip).begin(), mips.charts(mip).end());
        for (std::size_t a = 0; a < 2; ++a)
            begin[a] += mips.size(mip)[a];
    }
    return words;
}

// All texels of a source in memory.
inline std::vector<std::byte> all_texels(TexelSource& source) {
    const Box4 all = Box4::whole(source.desc().size);
    std::vector<std::byte> texels(source.desc().box_bytes(all));
    must(source.read(all, texels));
    return texels;
}

// The same as pixels of four samples, angular images side by side.
inline std::vector<std::byte> all_pixels(const TextureDesc& desc,
                                         std::span<const std::byte> texels) {
    const Box4 all = Box4::whole(desc.size);
    std::vector<std::byte> pixels(all.texels() * 4 * sample_bytes(desc.type));
    put_pixels(desc, all, texels, desc.size[axis_u] * desc.size[axis_s], pixels);
    return pixels;
}

} // namespace tessera
