#include "tools/lab/rd/rd_texture.h"

#include "corpus/bake.h"
#include "format/output_file.h"
#include "format/texture.h"
#include "format/work.h"
#include "tools/scenes/scene_name.h"
#include "tools/support/checksum.h"
#include "tools/support/interrupt.h"
#include "tools/support/parse.h"
#include "tools/support/url.h"
#include "tools/texture_io/texture_io.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <unordered_map>

namespace tessera {
namespace {

// The box of --quick takes about a minute and satisfies video encoders, which need 64 pixels per
// side.
constexpr Extent4 crop_extent{64, 64, 16, 16};

Box4 central_box(const Extent4& size) {
    Box4 box;
    for (std::size_t axis = 0; axis < 4; ++axis) {
        const std::uint32_t extent = std::min(size[axis], crop_extent[axis]);
        box.begin[axis] = (size[axis] - extent) / 2;
        box.end[axis] = box.begin[axis] + extent;
    }
    return box;
}

bool is_scene(const std::string& name) {
    return kind_of(name) == TextureKind::unknown && corpus::find_scene(name).ok();
}

Result<std::unique_ptr<TexelSource>> open_scene(const TextureRequest& r, RdTexture& texture) {
    TESSERA_TRY_ASSIGN(const auto info, corpus::find_scene(r.name));
    texture.window = SphereWindow{};
    return corpus::make_baked_source(r.name, r.hints.size.value_or(info.default_size), r.samples,
                                     1);
}

Result<std::unique_ptr<TexelSource>> open_named(const TextureRequest& r, RdTexture& texture) {
    if (is_scene(r.name))
        return open_scene(r, texture);
    TESSERA_TRY_ASSIGN(auto opened, open_texture(r.name, r.hints));
    const auto window = sphere_window(opened.description);
    if (window.ok() && !window->inside) // the paper's views look at it from outside
        texture.window = *window;
    else if (r.on_sphere)
        texture.window = SphereWindow{};
    return std::move(opened.source);
}

// Reads a slab in parallel, one row of v per task.
Status read_slab(TexelSource& source, const Box4& slab, RdTexture& texture, const Box4& box,
                 unsigned threads, const std::function<void()>& tick) {
    TESSERA_TRY(source.begin_slab(slab));
    std::vector<int> workers(thread_count(threads));
    const std::uint32_t rows = slab.extent()[axis_v];
    return parallel_for(
        workers, rows,
        [&](int, std::size_t row) -> Status {
            Box4 part = slab;
            part.begin[axis_v] += static_cast<std::uint32_t>(row);
            part.end[axis_v] = part.begin[axis_v] + 1;
            std::vector<std::byte> texels(texture.desc.box_bytes(part));
            TESSERA_TRY(source.read(part, texels));
            copy_box(part, part, texels, box, texture.texels, texture.desc.texel_bytes());
            return {};
        },
        [&](std::size_t) { tick(); });
}

// Divides the box into slabs that suit the locality of the source.
std::vector<Box4> slabs_of(const TexelSource& source, const Box4& box) {
    if (source.locality() == Locality::angular_cells)
        return {box};
    std::vector<Box4> slabs;
    constexpr std::uint32_t rows = 8;
    for (std::uint32_t v = box.begin[axis_v]; v < box.end[axis_v]; v += rows) {
        slabs.push_back(box);
        slabs.back().begin[axis_v] = v;
        slabs.back().end[axis_v] = std::min(v + rows, box.end[axis_v]);
    }
    return slabs;
}

Status read_box(TexelSource& source, const Box4& box, RdTexture& texture, unsigned threads,
                const ProgressFunction& progress) {
    const std::vector<Box4> slabs = slabs_of(source, box);
    for (std::size_t i = 0; i < slabs.size(); ++i)
        TESSERA_TRY(read_slab(source, slabs[i], texture, box, threads, [&] {
            if (progress)
                progress("reading", static_cast<double>(i), static_cast<double>(slabs.size()));
        }));
    return {};
}

std::string label_of(const std::string& name) {
    std::string path = name;
    while (path.size() > 1 && path.back() == '/')
        path.pop_back();
    std::string label = to_path(path).stem().string();
    for (char& c : label)
        if (!std::isalnum(static_cast<unsigned char>(c)))
            c = '_';
    return label.empty() ? "texture" : label;
}

std::string hex(std::uint32_t value) {
    char text[16];
    std::snprintf(text, sizeof text, "%08x", value);
    return text;
}

} // namespace

Status check_rd_name(const std::string& name) {
    const bool says_kind = kind_of(name) != TextureKind::unknown || is_url(name);
    return says_kind || std::filesystem::exists(to_path(name)) ? Status() : check_scene(name);
}

const std::byte* RdTexture::texel(std::uint32_t u, std::uint32_t v, std::uint32_t s,
                                  std::uint32_t t) const {
    return texels.data() + Box4::whole(desc.size).index_of({u, v, s, t}) * desc.texel_bytes();
}

void describe_texels(RdTexture& texture) {
    const std::size_t bytes = texture.desc.texel_bytes();
    texture.checksum = to_string(texture.desc.size) + " " + std::to_string(texture.desc.channels) +
                       " x " + name_of(texture.desc.type) + " " + hex(checksum(texture.texels));
    std::unordered_map<std::uint64_t, std::uint64_t> counts;
    for (std::size_t at = 0; at < texture.texels.size(); at += bytes) {
        std::uint64_t value = 0;
        std::memcpy(&value, texture.texels.data() + at, bytes);
        ++counts[value];
    }
    std::uint64_t best = 0, most = 0;
    for (const auto& [value, count] : counts)
        if (count > most || (count == most && value < best)) {
            best = value;
            most = count;
        }
    texture.background.resize(bytes);
    std::memcpy(texture.background.data(), &best, bytes);
    texture.background_share =
        static_cast<double>(most) / static_cast<double>(texture.texel_count());
}

Result<RdTexture> load_rd_texture(const TextureRequest& request, const ProgressFunction& progress) {
    RdTexture texture;
    texture.name = request.name;
    texture.label = label_of(request.name);
    TESSERA_TRY_ASSIGN(auto opened, open_named(request, texture));
    const auto source = interruptible(std::move(opened));
    const Extent4 whole = source->desc().size;
    const Box4 box = request.crop ? central_box(whole) : Box4::whole(whole);
    texture.desc = source->desc();
    texture.desc.size = box.extent();
    if (texture.desc.size != whole) {
        texture.crop = to_string(box);
        texture.window.reset(); // views need the whole sphere
    }
    const std::uint64_t bytes = texture.desc.box_bytes(box);
    if (bytes > max_rd_bytes)
        return Status(ErrorCode::unsupported,
                      request.name + ": " + human_bytes(bytes) +
                          " of texels; rd holds them in memory and takes up to " +
                          human_bytes(max_rd_bytes) + "; use --quick to measure a part");
    texture.texels.resize(bytes);
    TESSERA_TRY(read_box(*source, box, texture, request.hints.threads, progress));
    describe_texels(texture);
    return texture;
}

} // namespace tessera
