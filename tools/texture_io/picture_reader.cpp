#include "tools/support/interrupt.h"
#include "tools/support/slab_buffer.h"
#include "tools/texture_io/mosaic_size.h"
#include "tools/texture_io/picture_format.h"
#include "tools/texture_io/picture_io.h"
#include "tools/texture_io/picture_layout.h"

#include <cstring>

namespace tessera {
namespace {

class PictureSource : public TexelSource {
public:
    PictureSource(std::unique_ptr<ByteSource> file, const PictureShape& shape,
                  const TextureDesc& desc, const ViewLayout& layout)
        : file_(std::move(file)), shape_(shape), desc_(desc),
          layout_(desc.size, layout, shape.width, shape.height), quilt_(layout.quilt) {}

    const TextureDesc& desc() const override { return desc_; }
    Locality locality() const override {
        return quilt_ ? Locality::angular_cells : Locality::spatial_rows;
    }

    // PNG and JPEG begin at the top each time.
    Status begin_slab(const Box4& box) override {
        TESSERA_TRY(check_interrupt());
        TESSERA_TRY(slab_.reset(desc_, box).with_context(file_->name()));
        const auto [first, last] = layout_.rows_of(box);
        return read_picture_rows(*file_, shape_, desc_.type, first, last,
                                 [&](std::uint32_t y, std::span<const std::byte> row) {
                                     layout_.visit_row(y, box, [&](const PictureRun& run) {
                                         store(run, row.data() + run.x * desc_.texel_bytes());
                                     });
                                 });
    }

    Status read(const Box4& box, std::span<std::byte> out) override {
        return slab_.copy_out(box, out).with_context(file_->name());
    }

private:
    // What of a run lies in the slab.
    void store(const PictureRun& run, const std::byte* pixels) {
        const Box4& box = slab_.box();
        const std::size_t texel = desc_.texel_bytes();
        const auto inside = [&](Axis axis, std::uint32_t at) {
            return at >= box.begin[axis] && at < box.end[axis];
        };
        if (!inside(axis_v, run.v) || !inside(axis_t, run.t) ||
            !inside(run.along_s ? axis_u : axis_s, run.along_s ? run.u : run.s))
            return;
        if (run.along_s) {
            const std::uint32_t s = box.begin[axis_s];
            std::memcpy(slab_.texel(run.u, run.v, s, run.t), pixels + s * texel,
                        (box.end[axis_s] - s) * texel);
            return;
        }
        for (std::uint32_t u = box.begin[axis_u]; u < box.end[axis_u]; ++u)
            std::memcpy(slab_.texel(u, run.v, run.s, run.t), pixels + u * texel, texel);
    }

    std::unique_ptr<ByteSource> file_;
    PictureShape shape_;
    TextureDesc desc_;
    PictureLayout layout_;
    bool quilt_;
    SlabBuffer slab_;
};

std::string pixels_of(const PictureShape& shape) {
    return std::to_string(shape.width) + "x" + std::to_string(shape.height) + " pixels";
}

// Sets the size of a quilt's texture.
Status find_quilt(const PictureShape& shape, const ViewHints& hints, const ViewLayout& layout,
                  Extent4& size, std::string& told) {
    const ViewGrid& quilt = *layout.quilt;
    const ViewGrid cameras =
        hints.grid.value_or(ViewGrid{static_cast<std::uint32_t>(quilt.count()), 1});
    if (cameras.count() > quilt.count())
        return {ErrorCode::bad_argument, "a grid of " + to_string(cameras) +
                                             " cameras does not fit a quilt of " +
                                             to_string(quilt)};
    size = {shape.width / quilt.s, shape.height / quilt.t, cameras.s, cameras.t};
    if (size[axis_u] == 0 || size[axis_v] == 0)
        return {ErrorCode::bad_argument,
                "its " + pixels_of(shape) + " are no quilt of " + to_string(quilt)};
    told = "a quilt of " + to_string(quilt) + " views from the " +
           (layout.order.bottom_up ? "bottom " : "top ") +
           (layout.order.right_left ? "right" : "left") + ", " + to_string(cameras) + " cameras";
    if (const std::uint32_t x = shape.width % quilt.s, y = shape.height % quilt.t; x + y > 0)
        told += "; " + std::to_string(x) + " columns and " + std::to_string(y) +
                " rows of pixels are left over";
    return {};
}

} // namespace

Result<std::unique_ptr<TexelSource>> open_picture(std::unique_ptr<ByteSource> file,
                                                  const TextureHints& hints, ViewsFacts& facts) {
    const std::string name = file->name();
    TESSERA_TRY_ASSIGN(const auto shape, read_picture_shape(*file));
    TextureDesc desc;
    desc.channels = shape.channels;
    desc.type = hints.type.value_or(shape.usual_type());
    ViewHints views = hints.views;
    if (!views.mosaic && !views.quilt && !hints.size)
        views.quilt = quilt_in_name(name);
    if (views.quilt) {
        facts.layout.quilt = views.quilt;
        facts.layout.order = views.order.value_or(ViewOrder{false, false, !views.grid, false});
        TESSERA_TRY(
            find_quilt(shape, views, facts.layout, desc.size, facts.told).with_context(name));
        if (hints.size && *hints.size != desc.size)
            return Status(ErrorCode::bad_argument, name + ": is " + to_string(desc.size) +
                                                       ", not " + to_string(*hints.size));
    } else if (views.mosaic) {
        TESSERA_TRY_ASSIGN(
            desc.size, mosaic_size(*views.mosaic, shape.width, shape.height).with_context(name));
        facts.told = "a mosaic of angular images of " + to_string(*views.mosaic) + " pixels";
    } else {
        desc.size = hints.size.value_or(Extent4{shape.width, shape.height, 1, 1});
        facts.told = hints.size ? "a mosaic" : "one view";
    }
    TESSERA_TRY(check_desc(desc).with_context(name));
    if (!views.quilt)
        if (Status s = check_mosaic(desc.size, shape.width, shape.height); !s.ok())
            return Status(ErrorCode::bad_argument, name + ": " + s.message());
    return std::unique_ptr<TexelSource>(
        std::make_unique<PictureSource>(std::move(file), shape, desc, facts.layout));
}

} // namespace tessera
