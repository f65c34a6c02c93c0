// The encoder's options, which encode and bake share.
#pragma once

#include "codec/encoder.h"

#include <CLI/CLI.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tessera {

struct EncodeArguments {
    std::optional<double> quality, target_psnr, target_bpt, max_error;
    std::optional<std::uint64_t> target_bytes;
    std::optional<int> effort;
    bool lossless = false, lossless_fallback = false, no_verify = false, layers = false,
         strict = false, resume = false, json = false;
    std::string tile, memory;
    std::vector<std::string> metadata;              // key=value
    std::map<std::string, std::string> description; // field -> text
};

// Headings of the help.
inline constexpr const char* layout_heading = "Layout of the file";
inline constexpr const char* description_heading = "Description of the texture";

void add_rate_options(CLI::App& app, EncodeArguments& arguments);        // and --effort
void add_run_options(CLI::App& app, EncodeArguments& arguments);         // how a run goes
void add_layout_options(CLI::App& app, EncodeArguments& arguments);      // how the file is made up
void add_description_options(CLI::App& app, EncodeArguments& arguments); // what the texture is

// `metadata` and `description` come from the input; the command line overrides them. Accepts
// --proxy mesh without looking for a mesh. Errors: bad_argument.
Result<EncodeOptions> make_encode_options(const EncodeArguments& arguments, unsigned threads,
                                          Metadata metadata, Description description);

// Refuses options whose values the file of --reuse determines. Errors: bad_argument.
Status check_reuse_options(const EncodeArguments& arguments);

// Whether a .tess may be written to `output`, beside the JSON. Call it before reading anything.
// Errors: bad_argument, io.
Status check_tess_output(const EncodeArguments& arguments, const std::string& output);

// Whether `options` suit the texture. Call it before reading a texel. Errors: bad_argument, with
// the option as the user typed it.
Status check_for(const EncodeArguments& arguments, const EncodeOptions& options,
                 const TextureDesc& desc);

// The first option on the command line that only a compressed file can honour; "" if there is none.
std::string option_of_encoder(const EncodeArguments& arguments);

// `status` of encode_file, with a hint to --resume if the journal holds finished tiles.
Status with_resume_hint(const Status& status, const std::string& output);

} // namespace tessera
