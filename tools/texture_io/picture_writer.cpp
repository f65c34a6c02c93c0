#include "format/output_file.h"
#include "tools/texture_io/picture_format.h"
#include "tools/texture_io/picture_io.h"
#include "tools/texture_io/picture_layout.h"

#include <vector>

namespace tessera {
namespace {

constexpr std::uint64_t max_held_bytes = 1ull << 30;

struct Sides {
    std::uint64_t width = 0, height = 0;
};

Sides sides_of(const TextureDesc& desc, const ViewLayout& layout) {
    const Extent4& n = desc.size;
    if (layout.quilt)
        return {std::uint64_t{n[axis_u]} * layout.quilt->s,
                std::uint64_t{n[axis_v]} * layout.quilt->t};
    return {std::uint64_t{n[axis_u]} * n[axis_s], std::uint64_t{n[axis_v]} * n[axis_t]};
}

// Takes boxes in any order into the picture, which is written at the end.
class PictureSink : public TexelSink {
public:
    PictureSink(OutputFile file, const TextureDesc& desc, const ViewLayout& layout)
        : file_(std::move(file)), desc_(desc), sides_(sides_of(desc, layout)),
          layout_(desc.size, layout, static_cast<std::uint32_t>(sides_.width),
                  static_cast<std::uint32_t>(sides_.height)),
          pixels_(sides_.width * sides_.height * desc.texel_bytes()) {}

    Status write(const Box4& box, std::span<const std::byte> texels) override {
        TESSERA_TRY(check_box(desc_, box, texels.size()));
        const auto [top, bottom] = layout_.rows_of(box);
        for (std::uint32_t y = top; y < bottom; ++y)
            layout_.visit_row(y, box, [&](const PictureRun& run) { take(run, y, box, texels); });
        return {};
    }

    Status finish() override {
        const PictureShape shape{picture_kind_of_name(file_.path()),
                                 static_cast<std::uint32_t>(sides_.width),
                                 static_cast<std::uint32_t>(sides_.height), desc_.channels};
        TESSERA_TRY_ASSIGN(const auto bytes,
                           encode_picture(shape, desc_.type, pixels_).with_context(file_.path()));
        TESSERA_TRY(file_.append(bytes));
        return file_.commit();
    }

private:
    // The texels of `box` that belong to a run.
    void take(const PictureRun& run, std::uint32_t y, const Box4& box,
              std::span<const std::byte> texels) {
        Box4 of_run{{run.u, run.v, run.s, run.t}, {run.u + 1, run.v + 1, run.s + 1, run.t + 1}};
        of_run.end[run.along_s ? axis_s : axis_u] += run.count - 1;
        const Box4 shared = intersect(of_run, box);
        if (shared.texels() == 0)
            return;
        const std::size_t texel = desc_.texel_bytes();
        const std::uint32_t skipped =
            run.along_s ? shared.begin[axis_s] - run.s : shared.begin[axis_u] - run.u;
        std::byte* to = pixels_.data() + (y * sides_.width + run.x + skipped) * texel;
        copy_box(shared, box, texels, shared, {to, desc_.box_bytes(shared)}, texel);
    }

    OutputFile file_;
    TextureDesc desc_;
    Sides sides_;
    PictureLayout layout_;
    std::vector<std::byte> pixels_;
};

} // namespace

Status check_picture_output(const std::string& path, const TextureDesc& desc,
                            const ViewLayout& layout) {
    const std::uint64_t views = std::uint64_t{desc.size[axis_s]} * desc.size[axis_t];
    if (layout.quilt && layout.quilt->count() != views)
        return {ErrorCode::bad_argument, path + ": a quilt of " + to_string(*layout.quilt) +
                                             " has not one place for each view of " +
                                             to_string(desc.size) + "; say --quilt"};
    TESSERA_TRY(check_picture_kind(picture_kind_of_name(path), desc.type, desc.channels)
                    .with_context(path));
    const Sides sides = sides_of(desc, layout);
    if (sides.width > max_extent || sides.height > max_extent ||
        sides.width * sides.height * desc.texel_bytes() > max_held_bytes)
        return {ErrorCode::unsupported, path + ": a picture of " + std::to_string(sides.width) +
                                            "x" + std::to_string(sides.height) +
                                            " pixels is too large; views/ or .exr are not"};
    return {};
}

Result<std::unique_ptr<TexelSink>> create_picture(const std::string& path, const TextureDesc& desc,
                                                  const ViewLayout& layout) {
    TESSERA_TRY(check_picture_output(path, desc, layout));
    TESSERA_TRY_ASSIGN(auto file, OutputFile::create(path));
    return std::unique_ptr<TexelSink>(std::make_unique<PictureSink>(std::move(file), desc, layout));
}

} // namespace tessera
