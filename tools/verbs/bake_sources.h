// The arguments of `tessera bake`, and the texels that they give.
#pragma once

#include "codec/encoder.h"
#include "corpus/surface/surface_detail.h"
#include "tools/scenes/lit_model_file.h"
#include "tools/support/encode_arguments.h"
#include "tools/support/json_text.h"
#include "tools/support/texture_arguments.h"
#include "tools/verbs/glb_output.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tessera {

inline constexpr std::uint64_t usual_bake_seed = 1;
inline constexpr corpus::Texels2 usual_directions{16, 16}; // of one texture of a model

struct BakeCommand {
    std::string scene, output; // a built-in scene's name, or a model's file
    TextureArguments texture;  // threads, quiet, and the size to bake
    unsigned samples = 16;
    std::optional<std::uint64_t> seed;
    bool list = false, layered = false, single = false;
    std::optional<double> density;
    std::string directions;       // SxT
    std::optional<double> texels; // of a layer
    std::optional<unsigned> lights;
    std::optional<double> noise; // of layers, dB
    ModelArguments model;
    EncodeArguments encode; // its description contains the proxy
    GlbArguments glb;
};

struct Baking {
    std::unique_ptr<TexelSource> texels;
    std::unique_ptr<TexelSource> mask; // none: no texel is masked
    Description description;
    std::vector<std::byte> mesh; // of Proxy::mesh
    Extent4 tile = tile_by_trial;
    // Everything that the texels depend on, as names and values. They are facts of the journal and,
    // capitalised, metadata.
    std::vector<std::pair<std::string, std::string>> facts;
    // The same for the files that are read; facts of the journal only.
    std::vector<std::pair<std::string, std::string>> input_facts;
    Json json;                          // the facts and more, for --json
    std::string remark;                 // one line for people; may be empty
    std::unique_ptr<Warnings> warnings; // of models
};

// A model with its light, as both kinds of bakes need it.
struct ModelToBake {
    LitModelFile file;
    std::unique_ptr<Warnings> warnings;
    std::vector<std::string> notes; // what the model has that is not baked
};

bool is_compressed(const BakeCommand& a);

// Whether the output, a .tess or a .glb, may be written. Errors: those of check_tess_output();
// bad_argument, if the command asks of a .glb what it cannot have.
Status check_compressed_output(const BakeCommand& a);

// Whether the command bakes a mesh if the output is a .glb. Call it before make_baking(). Errors:
// bad_argument.
Status check_has_glb_mesh(const BakeCommand& a);

// Writes the baked .tess as the .glb of the command. Errors: those of write_glb().
Result<GlbReport> write_baked_glb(const BakeCommand& a, std::span<const std::byte> tess);

// The wishes of --density, --directions and --tile. Errors: bad_argument.
Result<corpus::SurfaceWish> surface_wish(const BakeCommand& a);

// A texture on a sphere or, with --proxy mesh and for models, on the surfaces themselves. `model`
// is the one that the command names, or nullptr for a scene. Removes the words from the description
// in `a` that it has applied. Errors: bad_argument, if options do not go together; those of the
// bakers.
Result<Baking> make_baking(BakeCommand& a, ModelToBake* model);

// Facts as metadata: their names begin with a capital letter.
Metadata metadata_of(const std::vector<std::pair<std::string, std::string>>& facts);

// What --size, --seed and such cannot mean with --proxy mesh. Errors: bad_argument.
Status check_mesh_options(const BakeCommand& a);
// Everything that the texels of a scene on its own surfaces depend on.
std::vector<std::pair<std::string, std::string>> scene_facts(const BakeCommand& a, double density,
                                                             const std::string& background);

// Of models only, in bake_models.cpp. What all bakes of models have in common:
Status check_model(const BakeCommand& a); // errors: bad_argument
// Its model has both sides. Errors: those of load_lit_model() and corpus::with_both_sides();
// unsupported, if the command is strict and something is not baked.
Result<ModelToBake> load_model_to_bake(const BakeCommand& a);
// Everything that the texels depend on but the files that are read.
std::vector<std::pair<std::string, std::string>> model_facts(const BakeCommand& a,
                                                             const LitModelFile& file,
                                                             double density,
                                                             const std::vector<std::string>& notes);

// Of models only, in bake_models.cpp. `map` is the value of --angular-map, or empty. Errors of
// model_baking(): those of corpus/model, corpus/trace and corpus/model_surface; bad_argument.
void add_model_options(CLI::App& app, ModelArguments& arguments);
Status check_no_model_options(const ModelArguments& arguments); // errors: bad_argument
Result<Baking> model_baking(const BakeCommand& a, ModelToBake model, const std::string& map);

} // namespace tessera
