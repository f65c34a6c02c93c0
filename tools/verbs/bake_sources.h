// What `tessera bake` was asked for, and the texels that this makes.
#pragma once

#include "codec/encoder.h"
#include "corpus/surface/surface_detail.h"
#include "tools/scenes/lit_model_file.h"
#include "tools/support/encode_arguments.h"
#include "tools/support/json_text.h"
#include "tools/support/texture_arguments.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tessera {

struct BakeCommand {
    std::string scene, output; // a built-in scene's name, or a model's file
    TextureArguments texture;  // threads and quiet; size is the size to bake
    unsigned samples = 16;
    std::optional<std::uint64_t> seed;
    bool list = false;
    std::optional<double> density;
    std::string directions; // SxT
    ModelArguments model;
    EncodeArguments encode; // its description has the proxy
};

struct Baking {
    std::unique_ptr<TexelSource> texels;
    std::unique_ptr<TexelSource> mask; // none: all texels matter
    Description description;
    std::vector<std::byte> mesh; // of Proxy::mesh
    Extent4 tile = tile_by_trial;
    // What makes the texels, as names and values: facts of the journal and, with a capital, metadata.
    std::vector<std::pair<std::string, std::string>> facts;
    // Of files that are read for it: facts of the journal alone.
    std::vector<std::pair<std::string, std::string>> input_facts{};
    Json json;          // the same and more, for --json
    std::string remark; // for people, a line; may be empty
};

bool is_compressed(const BakeCommand& a);

// --density, --directions and --tile. Errors: bad_argument.
Result<corpus::SurfaceWish> surface_wish(const BakeCommand& a);

// On the paper's sphere or, with --proxy mesh and for models, on the surfaces of the things themselves. Takes out of `a` the
// words of the description that are said in another way. Errors: bad_argument, where options do not go
// together; those of the bakers.
Result<Baking> make_baking(BakeCommand& a);

} // namespace tessera
