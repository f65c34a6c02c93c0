#include "corpus/picture_file.h"
#include "format/work.h"
#include "tools/support/description_text.h"
#include "tools/support/interrupt.h"
#include "tools/support/parse.h"
#include "tools/support/slab_buffer.h"
#include "tools/texture_io/clamped_rows.h"
#include "tools/texture_io/picture_io.h"
#include "tools/texture_io/picture_layout.h"

namespace tessera {
namespace {

using corpus::PictureKind;
using corpus::PictureReader;
using corpus::PictureShape;

class PictureSource : public TexelSource {
public:
    PictureSource(std::unique_ptr<ByteSource> file, std::unique_ptr<PictureReader> reader,
                  const TextureDesc& desc, const ViewLayout& layout, Warnings* warnings)
        : file_(std::move(file)), reader_(std::move(reader)), desc_(desc),
          layout_(desc.size, layout, reader_->shape().height), quilt_(layout.quilt),
          warnings_(warnings) {}

    const TextureDesc& desc() const override { return desc_; }
    Locality locality() const override {
        return quilt_ ? Locality::angular_cells : Locality::spatial_rows;
    }

    Status begin_slab(const Box4& box) override {
        TESSERA_TRY(check_interrupt());
        TESSERA_TRY(slab_.reset(desc_, box).with_context(file_->name()));
        const auto [first, last] = layout_.rows_of(box);
        const std::uint32_t t0 = box.begin[axis_t], t1 = box.end[axis_t], t = desc_.size[axis_t];
        // PNG and JPEG decode all rows from the top in any case.
        if (quilt_ || t1 - t0 == t || reader_->shape().kind != PictureKind::exr)
            return read_rows(first, last);
        for (std::uint32_t v = box.begin[axis_v]; v < box.end[axis_v]; ++v)
            TESSERA_TRY(read_rows(v * t + t0, v * t + t1));
        return {};
    }

    Status read(const Box4& box, std::span<std::byte> out) override {
        return slab_.copy_out(box, out).with_context(file_->name());
    }

private:
    // Stores the part of some rows that lies in the slab.
    Status read_rows(std::uint32_t first, std::uint32_t last) {
        const std::size_t texel = desc_.texel_bytes();
        ClampedRows clamped(counted_);
        TESSERA_TRY(reader_->read_rows(
            desc_.type, first, last, [&](std::uint32_t y, std::span<const std::byte> row) {
                clamped.add(y, reader_->clamped_in_row());
                layout_.visit_row(y, slab_.box(), [&](const Box4& part, std::uint32_t x) {
                    copy_box(part, part, row.subspan(x * texel, desc_.box_bytes(part)), slab_.box(),
                             slab_.bytes(), texel);
                });
            }));
        return clamped.say(warnings_, file_->name());
    }

    std::unique_ptr<ByteSource> file_;
    std::unique_ptr<PictureReader> reader_;
    TextureDesc desc_;
    PictureLayout layout_;
    bool quilt_;
    Warnings* warnings_;
    std::vector<bool> counted_; // for ClampedRows
    SlabBuffer slab_;
};

std::string pixels_of(const PictureShape& shape) {
    return std::to_string(shape.width) + "x" + std::to_string(shape.height) + " pixels";
}

// Detects the size of the texture in a quilt or a mosaic, and the facts about it.
class SizeDetection {
public:
    SizeDetection(const PictureReader& reader, const TextureHints& hints, ViewsFacts& facts)
        : reader_(reader), shape_(reader.shape()), hints_(hints), facts_(facts) {}

    Status quilt(const ViewGrid& quilt, Extent4& size) {
        const ViewHints& views = hints_.views;
        ViewOrder usual;
        usual.bottom_up = !views.grid;
        const ViewOrder order = views.order.value_or(usual);
        facts_.layout.quilt = quilt;
        facts_.layout.order = order;
        const ViewGrid cameras =
            views.grid.value_or(ViewGrid{static_cast<std::uint32_t>(quilt.count()), 1});
        if (cameras.count() > quilt.count())
            return {ErrorCode::bad_argument, "a grid of " + to_string(cameras) +
                                                 " cameras does not fit a quilt of " +
                                                 to_string(quilt)};
        size = {shape_.width / quilt.s, shape_.height / quilt.t, cameras.s, cameras.t};
        if (size[axis_u] == 0 || size[axis_v] == 0)
            return {ErrorCode::bad_argument,
                    "its " + pixels_of(shape_) + " are no quilt of " + to_string(quilt)};
        facts_.told = "a quilt of " + to_string(quilt) + " views from the " +
                      (order.bottom_up ? "bottom " : "top ") +
                      (order.right_left ? "right" : "left") + ", " + to_string(cameras) +
                      " cameras";
        if (const std::uint32_t x = shape_.width % quilt.s, y = shape_.height % quilt.t; x + y > 0)
            facts_.told += "; " + std::to_string(x) + " columns and " + std::to_string(y) +
                           " rows of pixels are left over";
        return check_hint(size);
    }

