// The options of the encoder, shared by encode and bake.
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
    bool lossless_fallback = false, no_verify = false, layers = false, strict = false,
         resume = false, json = false;
    std::string tile, tools, memory;
    std::vector<std::string> metadata;              // key=value
    std::map<std::string, std::string> description; // field -> text
};

void add_encode_options(CLI::App& app, EncodeArguments& arguments);

// `metadata` and `description` are what the input says; the command line overrides them.
Result<EncodeOptions> make_encode_options(const EncodeArguments& arguments, unsigned threads,
                                          Metadata metadata, Description description);

// Whether nothing is asked for that a file of --reuse settles. Errors: bad_argument, naming the option.
Status check_reuse_options(const EncodeArguments& arguments);

// Whether a .tess may be written there, and JSON beside it: before anything is read. Errors:
// bad_argument, io.
Status check_tess_output(const EncodeArguments& arguments, const std::string& output);

// Whether `options` suit the texture, in the words of the command line; before a texel is read.
Status check_for(const EncodeArguments& arguments, const EncodeOptions& options,
                 const TextureDesc& desc);

// The first option that was given and that only a compressed file understands; "" for none.
std::string option_of_encoder(const EncodeArguments& arguments);

// An error of encode_file, with how to go on where its journal holds finished tiles.
Status with_resume_hint(const Status& status, const std::string& output);

} // namespace tessera
