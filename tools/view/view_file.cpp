#include "tools/view/view_file.h"

#include "corpus/exr_stream.h"
#include "corpus/model_surface/display.h"
#include "format/output_file.h"
#include "tools/support/output_folders.h"
#include "tools/texture_io/texture_io.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <algorithm>
#include <filesystem>

namespace tessera {
namespace {

std::string ending_of(const std::string& path) {
    return to_path(path).extension().string();
}

// EXR files hold light.
std::vector<float> light_of(const View& view, SampleType type) {
    std::vector<float> light = view.rgb;
    if (!traits_of(type).is_float)
        for (float& x : light)
            x = static_cast<float>(corpus::srgb_to_linear(static_cast<double>(x)));
    return light;
}

Status write_exr(const std::string& path, const View& view, SampleType type) {
    TESSERA_TRY(make_parent_folders(path));
    TESSERA_TRY_ASSIGN(auto file, OutputFile::create(path));
    ExrOutput stream(file);
    TESSERA_TRY(guard_exr(path, [&]() -> Status {
        const int width = static_cast<int>(view.width), height = static_cast<int>(view.height);
        Imf::Header header(width, height);
        header.compression() = Imf::ZIP_COMPRESSION;
        Imf::FrameBuffer frame;
        const std::vector<float> light = light_of(view, type);
        const std::size_t texel = 3 * sizeof(float);
        const char* const names[] = {"R", "G", "B"};
        for (std::size_t c = 0; c < 3; ++c) {
            header.channels().insert(names[c], Imf::Channel(Imf::FLOAT));
            frame.insert(names[c], Imf::Slice::Make(Imf::FLOAT, light.data() + c, Imath::V2i(0, 0),
                                                    width, height, texel, texel * view.width));
        }
        Imf::OutputFile picture(stream, header);
        picture.setFrameBuffer(frame);
        picture.writePixels(height);
        return {};
    }));
    TESSERA_TRY(stream.status()); // the destructor of Imf::OutputFile has written, too
    return file.commit();
}

} // namespace

Picture to_picture(const View& view, SampleType type) {
    Picture out = blank_picture(view.width, view.height, 0);
    const bool is_float = traits_of(type).is_float;
    for (std::size_t i = 0; i < view.rgb.size(); ++i) {
        const double x = view.rgb[i];
        if (is_float)
            out.rgb[i] = tone_mapped(x);
        else // NaN becomes black
            out.rgb[i] = std::byte(x > 0 ? static_cast<int>(255 * std::min(x, 1.0) + 0.5) : 0);
    }
    return out;
}

Status check_view_path(const std::string& path) {
    if (ending_of(path) != ".png" && ending_of(path) != ".exr")
        return {ErrorCode::bad_argument, path + ": the name of a view must end in .png or .exr"};
    return check_output_path(path);
}

Status write_view(const std::string& path, const View& view, SampleType type) {
    TESSERA_TRY(check_view_path(path));
    return ending_of(path) == ".exr" ? write_exr(path, view, type)
                                     : write_png(path, to_picture(view, type));
}

} // namespace tessera
