// Picture codecs, with one picture per view or all views in one mosaic.
#include "format/work.h"
#include "tools/lab/rd/picture_tools.h"
#include "tools/lab/rd/rivals.h"
#include "tools/lab/rd/view_layout.h"
#include "tools/picture/picture.h"
#include "tools/support/output_folders.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>

namespace tessera {
namespace {

bool is_ppm(const std::string& path) {
    return path.ends_with(".ppm");
}

Status write_picture(const std::string& path, const Picture& picture) {
    if (!is_ppm(path))
        return write_png(path, picture);
    const std::string head =
        "P6\n" + std::to_string(picture.width) + " " + std::to_string(picture.height) + "\n255\n";
    std::vector<std::byte> bytes(head.size());
    std::memcpy(bytes.data(), head.data(), head.size());
    bytes.insert(bytes.end(), picture.rgb.begin(), picture.rgb.end());
    return write_bytes(path, bytes);
}

const Status another_picture(ErrorCode::runtime, "decoded a picture of a different size or kind");

// Takes the samples from the end of the file, because the header may contain comments.
Result<Picture> read_ppm(const std::string& path, std::uint32_t width, std::uint32_t height) {
    TESSERA_TRY_ASSIGN(const auto bytes, bytes_in_file(path));
    Picture picture = blank_picture(width, height, 0);
    const std::size_t count = picture.rgb.size();
    const std::string size = std::to_string(width) + " " + std::to_string(height);
    const std::string head(reinterpret_cast<const char*>(bytes.data()),
                           bytes.size() - std::min(bytes.size(), count));
    if (!head.starts_with("P6") || head.find(size) == std::string::npos)
        return another_picture;
    std::copy(bytes.end() - static_cast<std::ptrdiff_t>(count), bytes.end(), picture.rgb.begin());
    return picture;
}

Result<Picture> read_picture(const std::string& path, std::uint32_t width, std::uint32_t height) {
    if (is_ppm(path))
        return read_ppm(path, width, height);
    TESSERA_TRY_ASSIGN(auto picture, read_png(path));
    return picture.width == width && picture.height == height ? std::move(picture)
                                                              : Result<Picture>(another_picture);
}

// Runs a command for each of `count` files, on all threads. Returns the wall-clock seconds for all.
template <class Command>
Result<double> run_for_all(std::size_t count, const CodingJob& job, const char* stage,
                           const Command& command) {
    const auto begun = std::chrono::steady_clock::now();
    std::vector<int> workers(thread_count(job.threads));
    std::atomic<std::size_t> done{0};
    TESSERA_TRY(parallel_for(
        workers, count,
        [&](int, std::size_t i) {
            const Status ran = run_tool_well(command(i), job.timeout).status();
            ++done;
            return ran;
        },
        [&](std::size_t) {
            if (job.progress)
                job.progress(stage, static_cast<double>(done), static_cast<double>(count));
        }));
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
}

// Encodes and decodes pictures of equal size with the tool. Sets the bytes and times of `coded`.
Result<std::vector<Picture>> code_pictures(const PictureTool& tool, const CodingJob& job,
                                           const std::string& setting,
                                           const std::vector<Picture>& pictures, Coded& coded) {
    const auto file = [&](const char* what, std::size_t i, const char* ending) {
        return job.folder.at(std::string(what) + std::to_string(i) + "." + ending);
    };
    // Many pictures run in parallel with one thread each. A single picture gets all threads.
    const std::string threads = pictures.size() > 1 ? "1" : threads_text(job.threads);
    TESSERA_TRY(parallel_for(pictures.size(), job.threads, [&](std::uint64_t i) {
        return write_picture(file("in", i, tool.pictures), pictures[i]);
    }));
    TESSERA_TRY_ASSIGN(coded.encode_seconds,
                       run_for_all(pictures.size(), job, "encoding", [&](std::size_t i) {
                           return tool.encode(file("in", i, tool.pictures),
                                              file("coded", i, tool.ending), setting, threads);
                       }));
    for (std::size_t i = 0; i < pictures.size(); ++i) {
        TESSERA_TRY_ASSIGN(const auto bytes, bytes_of_file(file("coded", i, tool.ending)));
        coded.bytes += bytes;
    }
    TESSERA_TRY_ASSIGN(coded.decode_seconds, best_time([&] {
                           return run_for_all(pictures.size(), job, "decoding", [&](std::size_t i) {
                               return tool.decode(file("coded", i, tool.ending),
                                                  file("out", i, tool.pictures), threads);
                           });
                       }));
    std::vector<Picture> back(pictures.size());
    TESSERA_TRY(parallel_for(pictures.size(), job.threads, [&](std::uint64_t i) {
        TESSERA_TRY_ASSIGN(back[i], read_picture(file("out", i, tool.pictures), pictures[i].width,
                                                 pictures[i].height));
        return Status();
    }));
    return back;
}

Result<Coded> code_views(const PictureTool& tool, const CodingJob& job,
                         const std::string& setting) {
    const auto order = serpentine(job.texture.desc.size);
    std::vector<Picture> views;
    for (const ViewIndex view : order)
        views.push_back(view_picture(job.texture, view));
    Coded coded;
    TESSERA_TRY_ASSIGN(const auto back, code_pictures(tool, job, setting, views, coded));
    coded.texels.resize(job.texture.texels.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        store_view(back[i], 0, 0, job.texture.desc.size, order[i], coded.texels);
    coded.texel_bytes = coded.view_bytes =
        static_cast<double>(coded.bytes) / static_cast<double>(order.size());
    coded.note = std::to_string(order.size()) + " processes";
    return coded;
}

Result<Coded> code_mosaic(const PictureTool& tool, const CodingJob& job,
                          const std::string& setting) {
    const Extent4& n = job.texture.desc.size;
    const std::uint64_t width = std::uint64_t{n[axis_u]} * n[axis_s];
    const std::uint64_t height = std::uint64_t{n[axis_v]} * n[axis_t];
    if (std::max(width, height) > tool.max_side)
        return Status(ErrorCode::unsupported, "the mosaic has " + std::to_string(width) + " x " +
                                                  std::to_string(height) +
                                                  " pixels, but the limit is " +
                                                  std::to_string(tool.max_side) + " per side");
    Coded coded;
    TESSERA_TRY_ASSIGN(const auto back,
                       code_pictures(tool, job, setting, {mosaic_picture(job.texture)}, coded));
    coded.texels.resize(job.texture.texels.size());
    store_mosaic(back.front(), n, coded.texels);
    coded.texel_bytes = coded.view_bytes = static_cast<double>(coded.bytes);
    return coded;
}

// ASTC blocks have 16 bytes and known positions. A texel needs one block, a view all the blocks
// that it touches.
Result<Coded> code_astc(const CodingJob& job, const std::string& setting) {
    TESSERA_TRY_ASSIGN(auto coded, code_mosaic(astc_tool(), job, setting));
    const std::string block = value_of(setting);
    const double side_x = std::stod(block), side_y = std::stod(block.substr(block.find('x') + 1));
    const Extent4& n = job.texture.desc.size;
    coded.texel_bytes = 16;
    coded.view_bytes = 16 * (n[axis_u] / side_x + 1) * (n[axis_v] / side_y + 1);
    return coded;
}

Rival rival_of(const PictureTool& tool) {
    Rival rival;
    rival.id = tool.id;
    rival.layout = tool.about;
    rival.tools = tool.tools;
    rival.package = tool.package;
    rival.version_arguments = tool.version;
    rival.settings = tool.settings;
    rival.coarser = tool.coarser;
    rival.finer = tool.finer;
    rival.not_applicable = needs_rgb8;
    return rival;
}

Rival rival_by_views(const PictureTool& tool) {
    Rival rival = rival_of(tool);
    rival.layout += ", one file per view";
    rival.run = [&tool](const CodingJob& job, const std::string& setting) {
        return code_views(tool, job, setting);
    };
    return rival;
}

// A third channel of medium grey costs AVIF nothing.
RdTexture with_third_channel(const RdTexture& texture) {
    RdTexture wide;
    wide.desc = texture.desc;
    wide.desc.channels = 3;
    wide.texels.reserve(texture.texel_count() * 3);
    for (std::size_t at = 0; at < texture.texels.size(); at += 2)
        wide.texels.insert(wide.texels.end(),
                           {texture.texels[at], texture.texels[at + 1], std::byte{128}});
    return wide;
}

Result<Coded> code_planes(const CodingJob& job, const std::string& setting) {
    if (job.texture.desc.channels == 3)
        return code_views(avif_planes_tool(), job, setting);
    const RdTexture wide = with_third_channel(job.texture);
    TESSERA_TRY_ASSIGN(auto coded,
                       code_views(avif_planes_tool(),
                                  {wide, job.folder, job.threads, job.timeout, job.progress},
                                  setting));
    std::vector<std::byte> texels;
    texels.reserve(job.texture.texels.size());
    for (std::size_t at = 0; at < coded.texels.size(); at += 3)
        texels.insert(texels.end(), {coded.texels[at], coded.texels[at + 1]});
    coded.texels = std::move(texels);
    return coded;
}

// Takes two channels as well, such as those of normals whose third coordinate is computed.
Rival avif_planes() {
    Rival rival = rival_of(avif_planes_tool());
    rival.layout += ", one file per view";
    rival.usual = false;
    rival.not_applicable = [](const TextureDesc& desc) {
        TextureDesc rgb = desc;
        if (rgb.channels == 2)
            rgb.channels = 3;
        return needs_rgb8(rgb);
    };
    rival.run = code_planes;
    return rival;
}

Rival avif_mosaic() {
    Rival rival = rival_of(avif_tool());
    rival.id += ":mosaic";
    rival.layout += ", all views in one picture";
    rival.quick = true;
    rival.run = [](const CodingJob& job, const std::string& setting) {
        return code_mosaic(avif_tool(), job, setting);
    };
    return rival;
}

Rival astc_rival() {
    Rival rival = rival_of(astc_tool());
    rival.run = code_astc;
    return rival;
}

} // namespace

std::vector<Rival> picture_rivals() {
    return {rival_by_views(avif_tool()), avif_planes(), avif_mosaic(), rival_by_views(jxl_tool()),
            astc_rival()};
}

} // namespace tessera