    Status mosaic(Extent4& size) {
        const bool is_exr = shape_.kind == PictureKind::exr;
        if (is_exr)
            TESSERA_TRY(check_exr_layout());
        if (const auto& angular = hints_.views.mosaic) {
            TESSERA_TRY(size_from(*angular, size));
            facts_.told = "a mosaic of angular images of " + to_string(*angular) + " pixels";
            TESSERA_TRY(check_hint(size));
        } else if (hints_.size) {
            size = *hints_.size;
            facts_.told = "a mosaic";
        } else if (is_exr) {
            TESSERA_TRY(size_from_attribute(size));
        } else {
            size = {shape_.width, shape_.height, 1, 1};
            facts_.told = "one view";
        }
        if (is_exr) // described by its attributes, and not assumed to show views of cameras
            facts_.told.clear();
        const std::uint64_t width = std::uint64_t{size[axis_u]} * size[axis_s];
        const std::uint64_t height = std::uint64_t{size[axis_v]} * size[axis_t];
        if (width == shape_.width && height == shape_.height)
            return {};
        return {is_exr ? ErrorCode::invalid_file : ErrorCode::bad_argument,
                "a mosaic of " + to_string(size) + " has " + std::to_string(width) + "x" +
                    std::to_string(height) + " pixels, the picture " +
                    std::to_string(shape_.width) + "x" + std::to_string(shape_.height)};
    }

private:
    Status check_hint(const Extent4& size) const {
        if (!hints_.size || *hints_.size == size)
            return {};
        return {ErrorCode::bad_argument,
                "is " + to_string(size) + ", not " + to_string(*hints_.size)};
    }

    Status check_exr_layout() {
        const std::string layout = reader_.attribute("tessera:layout");
        if (!layout.empty() && layout != "angular-mosaic")
            return {ErrorCode::unsupported, "layout '" + layout.substr(0, 100) + "'"};
        for (const char* field : description_fields)
            if (const std::string text = reader_.attribute(std::string("tessera:") + field);
                !text.empty())
                if (Status s = set_description_field(facts_.description, field, text); !s.ok())
                    return {ErrorCode::invalid_file, s.message()};
        return {};
    }

    Status size_from_attribute(Extent4& size) const {
        const std::string attribute = reader_.attribute("tessera:size");
        if (attribute.empty())
            return {ErrorCode::bad_argument,
                    "has no attribute tessera:size; say --size UxVxSxT, or "
                    "--mosaic SxT or --quilt CxR"};
        const auto parsed = parse_extent(attribute);
        if (!parsed.ok())
            return {ErrorCode::invalid_file,
                    "attribute tessera:size: " + parsed.status().message()};
        size = *parsed;
        return {};
    }

    Status size_from(const ViewGrid& angular, Extent4& size) const {
        size = {shape_.width / angular.s, shape_.height / angular.t, angular.s, angular.t};
        if (shape_.width % angular.s == 0 && shape_.height % angular.t == 0 &&
            size[axis_u] <= max_extent && size[axis_v] <= max_extent)
            return {};
        return {ErrorCode::bad_argument, "its " + pixels_of(shape_) +
                                             " are no mosaic of angular images of " +
                                             to_string(angular)};
    }

    const PictureReader& reader_;
    const PictureShape& shape_;
    const TextureHints& hints_;
    ViewsFacts& facts_;
};

} // namespace

Result<std::unique_ptr<TexelSource>> open_picture(std::unique_ptr<ByteSource> file,
                                                  const TextureHints& hints, ViewsFacts& facts) {
    const std::string name = file->name();
    TESSERA_TRY_ASSIGN(auto reader,
                       corpus::open_picture_file(*file, {.threads = thread_count(hints.threads),
                                                         .exif = hints.views.exif,
                                                         .layer = hints.views.layer}));
    if (hints.warnings != nullptr)
        for (const std::string& note : reader->notes())
            TESSERA_TRY(hints.warnings->add(note, name));
    std::optional<ViewGrid> quilt = hints.views.quilt;
    if (!quilt && !hints.views.mosaic && !hints.size)
        quilt = quilt_in_name(name);
    TextureDesc desc;
    SizeDetection detection(*reader, hints, facts);
    TESSERA_TRY((quilt ? detection.quilt(*quilt, desc.size) : detection.mosaic(desc.size))
                    .with_context(name));
    desc.channels = reader->shape().channels;
    const bool is_unorm8 = !quilt && reader->attribute("tessera:type") == "unorm8";
    desc.type = hints.type.value_or(is_unorm8 ? SampleType::unorm8 : reader->shape().usual_type());
    TESSERA_TRY(check_desc(desc).with_context(name));
    return std::unique_ptr<TexelSource>(std::make_unique<PictureSource>(
        std::move(file), std::move(reader), desc, facts.layout, hints.warnings));
}

} // namespace tessera
